"""Modal data of any points, and its bad input."""

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.core.quaternions import matrix_of, quaternion
from pliant.plants.modal_data.modal_data import ModalData

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8, damping=0.01)
RNG = np.random.default_rng(5)


def cloud(n, count=8, rng=RNG):
    """A body of random nodes."""
    return ModalData.from_nodes(
        rng.normal(size=(count, 3)),
        rng.uniform(0.5, 2, count),
        rng.normal(size=(n, count, 3)),
        frequencies=np.arange(1.0, n + 1),
    )


def test_turned_axes_turn_the_inertia():
    rng = np.random.default_rng(5)
    r, dm, phi = rng.normal(size=(8, 3)), rng.uniform(0.5, 2, 8), rng.normal(size=(3, 8, 3))
    data = ModalData.from_nodes(r, dm, phi, frequencies=np.ones(3))
    assert np.linalg.eigvalsh(data.pi)[0] > -1e-12
    turn = matrix_of(quaternion([0.3, -0.2, 0.9]))
    turned = ModalData.from_nodes(r @ turn.T, dm, phi @ turn.T, frequencies=np.ones(3))
    np.testing.assert_allclose(turned.inertia, turn @ data.inertia @ turn.T, atol=1e-12)


def test_the_slowest_modes_in_any_order():
    data = cloud(4)
    reordered = data.keep([2, 0, 3, 1])
    np.testing.assert_array_equal(reordered.slowest(2).R, data.R[[0, 1]])
    np.testing.assert_array_equal(reordered.shortening_squares, data.shortening_squares)


def test_shortening_of_a_pendulum():
    """One rigid-like shape phi = x e_z: a bar turned by eta shortens by x eta^2/2, the cosine's second order."""
    x = np.linspace(0.1, 1.0, 10)
    nodes = np.column_stack([x, 0 * x, 0 * x])
    shapes = np.zeros((1, 10, 3))
    shapes[0, :, 2] = x
    g = np.zeros((1, 1, 10, 3))
    g[0, 0, :, 0] = x
    data = ModalData.from_nodes(nodes, np.ones(10), shapes, frequencies=[1.0], shortening=g)
    assert data.shortening[0, 0, 0] == pytest.approx(x.sum())
    assert data.shortening_moments[0, 0, 0, 0] == pytest.approx((x**2).sum())


BAD = {
    "mass": (lambda: ModalData.rigid(-1.0, (0, 0, 0), np.eye(3)), r"ModalData\.mass = -1\.0 must be > 0 \[kg\]"),
    "inertia": (
        lambda: ModalData.rigid(1.0, (9.0, 0, 0), np.eye(3)),
        r"inertia = .* too small for 1 kg whose centre is at",
    ),
    "node mass": (
        lambda: ModalData.from_nodes(np.eye(3), [1, -1, 1], np.zeros((0, 3, 3)), frequencies=[]),
        r"masses\[1\] = -1",
    ),
    "both": (lambda: ModalData.from_nodes(np.eye(3), np.ones(3), np.ones((1, 3, 3))), "exactly one of frequencies"),
    "same modes": (
        lambda: ModalData.from_nodes(np.eye(3), np.ones(3), np.ones((2, 3, 3)), frequencies=[1, 2]),
        "the 2 modes must be independent",
    ),
    "counts": (lambda: ModalData.boom(BOOM, (1.5, 1)), r"ModalData\.boom\.modes\[0\] = 1\.5 must be an integer"),
    "width": (lambda: ModalData.panel(BOOM, -1.0), r"width = -1\.0 must be > 0 \[m\]"),
    "keep": (
        lambda: ModalData.boom(BOOM, (1, 1)).keep([2]),
        r"ModalData\.keep\.modes\[0\] = 2 must be an integer from 0 to 1",
    ),
    "shape": (
        lambda: ModalData.from_nodes(np.eye(3), np.ones(4), np.ones((1, 3, 3)), frequencies=[1]),
        r"masses has shape",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name):
    make, words = BAD[name]
    with pytest.raises(ValueError, match=words):
        make()
