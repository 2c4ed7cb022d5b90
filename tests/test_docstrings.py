"""Every public name has shapes, units, errors and an example, and the examples run."""

import doctest
import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

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
# Shown and not run, for they need a file, minutes, another package or names that they do not make: this
# list may shrink, not grow.
SHOWN_ONLY = {
    "pliant.controllers.analysis.margins_along.margins_along",
    "pliant.controllers.robust_design.many_model_lqr.MultiModelLQR.for_scene",
    "pliant.controllers.robust_design.many_model_lqr.MultiModelLQR",
    "pliant.studies.robust.robustify.robustify",
    "pliant.controllers.analysis.margins_along.MarginsAlong",
    "pliant.controllers.robust_analysis.miss_over_box.MissOverBox",
    "pliant.controllers.robust_analysis.miss_over_box.miss_over_box",
    "pliant.controllers.robust_analysis.robust_stability.stands",
    "pliant.envs.scenes.scene.Scene.differentiable",  # of torch
    "pliant.controllers.export.arrays.arrays_of",
    "pliant.controllers.export.arrays.export_arrays",
    "pliant.controllers.export.export_c.export_c",
    "pliant.controllers.learning.train.train",
    "pliant.controllers.robust_analysis.robust_gain.robust_gain",
    "pliant.controllers.robust_analysis.robust_stability.robust_stability",
    "pliant.controllers.robust_analysis.worst_parameters.worst_parameters",
    "pliant.envs.environments.scene_check.check_scene",
    "pliant.envs.scene_files.scene_file.load",
    "pliant.plants.contract.check.check",
    "pliant.plants.dynamics.declaration.Declaration.casadi",
    "pliant.plants.dynamics.plant.Plant.left_ranges",
    "pliant.plants.experiments.csv_columns.read_experiment",
    "pliant.plants.experiments.csv_columns.write_experiment",
    "pliant.plants.experiments.experiment.Experiment",
    "pliant.plants.identification.experiment_design.rank_motions",
    "pliant.plants.identification.maximum_likelihood.identify",
    "pliant.plants.large_deflection.large_beam.LargeDeflectionBeam",
    "pliant.plants.modal_data.modal_data.ModalData.from_craig_bampton",
    "pliant.plants.modal_data.modal_fields.ModalNode",
    "pliant.plants.multibody.tree.FlexibleTree",
    "pliant.plants.multibody.tree.FlexibleTree.from_urdf",
    "pliant.plants.multibody_parts.joint.ElasticJoint",
    "pliant.plants.multibody_parts.joint.Frame",
    "pliant.plants.multibody_parts.joint.FrameThruster",
    "pliant.plants.multibody_parts.joint.Joint",
    "pliant.plants.multibody_parts.joint.Sliding",
    "pliant.plants.multibody_parts.tree_body.TreeBody",
    "pliant.plants.multibody_parts.tree_body.TreeBody.wheel",
    "pliant.plants.tables.plant_types.register",
    "pliant.studies.charts.gallery.gallery",
    "pliant.studies.charts.measure.chart",
    "pliant.studies.fidelity.choice.choose",
    "pliant.studies.monte_carlo.monte_carlo.monte_carlo",
}
SAMPLE = ("controllers: LQR", "parts: Beam", "parts: Trajectory", "scenes: PlantEnv")
PUBLIC = docstrings.public()
SECTIONS = {test.name: test for test in sessions.tests()}
OWN = {name: item for name, item in PUBLIC.items() if ">>>" in item.doc and name not in SHOWN_ONLY}


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
def test_an_example_in_a_docstring_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    item = OWN[name]
    module = importlib.import_module((item.function or item.what).__module__)
    names = {"np": np} | vars(module)
    assert outcome(doctest.DocTestParser().get_doctest(item.doc, names, name, None, 0)) == ""
