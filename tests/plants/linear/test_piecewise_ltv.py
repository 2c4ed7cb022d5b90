"""Models with jumps: a bat on a swinging mass, against the closed form of both swings."""

import numpy as np
import pytest

from pliant.plants import SingleLinkArm, Trajectory
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV, linearize_pieces

OMEGA = 2.0
SWING = np.array([[0.0, 1.0], [-(OMEGA**2), 0.0]])


def swing(t):
    """x'' = -4 x + u, the states as outputs."""
    nt = len(t)
    B = np.tile([[0.0], [1.0]], (nt, 1, 1))
    named = {"states": ("x", "v"), "inputs": ("u",), "disturbances": (), "outputs": ("x", "v")}
    zero = {k: np.zeros((nt, n)) for k, n in (("c", 2), ("x", 2), ("u", 1), ("y", 2))}
    sizes = {"C": np.tile(np.eye(2), (nt, 1, 1)), "D": np.zeros((nt, 2, 1)), "F": np.zeros((nt, 2, 0))}
    return LTVModel(t, np.tile(SWING, (nt, 1, 1)), B, np.zeros((nt, 2, 0)), **sizes, **zero, **named)


def turned(t):
    """e^(A t) of the swing."""
    c, s = np.cos(OMEGA * t), np.sin(OMEGA * t)
    return np.array([[c, s / OMEGA], [-OMEGA * s, c]])


FIRST, SECOND = np.linspace(0.0, 0.7, 8), np.linspace(0.7, 1.5, 9)
J, KICK = np.array([[1.0, 0.0], [-3.0, 0.5]]), np.array([0.0, 2.0])


def test_a_motion_through_a_jump_and_its_map():
    model = PiecewiseLTV((swing(FIRST), swing(SECOND)), ((J, KICK),))
    start = np.array([1.0, -0.5])
    end = turned(0.8) @ (J @ turned(0.7) @ start + KICK)
    dx, dy = model.simulate(start)
    np.testing.assert_allclose(dx[-1], end, atol=1e-12)
    np.testing.assert_allclose(dx[8], J @ dx[7] + KICK, atol=1e-14)
    np.testing.assert_array_equal(dx, dy)
    np.testing.assert_allclose(model.transition(), turned(0.8) @ J @ turned(0.7), atol=1e-12)
    assert model.t.tolist() == [*FIRST, *SECOND] and model.jump_times.tolist() == [0.7]


def test_inputs_are_given_by_piece():
    """u = 4 in the second piece alone: x'' = -4 (x - 1) from rest at 0 is x = 1 - cos 2t."""
    model = PiecewiseLTV((swing(FIRST), swing(SECOND)), ((np.eye(2), np.zeros(2)),))
    dx, _ = model.simulate(np.zeros(2), [None, [4.0]])
    assert dx[-1, 0] == pytest.approx(1 - np.cos(2 * 0.8), abs=1e-12) and not dx[:8].any()


def test_pieces_must_meet():
    with pytest.raises(ValueError, match=r"pieces\[1\].t\[0\] = 0.7 must be 0.7|jumps has 0 entries, must have 1"):
        PiecewiseLTV((swing(FIRST), swing(SECOND)))
    with pytest.raises(ValueError, match=r"pieces\[1\].t\[0\] = 0.8 must be 0.7, with the same states"):
        PiecewiseLTV((swing(FIRST), swing(SECOND + 0.1)), ((J, KICK),))


def test_an_impulse_on_a_rigid_hub_changes_its_rate_by_torque_over_inertia():
    """A rigid arm without gravity: d(rate) = P / J, and the nominal that jumps by just that has no jump left."""
    arm = SingleLinkArm.textbook().ladder()[0]
    J0, P = float(arm.mass_matrix(np.zeros(2))[0, 0]), 3.0
    before = arm.simulate(np.zeros(2), None, [0.0, 0.1, 0.2])
    after = arm.simulate([0.0, P / J0], None, [0.2, 0.3, 0.4])
    model = linearize_pieces(arm, (before, after), [[P]])
    np.testing.assert_allclose(model.jumps[0][1], np.zeros(2), atol=1e-12)
    missed = linearize_pieces(arm, (before, after), [[2 * P]])
    np.testing.assert_allclose(missed.jumps[0][1], [0.0, P / J0], rtol=1e-10)
    np.testing.assert_allclose(missed.jumps[0][0], np.eye(2), atol=1e-12)


def test_impulses_are_counted():
    arm = SingleLinkArm.textbook().ladder()[0]
    still = Trajectory.from_arrays([0.0, 1.0], np.zeros((2, 2)), np.zeros((2, 1)), plant=arm)
    with pytest.raises(ValueError, match="2 impulses, must be 0"):
        linearize_pieces(arm, (still,), [[1.0], [2.0]])
    with pytest.raises(ValueError, match="must be one or more pieces"):
        linearize_pieces(arm, ())
