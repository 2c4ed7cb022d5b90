"""A link's inertia written out: both ways of summing agree, and loads are those of points that the link moves."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, Payload, beams
from pliant.plants.beams import STEEL
from pliant.plants.exact_rotations import moving_link
from pliant.plants.exact_rotations.moving_link import MovingLink
from pliant.plants.exact_rotations.strain_link import StrainLink

BEAM = Beam.rectangular(0.8, width=0.03, depth=0.004, material=STEEL)
LOAD = Payload(mass=0.3, inertia=0.002, offset=(0.04, -0.03, 0.0))


def built(n, load=None):
    """(y, y') -> M, force, tip, tip's Jacobian and bias, moment's Jacobian and bias."""
    link = StrainLink(BEAM, beams.basis("polynomial", n), True)
    y, rate = ca.SX.sym("y", 1 + n), ca.SX.sym("rate", 1 + n)
    turn, omega, q, v = y[0], rate[0], y[1:], rate[1:]
    own = MovingLink.of(link, turn, omega, q, v)
    if load is not None:
        own = own.loaded(link, load, turn + link.slope(q), omega + link.slope(v), True)
    c, s, (x, z) = ca.cos(turn), ca.sin(turn), link.tip(q)
    tip = ca.vertcat(c * x - s * z, s * x + c * z)
    parts = [own.M, own.force, tip, own.tip.jacobian, own.tip.bias, own.moment.jacobian, own.moment.bias]
    return ca.Function("built", [y, rate], [ca.densify(e) for e in parts])


def drawn(n):
    rng = np.random.default_rng(n)
    size = np.concatenate([[1.0], 0.1 / 4.0 ** np.arange(n)])
    return rng.uniform(-1, 1, 1 + n) * size, rng.uniform(-1, 1, 1 + n) * size


@pytest.mark.parametrize("n", [1, 4])
def test_pairs_and_products_agree(monkeypatch, n):
    """cos(Theta_a - Theta_b) = cos cos + sin sin: the same sums in another order."""
    at = drawn(n)
    pairs = built(n)(*at)
    monkeypatch.setattr(moving_link, "PAIRWISE", 0)
    for one, other in zip(pairs, built(n)(*at)):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13 * np.abs(np.asarray(one)).max())


@pytest.mark.parametrize("load", [None, LOAD], ids=["bare", "loaded"])
def test_force_is_what_a_changing_mass_matrix_leaves(load):
    """Lagrange: force = dM/dt y' - d(y'.M y'/2)/dy, by central differences of M alone."""
    f, (y, rate), h = built(2, load), drawn(2), 1e-5

    def M(at):
        return np.asarray(f(at, rate)[0])

    change = (M(y + h * rate) - M(y - h * rate)) / (2 * h)
    across = [rate @ (M(y + h * e) - M(y - h * e)) @ rate / (4 * h) for e in np.eye(3)]
    np.testing.assert_allclose(np.asarray(f(y, rate)[1]).ravel(), change @ rate - across, rtol=0, atol=1e-7)


def test_tip_moves_by_its_jacobian_and_bias():
    """Central differences of the tip's position along y + rate t, whose second derivative is the bias alone."""
    f, (y, rate), h = built(2), drawn(2), 1e-4
    behind, here, ahead = (np.asarray(f(y + k * h * rate, rate)[2]).ravel() for k in (-1, 0, 1))
    np.testing.assert_allclose(np.asarray(f(y, rate)[3]) @ rate, (ahead - behind) / (2 * h), rtol=0, atol=1e-7)
    bias = (ahead - 2 * here + behind) / h**2
    np.testing.assert_allclose(np.asarray(f(y, rate)[4]).ravel(), bias, rtol=0, atol=1e-6)


def test_a_point_mass_adds_its_own_moment_and_inertia():
    y, rate = drawn(2)
    bare, loaded = (built(2, load)(y, rate) for load in (None, dataclasses.replace(LOAD, offset=(0.0, 0.0, 0.0))))
    J, b = (np.asarray(bare[k]) for k in (3, 4))
    slope = np.concatenate([[1.0], beams.basis("polynomial", 2).tip_slope / BEAM.length])
    expected = np.asarray(bare[0]) + LOAD.mass * J.T @ J + LOAD.inertia_z * np.outer(slope, slope)
    np.testing.assert_allclose(loaded[0], expected, rtol=1e-12)
    np.testing.assert_allclose(loaded[6], np.asarray(bare[6]) + LOAD.mass * b, rtol=1e-12)
