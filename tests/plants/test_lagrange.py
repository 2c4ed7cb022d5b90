"""What every plant must do, whatever its fidelity: definite mass, balanced energy, exact derivatives, known limits."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from pliant.plants import SingleLinkArm, Trajectory, TwoLinkArm

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()
HUBBED = dataclasses.replace(ARM, modes=(1, 1), hub_inertia=(0.1, 0.02))
METHOD_ORDER = {"rk4": 4, "midpoint": 2, "rosenbrock": 3}


def slope(x, y):
    """Exponent of y ~ x^slope by least squares."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def stiffer(plant, factor):
    """The plant with every beam's E multiplied."""
    changes = {
        name: dataclasses.replace(getattr(plant, name), E=getattr(plant, name).E * factor)
        for name in ("link", "link1", "link2")
        if hasattr(plant, name)
    }
    return dataclasses.replace(plant, **changes)


def test_mass_matrix_is_symmetric_and_positive_definite(plant, random_state):
    states = np.array([random_state(plant, seed) for seed in range(20)])
    M = plant.mass_matrix(states)
    np.testing.assert_allclose(M, M.transpose(0, 2, 1), rtol=0, atol=1e-14 * np.abs(M).max())
    assert np.linalg.eigvalsh(M).min() > 0
    v = states[:, plant.nx // 2 :]
    np.testing.assert_allclose(plant.kinetic(states), np.einsum("bi,bij,bj->b", v, M, v) / 2, rtol=1e-11)


def test_energy_changes_at_the_net_power(plant, random_state):
    for seed in range(5):
        x, u, w = random_state(plant, seed), np.full(plant.nu, 0.7), np.array([1.5, -0.4])
        put_in, lost = plant.power(x, u, w=w)
        rate = plant.dynamics(x, u, w=w)
        step = 1e-3 / np.abs(rate).max()
        differences = [(plant.energy(x + h * rate) - plant.energy(x - h * rate)) / (2 * h) for h in (step, step / 2)]
        change = (4 * differences[1] - differences[0]) / 3
        v = np.abs(x[plant.nx // 2 :]) @ np.abs(plant.mass_matrix(x)) @ np.abs(rate[plant.nx // 2 :])
        assert put_in - lost == pytest.approx(change, abs=1e-7 * (v + abs(put_in)))
        assert lost >= 0


def test_work_done_equals_energy_gained_over_twenty_seconds(undamped):
    x = np.zeros(undamped.nx)
    x[0] = -1.2
    torque = 0.3 * np.ones(undamped.nu)
    motion = undamped.simulate(
        x, lambda t: torque * np.sin(2 * t), np.linspace(0, 20, 81), rtol=1e-9, atol=1e-12, audit=True
    )
    assert np.ptp(undamped.energy(motion.x)) > 1e-3  # work was done
    assert motion.stats["energy_balance"] < 1e-9
