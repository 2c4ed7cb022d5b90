"""Quantities that no input changes and directions that nothing feels, against models made to have them."""

import numpy as np
import pytest

from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.rest_spaces import conserved_by, keeping, unfelt

NAMES = ("angle", "rate", "h1", "h2")


def hub_of_two_wheels(unit=1.0):
    """A hub turned by two wheels about the same axis; their momenta in `unit`."""
    A = np.zeros((4, 4))
    A[0, 1] = 1.0
    return A, np.array([[0.0, 0.0], [1.0, 1.0], [-unit, 0.0], [0.0, -unit]])


def made_to(rng, n, nu, k):
    """A (n, n), B (n, nu) in random coordinates with k conserved quantities, each unseen at rest; the units wild."""
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, nu))
    A[:, n - k :], A[n - k :], B[n - k :] = 0.0, 0.0, 0.0
    mix = np.eye(n) + 0.3 * rng.normal(size=(n, n))
    mix = np.diag(10.0 ** rng.uniform(-5, 5, n)) @ mix
    return mix @ A @ np.linalg.inv(mix), mix @ B, mix


@pytest.mark.parametrize("unit", [1.0, 1e8, 1e-8])
@pytest.mark.parametrize("dt", [None, 0.1])
def test_two_wheels_on_one_axis_keep_the_sum_and_share_a_spin(unit, dt):
    A, B = hub_of_two_wheels(unit)
    if dt is not None:
        sampled = LinearModel.from_matrices(A, B).discretize(dt)
        A, B = sampled.A, sampled.B
    found = conserved_by(A, B, dt, NAMES)
    [w] = found.quantities
    np.testing.assert_allclose(w / w[1] * [1, 1, unit, unit], [0, 1, 1, 1], atol=1e-12)
    loose = unfelt(A, B, np.diag([1.0, 1.0, 0.0, 0.0]), dt, NAMES)
    assert loose.others == [0, 1] and loose.directions.shape == (4, 2)
    np.testing.assert_allclose(loose.down, np.eye(4)[:2], atol=1e-12)
    assert loose.names in (("h1 -1 h2",), ("h2 -1 h1",))


def test_an_angle_that_is_not_seen_is_not_free():
    """Not to weigh an angle is to let it drift: its rate is a state, which the rest of the system drives."""
    A, B = np.array([[0.0, 1.0], [0.0, -0.5]]), np.array([[0.0], [1.0]])
    assert unfelt(A, B, np.diag([0.0, 1.0]), None, NAMES[:2]).directions.shape == (2, 0)
    assert conserved_by(A, B, None, NAMES[:2]).names == ()


@pytest.mark.parametrize("dt", [None, 0.1])
def test_a_free_base_keeps_its_momentum_then_its_mass_centre(dt):
    """Two masses with a force between them: v1 + v2 = const, and where that is 0, x1 + x2 = const too."""
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [np.zeros((2, 4))]])
    B = np.array([[0.0], [0.0], [1.0], [-1.0]])
    if dt is not None:
        sampled = LinearModel.from_matrices(A, B).discretize(dt)
        A, B = sampled.A, sampled.B
    found = conserved_by(A, B, dt, ("x1", "x2", "v1", "v2"))
    np.testing.assert_allclose(found.quantities[0] / found.quantities[0, 2], [0, 0, 1, 1], atol=1e-12)
    np.testing.assert_allclose(found.quantities[1, :2] / found.quantities[1, 0], [1, 1], atol=1e-12)
    assert len(found.names) == 2
    between = np.array([[1.0, -1.0, 0, 0], [0, 0, 1.0, -1.0]])
    loose = unfelt(A, B, between, dt, ("x1", "x2", "v1", "v2"))
    assert loose.directions.shape == (4, 2) and loose.names == ()
    np.testing.assert_allclose(between @ loose.directions, 0.0, atol=1e-12)
    assert unfelt(A, B, np.eye(4), dt, NAMES).directions.shape == (4, 0)


def test_random_systems_in_wild_units():
    rng = np.random.default_rng(5)
    for _ in range(100):
        n, nu, k = rng.integers(4, 9), rng.integers(1, 4), rng.integers(1, 3)
        A, B, mix = made_to(rng, n, nu, k)
        names = tuple(f"x{i}" for i in range(n))
        found = conserved_by(A, B, None, names)
        assert len(found.names) == k
        back = found.quantities @ mix  # in the coordinates where the last k are conserved
        assert np.abs(back[:, : n - k]).max() < 1e-6 * np.abs(back).max()
        seen = np.hstack([np.eye(n - k), np.zeros((n - k, k))]) @ np.linalg.inv(mix)
        loose = unfelt(A, B, seen, None, names)
        assert loose.directions.shape == (n, k) and loose.names == ()
        np.testing.assert_allclose(loose.down @ loose.up, np.eye(n - k), atol=1e-12)
        poles = np.linalg.eigvals(loose.down @ A @ loose.up)
        whole = np.linalg.eigvals((np.linalg.inv(mix) @ A @ mix)[: n - k, : n - k])
        assert all(np.abs(whole - z).min() < 1e-6 * np.abs(whole).max() for z in poles)


def test_what_keeps_a_quantity_without_being_felt():
    w, felt = np.array([[1.0, 1.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
    v = keeping(w, felt)
    np.testing.assert_allclose(w @ v, [[1.0]])
    np.testing.assert_allclose(felt @ v, [[0.0]], atol=1e-15)
    assert keeping(w, np.eye(3)) is None
