"""The elimination of the bodies against dense solves with NumPy."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.spacecraft.block_arrow import Share, accelerations, eliminate, solve


def test_the_block_arrow_solves_the_whole(anywhere, ring):
    craft = ring(5)
    x = anywhere(craft, size=0.01)
    M, found = craft.mass_matrix(x), craft.dynamics(x)
    order = [
        *(craft.turn(x).T @ found[craft.layout.velocity]),
        *found[craft.layout.omega],
        *found[craft.layout.rates :],
    ]
    rest = craft.residual(x, np.zeros(len(M)))
    np.testing.assert_allclose(M @ order, -rest, atol=1e-9 * np.abs(rest).max())


def arrow(seed=0, sizes=(3, 0, 2), given=(0, 0, 1)):
    """Shares of a positive definite block arrow in numbers, and the whole M, r and what is given, assembled densely.

    Unknowns of the bodies are interleaved, as hinges and modes are in a spacecraft.
    """
    rng = np.random.default_rng(seed)
    count = 6 + sum(sizes)
    places = rng.permutation(np.arange(6, count))
    owns = np.split(places, np.cumsum(sizes)[:-1])
    M, r, values, parts = np.zeros((count, count)), np.zeros(count), {}, []
    for own, held in zip([np.zeros(0, dtype=int), *owns], (0, *given)):
        n = 6 + len(own)
        L = rng.normal(size=(n, n))
        block, load, drive = L @ L.T + 0.1 * np.eye(n), rng.normal(size=n), rng.normal(size=held)
        rows = [*range(6), *own]
        M[np.ix_(rows, rows)] += block
        r[rows] += load
        values |= dict(zip(own[:held].tolist(), drive))
        fixed = ca.SX(ca.DM(drive)) if held else None
        parts.append(Share(ca.SX(ca.DM(block)), ca.SX(ca.DM(load)), own.tolist(), fixed))
    return parts, M, r, values


def numbers(expression):
    return np.array(ca.DM(ca.evalf(ca.SX(ca.densify(expression)))))


@pytest.mark.parametrize("seed", range(4))
def test_accelerations_are_those_of_a_dense_solve(seed):
    """NumPy's solve of the rows that are not given, with the given ones moved to the right-hand side."""
    parts, M, r, values = arrow(seed)
    held = sorted(values)
    free = np.setdiff1d(np.arange(len(M)), held)
    wanted = np.zeros(len(M))
    wanted[held] = [values[k] for k in held]
    wanted[free] = np.linalg.solve(M[np.ix_(free, free)], -(r + M @ wanted)[free])
    a, pivot = accelerations(parts)
    np.testing.assert_allclose(numbers(a).ravel(), wanted, rtol=1e-9, atol=1e-10)
    assert float(numbers(pivot).item()) > 0


def test_many_columns_are_solved_with_one_elimination():
    parts, M, _, _ = arrow(7, given=(0, 0, 0))
    rng = np.random.default_rng(1)
    columns = [rng.normal(size=(6 + len(p.own), 4)) for p in parts]
    whole = np.zeros((len(M), 4))
    for part, column in zip(parts, columns):
        whole[[*range(6), *part.own]] += column
    found = numbers(solve(parts, eliminate(parts), [ca.SX(ca.DM(c)) for c in columns]))
    np.testing.assert_allclose(found, -np.linalg.solve(M, whole), rtol=1e-9, atol=1e-10)


def test_pivots_are_those_of_the_determinant_and_say_where_it_is_not_definite():
    """The product of the pivots of M = L D L^T is det M; an indefinite body shows a negative one."""
    parts, M, _, _ = arrow(3, given=(0, 0, 0))
    pivots = numbers(ca.vertcat(*eliminate(parts).pivots)).ravel()
    assert len(pivots) == len(M) and np.prod(pivots) == pytest.approx(np.linalg.det(M), rel=1e-9)
    spoilt = parts[1].M - 1e3 * ca.diagcat(ca.SX(6, 6), ca.SX.eye(3))
    assert float(numbers(accelerations([parts[0], parts[1]._replace(M=spoilt), *parts[2:]])[1]).item()) < 0
