"""The same design in other units: SciPy's solver alone loses it, Pliant scales first and says how far a gain is known.

Case: four undamped modes to 1e4 rad/s, eight states, in units of 1e+7 and 1e-7; and a sensor of 1e-5 beside noise of
1e2, whose covariance, subtracted, keeps few digits.
"""

import warnings

import numpy as np
import pytest
from scipy.linalg import LinAlgError, block_diag, solve_continuous_are, solve_discrete_are

from pliant.controllers import LQR, Kalman, Sensor
from pliant.plants import LinearModel, PliantError, SingleLinkArm, UncontrollableError

W = np.linspace(1, 1e4, 4)  # [rad/s]
A = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.diag(W**2), np.zeros((4, 4))]])  # of [q, q']
B = np.array([[0, 0, 0, 0, 1.0, 0.7, -0.4, 0.9]]).T
Q, R = np.eye(8), np.eye(1)
EVEN = np.concatenate([W, np.ones(4)])  # [W q, q']: in these SciPy keeps its digits
OURS = 1e-9  # of the gain, to which Pliant's is right in any units
UNIT = 10.0 ** np.array([7, -7, -7, 7, -7, 7, -7, 7])


def naive(A, B, Q, R):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return np.linalg.solve(R, B.T @ solve_continuous_are(A, B, Q, R))


def scaled(unit):
    return unit[:, None] * A / unit, unit[:, None] * B, Q / unit[:, None] / unit


RIGHT = naive(*scaled(EVEN), R) * EVEN


def test_scipy_alone_gives_another_gain_or_none():
    try:
        found = naive(*scaled(UNIT), R) * UNIT
    except LinAlgError:
        return
    assert np.abs(found - RIGHT).max() > 10 * OURS * np.abs(RIGHT).max()


@pytest.mark.parametrize("unit", [np.ones(8), EVEN, UNIT, 1 / UNIT])
def test_pliant_gives_the_same_gain(unit):
    a, b, q = scaled(unit)
    found = LQR.design(LinearModel.from_matrices(a, b), q, R).K * unit
    np.testing.assert_allclose(found, RIGHT, rtol=0, atol=OURS * np.abs(RIGHT).max())


def test_what_cannot_be_reached_is_refused_in_any_units():
    missed = B * (np.arange(8) != 5)[:, None]  # the second mode, 3334 rad/s
    for unit in (np.ones(8), UNIT):
        a, _, q = scaled(unit)
        with pytest.raises(UncontrollableError, match=r"mode 530\.\d\d Hz \(x\d\) cannot be reached by the input"):
            LQR.design(LinearModel.from_matrices(a, unit[:, None] * missed), q, R)


def test_what_no_units_can_tell_is_refused_with_how_far_it_is_known():
    """Two springs that differ in their last digit, pushed alike: the mode in which they move apart is not known."""
    near = block_diag(*[[[0.0, 1.0], [-9.0, 0.0]]] * 2)
    near[3, 2] *= 1 + 1e-14
    push = np.array([[0.0], [1.0], [0.0], [1.0]])
    with pytest.raises(PliantError, match=r"known only to|cannot be reached"):
        LQR.design(LinearModel.from_matrices(near, push), np.eye(4), R)


def test_an_arm_in_nanometres():
    """Deflections and their rates in nanometres: Q is positive definite, and was said not to see them."""
    arm = SingleLinkArm.textbook().linearize(np.zeros(6), np.zeros(1))
    unit = np.array([1.0 if "hub" in s.name else 1e9 for s in arm.states])
    Q = np.diag([100.0, 1, 1, 1, 0.1, 0.1])
    one = LQR.design(arm, Q, [[0.01]]).K
    names = {"states": arm.state_names}
    nano = LinearModel.from_matrices(unit[:, None] * arm.A / unit, unit[:, None] * arm.B, **names)
    other = LQR.design(nano, Q / unit[:, None] / unit, [[0.01]]).K * unit
    np.testing.assert_allclose(other, one, rtol=0, atol=1e-11 * np.abs(one).max())


def test_a_covariance_by_differences_loses_its_digits():
    """Kalata's tracker (1984), acceleration of standard deviation 1e2 held in T, sensor of 1e-5; r and P in closed form
    (tests/controllers/estimation/test_square_root.py)."""
    T, v, a = 0.5, 1e-5, 1e2
    index = a * T**2 / v
    r = 4 / (4 + index + np.sqrt(8 * index + index**2))
    right = v**2 * (1 - r**2)
    F, G, C = np.array([[1.0, T], [0.0, 1.0]]), np.array([[T**2 / 2], [T]]), np.array([[1.0, 0.0]])
    before = solve_discrete_are(F.T, C.T, a**2 * G @ G.T, np.array([[v**2]]))
    lost = before - before @ C.T @ C @ before / (before[0, 0] + v**2)
    assert abs(lost[0, 0] / right - 1) > 1e-5  # of the size of rounding times index^2
    model = LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], C, outputs=["seen"], inputs=["a"])
    found = Kalman.design(model, [Sensor("other", "seen", "", noise=v)], {"a": a**2 * T}, dt=T, noise="held")
    assert found.covariance[0, 0] == pytest.approx(right, rel=1e-12)
    rate = 4 * (1 - r) ** 3 / (r * T**2) * v**2
    assert found.covariance[1, 1] == pytest.approx(rate, rel=300 * 2.3e-16 * index)
