"""Jacobians from the residual's blocks against those of the solved equations."""

import casadi as ca
import numpy as np
import pytest


@pytest.mark.every(2)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"kinematics": "linear", "drive": "motion"},
        {"drive": "angle", "translation": False},
        {"kinematics": "rigid"},
    ],
    ids=str,
)
def test_jacobians_are_those_of_the_dynamics(busy, anywhere, options):
    made = busy(**options)
    t, x, u, w, p = made.symbols
    whole = ca.Function("whole", [t, x, u, w, p], [ca.jacobian(e, ca.vertcat(x, u, w)) for e in made.expressions])
    rng = np.random.default_rng(1)
    at, u, w = anywhere(made, size=0.03), rng.normal(size=made.nu), rng.normal(size=made.nw)
    f, h = (np.array(v) for v in whole(2.0, at, u, w, []))
    A, B, E, C, D, F = made.jacobians(at, u, w=w, t=2.0)
    np.testing.assert_allclose(np.hstack([A, B, E]), f, atol=1e-11 * np.abs(f).max())
    np.testing.assert_allclose(np.hstack([C, D, F]), h, atol=1e-12)


@pytest.mark.campaign
def test_twenty_appendages_of_four_modes(anywhere, ring):
    craft = ring(20)
    x = anywhere(craft, size=0.01)
    A = craft.jacobians(x)[0]
    assert A.shape == (173, 173) and len(craft.deviations) == 172
    assert craft._linear.solved.function.n_instructions() < 500_000  # about a millisecond
    modes, rates = craft.layout.modes, craft.layout.mode_rates
    assert np.abs(A[rates[3], modes[17]]).max() > 0  # one boom moves another, through the hub
