"""Each step moves inertia as it moves mass points, and forces do the work that motions say."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.core.quaternions import matrix_of, quaternion
from pliant.plants.multibody_parts.spatial import Inertia, Motion, Wrench, upper
from pliant.plants.multibody_parts.steps import Acting, Ball, Fixed, Move, Spin

RNG = np.random.default_rng(1)
POINTS, MASSES = RNG.normal(size=(5, 3)), RNG.uniform(1, 2, 5)
STILL = ca.SX.zeros(3)


def column(v):
    return ca.SX(ca.DM(v))


def numbers(v):
    return np.array(ca.DM(v)).squeeze()


def turn(axis, angle):
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[i, i] = R[j, j] = np.cos(angle)
    R[j, i], R[i, j] = np.sin(angle), -np.sin(angle)
    return R


def cloud(points):
    P = np.einsum("p,pi,pj->ij", MASSES, points, points)
    return Inertia(ca.SX(MASSES.sum()), column(MASSES @ points), upper(ca.SX(ca.DM(P))))


QUATERNION = quaternion([0.3, -0.8, 0.5])
R0 = turn(0, 0.3) @ turn(1, -0.8)
SHIFT = np.array([0.3, -0.2, 0.5])
STEPS = {
    **{
        f"spin {axis}": (
            Spin(axis, ca.SX(np.cos(0.7)), ca.SX(np.sin(0.7)), ca.SX(0), Acting(0, np.eye(3)[axis]), ca.SX(0.7)),
            turn(axis, 0.7),
            np.zeros(3),
        )
        for axis in range(3)
    },
    "ball": (Ball(column(QUATERNION), STILL, (0, 1, 2)), matrix_of(QUATERNION), np.zeros(3)),
    "fixed": (Fixed(ca.DM(R0)), R0, np.zeros(3)),
    "move": (Move(column(SHIFT), STILL, STILL), np.eye(3), SHIFT),
}


@pytest.mark.parametrize("name", STEPS)
def test_inertia_and_forces(name):
    step, R, r = STEPS[name]
    moved = POINTS @ R.T + r
    found, wanted = step.lift(cloud(POINTS)), cloud(moved)
    np.testing.assert_allclose(numbers(found.S), numbers(wanted.S), atol=1e-12)
    np.testing.assert_allclose(numbers(found.P), numbers(wanted.P), atol=1e-12)
    f, n = RNG.normal(size=(2, 3))
    load = step.up(Wrench(column(f), column(n)))
    np.testing.assert_allclose(numbers(load.f), R @ f, atol=1e-12)
    np.testing.assert_allclose(numbers(load.n), R @ n + np.cross(r, R @ f), atol=1e-12)
    v = RNG.normal(size=3)
    np.testing.assert_allclose(numbers(step.within(step.out(column(v)))), v, atol=1e-12)


def test_a_turn_against_its_axis_works_against_it():
    step = Spin(1, ca.SX(1), ca.SX(0), ca.SX(-2.0), Acting(0, -np.eye(3)[1]), ca.SX(0))
    (work,) = step.work(Wrench(STILL, column([1.0, 5.0, 2.0]))).values()
    assert float(work) == -5.0
    (load,) = step.unit(cloud(POINTS)).values()
    np.testing.assert_allclose(numbers(load.n), -numbers(cloud(POINTS).turning(1).n))


def test_motion_goes_down():
    """Of a point that slides out along a turning line: a + alpha x r + omega x (omega x r) + 2 omega x r'."""
    omega, alpha, a, rate = RNG.normal(size=(4, 3))
    step = Move(column(SHIFT), column(rate), STILL)
    found = step.down(Motion(column(omega), column(alpha), column(a)))
    wanted = a + np.cross(alpha, SHIFT) + np.cross(omega, np.cross(omega, SHIFT)) + 2 * np.cross(omega, rate)
    np.testing.assert_allclose(numbers(found.a), wanted, atol=1e-12)
    spin = Spin(2, ca.SX(1), ca.SX(0), ca.SX(0.5), Acting(0, np.eye(3)[2]), ca.SX(0))
    turned = spin.down(Motion(column(omega), column(alpha), column(a)))
    np.testing.assert_allclose(numbers(turned.omega), omega + np.array([0, 0, 0.5]), atol=1e-12)
    np.testing.assert_allclose(numbers(turned.alpha), alpha + np.cross(omega, [0, 0, 0.5]), atol=1e-12)


def test_a_ball_is_three_turns():
    """Work, units and motion of a quaternion's turn, its coordinates the angular velocity beyond."""
    step, R = STEPS["ball"][:2]
    n = np.array([0.5, -1.0, 2.0])
    assert list(step.work(Wrench(STILL, column(n))).values()) == list(n)
    for i, load in step.unit(cloud(POINTS)).items():
        np.testing.assert_array_equal(numbers(load.n), numbers(cloud(POINTS).turning(i).n))
    omega, alpha, a, rate = RNG.normal(size=(4, 3))
    moving = Ball(step.quaternion, column(rate), (0, 1, 2))
    found = moving.down(Motion(column(omega), column(alpha), column(a)))
    np.testing.assert_allclose(numbers(found.omega), R.T @ omega + rate, atol=1e-12)
    np.testing.assert_allclose(numbers(found.alpha), R.T @ alpha + np.cross(R.T @ omega, rate), atol=1e-12)
    pushed = moving.pushed(found, dict(enumerate(column(n).elements())))
    np.testing.assert_allclose(numbers(pushed.alpha) - numbers(found.alpha), n, atol=1e-12)
