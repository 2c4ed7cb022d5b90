"""The cosh and sinh form of a mode shape, as printed in textbooks, has no digit left by mode 15."""

import math

import mpmath as mp
import numpy as np

from pliant.plants.beams import euler_bernoulli_modes

XI = np.linspace(0.0, 1.0, 41)


def textbook(lib, beta, xi):
    """phi = cosh - cos - sigma (sinh - sin), evaluated as printed by numpy or mpmath."""
    sigma = (lib.sinh(beta) - lib.sin(beta)) / (lib.cosh(beta) + lib.cos(beta))
    z = beta * xi
    return lib.cosh(z) - lib.cos(z) - sigma * (lib.sinh(z) - lib.sin(z))


def exact(k):
    with mp.workdps(80):
        beta = mp.findroot(lambda b: mp.cos(b) * mp.cosh(b) + 1, (k - 0.5) * math.pi)
        return np.array([float(textbook(mp, beta, mp.mpf(xi))) for xi in XI])


def test_textbook_form_loses_all_digits_before_mode_15_and_ours_none():
    phi = euler_bernoulli_modes.shapes("clamped-free", 15)
    for k in (12, 14, 15):
        printed = np.abs(textbook(np, phi.roots[k - 1], XI) - exact(k)).max()
        assert printed > {12: 0.01, 14: 1.0, 15: 1.0}[k]  # the shape itself nowhere exceeds 2
        assert np.abs(phi(XI)[:, k - 1] - exact(k)).max() < 2e-14


def test_textbook_characteristic_equation_is_noise_where_ours_still_finds_roots():
    beta = euler_bernoulli_modes.roots("clamped-free", 15)[-1]
    near = beta * (1 + np.linspace(-1, 1, 9) * 1e-15)
    assert np.abs(np.cos(near) * np.cosh(near) + 1).max() > 1e3
    assert abs(beta - 14.5 * math.pi) < 1e-13
