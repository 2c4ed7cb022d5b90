"""Forms that are the state matrix itself where that is a polynomial, or one over a mass."""

import numpy as np

from pliant.controllers.uncertain_blocks.fractional_form import fitted

RNG = np.random.default_rng(4)
K0, K1, D0 = np.diag([4.0, 9.0]), np.array([[1.0, -1.0], [-1.0, 1.0]]), 0.1 * np.eye(2)


def mass(d):
    return np.array([[2 + 0.5 * d[0], 0.3], [0.3, 1.0]])


def frame(d):
    M = np.linalg.inv(mass(d))
    return np.block([[np.zeros((2, 2)), np.eye(2)], [-M @ (K0 + 0.6 * d[1] * K1 + 0.2 * d[0] * d[1] * K1), -M @ D0]])


def wide(d):
    return np.block([[np.eye(2), np.zeros((2, 2))], [np.zeros((2, 2)), mass(d)]])


def test_a_mass_matrix_makes_it_exact():
    form = fitted(frame, 2, mass=wide)
    assert form.left < 1e-12
    assert sum(b.size for b in form.blocks) <= 5
    for d in RNG.uniform(-1, 1, (20, 2)):
        np.testing.assert_allclose(form.at(d), frame(d), atol=1e-12)


def test_without_one_what_it_lacks_is_told():
    form = fitted(frame, 2)
    off = max(np.linalg.norm(form.at(d) - frame(d), 2) for d in RNG.uniform(-1, 1, (200, 2)))
    assert 1e-4 < off / np.linalg.norm(form.A, 2) < 1.1 * form.left
