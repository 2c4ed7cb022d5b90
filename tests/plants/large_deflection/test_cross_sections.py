"""Rotation vectors against SciPy, and what planar sections add to a bent beam, by hand."""

import math

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pliant.plants import Beam, Payload
from pliant.plants.large_deflection.cross_sections import (
    PlanarSections,
    payload_tensor,
    rotation,
    series,
    spin,
    turned_about_z,
)

BEAM = Beam(length=2.0, area=1e-4, I_y=1e-9, I_z=2e-9, J=3e-9, density=2700.0, E=7e10, G=2.6e10, damping=0.01)


def numbers(expression):
    return np.array(ca.DM(ca.evalf(ca.SX(ca.densify(expression)))))


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.3, 2.0, 6.0])
def test_rotation_is_that_of_scipy_below_one_turn(size):
    theta = size * np.array([0.48, -0.6, 0.64])
    wanted = Rotation.from_rotvec(theta).as_matrix()
    np.testing.assert_allclose(numbers(rotation(ca.SX(ca.DM(theta)))), wanted, atol=1e-12)


@pytest.mark.parametrize("size", [0.3, 2.0, 5.0])
def test_spin_is_the_rate_of_the_rotation(size):
    """Of exp(theta + t rate) by central differences: R^T dR/dt is skew of the spin in its own axes; error h^2."""
    theta, rate, h = size * np.array([0.48, -0.6, 0.64]), np.array([0.3, 0.7, -0.5]), 1e-5
    after, before = (Rotation.from_rotvec(theta + s * h * rate) for s in (1, -1))
    wanted = (before.inv() * after).as_rotvec() / (2 * h)
    np.testing.assert_allclose(numbers(spin(ca.SX(ca.DM(theta)), ca.SX(ca.DM(rate)))).ravel(), wanted, atol=1e-8)


def test_series_are_those_of_the_cosine_and_the_sine():
    for z in (1e-6, 0.5, 20.0):
        phi = math.sqrt(z)
        assert float(series(ca.SX(z), 2)) == pytest.approx(2 * math.sin(phi / 2) ** 2 / z, rel=1e-11)  # (1 - cos)/z
        if z > 1e-3:
            assert float(series(ca.SX(z), 3)) == pytest.approx((phi - math.sin(phi)) / phi**3, rel=1e-11)


def test_turn_about_z_and_tensors():
    np.testing.assert_allclose(numbers(turned_about_z(ca.SX(0.7))), Rotation.from_euler("z", 0.7).as_matrix())
    np.testing.assert_array_equal(numbers(payload_tensor(Payload(mass=1.0, inertia=0.3))), 0.3 * np.eye(3))
    tensor = ((3.0, 0.1, 0.2), (0.1, 4.0, 0.3), (0.2, 0.3, 5.0))
    np.testing.assert_array_equal(numbers(payload_tensor(Payload(mass=1.0, inertia=tensor))), tensor)


def test_a_beam_of_constant_curvature():
    """theta = q xi: bending energy E I q^2/(2 L), rotary energy rho I L v^2/6, and a payload turned with the tip."""
    load = Payload(mass=0.5, inertia=0.2, offset=(0.3, 0.1, 0.0))
    sections = PlanarSections(BEAM, load, np.eye(1), np.eye(1) / 3, np.ones(1))
    q, v = ca.SX(ca.DM([0.8])), ca.SX(ca.DM([1.5]))
    EI = 7e10 * 2e-9
    assert float(sections.strain_energy(q)) == pytest.approx(EI * 0.8**2 / (2 * 2.0), rel=1e-14)
    assert float(sections.dissipation(q, v)) == pytest.approx(0.01 * EI * 1.5**2 / (2 * 2.0), rel=1e-14)
    assert float(sections.elastic_force(q, v)) == pytest.approx(-EI / 2.0 * (0.8 + 0.01 * 1.5), rel=1e-14)
    rotary = 2700.0 * 2e-9 * 2.0 * 1.5**2 / 6
    assert float(sections.kinetic(q, v)) == pytest.approx(rotary + 0.2 * 1.5**2 / 2, rel=1e-14)
    M, r = sections.inertia(q, v)
    assert float(M) * 1.5**2 / 2 == pytest.approx(float(sections.kinetic(q, v)), rel=1e-14) and not numbers(r).any()
    arm = Rotation.from_euler("z", 0.8).as_matrix()[:2, :2] @ [0.3, 0.1]
    np.testing.assert_allclose(numbers(sections.carried(q)).ravel(), arm, rtol=1e-14)
    assert float(sections.tip_rotation(q)) == 0.8
