"""Strains as coordinates: the energy they store against quadrature of the strains, and what a coordinate stands for."""

import casadi as ca
import numpy as np
import pytest
from strained_cases import SECTION, STRAINED

from pliant.plants.beam_strains.strain_fields import integrated, legendre

XI, WEIGHTS = np.polynomial.legendre.leggauss(30)
XI, WEIGHTS = (1 + XI) / 2, WEIGHTS / 2


@pytest.mark.parametrize("name", STRAINED)
def test_energy_is_the_integral_of_the_strains(name):
    strains = STRAINED[name].strained_beam.frames.strains
    q = np.random.default_rng(1).uniform(-1, 1, strains.n)
    b, total = SECTION, 0.0
    L = b.length
    for kind, stiffness in (
        ("bend", b.E * b.I_z / L),
        ("flap", b.E * b.I_y / L),
        ("twist", b.G * b.J / L),
        ("stretch", b.E * b.area * L),
        ("shear_y", 0.8 * b.G * b.area * L),
        ("shear_z", 0.8 * b.G * b.area * L),
    ):
        if kind != "flap" or not strains.planar:
            strain = np.asarray(ca.DM(strains.of(kind, ca.SX(q), XI))).ravel()
            total += stiffness / 2 * WEIGHTS @ strain**2
    assert float(ca.DM(strains.strain_energy(b, ca.SX(q)))) == pytest.approx(total, rel=1e-12)
    v = np.random.default_rng(2).uniform(-1, 1, strains.n)
    force = np.asarray(ca.DM(strains.elastic_force(b, ca.SX(q), ca.SX(v)))).ravel()
    energy = ca.SX.sym("q", strains.n)
    gradient = ca.Function("g", [energy], [ca.gradient(strains.strain_energy(b, energy), energy)])
    np.testing.assert_allclose(force, -np.asarray(gradient(q + b.damping * v)).ravel(), rtol=1e-12, atol=1e-9)


def test_the_first_of_each_strain_is_its_mean_and_the_slices_fill_q():
    plant = STRAINED["space"]
    strains = plant.strained_beam.frames.strains
    names = [s.name for s in plant.coordinates]
    assert names == ["hub_angle", "bend1", "flap1", "twist1", "stretch1", "shear1", "shear_z1"]
    assert sorted(k for s in strains.slices.values() for k in range(s.start, s.stop)) == list(range(strains.n))
    assert [names[strains.slices[k].start] for k in ("twist", "stretch", "shear_y", "shear_z")] == [
        "twist1", "stretch1", "shear1", "shear_z1",
    ]  # fmt: skip
    q = np.zeros(strains.n)
    q[names.index("stretch1")] = 0.02
    assert WEIGHTS @ np.asarray(ca.DM(strains.of("stretch", ca.SX(q), XI))).ravel() == pytest.approx(0.02)


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_integrals_of_the_shapes(count):
    at = np.array([0.0, 0.3, 1.0])
    inner = at[:, None] * XI
    expected = at[:, None] * np.einsum("k,ikn->in", WEIGHTS, legendre(count, inner.ravel()).reshape(3, 30, count))
    np.testing.assert_allclose(integrated(count, at), expected, atol=1e-14)
