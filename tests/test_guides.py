"""The guides to one's own plants and scenes: their blocks run as they stand, and say what the text says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from pliant.envs import scenes
from pliant.envs.scene_files import scene_tables
from pliant.plants.files.toml_text import loads

DOCS = Path(__file__).parents[1] / "docs"
CHECKS = {
    "own_plant.md": """
assert abs(swing - (9.81 / 3.0) ** 0.5) < 1e-12  # of a pendulum, any textbook
assert carts.rates == {"x1": "v1", "x2": "v2"} and [(j.input, j.position) for j in carts.joints] == [("force", "x1")]
free = max(model.eigenvalues.imag)  # of a pendulum of 8 kg under a free trolley of 20 kg, friction aside
assert abs(free / (9.81 / 3.0 * (1 + 8.0 / 20.0)) ** 0.5 - 1) < 1e-3
assert tree.nx == 8
""",
    "integrators.md": "assert off < 1e-6 and 1e-4 < limit < 0.02 and coarse.stats['steps'] > 50\n",
    "choose_controller.md": "assert found.holds in (True, False)\nassert reach.cost(played) < 6.0\n",
    "limits.md": "assert arm.unmodelled\n",
    "own_scene.md": "assert observation.shape == (8,) and scene.duration == 4.0\n",
}


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("page", list(CHECKS))
def test_a_guides_blocks_run_in_order(page, tmp_path):
    (tmp_path / "guide.py").write_text("\n".join([*blocks(page, "python"), CHECKS[page]]), encoding="utf-8")
    run = subprocess.run([sys.executable, "guide.py"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_every_page_with_blocks_is_run_by_a_test():
    """The sessions by test_docstrings, which names api.md too; learning.md by test_stock_learners."""
    tests = Path(__file__).parent
    told = "".join((tests / name).read_text(encoding="utf-8") for name in ("test_examples.py", "test_docstrings.py"))
    told += (tests / "envs" / "test_stock_learners.py").read_text(encoding="utf-8")
    pages = [
        p for p in DOCS.rglob("*.md") if "```python" in p.read_text(encoding="utf-8") and p.parent.name != "sessions"
    ]
    lacking = [p.name for p in pages if p.name not in CHECKS and f'{p.name}"' not in told]
    assert pages and lacking == []


def test_a_crane_from_energies_takes_at_most_60_lines():
    assert len(blocks("own_plant.md", "python")[0].splitlines()) <= 60


def test_the_guide_has_every_key_of_a_scene_file():
    text = (DOCS / "own_scene.md").read_text(encoding="utf-8")
    lacking = [key for key in scene_tables.KEYS if not re.search(rf"`\[?{key}\]?`", text)]
    assert lacking == []
    found = scene_tables.from_tables(loads(blocks("own_scene.md", "toml")[0]))
    assert (
        found.duration == 4.0 and found.plant.modes == (1, 1) and found.weights == scenes.get("two-link-reach").weights
    )
