"""What a moving beam takes: Lagrange's equations of its kinetic energy about a root that moves as it is told."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.multibody_parts.beam_forces import inertial, spread
from pliant.plants.multibody_parts.spatial import Motion
from pliant.plants.multibody_parts.tree_beam import TreeBeam

BEAM = Beam(length=1.3, area=2e-4, I_y=3e-9, I_z=5e-9, J=6e-9, density=2700.0, E=7e10, G=2.7e10)
X, W = np.polynomial.legendre.leggauss(24)
XI, W = (1 + X) / 2, W / 2


def test_forces_are_sums_over_points():
    """Linear, without torsion: each mass point's a + U p + 2 omega x p', its moment and its work on each shape."""
    beam, rng = TreeBeam(BEAM, (2, 1, 0, 2), "polynomial", False), np.random.default_rng(0)
    eta, rate = 0.02 * rng.normal(size=5), rng.normal(size=5)
    motion = Motion(*(ca.SX(ca.DM(v)) for v in rng.normal(size=(3, 3))))
    omega, alpha, a = (np.array(ca.DM(v)).ravel() for v in motion)
    found, Q = inertial(beam, motion, motion.U, ca.SX(ca.DM(eta)), ca.SX(ca.DM(rate)))
    f, n, work = np.zeros(3), np.zeros(3), np.zeros(5)
    for xi, w in zip(XI, W, strict=True):
        s = beam.section(float(xi), ca.SX(ca.DM(eta)), ca.SX(ca.DM(rate)))
        p, v = (np.array(ca.DM(q)).ravel() for q in (s.shift, s.shift_rate))
        each = a + np.cross(alpha, p) + np.cross(omega, np.cross(omega, p)) + 2 * np.cross(omega, v)
        f, n = f + BEAM.mass * w * each, n + BEAM.mass * w * np.cross(p, each)
        work = work + BEAM.mass * w * np.array(ca.DM(s.T[:3, :])).T @ each
    polar = BEAM.density * BEAM.polar_moment * BEAM.length  # about x: the sections' own, alpha and gyroscopic
    n = n + polar * np.array([alpha[0], omega[2] * omega[0], -omega[1] * omega[0]])
    np.testing.assert_allclose(np.array(ca.DM(found.f)).ravel(), f, atol=1e-12)
    np.testing.assert_allclose(np.array(ca.DM(found.n)).ravel(), n, atol=1e-12)
    np.testing.assert_allclose(np.array(ca.DM(Q)).ravel(), work, atol=1e-12)


@pytest.mark.parametrize("n", [0, 1, 3])
def test_spread(n):
    v = ca.SX(ca.DM([1.0, 2.0]))
    np.testing.assert_array_equal(np.array(ca.DM(spread(v, n))).ravel(), [1.0, 2.0, 0.0][:n])
