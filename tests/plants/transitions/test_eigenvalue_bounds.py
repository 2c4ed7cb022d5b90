"""Bounds on the eigenvalues of all matrices in a ball, against eigenvalues of members of it."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from pliant.plants.transitions.eigenvalue_bounds import bounds, separated
from pliant.plants.transitions.state_matrix_path import parts_of


def members(M, D, rng, count=60):
    """Members of the ball, most of them on its corners."""
    for k in range(count):
        yield M + D * (np.sign(rng.uniform(-1, 1, M.shape)) if k % 4 else rng.uniform(-1, 1, M.shape))


def of_kind(kind, rng):
    n = 4
    Q = np.linalg.qr(rng.standard_normal((n, n)))[0]
    if kind == "simple":
        return rng.standard_normal((n, n)) * 0.6
    if kind == "normal":
        return Q @ np.diag([0.99, -0.97, 0.5, 0.1]) @ Q.T
    if kind == "chain":
        return Q @ (np.diag([1.0, 1.0, 1.0, 0.3]) + np.diag([1.0, 1.0, 0.0], 1)) @ Q.T
    if kind == "equal":
        turn = 0.98 * np.array([[np.cos(1), -np.sin(1)], [np.sin(1), np.cos(1)]])
        return Q @ np.kron(np.eye(2), turn) @ Q.T
    return np.triu(rng.standard_normal((n, n)))


@pytest.mark.every(3)
@pytest.mark.parametrize("kind", ["simple", "normal", "chain", "equal", "triangular"])
@pytest.mark.parametrize("size", (1e-9, 1e-4, 3e-2))
@pytest.mark.parametrize("scaled", (False, True))
def test_no_member_leaves_the_bounds(kind, size, scaled):
    rng = np.random.default_rng(7)
    M = of_kind(kind, rng)
    D = size * rng.uniform(0.1, 1, M.shape) * (M != 0)
    if scaled:
        s = 10.0 ** rng.uniform(-6, 6, 4)
        M, D = M * s / s[:, None], D * s / s[:, None]
    for line in (False, True):
        b = bounds(M, D, line=line)
        for other in members(M, D, rng):
            lam = np.linalg.eigvals(other)
            slack = 1e-9 * max(1.0, np.abs(lam).max())
            cost = np.maximum(np.abs(b.values[:, None] - lam) - b.errors[:, None] - slack, 0)
            rows, columns = linear_sum_assignment(np.where(np.isfinite(cost), cost, 0))
            assert cost[rows, columns].max() == 0
            largest = (lam.real if line else np.abs(lam)).max()
            assert b.least - slack <= largest <= b.most + slack
            edge = 0.0 if line else 1.0
            assert not (b.inside and largest >= edge) and not (b.outside and largest <= edge)


def test_what_is_well_known_is_decided():
    rng = np.random.default_rng(1)
    Q = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    for top, said in ((0.99, "inside"), (1.01, "outside")):
        M = Q @ np.diag([top, 0.5, -0.3]) @ Q.T
        b = bounds(M, np.full((3, 3), 1e-3))
        assert (b.inside, b.outside) == (said == "inside", said == "outside")
        assert not bounds(M, np.full((3, 3), 2e-2)).inside and not bounds(M, np.full((3, 3), 2e-2)).outside


def test_a_cluster_is_known_to_a_root_of_what_its_matrix_is():
    Q = np.linalg.qr(np.random.default_rng(0).standard_normal((4, 4)))[0]
    M = Q @ (np.diag([1.0, 1.0, 1.0, 0.3]) + np.diag([1.0, 1.0, 0.0], 1)) @ Q.T
    b = bounds(M, np.full((4, 4), 1e-12))
    three = np.abs(b.values - 1) < 1e-2
    assert three.sum() == 3 and 1e-4 < b.errors[three].max() < 5e-3 and b.errors[~three][0] < 1e-9


def test_liouville_decides_what_a_pair_hangs_on():
    """A complex pair: its size is e^(integral of the trace / 2), however little is known of the matrix itself."""
    M = 0.98 * np.array([[np.cos(1), -np.sin(1)], [np.sin(1), np.cos(1)]])
    D = np.full((2, 2), 0.1)
    known = (np.full(2, np.log(0.98)), np.full(2, 1e-6))
    assert bounds(M, D, volume=known).inside and not bounds(M, D).inside
    assert bounds(M, D, volume=known).most == pytest.approx(0.98, rel=2e-6)
    D[:] = 0.6  # the trace no longer shows that it is a pair
    assert not bounds(M, D, volume=known).inside


def test_two_states_of_which_little_is_known():
    """The largest eigenvalue is smallest where two meet, within the box of traces and determinants: by members."""
    rng = np.random.default_rng(7)
    for _ in range(40):
        M, D = 2 * rng.standard_normal((2, 2)), np.abs(rng.standard_normal((2, 2)))
        b = bounds(M, D)
        sizes = [np.abs(np.linalg.eigvals(member)).max() for member in members(M, D, rng)]
        assert b.least <= min(sizes) and max(sizes) <= b.most * (1 + 1e-12)
    M, D = np.diag([3.0, 0.0]), np.array([[2.9, 1.0], [1.0, 0.1]])  # 3 may be 0.1, all else nothing
    b = bounds(M, D)
    assert b.least <= 0.1 and not b.outside


def test_parts_stand_alone_and_ratios_of_1e15_keep_their_digits():
    A = np.zeros((4, 4))
    A[0, 1] = A[1, 0] = A[2, 0] = A[3, 3] = 1.0
    assert sorted(p.tolist() for p in parts_of(A)) == [[0, 1], [2], [3]]
    A = np.array([[-1e15, 1e3, 0], [1e-3, -1.0, 0.5], [0, 0.5, -2.0]])
    b = bounds(A, 1e-15 * np.abs(A), line=True)
    slow = np.sort(b.values.real)[1:]
    np.testing.assert_allclose(slow, np.sort(np.linalg.eigvals(A[1:, 1:])), rtol=1e-12)
    assert b.inside and b.errors[np.abs(b.values) < 3].max() < 1e-13


def test_curves_that_are_crossed_are_not_free():
    M = np.array([[0.9, 1.0], [0.0, 0.5]])
    assert separated(M, np.full((2, 2), 1e-3), 1.0)
    assert not separated(M, np.full((2, 2), 0.1), 1.0)
    assert separated(M, np.full((2, 2), 1e-3), 0.2, centre=0.9) and not separated(M, np.zeros((2, 2)), 0.4, centre=0.9)


def test_what_is_not_finite_is_not_judged():
    b = bounds(np.full((2, 2), np.inf), np.zeros((2, 2)))
    assert not b.inside and not b.outside and b.most == np.inf


def test_powers_beyond_the_range_of_numbers_tell_nothing():
    """1e200 squared is no number: no warning is given."""
    M = 1e200 * np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    with np.errstate(all="raise"):
        found = bounds(M, np.abs(M) * 0.5)
    assert not found.inside and found.most > 1e200


def test_of_a_matrix_that_may_be_off_without_bound_nothing_is_known():
    M = np.array([[0.1, 0.2, 0.0], [0.0, 0.1, 0.3], [0.2, 0.0, 0.1]])
    found = bounds(M, np.full((3, 3), np.inf))
    assert not found.inside and not found.outside and (found.least, found.most) == (0.0, np.inf)
    assert np.isinf(found.errors).all()
