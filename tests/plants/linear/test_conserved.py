"""Momenta that no input changes: found in any units, named, and left out of what a loop is asked for."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR, Feedback, loop, margins, spillover
from pliant.envs import scenes
from pliant.plants import PliantError, Wheel
from pliant.plants.linear.conserved import conserved, moved
from pliant.plants.linear.lti import LinearModel

SLEW = scenes.get("spacecraft-slew")


def pair(ratio=1.0, unit=1.0, friction=0.0):
    """A hub that a wheel turns: angle, rate, and the wheel's momentum, in `unit` of it."""
    drag = np.array([-friction, friction / ratio / unit])
    A = np.array([[0.0, 1.0, 0.0], [0.0, *drag], [0.0, *(-unit * drag)]])
    return LinearModel.from_matrices(A, [[0.0], [-1.0], [unit]], states=["angle", "rate", "momentum"])


@pytest.mark.parametrize("unit", [1.0, 1e9, 1e-9])
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("dt", [None, 0.1])
def test_the_total_momentum_of_a_hub_and_its_wheel(unit, friction, dt):
    model = pair(ratio=2.0, unit=unit, friction=friction)
    found = conserved(model if dt is None else model.discretize(dt))
    [w] = found.quantities
    np.testing.assert_allclose(w / w[1] * [1.0, 1.0, unit], [0.0, 1.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(found.down @ found.up, np.eye(2), atol=1e-12)
    assert np.abs(w @ found.up).max() < 1e-12 * np.abs(w).max() * np.abs(found.up).max()
    assert "rate" in found.names[0] and "momentum" in found.names[0]


@pytest.mark.parametrize("name", scenes.names())
def test_of_the_shipped_scenes_two_conserve_something(name):
    scene = scenes.get(name)
    try:
        model = scene.feedback_model
    except PliantError:
        pytest.skip("the goal is no equilibrium")
    kept = {"spacecraft-wheels": 3, "satellite-arm": 12}.get(name, 0)  # twelve: momentum, and with it where it drifts
    assert (len(conserved(model).names), moved(model) is model) == (kept, not kept)


def test_random_models_conserve_nothing_unless_made_to():
    rng = np.random.default_rng(3)
    for _ in range(200):
        n, nu = rng.integers(2, 9), rng.integers(1, 4)
        A, B = rng.normal(size=(n, n)), rng.normal(size=(n, nu))
        assert conserved(LinearModel.from_matrices(A, B)).names == ()
        w, scale = rng.normal(size=n), 10.0 ** rng.uniform(-6, 6, n)
        off = np.eye(n) - np.outer(w, w) / (w @ w)
        wide = LinearModel.from_matrices(scale[:, None] * (off @ A) / scale, scale[:, None] * (off @ B))
        found = conserved(wide)
        assert len(found.names) == 1
        mine = found.quantities[0] * scale
        assert abs(mine @ w) == pytest.approx(np.linalg.norm(mine) * np.linalg.norm(w), rel=1e-9)  # parallel
        before, after = np.linalg.eigvals(off @ A), np.linalg.eigvals(moved(wide).A)
        assert len(after) == n - 1 and all(np.abs(before - z).min() < 1e-4 * np.abs(before).max() for z in after)


def test_a_mode_that_no_input_reaches_is_not_called_conserved():
    """An undamped vibration beside the loop changes by itself: the loop is refused, as before."""
    A = np.array([[-1.0, 0, 0], [0, 0, 1], [0, -4, 0]])
    model = LinearModel.from_matrices(A, [[1.0], [0], [0]])
    assert conserved(model).names == ()
    with pytest.raises(PliantError, match="is not stable, a pole is"):
        margins(loop(model, Feedback([[1.0]], ("x1",))))


def test_a_craft_with_wheels_has_the_margins_of_one_with_torques():
    """Wheels turn the hub by the torque that they take: the same loop, but for three momenta."""
    axes = ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))
    hub = dataclasses.replace(SLEW.plant.hub, wheels=tuple(Wheel(axis=a, inertia=0.05) for a in axes))
    craft = dataclasses.replace(SLEW.plant, hub=hub)
    effort = tuple((f"wheel{k}_torque", weight) for k, (_, weight) in zip((1, 2, 3), SLEW.effort))
    scene = dataclasses.replace(SLEW, plant=craft, drive=lambda plant, t: np.zeros(3), effort=effort)
    with_wheels, without = LQR.for_scene(scene), LQR.for_scene(SLEW)
    found = margins(loop(scene.feedback_model, with_wheels))
    wanted = margins(loop(SLEW.feedback_model, without))
    assert len(found.conserved) == 3 and wanted.conserved == ()
    assert "apart from what no input changes: " in str(found)
    assert found.disk == pytest.approx(wanted.disk, rel=1e-2)  # the wheels' own inertia is a thousandth of the hub's
    for have, want in zip(found.channels, wanted.channels):
        assert (have.phase_deg, have.delay) == pytest.approx((want.phase_deg, want.delay), rel=2e-2)
    said = spillover(with_wheels, [craft], dict(scene.goal))
    assert said.holds and said.conserved == found.conserved and "apart from" in said.verdict
