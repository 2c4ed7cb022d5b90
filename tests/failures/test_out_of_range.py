"""A motion that bends a link further than its kinematics bear: numbers without a word, until the range is looked at.

Naive       a stiffened arm, small slopes, turned so hard that its tip lags by three quarters of its length: a fifth of
            that is wrong
Noticed     simulate warns, names the slope, its range, when it is left and what holds; so do the file, the environment
            and the choice of a model
Holds       kinematics="strain", and LargeDeflectionBeam under the same motion of the hub; other shape functions agree
"""

import dataclasses
import warnings

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.plants import Beam, LargeDeflectionBeam, Material, SingleLinkArm, ValidityWarning
from pliant.studies import choose

STEEL = Material(density=7850.0, E=210e9, G=81e9)
LINK = Beam.rectangular(5.0, width=0.02, depth=0.02, material=STEEL)
ARM = SingleLinkArm(link=LINK, drive="motion", modes=3)
BEAM = LargeDeflectionBeam(beam=LINK, root="driven", gravity=(0.0, 0.0, 0.0), modes=4)
T = np.linspace(0.0, 0.5, 51)
TOLERANCES = {"rtol": 1e-6, "atol": 1e-8}


def lag(plant, hard):
    """Deflection (51,) [m] and what was told, with the hub turned at `hard` rad/s^2."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        motion = plant.simulate(np.zeros(plant.nx), np.array([hard]), T, **TOLERANCES)
    return motion["tip_deflection"], [str(w.message) for w in told if w.category is ValidityWarning]


def test_small_slopes_are_believed_as_far_as_they_go() -> None:
    (naive, told), (true, silent) = lag(ARM, 10.0), lag(BEAM, 10.0)
    assert np.abs(true).max() > 0.7 * LINK.length
    assert np.abs(naive - true).max() > 0.2 * np.abs(true).max()  # wrong by a fifth
    assert len(told) == 1 and "slope of the link" in told[0] and 'kinematics="strain"' in told[0]
    assert not silent
    again, silent = lag(dataclasses.replace(BEAM, basis="polynomial", modes=5), 10.0)
    assert np.abs(again - true).max() < 0.005 * np.abs(true).max() and not silent
    holds, silent = lag(dataclasses.replace(ARM, kinematics="strain"), 10.0)
    assert np.abs(holds - true).max() < 0.005 * np.abs(true).max() and not silent
    (naive, told), (true, _) = lag(ARM, 1.5), lag(BEAM, 1.5)
    assert np.abs(naive - true).max() < 0.05 * np.abs(true).max() and not told


@pytest.fixture(scope="module")
def soft():
    """The slew with a link a hundredth as stiff."""
    scene = scenes.get("single-link-slew", duration=0.2)
    link = dataclasses.replace(scene.plant.link, E=2e9, damping=2e-3)
    plant = dataclasses.replace(scene.plant, link=link)
    return dataclasses.replace(scene, plant=plant, randomise=(), bounds=(), move_time=0.2)


def test_the_environments_say_so_in_the_step_in_which_it_happens(soft) -> None:
    single, lanes = PlantEnv(soft), PlantVectorEnv(soft, 2)
    single.reset()
    lanes.reset()
    seen = []
    for _ in range(8):
        info = single.step(np.ones(1))[4]
        infos = lanes.step(np.array([[1.0], [0.0]]))[4]
        assert ("validity" in info) == ("validity" in infos)
        if "validity" in info:
            (entry,) = info["validity"]
            assert entry["quantity"] == "slope of the link" and entry["holds"] == 'kinematics="strain"'
            assert infos["_validity"].tolist() == [True, False]
            assert infos["validity"][0] == pytest.approx(entry["largest"] / 0.3, rel=1e-6)
        seen.append("validity" in info)
    assert not seen[0] and seen[-1]
    _, info = single.reset(options={"state": np.array([0.0, 0.5, 0.0, 0.0, 0.0, 0.0])})
    assert info["validity"][0]["time"] == 0.0


def test_no_rung_is_taken_for_shown_where_physics_itself_leaves_its_range(soft) -> None:
    found = choose(soft, 10.0)  # a tolerance that every rung keeps
    assert not found.met and all(r.bound is not None for r in found.rungs)
    assert found.missing[0].startswith("turn of") and "Missing: turn of" in found.text  # more points would hold
    assert found.beyond[0].startswith("strain of") and "made for: strain of" in found.text  # nothing here would
