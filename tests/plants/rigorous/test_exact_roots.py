import numpy as np
import pytest
from scipy.linalg import block_diag

from pliant.plants.rigorous.exact_roots import counted


def companion(*low_to_high):
    """Of the monic polynomial s^n + c[n-1] s^(n-1) + .. + c[0]."""
    A = np.eye(len(low_to_high), k=1)
    A[-1] = -np.array(low_to_high)
    return A


# s^3 + s^2 + s + c: Routh's condition is c < 1; at c = 1 it is (s + 1)(s^2 + 1)
@pytest.mark.parametrize("c, told", [(1 - 2**-53, (0, 0, 3)), (1.0, (0, 2, 1)), (1 + 2**-52, (2, 0, 1))])
def test_the_last_bit_decides(c, told):
    found = counted(companion(c, 1.0, 1.0), circle=False)
    assert (found.outside, found.on, found.inside) == told
    sides = (found.largest[0] > 0, found.largest == (0.0, 0.0), found.largest[1] < 0)
    assert sides == tuple(k == np.flatnonzero(told)[0] for k in range(3))


@pytest.mark.parametrize(
    "A, on, power",
    [
        (np.zeros((2, 2)), 2, 0),
        (np.eye(3, k=1), 3, 2),  # a chain of integrators
        (companion(1.0, 0.0, 2.0, 0.0), 4, 1),  # (s^2 + 1)^2, resonant
        (block_diag(companion(1.0, 0.0), companion(1.0, 0.0)), 4, 0),  # the same roots, apart
        (companion(6.0, 0.0, 5.0, 0.0), 4, 0),  # (s^2 + 2)(s^2 + 3)
    ],
)
def test_those_on_the_axis_and_how_they_grow(A, on, power):
    found = counted(A, circle=False)
    assert (found.outside, found.on, found.power) == (0, on, power)


def test_pairs_about_the_axis_are_not_on_it():
    # (s^2 + 2 s + 5)(s^2 - 2 s + 5) = s^4 + 6 s^2 + 25 is even, with no root on the axis
    found = counted(companion(25.0, 0.0, 6.0, 0.0), circle=False)
    assert (found.outside, found.on, found.inside) == (2, 0, 2)
    assert found.largest[0] <= 1.0 <= found.largest[1] and found.largest[1] - found.largest[0] < 1e-15


@pytest.mark.parametrize(
    "A, told",
    [
        (np.diag([-1.0, -1.0, 0.5]), (0, 2, 1, 0)),
        (np.array([[-1.0, 1.0], [0.0, -1.0]]), (0, 2, 0, 1)),
        (np.array([[0.0, 1.0], [-1.0, 0.0]]), (0, 2, 0, 0)),
        (np.array([[0.6, 0.8], [-0.8, 0.6]]), (2, 0, 0, 0)),  # 0.6^2 + 0.8^2 of these doubles is more than 1
        (np.array([[0.5]]), (0, 0, 1, 0)),
    ],
)
def test_against_the_circle(A, told):
    found = counted(A, circle=True)
    assert (found.outside, found.on, found.inside, found.power) == told


def test_eigenvalues_are_within_their_radii():
    from mpmath import eig, mp

    rng = np.random.default_rng(3)
    A = rng.normal(size=(7, 7))
    found = counted(A, circle=False)
    with mp.workdps(40):
        truth = eig(mp.matrix(A.tolist()), left=False, right=False)
        for value, radius in zip(found.values, found.radii):
            assert min(abs(mp.mpc(value) - z) for z in truth) <= radius < 1e-14
