"""The package: folders that install under one name, a wheel that holds the tree, imports that stay light."""

import ast
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDERS = ("plants", "envs", "controllers", "studies")
HEAVY = ("control", "matplotlib", "gymnasium", "scipy.optimize", "scipy.signal", "scipy.integrate", "pandas", "torch")


def python(*code, **options):
    return subprocess.run([sys.executable, *code], capture_output=True, text=True, timeout=120, **options)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel's file list, built from a copy, without network."""
    pytest.importorskip("setuptools", minversion="77")
    out = tmp_path_factory.mktemp("wheel")
    copy = out / "copy"
    copy.mkdir()
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    for name in ("pyproject.toml", settings["project"]["readme"], *settings["project"]["license-files"]):
        (copy / name).write_bytes((ROOT / name).read_bytes())
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                target = copy / path.relative_to(ROOT)
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(path.read_bytes())
    built = python(
        "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(out), str(copy)
    )
    assert built.returncode == 0, built.stderr
    (path,) = out.glob("pliant-*.whl")
    with zipfile.ZipFile(path) as archive:
        return sorted(archive.namelist())


def test_wheel_holds_exactly_the_tree(wheel):
    inside = [name for name in wheel if ".dist-info/" not in name]
    tree = sorted(
        f"pliant/{path.relative_to(ROOT).as_posix()}"
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    )
    assert inside == tree
    assert all(f"pliant/{folder}/py.typed" in inside for folder in FOLDERS)
    assert "pliant/__init__.py" not in inside  # a namespace
    assert any(name.endswith("licenses/LICENSE") for name in wheel)
    assert any(name.endswith("entry_points.txt") for name in wheel)


@pytest.mark.parametrize("folder", FOLDERS)
def test_bare_import_names_the_right_one(folder):
    done = python("-c", f"import {folder}", cwd=ROOT)
    assert done.returncode != 0
    assert f"ImportError: this folder is installed as pliant.{folder}: write `import pliant.{folder}`" in done.stderr


def test_importing_plants_imports_nothing_heavy(tmp_path):
    code = f"import sys, pliant.plants; print([m for m in {HEAVY!r} if m in sys.modules])"
    done = python("-c", code, cwd=tmp_path)
    assert done.stdout.strip() == "[]", done.stdout + done.stderr


def test_imports_go_one_way():
    allowed = {
        "plants": {"plants"},
        "controllers": {"plants", "controllers"},
        "envs": {"plants", "envs"},
        "studies": set(FOLDERS),
    }
    for folder, may in allowed.items():
        for path in (ROOT / folder).glob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                modules = []
                if isinstance(node, ast.Import):
                    modules = [alias.name for alias in node.names]
                elif isinstance(node, ast.ImportFrom) and node.level == 0:
                    modules = [node.module] if node.module != "pliant" else [f"pliant.{a.name}" for a in node.names]
                found = {m.split(".")[1] for m in modules if m.startswith("pliant.")}
                assert found <= may, f"{folder}/{path.name} imports {found - may}"


def test_every_folder_says_what_it_exports():
    code = (
        "import importlib\n"
        f"for f in {FOLDERS!r}:\n"
        "    m = importlib.import_module('pliant.' + f)\n"
        "    for name in getattr(m, '__all__', ()):\n"
        "        getattr(m, name)\n"
        "import importlib.metadata as im; print(im.version('pliant'))"
    )
    done = python("-c", code, cwd=ROOT / "tests")
    assert done.returncode == 0, done.stderr
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert done.stdout.strip() == settings["project"]["version"]
