"""A link so stiff that nobody sees it bend, whose fastest mode still sets the explicit methods' steps.

Damped in its material, the mode is gone in microseconds and stays at rest. The naive way simulates it as any other arm:
RK4 at a millisecond runs away, which Pliant refuses, and dop853 takes a step every ten microseconds, at any tolerance.
Rodas5P takes a few dozen. Exact: the arm is rigid to 1e-9, so that the hub's angle is that of a body of inertia J under
a torque that is switched over.
"""

import dataclasses

import numpy as np
import pytest

from pliant.plants import IntegrationError, SingleLinkArm, StabilityLimitError
from pliant.plants.integration.step_maps import stepper
from pliant.plants.motions import adaptive_steps

SOFT = SingleLinkArm.textbook()
STIFF = dataclasses.replace(SOFT, modes=2, link=dataclasses.replace(SOFT.link, E=1e6 * SOFT.link.E, damping=1e-5))
TIMES, TORQUE = np.linspace(0.0, 0.1, 101), 2.0  # [N m], the other way from the middle on
PUSH = np.where(np.arange(101) < 50, TORQUE, -TORQUE)[:, None]
LOOSE = {"rtol": 1e-6, "atol": 1e-9}


def rigid_angle(t):
    link, tip = STIFF.link, STIFF.payload
    J = STIFF.hub_inertia + link.density * link.area * link.length**3 / 3 + tip.mass * link.length**2 + tip.inertia
    half = TIMES[-1] / 2
    return TORQUE / J * np.where(t < half, t**2 / 2, half * t - half**2 / 2 - (t - half) ** 2 / 2)


@pytest.fixture(autouse=True)
def on_the_virtual_machine(monkeypatch):
    monkeypatch.setenv("PLIANT_NATIVE", "0")  # steps are the same, and nothing is compiled


def test_the_naive_fixed_step_runs_away_and_is_refused():
    step, x = stepper(STIFF, "rk4"), np.zeros(STIFF.nx)
    with np.errstate(all="ignore"):
        for k in range(100):
            x = step(TIMES[k], x, np.full(3, PUSH[k, 0]), np.zeros(STIFF.nw), np.zeros(0), 1e-3)[0]
    assert not np.abs(x).max() < 1e6
    with pytest.raises(StabilityLimitError, match=r"needs a step of at most 4\.608e-06 s"):
        STIFF.simulate(None, PUSH, TIMES, method="rk4", step=1e-3)


def test_the_naive_adaptive_method_takes_thousands_of_steps_at_any_tolerance(monkeypatch):
    monkeypatch.setattr(adaptive_steps, "MOST_STEPS", 2000)
    for loose in (LOOSE, {"rtol": 1e-3, "atol": 1e-6}):
        with pytest.raises(IntegrationError, match=r'after 2,000 steps, .* or use method="rodas5p"') as stopped:
            STIFF.simulate(None, PUSH, TIMES, **loose)
        assert stopped.value.time < 0.03


def test_the_l_stable_method_holds():
    motion = STIFF.simulate(None, PUSH, TIMES, method="rodas5p", **LOOSE)
    np.testing.assert_allclose(motion["hub_angle"], rigid_angle(TIMES), atol=2e-9)
    assert motion.stats["steps"] < 150
