"""Beams of small slopes as bodies of a tree: Kelvin-Voigt damping, the line that is drawn, the end that is read."""

import casadi as ca
import numpy as np

from pliant.plants import Beam
from pliant.plants.elastic_bodies.bent_beam import BentBeam
from pliant.plants.multibody_parts.tree_beam import TreeBeam

BEAM = Beam(length=1.3, area=2e-4, I_y=3e-9, I_z=5e-9, J=6e-9, density=2700.0, E=7e10, G=2.7e10, damping=2e-4)
BODY = BentBeam(TreeBeam(BEAM, (1, 1, 1, 1), "polynomial", True))


def test_forces_are_gradients():
    """Of strain energy by coordinates and of Rayleigh's function by rates; of sqrt(5) xi^2, 20 E I/L^3 is stiffness."""
    q, v = ca.SX.sym("q", 4), ca.SX.sym("v", 4)
    gap = BODY.resistance(q, v) - ca.gradient(BODY.strain_energy(q), q) - ca.gradient(BODY.dissipation(v), v)
    found = ca.Function("f", [q, v], [gap, BODY.strain_energy(q)])
    gap, V = (np.array(e).ravel() for e in found([0.1, -0.2, 0.3, 0.01], [1.0, 2.0, 3.0, 4.0]))
    np.testing.assert_allclose(gap, 0.0, atol=1e-9)
    _, V = found([1.0, 0.0, 0.0, 0.0], 0)
    np.testing.assert_allclose(float(V), BEAM.EI / (2 * BEAM.length**3) * 20.0, rtol=1e-12)


def test_readings():
    eta = np.array([0.02, -0.03, 0.1, 1e-3])
    read = [float(ca.DM(e)) for e in BODY.readings(ca.SX(ca.DM(eta)), ca.SX(ca.DM(2 * eta)))]
    np.testing.assert_allclose(read[:4], np.sqrt(5) * np.r_[eta[:2], 2 * eta[:2]], rtol=1e-12)
    np.testing.assert_allclose(read[4:], 2 * np.sqrt(5) * eta[:2] / BEAM.length**2, rtol=1e-12)
