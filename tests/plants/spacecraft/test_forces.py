"""Forces at accelerations that are given against the equations that are solved: r - M a = M (f - a)."""

import numpy as np
import pytest

from pliant.plants.core.trajectory import Trajectory


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"kinematics": "linear", "drive": "motion"},
        {"drive": "angle", "translation": False},
        {"drive": "motion", "translation": False},
        {"kinematics": "rigid"},
    ],
    ids=str,
)
def test_what_is_lacking_takes_any_rates_to_the_models_own(busy, anywhere, options):
    """Wheels, thrusters, hinges, an orbit, the sun: at rates that are no solution."""
    craft = busy(**options)
    rng = np.random.default_rng(1)
    t, x = np.array([0.0, 2.0]), np.array([anywhere(craft, size=0.03), anywhere(craft, size=0.01)])
    u, own = rng.normal(size=(2, craft.nu)), craft.force_balance
    rate = craft.dynamics(x, u, t=t)
    a = rng.normal(size=(2, own.n))
    for i, k in own.driven.items():
        a[:, i] = u[:, k]
    M = own.mass(t, x, u)
    assert (np.linalg.eigvalsh(M) > 0).all()
    a[:, own.free] += np.linalg.solve(M, own.lacking(t, x, u, a)[..., None])[..., 0]
    np.testing.assert_allclose(np.hstack([own.rates(x), a]), rate, atol=1e-10 * np.abs(rate).max())


@pytest.mark.parametrize("options", [{"translation": False}, {"drive": "motion"}], ids=str)
def test_jacobians_along_a_motion_of_the_plant_are_those_of_its_rates(busy, anywhere, options):
    craft = busy(**options)
    x, u = np.tile(anywhere(craft, size=0.03), (2, 1)), np.random.default_rng(2).normal(size=(2, craft.nu))
    t = np.array([0.0, 2.0])
    motion = Trajectory.from_arrays(t, x, u, plant=craft, dx=craft.dynamics(x, u, t=t))
    A = np.array([craft.jacobians(*at, t=time)[0] for *at, time in zip(x, u, t)])
    q = x[0, craft.layout.quaternion]
    unit = np.eye(craft.nx)  # changes that leave the quaternion one of unit length: others are no attitudes
    unit[craft.layout.quaternion, craft.layout.quaternion] -= np.outer(q, q)
    np.testing.assert_allclose(craft.state_jacobians_along(motion) @ unit, A @ unit, atol=1e-10 * np.abs(A).max())
