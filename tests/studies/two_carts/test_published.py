"""Published laws from their recipes."""

import numpy as np
import pytest

from pliant.studies.two_carts.published import FASTEST, PLANT, PUBLISHED, characteristic


def test_indices_and_time_constant_are_those_asked_for():
    a = characteristic((2.5, 2.0, 1.5), 6.0)[::-1]
    np.testing.assert_allclose(a[1:-1] ** 2 / (a[2:] * a[:-2]), (2.5, 2.0, 1.5), rtol=1e-12)
    assert a[1] / a[0] == pytest.approx(6.0)


def test_first_law_as_cdmtb_designs_it():
    """cdmtb 0.2.4, g2c with nc = mc = 3: A and B over the leading coefficient of A."""
    law = PUBLISHED[0]
    np.testing.assert_allclose(law.denominator, [1.0, 13.33333333, 86.88888889, 269.62962963], rtol=1e-9)
    np.testing.assert_allclose(law.numerator, [320.04938272, -127.73662551, 171.46776406, 28.57796068], rtol=1e-9)


def test_fastest_has_all_six_poles_in_one_place():
    """Henrion and Overton 2006: A = s^2 + 6 sqrt(15)/5 s + 7, B = -43/5 s^2 + 54 sqrt(15)/125 s + 27/125."""
    law = PUBLISHED[-1]
    np.testing.assert_allclose(law.denominator, [1.0, 6 * np.sqrt(15) / 5, 7.0], rtol=1e-13)
    np.testing.assert_allclose(law.numerator, [-43 / 5, 54 * np.sqrt(15) / 125, 27 / 125], rtol=1e-12)
    whole = np.convolve(PLANT, law.denominator) + np.concatenate([np.zeros(4), law.numerator])
    np.testing.assert_allclose(whole, np.poly([-FASTEST] * 6), atol=1e-13)


def test_no_law_near_the_fastest_decays_faster():
    """A local optimum: 200 changes of its five coefficients, by 1e-6 to 1e-2, none with a faster slowest pole."""
    law, rng = PUBLISHED[-1], np.random.default_rng(0)
    for size in np.geomspace(1e-6, 1e-2, 200):
        A = law.denominator + np.append(0.0, size * rng.standard_normal(2))
        B = law.numerator + size * rng.standard_normal(3)
        poles = np.roots(np.convolve(PLANT, A) + np.concatenate([np.zeros(4), B]))
        assert poles.real.max() > -FASTEST


def test_state_space_is_the_transfer_function():
    law, s = PUBLISHED[2], 0.3 + 1.1j
    ss = law.law
    given = ss.C @ np.linalg.solve(s * np.eye(3) - ss.A, ss.B) + ss.D
    assert given[0, 0] == pytest.approx(np.polyval(law.numerator, s) / np.polyval(law.denominator, s), rel=1e-12)
