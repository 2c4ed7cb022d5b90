"""The natural frequencies printed in "Elastodynamic Analysis of a Mechanism with Flexible Links" cannot be right.

Two planar frame elements, d_3y = 0, give 8 frequencies, as printed. Hold node 3 altogether: the highest frequency can
only fall (Rayleigh's quotient over fewer shapes), the slider's mass and the rod's angle no longer matter, and
stretching uncouples from bending. The stretching of two equal elements, consistent masses, has
    det(K - w^2 M) = 0:  2 (1 - 2 m)^2 = (1 + m)^2,  m = w^2 rho l^2/(6 E),  largest m = (1 + sqrt 2)/(2 sqrt 2 - 1),
which knows no section. So the highest frequency is at least sqrt(6 m E/rho)/(2 pi l) = 16,710 Hz for l = 140 mm.
"""

import numpy as np
import pytest
import scipy.linalg

PRINTED = [411.3230552, 1580.215521, 2776.688816, 11139.76175, 9.124618253, 0.1837169438, 712.9568269, 0.1667817193]
E, RHO, LENGTH = 2.1e11, 7700.0, 0.28  # as printed: 2.1e5 MPa, 7.7e-9 N s^2/mm^4, 280 mm
BOUND = 16710.0


def element(area, inertia, l):
    """Stiffness and consistent mass (6, 6) of a planar frame element; (u, v, theta) at both ends."""
    K, M = np.zeros((6, 6)), np.zeros((6, 6))
    along, across = np.ix_([0, 3], [0, 3]), np.ix_([1, 2, 4, 5], [1, 2, 4, 5])
    K[along] = E * area / l * np.array([[1, -1], [-1, 1]])
    M[along] = RHO * area * l / 6 * np.array([[2, 1], [1, 2]])
    K[across] = (
        E
        * inertia
        / l**3
        * np.array(
            [
                [12, 6 * l, -12, 6 * l],
                [6 * l, 4 * l**2, -6 * l, 2 * l**2],
                [-12, -6 * l, 12, -6 * l],
                [6 * l, 2 * l**2, -6 * l, 4 * l**2],
            ]
        )
    )
    M[across] = (
        RHO
        * area
        * l
        / 420
        * np.array(
            [
                [156, 22 * l, 54, -13 * l],
                [22 * l, 4 * l**2, 13 * l, -3 * l**2],
                [54, 13 * l, 156, -22 * l],
                [-13 * l, -3 * l**2, -22 * l, 4 * l**2],
            ]
        )
    )
    return K, M


def rod_frequencies(area, inertia, slider_mass, angle, held=(7,)):
    """Natural frequencies [Hz] of two elements at an angle to x; `held` are the fixed global displacements of 9."""
    k, m = element(area, inertia, LENGTH / 2)
    c, s = np.cos(angle), np.sin(angle)
    T = np.kron(np.eye(2), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
    K, M = np.zeros((9, 9)), np.zeros((9, 9))
    for first in (0, 3):
        K[first : first + 6, first : first + 6] += T.T @ k @ T
        M[first : first + 6, first : first + 6] += T.T @ m @ T
    M[[6, 7], [6, 7]] += slider_mass
    free = [i for i in range(9) if i not in held]
    squares = scipy.linalg.eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)


def sections(count):
    """Areas [m^2], second moments [m^4], slider masses [kg] and angles [rad], spread over many decades."""
    rng = np.random.default_rng(7)
    for _ in range(count):
        area = 10.0 ** rng.uniform(-7, -2)
        yield area, area * 10.0 ** rng.uniform(-9, -2), 10.0 ** rng.uniform(-6, 6), rng.uniform(-np.pi, np.pi)


def test_bound_is_that_of_the_stretching_alone_and_knows_no_section():
    m = (1 + np.sqrt(2)) / (2 * np.sqrt(2) - 1)
    assert 2 * (1 - 2 * m) ** 2 == pytest.approx((1 + m) ** 2, rel=1e-14)
    bound = np.sqrt(6 * m * E / RHO) / (2 * np.pi * LENGTH / 2)
    assert bound == pytest.approx(BOUND, abs=1.0)
    for area, inertia, mass, angle in sections(30):
        held = rod_frequencies(area, inertia, mass, angle, held=(6, 7))
        assert np.abs(held / bound - 1).min() < 1e-6  # the stretching is always among them


def test_no_section_mass_or_angle_has_so_low_a_highest_frequency():
    highest = np.array([rod_frequencies(*case)[-1] for case in sections(2000)])
    assert highest.min() > BOUND - 1.0
    assert max(PRINTED) < 0.67 * highest.min()


def test_bound_is_sharp():
    assert rod_frequencies(4e-5, 5e-11, 1e3, 0.0)[-1] == pytest.approx(BOUND, rel=1e-4)


def test_the_two_lowest_are_rigid_motions_of_frequency_zero():
    """Translation along x and turning about node 3: 0.18 and 0.167 Hz are not natural frequencies."""
    for area, inertia in ((4e-5, 5.33e-11), (1e-4, 8.3e-10)):
        found = rod_frequencies(area, inertia, 0.2, -0.17)
        assert len(found) == len(PRINTED)
        assert found[1] < 1e-2 and found[2] > 10.0
