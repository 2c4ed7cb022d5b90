"""Figures of merit against python-control, and scores against those that are printed."""

import numpy as np
import pytest

from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.plants.core.errors import PliantError
from pliant.studies.two_carts.merit import merit, of_the_program, score
from pliant.studies.two_carts.published import PUBLISHED

# python-control 0.10.2: stability_margins of B/(A PLANT); impulse_response of A/P, A (s^2 + 1)/P and -B (s^2 + 1)/P on
# a grid of 0.01 s: gain margin [-], phase margin [deg], last times [s] with |x2| >= 0.1 m, largest |u| [N]
BY_PYTHON_CONTROL = {
    "coefficient diagram 1": (2.1364751410, 39.4597020094, 12.48, 12.92, 14.7234706),
    "coefficient diagram 4": (2.0489582502, 35.4040877095, 14.09, 14.95, 0.4488042),
}
SCORES = {1: -1.41, 2: 0.35, 3: 5.99, 4: 6.70}  # quoted by the example of cdmtb 0.2.4; the fourth is that program's


@pytest.mark.parametrize("place", SCORES)
def test_scores_are_those_that_are_printed(place):
    law = PUBLISHED[place - 1]
    assert score(merit(law.law), of_the_program(law)) == pytest.approx(SCORES[place], abs=5e-3)


@pytest.mark.parametrize("name", BY_PYTHON_CONTROL)
def test_figures_are_those_of_python_control(name):
    gain, phase, first, second, peak = BY_PYTHON_CONTROL[name]
    found = merit(next(law for law in PUBLISHED if law.name == name).law)
    assert found.gain_margin == pytest.approx(20 * np.log10(gain), abs=1e-6)
    assert found.phase_margin == pytest.approx(phase, abs=1e-6)
    np.testing.assert_allclose(found.settling, (first + 0.01, second + 0.01), atol=1e-9)
    assert found.peak == pytest.approx(peak, rel=1e-6)


def test_stiffness_range_ends_where_the_characteristic_polynomial_does():
    """P(s) = s^4/k A + 2 s^2 A + B, by its roots."""
    law = PUBLISHED[2]

    def slowest(k):
        A = np.array(law.denominator)
        P = np.convolve([1 / k, 0, 2, 0, 0], A) + np.concatenate([np.zeros(4), law.numerator])
        return np.roots(P).real.max()

    low, high = merit(law.law).stiffness
    assert slowest(low) < 0 < slowest(low - 0.01)
    assert slowest(high) < 0 < slowest(high + 0.01)


def test_sampling_finely_changes_little_and_is_told_apart_from_acting_always():
    """Tustin's A and B at 10 ms: margins and times of the law that acts at every time, to that period."""
    law, h = PUBLISHED[2].law, 1e-2
    half = np.linalg.inv(np.eye(3) - h / 2 * law.A)
    A = half @ (np.eye(3) + h / 2 * law.A)
    sampled = LinearLaw(A, half @ law.B * h, law.C @ half, law.D + law.C @ half @ law.B * h / 2, law.reads, h)
    always, held = merit(law), merit(sampled)
    np.testing.assert_allclose(held.settling, always.settling, atol=0.1)
    assert held.phase_margin == pytest.approx(always.phase_margin, abs=0.5)
    assert held.phase_margin < always.phase_margin
    assert held.decay == pytest.approx(always.decay, rel=0.01)


def test_unstable_law_has_no_figures():
    still = LinearLaw(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.array([[0.5]]), ("tip_x",), None)
    with pytest.raises(PliantError, match="not stable"):
        merit(still)
