"""Conservation laws, and power as the rate of energy."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants.spacecraft.energies import conserved
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.environment import Environment, Sun
from pliant.plants.spacecraft_parts.hub import Wheel

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


@pytest.mark.every(2)
@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_momentum_norm_and_energy(hinged, kinematics):
    craft = hinged(dataclasses.replace(CRAFT, kinematics=kinematics), damping=2.0)
    wheels = (Wheel(axis=(1.0, 0.0, 0.0), inertia=0.1, friction=1e-3), Wheel(axis=(0.0, 0.0, 1.0), inertia=0.1))
    craft = dataclasses.replace(craft, hub=dataclasses.replace(craft.hub, wheels=wheels))
    x = craft.state(
        rate_x=0.05,
        rate_y=0.08,
        rate_z=0.1,
        eta1_1=0.05,
        eta2_2=0.02,
        velocity_x=0.1,
        hinge1_1=0.1,
        wheel1_momentum=3.0,
    )
    t = np.linspace(0, 30, 61)
    run = craft.simulate(x, lambda s: np.array([0.5 * np.cos(0.3 * s), 0.2]), t)
    linear, angular = craft.momentum(run.x)
    assert np.abs(linear - linear[0]).max() < 1e-12 * np.linalg.norm(linear[0])
    assert np.abs(angular - angular[0]).max() < 1e-11 * np.linalg.norm(angular[0])
    assert np.abs(np.linalg.norm(run.x[:, craft.layout.quaternion], axis=1) - 1).max() < 1e-12
    push = np.array([0.5, 0.2])

    def with_work(s, z):
        put_in, lost = craft.power(z[:-1], push)
        return np.append(craft.dynamics(z[:-1], push), put_in - lost)

    end = solve_ivp(with_work, (0, 5), np.append(x, 0.0), method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    gained = craft.energy(end[:-1]) - craft.energy(x)
    assert abs(gained) > 0.01 * craft.energy(x)
    assert gained == pytest.approx(end[-1], abs=1e-9 * craft.energy(x))


def test_momentum_over_a_thousand_seconds():
    """Undamped, so that it never comes to rest."""
    craft = dataclasses.replace(CRAFT, appendages=tuple(dataclasses.replace(a, modes=(1, 1)) for a in CRAFT.appendages))
    x = craft.state(rate_x=0.03, rate_y=0.05, rate_z=0.04, eta1_1=0.05, eta2_2=0.02, velocity_x=0.1)
    run = craft.simulate(x, None, np.linspace(0, 1000, 101), rtol=1e-12)
    for kept in craft.momentum(run.x):
        assert np.abs(kept - kept[0]).max() < 1e-10 * np.linalg.norm(kept[0])
    assert np.abs(np.linalg.norm(run.x[:, craft.layout.quaternion], axis=1) - 1).max() < 1e-12
    energy = craft.energy(run.x)
    assert np.abs(energy - energy[0]).max() < 1e-9 * energy[0]
    assert np.abs(run.x[-10:, craft.layout.modes[0]]).max() > 0.01  # it still moves


def test_without_translation_energy_and_momentum_are_about_the_mass_centre(hinged):
    """The whole spacecraft set off so that its mass centre rests has the same, and both keep them."""
    full = hinged(damping=0.0)
    full = dataclasses.replace(full, appendages=(full.appendages[0],))
    short = dataclasses.replace(full, translation=False)
    x = full.state(rate_x=0.05, rate_y=0.08, rate_z=0.1, eta1_1=0.05, eta1_1_rate=0.03, hinge1_1=0.1, hinge1_1_rate=0.1)
    M, at = full.mass_matrix(x), full.layout  # hub axes are the reference axes here
    speeds = np.concatenate([x[at.omega], x[at.rates :]])
    x[at.velocity] = -np.linalg.solve(M[:3, :3], M[:3, 3:] @ speeds)
    cut = np.delete(x, [*range(3), *range(at.velocity.start, at.velocity.stop)])
    assert np.abs(full.momentum(x)[0]).max() < 1e-12
    assert np.abs(short.momentum(cut)[0]).max() < 1e-12
    assert short.energy(cut) == pytest.approx(full.energy(x), rel=1e-13)
    np.testing.assert_allclose(short.momentum(cut)[1], full.momentum(x)[1], rtol=1e-12)
    assert full.energy(full.state(rate_y=0.08)) > 1.001 * short.energy(short.state(rate_y=0.08))  # about the hub
    run = short.simulate(cut, lambda t: np.array([0.2, -0.1, 0.3]) * np.sin(t), np.linspace(0, 10, 41), audit=True)
    assert run.stats["energy_balance"] < 1e-9 and np.ptp(short.energy(run.x)) > 0.1
    free = short.simulate(cut, None, np.linspace(0, 10, 41))
    kept = short.momentum(free.x)[1]
    assert np.abs(kept - kept[0]).max() < 1e-11 * np.linalg.norm(kept[0])


def test_power_is_the_rate_of_energy(busy, anywhere):
    craft = dataclasses.replace(
        busy(), environment=Environment(sun=Sun(direction=(0.0, 0.6, 0.8)), torque=(1.0, 0.0, 0.0))
    )
    t, x, u, w, p = craft.symbols
    rate = ca.Function("rate", [t, x, u, w, p], [ca.jtimes(conserved(craft, x)[0], x, craft.expressions[0])])
    rng = np.random.default_rng(3)
    at, u, w = anywhere(craft), rng.normal(size=craft.nu), rng.normal(size=craft.nw)
    put_in, lost = craft.power(at, u, w=w)
    assert put_in - lost == pytest.approx(float(rate(0, at, u, w, [])), rel=1e-10)
    assert lost > 0
