"""Every public name has shapes, units, errors and an example, and the examples run."""

import doctest
import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.envs import scenes

HOUSE = Path(__file__).parents[1] / "docs" / "house"
sys.path.insert(0, str(HOUSE))
docstrings, sessions = importlib.import_module("docstrings"), importlib.import_module("sessions")
sys.path.remove(str(HOUSE))

# What has no example that runs: this list may shrink, not grow.
WITHOUT = {
    "pliant.plants.core.trajectory.Trajectory.to_pandas",  # of pandas
    "pliant.plants.dynamics.mechanical.BalancedPlant.measure_at",
    "pliant.plants.dynamics.plant.Plant.told_rates",
    "pliant.plants.modal_data.modal_data.ModalData.from_nastran",  # of pyYeti and a file
}
# Shown and not run, and why: this list may shrink, not grow.
SHOWN_ONLY = {
    "pliant.studies.robust.robustify.robustify",  # takes minutes
    "pliant.envs.scenes.scene.Scene.differentiable",  # of torch
    "pliant.controllers.robust_analysis.robust_gain.robust_gain",  # of a loop with blocks that takes a page to make
    "pliant.envs.scene_files.scene_file.load",  # of a file
    "pliant.plants.multibody.tree.FlexibleTree.from_urdf",  # of a file; docs/tutorials/urdf_arm.md runs it
    "pliant.plants.tables.plant_types.register",  # a plant would stay registered
    "pliant.studies.charts.gallery.gallery",  # takes minutes
    "pliant.studies.charts.measure.chart",  # what it prints is time, another on each machine
}
SAMPLE = ("controllers: LQR", "parts: Beam", "parts: Trajectory", "scenes: PlantEnv")
PUBLIC = docstrings.public()
SECTIONS = {test.name: test for test in sessions.tests()}
OWN = {name: item for name, item in PUBLIC.items() if ">>>" in item.doc and name not in SHOWN_ONLY}


@pytest.fixture(scope="module")
def known():
    """What examples take as known beside their own module's names, as docs/api.md says."""
    scene = scenes.get("single-link-slew")
    law = LQR.for_scene(scene)
    motion = scene.plant.simulate(scene.initial[0], law, scene.times, rtol=1e-8, atol=1e-10)
    return {"np": np, "scene": scene, "arm": scene.plant, "law": law, "motion": motion}


def outcome(test):
    told = []
    with np.printoptions(precision=4, suppress=True):
        runner = doctest.DocTestRunner(optionflags=sessions.OPTIONS)
        runner.run(test, out=told.append)
    return "".join(told)


def test_public_names_lack_nothing_but_what_is_listed():
    gaps = docstrings.gaps(PUBLIC)
    assert {name for name, kinds in gaps.items() if kinds != ["example"]} == set()
    assert set(gaps) - WITHOUT == set()
    assert WITHOUT - set(gaps) == set(), "these have an example now: take them off the list"


def bare(q, v):
    return q


def half_told(mass: float) -> float:
    """The mass.

    >>> half_told(1.0)
    """
    if mass < 0:
        raise ValueError("mass")
    return mass


def test_a_planted_gap_is_found():
    """Without a docstring all is lacking; without unit and error those are."""
    assert docstrings.lacks(docstrings.Public("tests.bare", bare)) == list(docstrings.KINDS)
    assert docstrings.lacks(docstrings.Public("tests.half_told", half_told)) == ["measure", "errors"]
    beam = PUBLIC["pliant.plants.beams.section.Beam"]
    assert docstrings.lacks(beam) == []


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[] if n in SAMPLE else pytest.mark.docs, id=n) for n in SECTIONS]
)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_session_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert outcome(SECTIONS[name]) == ""


@pytest.mark.docs
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", OWN)
def test_an_example_in_a_docstring_runs(name, known, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    item = OWN[name]
    module = importlib.import_module((item.function or item.what).__module__)
    names = known | vars(module)
    assert outcome(doctest.DocTestParser().get_doctest(item.doc, names, name, None, 0)) == ""
