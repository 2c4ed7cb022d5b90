"""A fast batch stepper past its method's limit: unchecked, every lane is lost without a word; Pliant refuses the step.

The arm is undamped: RK4 keeps a mode of w rad/s up to a step of sqrt(8)/w (Hairer and Wanner 1996, IV.2).
"""

import numpy as np
import pytest

from pliant.plants import SingleLinkArm, StabilityLimitError

ARM = SingleLinkArm.textbook()
REST, HELD = ARM.equilibrium(hub_angle=0.1)
START = np.tile(REST + 1e-3, (4, 1))


def limit():
    """sqrt(8) / w of the fastest mode at rest."""
    values = np.linalg.eigvals(ARM.linearize(REST, HELD).A)
    assert np.abs(values.real).max() < 1e-9 * np.abs(values).max()
    return float(np.sqrt(8) / np.abs(values).max())


def moved(step, dt):
    """The largest of all lanes after 4 s."""
    x = START
    for _ in range(round(4.0 / dt)):
        x = step(x, HELD)
        if not step.sound.all() or np.abs(x).max() > 1e6:
            return np.inf
    return float(np.abs(x).max())


def test_unchecked_every_lane_is_lost_and_only_sound_tells():
    dt = 1.2 * limit()
    assert moved(ARM.stepper(dt, batch=4, check=False), dt) == np.inf


def test_it_is_refused_with_the_step_that_holds():
    dt = 1.2 * limit()
    with pytest.raises(StabilityLimitError, match="rk4") as caught:
        ARM.stepper(dt, batch=4)
    assert caught.value.largest_step == pytest.approx(limit(), rel=1e-6)


def test_the_recommended_ways_hold():
    """Substeps below the limit, or a method without one; the arm turns slowly."""
    dt = 1.2 * limit()
    for options in ({"substeps": 2}, {"method": "rosenbrock"}):
        assert moved(ARM.stepper(dt, batch=4, **options), dt) < 1.0
