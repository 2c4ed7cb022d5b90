"""The package: folders that install under one name, a wheel that holds the tree, imports that stay light."""

import importlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tomllib
import warnings
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDERS = ("plants", "envs", "controllers", "studies")
HEAVY = ("control", "matplotlib", "gymnasium", "scipy.optimize", "scipy.signal", "scipy.integrate", "pandas", "torch")


def python(*code, **options):
    return subprocess.run([sys.executable, *code], capture_output=True, text=True, timeout=120, **options)


@pytest.fixture(scope="module")
def wheel(wheel_file):
    """The wheel's file list."""
    with zipfile.ZipFile(wheel_file) as archive:
        return sorted(archive.namelist())


def test_wheel_holds_exactly_the_tree(wheel):
    inside = [name for name in wheel if ".dist-info/" not in name]
    tree = [
        f"pliant/{path.relative_to(ROOT).as_posix()}"
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    ]
    assert inside == sorted([*tree, "pliant/__init__.py", "pliant/py.typed"])
    assert all(f"pliant/{folder}/py.typed" in inside for folder in FOLDERS)
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


def test_the_version_is_the_packages(installed):
    """Of the wheel and of the install here; what is not there is no attribute, and nothing heavy is imported for it."""
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    code = "import pliant, sys; print(pliant.__version__, hasattr(pliant, 'nothing'), 'numpy' in sys.modules)"
    for path in (str(installed), ""):
        done = python("-c", code, cwd=ROOT / "tests", env=os.environ | {"PYTHONPATH": path})
        assert done.stdout.split() == [wanted, "False", "False"], done.stderr


def test_every_place_has_the_one_version_and_the_readme_names_every_extra():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert f"\nversion: {project['version']}\n" in (ROOT / "CITATION.cff").read_text()
    heading = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[1].rstrip(",")
    assert heading == project["version"]
    short = ".".join(project["version"].split(".")[:2])
    breaking = (ROOT / "docs" / "breaking.md").read_text()
    assert f"\n## {short} (since" in breaking and f"warns in {short} works in every {short}.x" in breaking
    table = re.findall(r"^\| (`.*`) \|", (ROOT / "README.md").read_text(), re.MULTILINE)
    told = {name for row in table for name in re.findall(r"`(\w+)`", row)}
    assert set(project["optional-dependencies"]) <= told


def test_a_wheel_or_an_archive_that_is_not_the_tree_is_told(wheel_file):
    """`make dist` looks at both; here at the wheel as it is, and with faults planted."""
    path = ROOT / ".ci" / "dist.py"
    spec = importlib.util.spec_from_file_location("dist", path)
    dist = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(dist)
    with zipfile.ZipFile(wheel_file) as archive:
        names = archive.namelist()
        (told,) = (name for name in names if name.endswith("/METADATA"))
        words = archive.read(told)
    assert dist.wrong_wheel(names, words) == []
    assert dist.wrong_wheel([n for n in names if not n.endswith("cli.py")], words) == [
        "the wheel lacks pliant/studies/commands/cli.py"
    ]
    assert dist.wrong_wheel([*names, "pliant/left.pyc"], words) == [
        "the wheel has pliant/left.pyc, which is not in the tree"
    ]
    wrong = dist.wrong_wheel(names, words.replace(b"\nVersion: ", b"\nVersion: 9"))
    assert any("must be " in line for line in wrong)
    whole = ["p/" + n.removeprefix("pliant/") for n in dist.tree()] + ["p/" + n for n in dist.MUST]
    assert dist.wrong_archive(whole) == []
    assert dist.wrong_archive([*whole[:-1], "p/build/x"]) == [
        "the archive lacks tests/conftest.py",
        "the archive has build/x",
    ]


def test_an_editable_install_lays_the_package_out_where_checkers_look(tmp_path):
    """Checkers read paths in .pth files, and run no import hook: the only line must be a folder that holds pliant."""
    pytest.importorskip("setuptools", minversion="77")
    copy = tmp_path / "copy"
    copy.mkdir()
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    for folder in ("package", *FOLDERS):
        (copy / folder).mkdir()
        shutil.copy(ROOT / folder / "__init__.py", copy / folder)
    code = "import sys; from setuptools import build_meta; print(build_meta.build_editable(sys.argv[1]))"
    done = python("-c", code, str(tmp_path), cwd=copy)
    assert done.returncode == 0, done.stderr
    (wheel,) = tmp_path.glob("pliant-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        (path,) = [archive.read(name).decode().strip() for name in archive.namelist() if name.endswith(".pth")]
    assert Path(path) == copy / ".editable"
    for folder in FOLDERS:
        assert (Path(path) / "pliant" / folder / "__init__.py").samefile(copy / folder / "__init__.py")


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


PUBLIC = {  # every __all__ of version 0.1, before the modules moved into rooms
    "pliant.controllers": (
        "ComputedTorque Controller Feedback Kalman LQG LQR MPC Margins Motion NMPC Objective PD Policy Predictive "
        "Sensor Shaper Spillover TVLQR delayed loop margins optimal plan riccati rl sensors sensors_of shape "
        "shaper_for spillover"
    ),
    "pliant.controllers.riccati": (
        "Regulator Sampled SampledLTV TimeVaryingRegulator dkalman dlqr dtvlqr kalman lqi lqr sampled sampled_along "
        "tvlqr"
    ),
    "pliant.envs": "PlantEnv Scene environment_id scenes",
    "pliant.envs.scene": "Scene minimum_jerk once_per_scene",
    "pliant.envs.scenes": "SCENES Scene get minimum_jerk names",
    "pliant.plants": (
        "Appendage Beam ElasticJoint Environment EquilibriumError FlexibleSpacecraft FlexibleTree Frame Hinge Hub "
        "InfeasibleError IntegrationError Joint LTVModel LagrangianPlant LargeDeflectionBeam LinearModel "
        "MassMatrixError Material ModalData Orbit Payload Plant PliantError Signal SingleLinkArm SliderCrank "
        "StabilityLimitError Sun Surface Terms Thruster Trajectory TransferMatrices TreeBody TwoLinkArm "
        "UncontrollableError Wheel beams paper_terms step_limit"
    ),
    "pliant.plants.beams": (
        "ALUMINIUM BASES BOUNDARIES Basis Beam Material ModeShapes OffsetPayload Payload PayloadModes Polynomials "
        "STEEL basis clamped_payload_roots count_loaded coupled_frequencies frequencies loaded_roots roots "
        "rotating_frequencies shapes"
    ),
    "pliant.plants.linear": "LTVModel LinearModel",
    "pliant.plants.perturbation": "RigidNominal SecondOrderModel perturbation",
    "pliant.plants.spacecraft": (
        "Appendage Environment FlexibleSpacecraft Hinge Hub ModalData Orbit Sun Surface Thruster Wheel"
    ),
    "pliant.plants.stability": (
        "Certificate Floquet FrozenTime Growth METHODS SlowVariation Verdict assess floquet frozen_time growth "
        "lyapunov slow_variation"
    ),
    "pliant.studies": "chart choose report scoreboard",
    "pliant.studies.figures": (
        "controllers eigenvalues evidence frozen histories inline ladder save settings speed_accuracy stroboscopic "
        "tip_path"
    ),
    "pliant.studies.stability_map": "ModeCount ModesNeeded StabilityMap map_stability modes_needed",
}


def old(module):
    """The module under its name of version 0.1."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return importlib.import_module(module)


@pytest.mark.parametrize("module", PUBLIC)
def test_every_public_name_of_version_0_1_imports_and_is_one_object(module):
    found = old(module)
    for name in PUBLIC[module].split():
        value = getattr(found, name)
        for other, names in PUBLIC.items():  # a name that two modules exported is still the same in both
            if name in names.split() and not (name == "controllers" or other == "pliant.studies.figures"):
                assert getattr(old(other), name) is value, (module, other, name)
        place = getattr(value, "__module__", None)  # and it is what stands in its room
        if hasattr(value, "__qualname__") and isinstance(place, str) and place.startswith("pliant."):
            assert getattr(importlib.import_module(place), value.__qualname__) is value, (module, name)


def test_the_top_packages_still_export_all_that_they_did():
    for module, names in PUBLIC.items():
        if module.count(".") == 1:
            assert set(names.split()) <= set(importlib.import_module(module).__all__), module
