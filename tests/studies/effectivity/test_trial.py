"""One scene from end to end, against numbers found without `trial`; failures are rows."""

import dataclasses
import importlib
import json

import numpy as np
import pytest

from pliant.plants import IntegrationError
from pliant.studies.effectivity.random_scenes import KINDS, random_scene
from pliant.studies.effectivity.tally import Tally
from pliant.studies.effectivity.trial import trial

module, finer = (importlib.import_module(f"pliant.studies.effectivity.{name}") for name in ("trial", "finer_models"))
QUICK = 28  # a cantilever with a wide tolerance, whose truth takes fewer shapes than others'
SIZES = {"cantilever drop": (7, 8)}
FINER = {"basis": "polynomial", "modes": 8, "segments": 1, "points": None, "theory": "timoshenko"}
FINER |= {"extensible": True, "stretches": 2, "shears": 2}


def outputs(scene, plant):
    u = np.array([scene.nominal_input(t) for t in scene.times])
    motion = plant.simulate(scene.with_plant(plant).initial[0], u, scene.times, method="cvodes", rtol=1e-9, atol=1e-11)
    return np.stack([motion[name] for name in scene.compare], axis=1)


@pytest.fixture(scope="module")
def row():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(finer, "SIZES", SIZES)
        return trial(QUICK)


@pytest.mark.campaign
def test_true_errors_are_those_from_the_finer_model(row):
    """CVODES alone, no code of the study but the scene."""
    drawn = random_scene(QUICK)
    scene = drawn.scene
    exact = outputs(scene, dataclasses.replace(scene.plant, **FINER))
    labels = {p.label: p for p in scene.plant.ladder()}
    for rung in row["rungs"]:
        true = np.abs(outputs(scene, labels[rung["variant"]]) - exact).max()
        assert rung["true"] == pytest.approx(true, rel=1e-3)


@pytest.mark.campaign
def test_what_choose_claims_holds_on_it(row):
    tally = Tally([row])
    assert row["failure"] == "" and row["uncertainty"] < 0.05 * row["tolerance"]
    assert not tally.faulty and tally.numbers["decided"] == 1.0
    assert tally.numbers["within 0.8 to 1.25"] == 1.0
    assert json.loads(json.dumps(row)) == row
    assert row["cpu"] > 0 and row["cpu_chosen"] > 0 and row["cpu_finest"] > 0


def test_a_crash_is_a_row_that_says_so(monkeypatch):
    def crash(scene):
        raise ZeroDivisionError("no")

    monkeypatch.setattr(module, "choose", crash)
    row = trial(QUICK)
    assert row["failure"] == "ZeroDivisionError: no" and Tally([row]).faulty


@pytest.mark.campaign
def test_a_truth_that_fails_is_a_row_that_is_left_out(monkeypatch):
    def fails(drawn, motions):
        raise IntegrationError("no steps left", 0.0, np.zeros(2), 0.1)

    monkeypatch.setattr(module, "truth", fails)
    assert Tally([trial(QUICK)]).numbers["left out"] == [QUICK]


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_every_kind(seed):
    tally = Tally([trial(seed)])
    assert not tally.faulty and tally.numbers["decided"] == 1.0
