"""Controllers side by side: the same runs as elsewhere, bounds that end a run, reasons where there is none."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import MPC
from pliant.envs import scenes
from pliant.plants import Trajectory
from pliant.studies.closed_loop.closed_loop import closed_loop, dearer
from pliant.studies.closed_loop.comparison import compare, ending
from pliant.studies.closed_loop.rollout import rollout

SLEW = scenes.get("single-link-slew")


@pytest.fixture(scope="module")
def slew():
    return compare(SLEW)


def by_name(found, plant):
    return {c.controller: c for c in found if c.plant == plant.label}


def test_every_controller_on_both_plants(slew):
    assert [(c.controller, c.states) for c in slew] == [
        (name, plant.nx) for plant in (SLEW.plant, dearer(SLEW.plant)) for name in ("LQR", "MPC", "trained policy")
    ]
    assert all(c.failure == "" and c.motion is not None for c in slew)
    assert [c.violations for c in slew] == [None, 0, None] * 2


def test_costs_are_those_of_the_environments_kernel(slew):
    """rollout.py plays by RK4 on the compiled kernel, here an adaptive method integrates."""
    law = MPC.for_scene(SLEW, horizon=20)
    played = rollout(SLEW, law)
    own = by_name(slew, SLEW.plant)["MPC"]
    assert own.cost == pytest.approx(played.cost, rel=1e-4)
    assert own.peak == pytest.approx(np.abs(played["tip_deflection"]).max(), rel=1e-3)


@pytest.mark.campaign
def test_the_lqr_that_was_run_already_is_taken(slew):
    """On the design plant and on the finest, not on a plant of the same label with another payload."""
    law, loops = closed_loop(SLEW)
    found = [c for c in compare(SLEW, law, loops) if c.controller == "LQR"]
    assert [c.motion for c in found] == [loops[0].motion, loops[-1].motion]
    assert [c.cost for c in found] == pytest.approx([loops[0].cost, loops[-1].cost], rel=1e-12)
    assert [c.cost for c in found] == pytest.approx([c.cost for c in slew if c.controller == "LQR"], rel=1e-6)


@pytest.mark.campaign
def test_bounds_end_a_run_as_in_the_environment():
    """The slew bends its tip by 16 mm: a bound of 10 mm ends it, at the charge of rollout.py."""
    tight = dataclasses.replace(SLEW, bounds=(("tip_deflection", 0.01),))
    own = by_name(compare(tight), SLEW.plant)["trained policy"]
    played = rollout(tight, _policy())
    assert own.failure == played.failure and "tip_deflection beyond its bound 0.01 at" in own.failure
    assert own.cost == pytest.approx(played.cost, rel=1e-3) and own.final_error is None
    assert len(own.motion.t) == len(played.t) < tight.steps


def _policy():
    from pliant.controllers import Policy

    return Policy.for_scene("single-link-slew")


def test_mpc_keeps_a_bound_that_the_others_break():
    tight = dataclasses.replace(SLEW, bounds=(("tip_deflection", 0.01), ("hub_angle_rate", 12.0)))
    own = by_name(compare(tight), SLEW.plant)
    assert own["MPC"].failure == "" and own["MPC"].peak < 0.01 < own["LQR"].peak
    assert own["LQR"].failure.startswith("tip_deflection beyond")


def test_a_start_out_of_bounds_ends_nothing():
    low = dataclasses.replace(SLEW, bounds=(("hub_angle", 1e-3),))
    x = np.zeros((low.steps + 1, 6))
    x[0, 0] = 1.0
    still = Trajectory.from_arrays(low.times, x, np.zeros((low.steps + 1, 1)), plant=low.plant)
    assert ending(low, still).failure == ""


def test_a_goal_that_is_a_cycle_is_held_by_both():
    short = dataclasses.replace(scenes.get("slider-crank-run"), dt=5 / 192, substeps=100, duration=5 / 24)
    found = compare(short)
    assert {c.controller for c in found} == {"LQR", "MPC"}
    for one in found:
        assert one.motion is not None and one.failure == ""


@pytest.mark.parametrize(
    ("change", "says"),
    [({"limits": (5.0,)}, "it was trained for limits of"), ({"dt": 0.01}, "it acts every 0.02 s")],
)
def test_a_policy_plays_only_what_it_was_trained_for(change, says):
    changed = dataclasses.replace(SLEW, duration=0.4, move_time=0.2, **change)
    assert says in by_name(compare(changed), SLEW.plant)["trained policy"].failure
