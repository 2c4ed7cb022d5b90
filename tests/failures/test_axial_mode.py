"""RK4 past its step limit on a mode that nobody looks at: the rod's stretch, far faster than its bending."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import SliderCrank, StabilityLimitError, step_limit
from pliant.plants.integration.step_maps import stepper

BENT = dataclasses.replace(SliderCrank.textbook(), modes=1, axial_modes=0)
STRETCHED = dataclasses.replace(BENT, axial_modes=1)
X_BENT, X = BENT.state(0.3), STRETCHED.state(0.3)
TIME = np.linspace(0.0, 0.05, 11)


def axial_frequency() -> float:
    """First stretch mode [rad/s] of a bar held at one end with the slider's mass at the other: beta tan beta = m/M."""
    rod, ratio = STRETCHED.rod, STRETCHED.rod.mass / STRETCHED.slider_mass
    beta = np.sqrt(ratio)
    for _ in range(50):
        beta -= (beta * np.tan(beta) - ratio) / (np.tan(beta) + beta / np.cos(beta) ** 2)
    return float(beta / rod.length * np.sqrt(rod.E / rod.density))


def test_the_stretch_sets_the_step_and_not_the_bending() -> None:
    """Its limit is that of the closed-form frequency, an order of magnitude below the bending's."""
    bending, stretch = step_limit(BENT, X_BENT), step_limit(STRETCHED, X)
    assert stretch < bending / 10
    assert stretch == pytest.approx(2 * np.sqrt(2) / axial_frequency(), rel=0.05)


def test_the_naive_step_diverges_and_is_refused_by_name() -> None:
    step = 0.2 * step_limit(BENT, X_BENT)  # safe for all that bends
    naive, x, held = stepper(STRETCHED, "rk4"), X.copy(), np.zeros(3)
    with np.errstate(all="ignore"):
        for k in range(200):
            x = naive(k * step, x, held, np.zeros(STRETCHED.nw), np.zeros(0), step)[0]
    assert not np.abs(x).max() < 1e6
    with pytest.raises(StabilityLimitError) as refused:
        STRETCHED.simulate(X, None, TIME, method="rk4", step=step)
    assert abs(refused.value.mode) == pytest.approx(axial_frequency(), rel=0.05)
    assert refused.value.largest_step == pytest.approx(step_limit(STRETCHED, X), rel=1e-6)


def test_what_holds_instead() -> None:
    """The L-stable method at the refused step, or RK4 below the limit, follow the adaptive motion."""
    true = STRETCHED.simulate(X, None, TIME)["mid_deflection"]
    size = np.abs(true).max()
    step = 0.2 * step_limit(BENT, X_BENT)
    damped = STRETCHED.simulate(X, None, TIME, method="rosenbrock", step=step)["mid_deflection"]
    fine = STRETCHED.simulate(X, None, TIME, method="rk4", step=0.9 * step_limit(STRETCHED, X))["mid_deflection"]
    assert np.abs(damped - true).max() < 0.02 * size
    assert np.abs(fine - true).max() < 0.002 * size
