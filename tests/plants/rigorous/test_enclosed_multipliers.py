import numpy as np
import pytest

from pliant.plants.rigorous.balls import flint, matrix, widened
from pliant.plants.rigorous.enclosed_multipliers import by_powers, multipliers


def of(M, radius=0.0, bits=96):
    with flint().ctx.workprec(bits):
        return multipliers(widened(matrix(M), flint().arb(radius)), [np.arange(len(M))], [])


def test_known_eigenvalues():
    # X diag(0.5, -0.25, 0.75) X^-1 in exact doubles
    X = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
    inverse = np.array([[1.0, -2.0, 2.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
    found = of(X @ np.diag([0.5, -0.25, 0.75]) @ inverse)
    assert found.least <= 0.75 <= found.most < 0.75 + 1e-12
    for truth in (0.5, -0.25, 0.75):
        assert min(abs(v - truth) - r for v, r in zip(found.values, found.radii)) <= 0


@pytest.mark.parametrize("value, decided", [(0.9, "most"), (1.1, "least")])
def test_a_cluster_with_one_direction(value, decided):
    found = of(np.diag([value] * 4) + np.eye(4, k=1))
    assert found.least <= value <= found.most
    assert (found.most < 1) if decided == "most" else (found.least > 1)


def test_every_member_of_a_ball():
    found = of(np.diag([0.5, 0.2]), 0.1)
    assert found.most >= 0.5 + 0.1 + 0.1**2 / 0.4  # all ones added
    assert found.least <= 0.4


def test_powers_hold_the_largest():
    low, high = by_powers(matrix(np.array([[0.0, 0.9], [-0.9, 0.0]])))
    assert low <= 0.9 <= high and high - low < 1e-3


def test_parts_and_states_that_nothing_moves():
    M = np.array([[1.0, 7.0], [0.0, 0.5]])
    found = multipliers(matrix(M), [np.array([1])], [np.array([0])])
    assert found.neutral == 1 and found.most < 1 and sorted(v.real for v in found.values) == [0.5, 1.0]
