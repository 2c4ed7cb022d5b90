"""A package of somebody else, installed beside Pliant: one plant, two scenes, known by its entry points alone."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pliant.envs.scene_files.starts import plant_start

PYPROJECT = """
[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"

[project]
name = "their-cranes"
version = "1.0"

[project.entry-points."pliant.plants"]
TheirCrane = "their_cranes.machine:TheirCrane"

[project.entry-points."pliant.scenes"]
their-crane = "their_cranes:their_crane"
their-heavy-crane = "their_cranes:their_heavy_crane"
their-broken-crane = "their_cranes:nothing"

[tool.setuptools]
packages = ["their_cranes"]
package-data = {their_cranes = ["*.toml"]}
"""
CODE = '''
"""Scenes of their crane."""
from pathlib import Path

from pliant.envs import scenes


def their_crane(load: float = 5.0):
    scene = scenes.load(Path(__file__).with_name("their-crane.toml"))
    return scene.with_plant(scene.plant.__class__(load=load))


def their_heavy_crane():
    import dataclasses

    return dataclasses.replace(their_crane(20.0), name="their-heavy-crane", about="the same with 20 kg")
'''


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """A folder with the package installed, and an environment in which Python finds it beside Pliant."""
    source, place = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("beside")
    files = plant_start("their-crane")
    (source / "their_cranes").mkdir()
    (source / "pyproject.toml").write_text(PYPROJECT)
    (source / "their_cranes" / "__init__.py").write_text(CODE)
    (source / "their_cranes" / "machine.py").write_text(files["their_crane.py"].replace("@plants.register", "# "))
    (source / "their_cranes" / "their-crane.toml").write_text(files["their-crane.toml"])
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*pip, "--target", str(place), str(source)], check=True, capture_output=True)
    return place


def told(package: Path, folder: Path, *words: str, status: int = 0) -> subprocess.CompletedProcess[str]:
    run = [sys.executable, "-c", "from pliant.studies.commands.cli import main; main()", *words]
    own = {"PYTHONPATH": str(package), "OMP_NUM_THREADS": "1", "COLUMNS": "120"}
    found = subprocess.run(run, cwd=folder, env=os.environ | own, capture_output=True, text=True)
    assert found.returncode == status, found.stderr
    return found


def test_it_is_listed_and_played_by_name(package, tmp_path):
    """And what of it cannot be had is told, and stops nothing."""
    listed = told(package, tmp_path, "scenes", "--json")
    names = [scene["name"] for scene in json.loads(listed.stdout)]
    assert names[-2:] == ["their-crane", "their-heavy-crane"]
    assert "error: scene 'their-broken-crane' of package 'their-cranes' cannot be had" in listed.stderr
    played = told(package, tmp_path, "linearize", "their-heavy-crane", "--set", "rope=2", "--json")
    swing = np.abs(np.linalg.eigvals(np.array(json.loads(played.stdout)["A"]))).max()
    assert swing == pytest.approx((9.81 / 2.0 * (1 + 20.0 / 20.0)) ** 0.5, rel=2e-3)  # of a load on a free trolley


FILE = """
name = "their-short-crane"
base = {name = "their-crane", load = 8.0}
parameters = {rope = 2.0}
"""


@pytest.mark.campaign
def test_it_is_reported_trained_scored_and_changed_by_a_file(package, tmp_path):
    told(package, tmp_path, "report", "their-crane", "--budget", "5")
    assert (tmp_path / "reports" / "their-crane" / "report.html").stat().st_size > 100_000
    told(package, tmp_path, "train", "their-crane", "--steps", "20000")
    assert list((tmp_path / "trained" / "their-crane").glob("*.npz"))
    (tmp_path / "short.toml").write_text(FILE)
    words = ("--seeds", "2", "--bounds", "0", "--controllers", "LQR,MPC", "--jobs", "1", "--json")
    scored = json.loads(told(package, tmp_path, "scoreboard", "their-crane", "short.toml", *words).stdout)
    assert {row["scene"] for row in scored["rows"]} == {"their-crane", "their-short-crane"}
    code = (
        "import gymnasium, pliant.envs; env = gymnasium.make('pliant/TheirHeavyCrane-v0'); "
        "print(env.unwrapped.scene.plant.load); env.reset(seed=0)"
    )
    own = os.environ | {"PYTHONPATH": str(package)}
    run = subprocess.run([sys.executable, "-c", code], env=own, capture_output=True)
    assert run.stdout.strip() == b"20.0", run.stderr
