"""Inertia by P against sums over mass points."""

import casadi as ca
import numpy as np

from pliant.plants.multibody_parts.spatial import Inertia, Motion, upper

RNG = np.random.default_rng(0)
POINTS, MASSES = RNG.normal(size=(5, 3)), RNG.uniform(1, 2, 5)


def cloud(points):
    P = np.einsum("p,pi,pj->ij", MASSES, points, points)
    return Inertia(ca.SX(MASSES.sum()), ca.SX(ca.DM(MASSES @ points)), upper(ca.SX(ca.DM(P))))


def test_inertial_force_and_moment():
    omega, alpha, a = RNG.normal(size=(3, 3))
    motion = Motion(*(ca.SX(ca.DM(v)) for v in (omega, alpha, a)))
    load = cloud(POINTS).inertial(motion, motion.U)
    each = a + np.cross(alpha, POINTS) + np.cross(omega, np.cross(omega, POINTS))
    np.testing.assert_allclose(np.array(ca.DM(load.f)).ravel(), MASSES @ each, atol=1e-12)
    np.testing.assert_allclose(np.array(ca.DM(load.n)).ravel(), MASSES @ np.cross(POINTS, each), atol=1e-12)


def test_unit_accelerations():
    body = cloud(POINTS)
    for axis in range(3):
        load, each = body.turning(axis), np.cross(np.eye(3)[axis], POINTS)
        np.testing.assert_allclose(np.array(ca.DM(load.f)).ravel(), MASSES @ each, atol=1e-12)
        np.testing.assert_allclose(np.array(ca.DM(load.n)).ravel(), MASSES @ np.cross(POINTS, each), atol=1e-12)
    e = np.array([0.6, 0.0, 0.8])
    load = body.sliding(e)
    np.testing.assert_allclose(np.array(ca.DM(load.n)).ravel(), np.cross(MASSES @ POINTS, e), atol=1e-12)
