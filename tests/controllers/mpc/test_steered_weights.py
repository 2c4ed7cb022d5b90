"""MPC where something is conserved: without active limits the inputs of LQR, which leaves the same out."""

import copy

import numpy as np
import pytest

from pliant.controllers import LQR, MPC
from pliant.controllers.mpc.steered_weights import steered_weights
from pliant.plants import LinearModel, UncontrollableError

J, WHEEL, DT = 2.0, 0.1, 0.05  # hub, wheel [kg m^2], period [s]


def hub(friction=0.0, wheels=1):
    """J w' = sum of u + f (h / I - w), h' = -(that): the sum of J w and all h stays."""
    A, B = np.zeros((2 + wheels, 2 + wheels)), np.zeros((2 + wheels, wheels))
    A[0, 1] = 1.0
    for k in range(wheels):
        on_hub = np.zeros(2 + wheels)
        on_hub[1], on_hub[2 + k] = -friction, friction / WHEEL
        A[1] += on_hub / J
        A[2 + k] -= on_hub
        B[1, k], B[2 + k, k] = 1 / J, -1.0
    return LinearModel.from_matrices(A, B, states=["angle", "rate", *(f"h{k + 1}" for k in range(wheels))])


@pytest.mark.parametrize(("friction", "wheels"), [(0.0, 1), (0.03, 1), (0.0, 3)])
def test_inputs_are_those_of_lqr(friction, wheels):
    """Whatever momentum there is; friction is paid for by an input that is not charged."""
    model, Q, R = hub(friction, wheels), {"angle": 4.0, "rate": 1.0}, 0.5 * np.eye(wheels)
    want = LQR.design(model, Q, R, dt=DT)
    found = MPC.design(model, Q, R, dt=DT, horizon=5, limits=(-np.ones(wheels), np.ones(wheels)))
    assert found.conserved == want.conserved != () and found.free == want.free and len(want.free) == wheels - 1
    for y in (np.full(2 + wheels, 0.01), 0.02 * np.arange(2.0 + wheels)):
        np.testing.assert_allclose(found.act(0.0, y), want.act(0.0, y), rtol=0, atol=1e-9)
    assert copy.deepcopy(found).conserved == found.conserved


def test_inputs_stay_within_limits_there():
    found = MPC.design(hub(), {"angle": 4.0, "rate": 1.0}, [[0.5]], dt=DT, horizon=5, limits=([-0.1], [0.1]))
    assert found.act(0.0, np.array([3.0, 0.0, 1.0])) == pytest.approx([-0.1]) and not found.record.failures


def test_what_is_conserved_and_weighed_is_named():
    """Unless the motion begins where it has the goal's value, as for LQR."""
    model, Q = hub(), {"angle": 1.0, "rate": 1.0, "h1": 1.0}
    with pytest.raises(UncontrollableError, match="cannot be reached by the input, which leaves its value as it is"):
        MPC.design(model, Q, [[1.0]], dt=DT)
    start = np.array([0.3, 0.1, -0.1 * J])
    want, found = (C.design(model, Q, [[1.0]], dt=DT, start=start) for C in (LQR, MPC))
    np.testing.assert_allclose(found.act(0.0, start), want.act(0.0, start), rtol=0, atol=1e-9)


def test_what_is_all_steered_stays_as_it_is():
    model = LinearModel.from_matrices([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]])
    found = steered_weights(model, {"x1": 1.0}, [[1.0]], None, DT, None)
    assert found.P is None and found.left == ((), ()) and found.Q == {"x1": 1.0}
