"""The check of the house finds what is planted in a small tree, and nothing in the tree as it is without that."""

import importlib
import shutil
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
HOUSE = ROOT / "docs" / "house"


@pytest.fixture
def check(monkeypatch):
    """docs/house/check.py, imported from its folder and forgotten afterwards."""
    monkeypatch.syspath_prepend(str(HOUSE))
    yield importlib.import_module("check")
    for name in ("check", "import_graph"):
        sys.modules.pop(name, None)


@pytest.fixture
def browser(monkeypatch):
    """docs/house/browser.py, the same way."""
    monkeypatch.syspath_prepend(str(HOUSE))
    yield importlib.import_module("browser")
    sys.modules.pop("browser", None)


RULES = """
[limits]
files = 3
lines = 40
class_lines = 20
[lazy]
packages = ["matplotlib"]
[[room]]
name = "plants.core"
what = "words"
[[room]]
name = "plants.arms"
what = "arms"
[[room]]
name = "envs.scenes"
what = "scenes"
"""
TREE = {
    "plants/__init__.py": "from pliant.plants.arms.arm import Arm\n",
    "plants/core/__init__.py": "",
    "plants/core/words.py": "import numpy\n",
    "plants/arms/__init__.py": "from .arm import Arm\n",
    "plants/arms/arm.py": "from pliant.plants.core.words import name\n\ndef draw():\n    import matplotlib\n",
    "envs/__init__.py": "from pliant.envs import scenes\n",
    "envs/scenes/__init__.py": "from pliant.plants import Arm\nfrom pliant.plants.core import words\n",
    "tests/plants/core/test_words.py": "",
    "tests/plants/arms/test_arm.py": "",
    "CONTRIBUTING.md": "# How\n",
}


@pytest.fixture
def tree(tmp_path):
    for name, text in TREE.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (tmp_path / "rooms.toml").write_text(RULES)
    return tmp_path


def test_a_tree_in_order_has_no_fault(check, tree):
    assert check.faults(tree, tree) == []


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("plants/core/words.py", "from pliant.plants.arms import arm\n", "order: plants.core.words:1"),
        ("plants/core/words.py", "from ..arms.arm import Arm\n", "order: plants.core.words:1"),
        (
            "plants/core/words.py",
            "def f():\n    import pliant.plants.arms.arm\n",
            "order: plants.core.words:2",
        ),
        (
            "plants/core/words.py",
            "if TYPE_CHECKING:\n    from pliant.plants.arms.arm import Arm\n",
            "order: plants.core.words:2 imports plants.arms.arm (for types)",
        ),
        ("plants/arms/arm.py", "import pliant.envs.scenes\n", "folder: plants.arms.arm:1"),
        ("plants/arms/arm.py", "from pliant.plants import Arm\n", "order: plants.arms.arm:1"),
        ("plants/arms/arm.py", "def f():\n    from pliant.plants.core import words\n", "late: plants.arms.arm:2"),
        ("plants/arms/arm.py", "f = lambda: 1\ndef g():\n    import numpy\n", "late: plants.arms.arm:3 imports numpy"),
        ("plants/arms/arm.py", "class A:\n" + "    x = 1\n" * 20, "size: class plants.arms.arm.A has 21 lines"),
        ("plants/arms/arm.py", "x = 1\n" * 41, "size: plants.arms.arm has 41 lines"),
        ("plants/arms/leg.py", "", "test: plants.arms.leg has no test file"),
        ("plants/legs/__init__.py", "x = 1\nimport numpy\n", "room plants.legs: not in rooms.toml"),
        ("CONTRIBUTING.md", "## Modules without a test file\n\n- `plants.arms.arm`: why\n", "which has one"),
        ("CONTRIBUTING.md", "## Modules without a test file\n\n- `plants.arms.gone`: why\n", "which is no module"),
    ],
)
def test_what_is_planted_is_found(check, tree, name, text, said):
    (tree / name).parent.mkdir(exist_ok=True)
    (tree / name).write_text(text)
    found = check.faults(tree, tree)
    assert any(said in fault for fault in found), found


def test_circles_and_full_rooms_are_found(check, tree):
    for name, other in (("one", "two"), ("two", "one")):
        (tree / f"plants/core/{name}.py").write_text(f"from .{other} import x\n")
    found = check.faults(tree, tree)
    assert "circle: plants.core.one <-> plants.core.two" in found
    assert "size: room plants.core has 4 files, more than 3" in found


def test_a_reason_excuses_what_it_names(check, tree):
    (tree / "plants/arms/leg.py").write_text("x = 1\n" * 41)
    (tree / "CONTRIBUTING.md").write_text(
        "## Modules without a test file\n\n- `plants.arms.leg`: drawn\n  by hand\n\n"
        "## Larger than the limits\n\n- `plants.arms.leg`: a table\n"
    )
    assert check.faults(tree, tree) == []
    (tree / "CONTRIBUTING.md").write_text("## Modules without a test file\n\n- `plants.arms.leg`\n")
    assert len(check.faults(tree, tree)) == 2  # a name without a reason excuses nothing


def test_an_upward_import_in_the_real_tree_is_found(check, tmp_path):
    shutil.copytree(ROOT / "plants", tmp_path / "plants", ignore=shutil.ignore_patterns("__pycache__"))
    path = tmp_path / "plants" / "core" / "errors.py"
    path.write_text(
        path.read_text() + "\n\ndef late() -> None:\n    from pliant.plants.arms.two_link import TwoLinkArm\n"
    )
    found = [f for f in check.faults(tmp_path) if "plants.core.errors:" in f]
    assert any(f.startswith("order: ") and "plants.arms stands below" in f for f in found)
    assert any(f.startswith("late: ") for f in found)


def test_the_house_stands(check):
    assert check.faults(ROOT) == []


def test_the_rooms_are_those_of_the_tree(check):
    listed = {room["name"] for room in check.settings()["room"]}
    folders = ("plants", "controllers", "envs", "studies")
    there = {f"{path.parts[-3]}.{path.parts[-2]}" for f in folders for path in (ROOT / f).glob("*/*.py")}
    assert listed == there


def test_contributing_lists_the_rooms(check):
    listed = importlib.import_module("rooms_list")
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    sys.modules.pop("rooms_list")
    assert listed.written(text) == text


@pytest.mark.docs
def test_a_page_that_does_not_fit_is_told(browser, tmp_path):
    """A wide box, a clipped line, a lost picture and grey on black; not a table in a box that scrolls."""
    program = browser.browser()
    if program is None:
        pytest.skip("no browser")
    box = '<p style="overflow:hidden;width:200px;white-space:nowrap">a line that goes on for ever and ever</p>'
    dark = "<style>@media (prefers-color-scheme: dark) {body {background: #111; color: #222}}</style>"
    (tmp_path / "a.html").write_text(
        f'<!doctype html>{dark}<p style="width:700px">wide</p>{box}<img src="no.png" width="9" height="9">'
        '<div style="overflow:auto"><table style="width:2000px"><tr><td>scrolls</td></tr></table></div>',
        encoding="utf-8",
    )
    told = list(browser.faults(tmp_path, program))
    kinds = {(line.split()[2], line.split()[4].rstrip(":"), line.split()[5]) for line in told}
    layout = {"cut", "broken"}
    wanted = {(width, "light", kind) for width in ("360", "800", "1400") for kind in layout}
    assert kinds == wanted | {("360", "light", "wide")} | {("800", "dark", kind) for kind in (*layout, "faint")}
    assert not any("scrolls" in line and "faint" not in line for line in told)
