"""A(t) between its nodes, and its transition matrices, against closed forms."""

import numpy as np
import pytest

from pliant.plants import LinearModel
from pliant.plants.transitions.state_matrix_path import Path, kept, modal, scaling


def turning(t):
    """A(t) of Markus and Yamabe (1960); exp(t / 2) (cos t, -sin t) is a solution."""
    t = np.asarray(t)
    c, s = np.cos(t), np.sin(t)
    A = [[-1 + 1.5 * c**2, 1 - 1.5 * s * c], [-1 - 1.5 * s * c, -1 + 1.5 * s**2]]
    return np.moveaxis(np.array(A), (0, 1), (-2, -1))


def path(nodes, length, *, periodic=False):
    t = np.linspace(0.0, length, nodes)
    return Path(t, turning(t), np.ones(2), periodic=periodic)


def test_a_periodic_path_of_few_waves_is_exact_between_its_nodes():
    """Waves up to the second: a trigonometric interpolant through 17 nodes leaves only rounding."""
    found = path(17, 2 * np.pi, periodic=True)
    at = np.linspace(0.1, 6.1, 23)
    np.testing.assert_allclose(found(at), turning(at), atol=1e-13)
    np.testing.assert_allclose(found.rate(at), (turning(at + 1e-5) - turning(at - 1e-5)) / 2e-5, atol=1e-8)


def test_a_spline_is_of_order_four():
    at = np.linspace(0.5, 1.5, 37)
    errors = [np.abs(path(n, 2.0)(at) - turning(at)).max() for n in (21, 41)]
    assert 3.5 < np.log2(errors[0] / errors[1]) < 4.6


@pytest.mark.parametrize("periodic", [True, False])
def test_transition_matrices_take_the_known_solution_along(periodic):
    found = path(129, 2 * np.pi, periodic=periodic)
    start, half, end = np.array([1.0, 0.0]), found.over(np.pi, 200), found.over(2 * np.pi, 400)
    np.testing.assert_allclose(half @ start, np.exp(np.pi / 2) * np.array([-1.0, 0.0]), rtol=0, atol=1e-5)
    np.testing.assert_allclose(end @ start, np.exp(np.pi) * start, rtol=0, atol=1e-4)
    # Liouville: the trace of A is -1/2 at all times
    assert np.linalg.det(end) == pytest.approx(np.exp(-np.pi), rel=1e-5)


def test_steps_in_between_are_products():
    found = path(65, 2.0)
    nodes = np.linspace(0.0, 2.0, 5)
    whole = found.over(2.0, 32)
    parts = found.between(nodes, 8)
    np.testing.assert_allclose(parts[3] @ parts[2] @ parts[1] @ parts[0], whole, atol=1e-9)


def test_a_constant_path_is_one_exponential():
    t = np.linspace(0.0, 1.0, 5)
    A = np.tile([[0.0, 1.0], [-4.0, 0.0]], (5, 1, 1))
    found = Path(t, A, np.ones(2))
    assert found.constant
    wanted = [[np.cos(1.0), np.sin(1.0) / 2], [-2 * np.sin(1.0), np.cos(1.0)]]
    np.testing.assert_allclose(found.over(0.5, 3), wanted, atol=1e-13)


def test_scaling_makes_a_stiff_vibration_even():
    """x'' = -w^2 x: with the place in units of 1/w both entries are w, to a factor of the powers of two taken."""
    w = 1e4
    A = np.array([[[0.0, 1.0], [-(w**2), 0.0]]])
    scale = scaling(A)
    even = np.abs(A[0] * scale / scale[:, None])
    assert 1 / 4 < even[0, 1] / even[1, 0] < 4 and even[0, 1] == pytest.approx(w, rel=3.0)


def test_kept_states_by_name():
    model = LinearModel.from_matrices(np.eye(3), np.zeros((3, 0)), states=("a", "b", "c"))
    assert kept(model, ("c", "a")) == [2, 0] and kept(model, None) == [0, 1, 2]
    with pytest.raises(ValueError, match=r"must (name one state or more, each once|be distinct names)"):
        kept(model, ("a", "a"))


def test_modes_of_the_mean_stand_one_beside_the_other():
    """Two pairs and a real root, hidden by a rotation: blocks again, for every A(t) of the same modes."""
    rng = np.random.default_rng(3)
    blocks = np.zeros((5, 5))
    blocks[:2, :2], blocks[2:4, 2:4], blocks[4, 4] = [[-0.1, 3.0], [-3.0, -0.1]], [[-0.2, 50], [-50, -0.2]], -1.0
    Q = np.linalg.qr(rng.standard_normal((5, 5)))[0]
    A = Q @ (np.array([0.9, 1.0, 1.1])[:, None, None] * blocks) @ Q.T
    X, inverse = modal(A)
    np.testing.assert_allclose(inverse @ X, np.eye(5), atol=1e-14)
    found = np.abs(inverse @ A @ X) > 1e-10
    assert found.any(axis=0).sum() == 4 * 2 + 1
