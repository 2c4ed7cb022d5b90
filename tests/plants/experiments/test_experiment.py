"""Measured motions: what is missing, what is unknown, and what is refused."""

import numpy as np
import pytest
from springs import SPRING, VARIED

from pliant.plants import Experiment, FlexibleSpacecraft, Trajectory
from pliant.plants.experiments.experiment import checked

T = np.linspace(0.0, 1.0, 5)
Y = {"place": np.array([0.0, np.nan, 0.2, 0.1, np.nan])}


def test_of_a_motion_with_noise_by_seed():
    motion = SPRING.simulate(np.array([1.0, 0.0]), None, np.linspace(0.0, 5.0, 2001))
    one = Experiment.of(motion, signals=("place",), noise={"place": 0.01}, seed=3)
    off = one.measured["place"] - motion["place"]
    assert abs(off.std() / 0.01 - 1) < 4 / np.sqrt(2 * 2001) and abs(off.mean()) < 4 * 0.01 / np.sqrt(2001)
    again = Experiment.of(motion, signals=("place",), noise={"place": 0.01}, seed=3)
    assert (again.measured["place"] == one.measured["place"]).all()
    assert (one.start == motion.x[0]).all() and one.hold == motion.hold


def test_in_a_plants_own_order():
    one = Experiment(t=T, measured={"felt": T, **Y}, u={"force": T}, unknown=("v",), start=(0.5, 0.0))
    found = checked(VARIED, one, "identify.motions[0]")
    assert found.signals == ("felt", "place") and found.unknown == (1,) and found.name == "motion 1"
    assert np.isnan(found.y[:, 1]).tolist() == [False, True, False, False, True]
    assert (found.u[:, 0] == T).all() and (found.start == [0.5, 0.0]).all() and found.scale.tolist() == [1.0]


def test_a_trajectory_is_an_experiment():
    motion = SPRING.simulate(np.array([1.0, 0.0]), None, T)
    assert isinstance(motion, Trajectory)
    found = checked(VARIED, motion, "identify.motions[2]", 2)
    assert found.signals == ("place", "felt") and found.name == "motion 3" and not found.unknown


def test_a_quaternion_is_no_unknown_start():
    craft = FlexibleSpacecraft.textbook()
    state = next(s.name for s in craft.states if not s.unit or s.unit == "1")
    motion = Experiment(t=T, measured={state: np.ones(5)}, start=craft.rest_state, unknown=(state,))
    with pytest.raises(ValueError, match=f"{state} must be known, it cannot move without other states"):
        checked(craft, motion, "identify.motions[0]")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"t": [0.0]}, r"Experiment\.t"),
        ({"t": [0.0, 0.0, 1.0, 2.0, 3.0]}, r"Experiment\.t"),
        ({"measured": {}}, r"Experiment\.measured = \{\} must name"),
        ({"measured": {"place": np.full(5, np.nan)}}, "every sample of place is missing"),
        ({"measured": {"place": [0.0, np.inf, 0, 0, 0]}}, r"measured\['place'\]\[1\] = inf must be finite, or NaN"),
        ({"measured": {"place": [0.0]}}, r"measured\['place'\] has shape \(1,\), must be \(5,\)"),
        ({"u": {"force": [0.0, np.nan, 0, 0, 0]}}, r"Experiment\.u\['force'\]\[1\] = nan must be finite"),
        ({"u": np.ones((4, 1))}, r"Experiment\.u has shape \(4, 1\)"),
        ({"hold": "spline"}, r"Experiment\.hold = 'spline' must be one of"),
        ({"unknown": "x"}, r"Experiment\.unknown = 'x' must be a tuple of names"),
        ({"name": 3}, r"Experiment\.name = 3 must be words"),
    ],
)
def test_refused(changed, words):
    with pytest.raises(ValueError, match=words):
        Experiment(**{"t": T, "measured": Y} | changed)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"measured": {"speed": T}}, "'speed': no such output or state"),
        ({"u": {"push": T}}, "'push': no such input"),
        ({"u": np.ones((5, 2))}, r"motions\[0\]\.u has shape \(5, 2\), must be \(5, 1\)"),
        ({"start": (0.0,)}, r"motions\[0\]\.start has shape \(1,\), must be \(2,\)"),
        ({"unknown": ("a",)}, "'a': no such state"),
        ({"w": (1.0,)}, r"motions\[0\]\.w has shape"),
    ],
)
def test_refused_of_this_plant(changed, words):
    with pytest.raises(ValueError, match=words):
        checked(VARIED, Experiment(**{"t": T, "measured": Y} | changed), "identify.motions[0]")
    with pytest.raises(ValueError, match=r"motions\[0\] = 3 must be an Experiment or Trajectory"):
        checked(VARIED, 3, "identify.motions[0]")


def test_disturbances_of_a_motion_must_be_constant():
    from pliant.plants import SingleLinkArm

    arm = SingleLinkArm.textbook()
    t = np.linspace(0.0, 0.1, 3)
    motion = arm.simulate(None, None, t, w=(0.0, 0.1))
    assert (Experiment.of(motion).w == [0.0, 0.1]).all()
    moved = Trajectory.from_arrays(t, motion.x, motion.u, plant=arm, w=[[0, 0], [0, 1], [0, 2]])
    with pytest.raises(ValueError, match="disturbances that change"):
        Experiment.of(moved)
