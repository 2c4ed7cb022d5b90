"""Tustin's rule with prewarping beside SciPy's, series, and transfers in z."""

import numpy as np
import pytest
from scipy import signal

from pliant.controllers import Filter, notch, roll_off


def test_a_sampled_notch_stays_at_its_frequency() -> None:
    f, dt = notch(3.0, depth=0.05), 0.4
    held = f.discretised(dt)
    assert held.at([3.0]) == pytest.approx(f.at([3.0]), rel=1e-12)
    plain = f.discretised(dt, prewarp=1e-6)
    assert abs(plain.at([3.0])[0]) > 0.15  # without prewarping it is elsewhere


def test_tustin_beside_scipy() -> None:
    top, bottom, dt = [1.0, 0.3], [1.0, 0.5, 2.0, 0.7], 0.2
    found = Filter.from_coefficients(top, bottom).discretised(dt)
    b, a, _ = signal.cont2discrete((top, bottom), dt, method="bilinear")
    w = np.array([0.1, 1.0, 5.0])
    z = np.exp(1j * w * dt)
    assert found.at(w) == pytest.approx(np.polyval(b.ravel(), z) / np.polyval(a, z), rel=1e-10)


def test_one_after_the_other() -> None:
    both, w = notch(3.0).then(roll_off(1.0)), np.array([0.5, 3.0, 4.0])
    assert both.at(w) == pytest.approx(notch(3.0).at(w) * roll_off(1.0).at(w), rel=1e-12)


def test_what_cannot_be_is_told() -> None:
    with pytest.raises(ValueError, match="sample faster"):
        notch(3.0).discretised(1.1)
    with pytest.raises(ValueError, match="sampled already"):
        notch(3.0).discretised(0.1).discretised(0.1)
    with pytest.raises(ValueError, match="dt = None"):
        notch(3.0).discretised(0.1).then(notch(3.0))
    with pytest.raises(ValueError, match="denominator"):
        Filter.from_coefficients([1.0, 0.0, 1.0], [1.0, 2.0])
