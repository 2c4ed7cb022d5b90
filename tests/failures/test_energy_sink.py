"""Spin about the minor axis: stable when rigid or undamped, unstable with any damper (Explorer 1, 1958).

Energy falls at constant angular momentum, and the minor axis holds the most energy for its momentum.
"""

import dataclasses

import numpy as np
import pytest

from pliant.plants.spacecraft.plant import FlexibleSpacecraft

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), translation=False)
SPIN = 0.8  # [rad/s], below the booms' whirling at 0.994


def damped(ratio, kinematics="stiffened"):
    parts = tuple(dataclasses.replace(a, damping=ratio) for a in CRAFT.appendages)
    return dataclasses.replace(CRAFT, appendages=parts, kinematics=kinematics)


def growth(craft, axis):
    roots = craft.linearize(craft.state({f"rate_{axis}": SPIN})).eigenvalues
    return roots.real.max()


def test_damping_decides():
    # the booms lie along x: x is the minor axis
    assert growth(dataclasses.replace(CRAFT, kinematics="rigid"), "x") < 1e-7
    assert growth(damped(0.0), "x") < 1e-7
    assert growth(damped(0.02), "x") > 1e-5
    # the major axis stays stable and damps its nutation; a root at 0 belongs to the spin angle
    equilibrium, _ = spun("z", damped(0.02))
    assert damped(0.02).linearize(equilibrium).eigenvalues.real.max() < 1e-6


def spun(axis, craft):
    """Steady spin with the booms stretched: about z they bend nowhere, so the state is exact."""
    x = craft.state({f"rate_{axis}": SPIN})
    return x, np.abs(craft.dynamics(x)).max()


def test_growth_grows_with_the_damping():
    rates = np.array([growth(damped(r), "x") for r in (0.005, 0.01, 0.02)])
    np.testing.assert_allclose(rates / rates[0], [1, 2, 4], rtol=0.05)  # a weak sink: proportional to the loss


def test_energy_falls_while_momentum_stays_and_nutation_opens():
    craft = damped(0.2)
    x = craft.state(rate_x=SPIN, rate_y=0.02)
    t = np.linspace(0, 400, 401)
    run = craft.simulate(x, None, t, rtol=1e-8)
    _, H = craft.momentum(run.x)
    assert np.abs(H - H[0]).max() < 1e-6 * np.linalg.norm(H[0])
    E = craft.energy(run.x)
    assert np.diff(E).max() < 1e-9 * E[0]
    cone = np.hypot(run["rate_y"], run["rate_z"])
    early, late = cone[:50].max(), cone[-50:].max()
    predicted = np.exp(growth(craft, "x") * (t[-25] - t[25]))
    assert late > 1.5 * early
    assert late / early == pytest.approx(predicted, rel=0.25)
