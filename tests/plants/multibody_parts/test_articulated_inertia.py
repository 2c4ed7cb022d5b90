"""Inertia with coordinates eliminated against matrices (6, 6) of the same steps."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.core.quaternions import matrix
from pliant.plants.multibody_parts.articulated_inertia import ArticulatedInertia, square
from pliant.plants.multibody_parts.spatial import Inertia, Wrench
from pliant.plants.multibody_parts.steps import Acting, Ball, Fixed, Move, Spin

R = np.array(ca.DM(matrix(np.array([0.8, 0.1, -0.5, 0.3]) / np.sqrt(0.99))))
SHIFT = np.array([0.3, -0.2, 0.5])
ZERO = ca.SX.zeros(3)


def cross(r):
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def whole(own):
    """(6, 6) numbers."""
    F, H, J = (np.array(ca.DM(A)) for A in (square(own.F), own.H, square(own.J)))
    return np.block([[F, H], [H.T, J]])


def some(seed=0):
    """A symmetric one."""
    A = np.random.default_rng(seed).standard_normal((6, 6))
    A = A @ A.T
    rows = np.triu_indices(3)
    return ArticulatedInertia(ca.SX(ca.DM(A[:3, :3][rows])), ca.SX(ca.DM(A[:3, 3:])), ca.SX(ca.DM(A[3:, 3:][rows]))), A


def test_of_a_body_that_moves_as_one() -> None:
    """f = m (a + alpha x c), n = m c x a + J alpha of two points."""
    points, masses = np.array([[0.1, 0.4, -0.3], [0.7, -0.2, 0.5]]), (2.0, 3.0)
    want = np.zeros((6, 6))
    for p, m in zip(points, masses, strict=True):
        moved = np.hstack([np.eye(3), -cross(p)])  # a + alpha x p
        want += m * moved.T @ moved
    P = sum(m * np.outer(p, p) for p, m in zip(points, masses, strict=True))
    S = sum(m * p for p, m in zip(points, masses, strict=True))
    body = Inertia(ca.SX(sum(masses)), ca.SX(ca.DM(S)), ca.SX(ca.DM(P[np.triu_indices(3)])))
    np.testing.assert_allclose(whole(ArticulatedInertia.of(body)), want, atol=1e-14)


@pytest.mark.parametrize(
    ("step", "turn", "shift"),
    [
        (Fixed(ca.DM(R)), R, np.zeros(3)),
        (Ball(ca.SX(ca.DM(np.array([0.8, 0.1, -0.5, 0.3]) / np.sqrt(0.99))), ZERO, (0, 1, 2)), R, np.zeros(3)),
        (Move(ca.SX(ca.DM(SHIFT)), ZERO, ZERO), np.eye(3), SHIFT),
        *(
            (
                Spin(i, ca.SX(np.cos(0.7)), ca.SX(np.sin(0.7)), ca.SX(0), Acting(0, np.eye(3)[i]), ca.SX(0.7)),
                np.array(ca.DM(matrix([np.cos(0.35), *(np.sin(0.35) * np.eye(3)[i])]))),
                np.zeros(3),
            )
            for i in range(3)
        ),
    ],
    ids=["fixed", "ball", "move", "x", "y", "z"],
)
def test_lifts_as_the_motion_goes_down(step, turn, shift) -> None:
    """I' = X^T I X, X takes (a, alpha) before the step to those beyond."""
    own, A = some()
    X = np.block([[turn.T, -turn.T @ cross(shift)], [np.zeros((3, 3)), turn.T]])
    np.testing.assert_allclose(whole(own.lift(step)), X.T @ A @ X, atol=1e-13)


@pytest.mark.parametrize("turns", [False, True])
def test_without_a_coordinate(turns) -> None:
    """I - U U^T / (s . U), and its row along s then zero."""
    own, A = some(1)
    s = np.zeros(6)
    s[3 * turns + 1] = 1.0
    U = own.unit(ca.SX(ca.DM(s[3 * turns :][:3])), turns)
    np.testing.assert_allclose(np.array(ca.DM(ca.vertcat(*U))).ravel(), A @ s, atol=1e-14)
    share = Wrench(U.f / (s @ A @ s), U.n / (s @ A @ s))
    want = A - np.outer(A @ s, A @ s) / (s @ A @ s)
    np.testing.assert_allclose(whole(own.without(U, share)), want, atol=1e-13)
    found = own.without(U, share, (turns, 1))
    np.testing.assert_allclose(whole(found), want, atol=1e-13)
    assert not whole(found)[3 * turns + 1].any()
