"""Strains as coordinates: the energy they store against quadrature of the strains, and what a coordinate stands for."""

import casadi as ca
import numpy as np
import pytest
from strained_cases import SECTION, STRAINED

from pliant.plants.beam_strains.strain_fields import PanelBends, integrated, legendre

XI, WEIGHTS = np.polynomial.legendre.leggauss(30)
XI, WEIGHTS = (1 + XI) / 2, WEIGHTS / 2
HALVES, HALF = np.concatenate([XI / 2, (1 + XI) / 2]), np.tile(WEIGHTS / 2, 2)  # of beams of one or two segments


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
            strain = np.asarray(ca.DM(strains.of(kind, ca.SX(q), HALVES))).ravel()
            total += stiffness / 2 * HALF @ strain**2
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


@pytest.mark.parametrize("panels", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_integrals_of_the_shapes(count, panels):
    """Panel by panel by Gauss points."""
    at = np.array([0.0, 0.3, 0.6, 1.0])
    expected = np.zeros((4, count * panels))
    for row, end in zip(expected, at):
        for i in range(panels):
            start, stop = i / panels, min((i + 1) / panels, end)
            if stop > start:
                row += (stop - start) * WEIGHTS @ legendre(count, start + (stop - start) * XI, panels)
    np.testing.assert_allclose(integrated(count, at, panels), expected, atol=1e-14)


@pytest.mark.parametrize("rotating", [False, True])
def test_bends_of_panels_turn_by_the_integral_of_their_curvature(rotating):
    shapes = PanelBends(3, 4, rotating)
    inner = np.concatenate([(i + XI) / 4 for i in range(4)])
    squares = np.einsum("k,ki,kj->ij", np.tile(WEIGHTS / 4, 4), shapes.curvature(inner), shapes.curvature(inner))
    np.testing.assert_allclose(shapes.stiffness, squares, atol=1e-12)
    assert shapes.n == 12 + rotating
    np.testing.assert_allclose(shapes(np.ones(1))[0], [1.0] * rotating + [1.0, 0.0, 0.0] * 4, atol=1e-14)
    h = 1e-6
    xi = np.array([0.1, 0.4, 0.9])
    np.testing.assert_allclose((shapes(xi + h) - shapes(xi - h)) / (2 * h), shapes.curvature(xi), atol=1e-8)
    fine = PanelBends(4, 4, rotating)
    q = np.random.default_rng(3).uniform(-1, 1, shapes.n)
    np.testing.assert_allclose(fine(xi) @ fine.embedding(shapes) @ q, shapes(xi) @ q, atol=1e-12)
