"""Sections, payloads and the integrals of shape functions, against closed forms and reference digits."""

import json
import math
from pathlib import Path

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

from pliant.plants import beams
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import ALUMINIUM, STEEL, Beam, Material
from pliant.plants.core import parameters

REFERENCE = Path(__file__).parents[2] / "reference"
PLAIN = {
    "length": 2.0,
    "area": 1e-3,
    "I_y": 2e-7,
    "I_z": 1e-7,
    "J": 5e-8,
    "density": 2700.0,
    "E": 7e10,
    "G": 2.7e10,
}
EVERY_KIND = [(kind, n) for kind in beams.BASES for n in (1, 4, 25)]


def build(kind, n):
    return beams.basis(kind, n, tip_mass_ratio=0.8, tip_inertia_ratio=0.05)


def test_sections():
    r = Beam.rectangular(2.0, 0.02, 0.05, ALUMINIUM)
    assert r.area == pytest.approx(1e-3) and r.mass == pytest.approx(5.4)
    assert r.I_z == pytest.approx(0.02 * 0.05**3 / 12) and r.I_y == pytest.approx(0.05 * 0.02**3 / 12)
    assert pytest.approx(70e9 * r.I_z) == r.EI and r.polar_moment == pytest.approx(r.I_y + r.I_z)
    c = Beam.circular(1.0, 0.03, STEEL)
    assert pytest.approx(math.pi * 0.03**4 / 32) == c.J and pytest.approx(c.polar_moment) == c.J
    t = Beam.tube(1.0, 0.05, 0.03, STEEL)
    assert t.area == pytest.approx(math.pi * (0.05**2 - 0.03**2) / 4)
    assert t.I_z == pytest.approx(math.pi * (0.05**4 - 0.03**4) / 64) and pytest.approx(2 * t.I_z) == t.J
    assert pytest.approx(81e9 * t.J) == t.GJ


@pytest.mark.parametrize("sides", [(0.05, 0.05), (0.02, 0.05), (0.05, 0.02), (1.0, 1e-3)])
def test_rectangle_torsion_constant_is_the_full_series(sides):
    a, b = max(sides), min(sides)
    series = mp.nsum(lambda k: mp.tanh((2 * k + 1) * mp.pi * a / (2 * b)) / (2 * k + 1) ** 5, [0, mp.inf])
    exact = a * b**3 * (mp.mpf(1) / 3 - 64 * b / (mp.pi**5 * a) * series)
    assert pytest.approx(float(exact), rel=1e-14, abs=0) == Beam.rectangular(1.0, *sides, STEEL).J


def test_square_torsion_constant_as_tabulated():
    assert pytest.approx(0.1406, abs=5e-5) == Beam.rectangular(1.0, 1.0, 1.0, STEEL).J  # Timoshenko, Goodier, 109


def test_a_parameter_may_be_a_symbol():
    length, width = ca.SX.sym("L"), ca.SX.sym("b")
    beam = parameters.put(Beam(**PLAIN), "length", length)
    assert float(ca.Function("m", [length], [beam.mass])(2.0)) == pytest.approx(5.4)
    section = Beam.rectangular(length, width, 0.05, ALUMINIUM)
    J = ca.Function("J", [width], [section.J])
    for w in (0.02, 0.09):
        assert float(J(w)) == pytest.approx(Beam.rectangular(1.0, w, 0.05, ALUMINIUM).J, rel=1e-14, abs=0)
    payload = Payload(mass=ca.SX.sym("m"), inertia=ca.SX.sym("I"), offset=(ca.SX.sym("x"), 0.0, 0.0))
    assert parameters.is_symbolic(payload.inertia_z)


def test_payload_inertia_about_z_and_dotted_names():
    tensor = ((2.0, 0.1, 0.0), (0.1, 2.0, 0.0), (0.0, 0.0, 3.0))
    assert Payload(inertia=tensor).inertia_z == 3.0 and Payload(inertia=0.4).inertia_z == 0.4
    assert Payload(inertia=np.array(tensor)) == Payload(inertia=tensor)
    assert parameters.put(Payload(), "offset.0", 0.2).offset == (0.2, 0.0, 0.0)
    assert parameters.unit_of(Payload(inertia=tensor), "inertia.2.2") == "kg m^2"
    Payload(inertia=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0)))  # a thin plate is on the limit


@pytest.mark.parametrize(
    "make, text",
    [
        (lambda: Beam(**{**PLAIN, "length": -1.0}), r"Beam.length = -1.0 must be > 0 \[m\]"),
        (lambda: Beam(**{**PLAIN, "density": 0.0}), "Beam.density = 0.0 must be > 0"),
        (lambda: Beam(**{**PLAIN, "I_z": math.nan}), "Beam.I_z = nan"),
        (lambda: Beam(**PLAIN, damping=-1e-3), "Beam.damping = -0.001 must be >= 0"),
        (lambda: Material(density=1.0, E=0.0, G=1.0), "Material.E = 0.0 must be > 0"),
        (lambda: Beam.rectangular(1.0, 0.1, -0.2, STEEL), "rectangular depth = -0.2 must be > 0"),
        (lambda: Beam.rectangular(0.0, 0.1, 0.2, STEEL), "Beam.length = 0.0 must be > 0"),
        (lambda: Beam.circular(1.0, "wide", STEEL), "circular diameter = 'wide' must be > 0"),
        (lambda: Beam.tube(1.0, 0.03, 0.05, STEEL), "tube inner = 0.05 must be > 0 and < outer = 0.03"),
        (lambda: Payload(mass=-1.0), "Payload.mass = -1.0 must be >= 0"),
        (lambda: Payload(inertia=-1.0), "Payload.inertia = -1.0 must be >= 0"),
        (lambda: Payload(inertia=((1.0, 0.0), (0.0, 1.0))), "must be a number or 3 x 3"),
        (lambda: Payload(inertia=((1, 0.5, 0), (0, 1, 0), (0, 0, 1))), "must be symmetric"),
        (lambda: Payload(inertia=((1, 2, 0), (2, 1, 0), (0, 0, 1))), "principal moments >= 0"),
        (lambda: Payload(inertia=((1, 0, 0), (0, 1, 0), (0, 0, 3))), "above the sum of the others"),
        (lambda: Payload(offset=(1.0, 2.0)), r"Payload.offset = \(1.0, 2.0\) must be three numbers"),
        (lambda: beams.basis("hermite", 2), "basis.kind = 'hermite' must be one of"),
        (lambda: beams.basis("polynomial", 31), "basis.n = 31 must be an integer from 0 to 30"),
        (lambda: beams.basis("payload", 201), "basis.n = 201 must be an integer from 0 to 200"),
        (lambda: beams.basis("payload", 2, tip_mass_ratio=-1.0), "tip_mass_ratio = -1.0 must be within"),
        (lambda: beams.frequencies(Beam(**PLAIN), 2, "free"), "boundary = 'free'"),
        (lambda: beams.frequencies(Beam(**PLAIN), 2, "pinned-free", Payload()), "'clamped-free'"),
        (lambda: beams.frequencies(Beam(**PLAIN), 2, payload=Payload(1.0, 0.1, (0, 0, 0.1))), r"offset\[2\]"),
    ],
)
def test_bad_input_names_field_value_and_range(make, text):
    with pytest.raises(ValueError, match=text):
        make()


def test_frequencies_of_plain_and_loaded_beams():
    beam = Beam.rectangular(1.0, 0.04, 0.002, STEEL)
    first = 1.875104068711961**2 * math.sqrt(beam.EI / (7850 * 8e-5))
    assert beams.frequencies(beam, 3)[0] == pytest.approx(first, rel=1e-14, abs=0)
    heavy = Payload(mass=1e6 * beam.mass)
    assert beams.frequencies(beam, 1, payload=heavy)[0] == pytest.approx(math.sqrt(3 * beam.EI / heavy.mass), rel=1e-6)
    cases = json.loads((REFERENCE / "offset_payload.json").read_text())["cases"]
    exact = float(cases["ii_Mt1"]["lambda"][1]) ** 2 * math.sqrt(beam.EI / beam.linear_density)
    loaded = beams.frequencies(beam, 2, payload=Payload(mass=beam.mass))
    assert loaded[1] == pytest.approx(exact, rel=1e-11)
    along = beams.frequencies(beam, 2, payload=Payload(mass=beam.mass, offset=(0.1, 0.0, 0.0)))
    assert np.all(along < loaded)


def test_reference_modal_digits():
    basis = beams.basis("clamped-free", 4)
    for k, row in enumerate(json.loads((REFERENCE / "two_link.json").read_text())["modal"]):
        want = {name: float(digits) for name, digits in row.items()}
        assert basis.phi.roots[k] == pytest.approx(want["betaL"], rel=1e-14, abs=0)
        assert basis.tip[k] == pytest.approx(want["phiE"], rel=1e-13)
        assert basis.tip_slope[k] == pytest.approx(want["dphiE"], rel=1e-13)
        assert 0.864 * basis.moment[k] == pytest.approx(want["nw"], rel=1e-12)
        assert 0.864 * basis.first[k] == pytest.approx(want["nq"], rel=1e-12)
        assert 119.46666666666668 * basis.stiffness[k, k] == pytest.approx(want["k"], rel=1e-12)


def test_clamped_free_integrals_have_their_closed_forms_up_to_mode_200():
    basis = beams.basis("clamped-free", 200)
    beta = basis.phi.roots
    sigma = (1 - 2 * np.sin(beta) * np.exp(-beta) - np.exp(-2 * beta)) / (
        1 + 2 * np.cos(beta) * np.exp(-beta) + np.exp(-2 * beta)
    )
    np.testing.assert_allclose(basis.first, 2 * sigma / beta, atol=2e-15)
    np.testing.assert_allclose(basis.moment, 2 / beta**2, atol=2e-15)
    np.testing.assert_allclose(np.diag(basis.shortening), sigma * beta * (2 + sigma * beta), rtol=1e-12)
    np.testing.assert_allclose(np.abs(basis.tip), 2.0, rtol=1e-12)


@pytest.mark.parametrize("kind", ["clamped-free", "payload", "polynomial"])
def test_weighted_shortening_against_adaptive_quadrature(kind):
    basis = build(kind, 3)
    for i, j in ((0, 0), (0, 1), (1, 2), (2, 2)):
        slopes = lambda s: float(np.prod(basis.phi(float(s), 1)[[i, j]]))  # noqa: E731, B023
        want = [
            mp.quad(lambda s: weight(s) * slopes(s), [0, 0.5, 1])  # noqa: B023
            for weight in (lambda s: 1, lambda s: 1 - s, lambda s: (1 - s * s) / 2)
        ]
        have = [basis.shortening[i, j], basis.shortening_mean[i, j], basis.shortening_moment[i, j]]
        np.testing.assert_allclose(have, np.array(want, dtype=float), rtol=1e-12, atol=1e-12)


def test_two_polynomials_by_hand():
    basis = beams.basis("polynomial", 2)  # sqrt(5) xi^2 and sqrt(7) (5 xi^2 - 6 xi^3)
    np.testing.assert_allclose(basis.tip, [math.sqrt(5), -math.sqrt(7)], rtol=1e-14)
    np.testing.assert_allclose(basis.tip_slope, [2 * math.sqrt(5), -8 * math.sqrt(7)], rtol=1e-14)
    coupled = -16 * math.sqrt(35)
    np.testing.assert_allclose(basis.stiffness, [[20, coupled], [coupled, 1204]], rtol=1e-13)
    np.testing.assert_allclose(basis.moment, [math.sqrt(5) / 4, math.sqrt(7) * (5 / 4 - 6 / 5)], rtol=1e-13)


@pytest.mark.parametrize("kind, n", EVERY_KIND)
def test_every_basis_meets_its_ends_and_its_integrals(kind, n):
    basis = build(kind, n)
    assert basis.n == n and basis.kind == kind
    zero, one = basis.phi(np.array([0.0, 1.0])), basis.phi(np.array([0.0, 1.0]), 1)
    size = np.abs(basis.tip_slope).max() + np.abs(one[0]).max() + 10
    np.testing.assert_allclose(zero[0], 0, atol=1e-12)
    left, _, right = kind.partition("-")
    if left != "pinned":
        np.testing.assert_allclose(one[0], 0, atol=1e-13 * size)
        assert np.all(basis.phi(0.0, 2) > 0)
    else:
        assert np.all(one[0] > 0)
    if right in ("pinned", "clamped"):
        np.testing.assert_allclose(zero[1], 0, atol=1e-12)
    if right == "clamped":
        np.testing.assert_allclose(one[1], 0, atol=1e-13 * size)

    x, w = np.polynomial.legendre.leggauss(120)  # one panel: not the rule under test
    xi, w = (1 + x) / 2, w[:, None] / 2
    value, curvature = basis.phi(xi), basis.phi(xi, 2)
    np.testing.assert_allclose(basis.mass, value.T @ (w * value), atol=1e-12)
    np.testing.assert_allclose(basis.stiffness, curvature.T @ (w * curvature), atol=1e-12 * basis.stiffness.max())
    np.testing.assert_allclose(np.diag(basis.mass), 1, atol=1e-13)
    for M in (basis.mass, basis.stiffness, basis.shortening, basis.shortening_mean, basis.shortening_moment):
        np.testing.assert_array_equal(M, M.T)
    assert np.linalg.eigvalsh(basis.stiffness)[0] > 0
    if kind in beams.BOUNDARIES:
        np.testing.assert_allclose(
            curvature.T @ (w * curvature), np.diag(basis.phi.roots**4), atol=1e-11 * basis.stiffness.max()
        )
    if kind == "payload" and n <= 4:
        assert np.linalg.eigvalsh(basis.mass)[0] > 0


@pytest.mark.parametrize("kind", ["payload", "polynomial"])
def test_polynomials_and_loaded_modes_give_the_loaded_frequencies(kind):
    basis = build(kind, 10)
    mass = basis.mass + 0.8 * np.outer(basis.tip, basis.tip) + 0.05 * np.outer(basis.tip_slope, basis.tip_slope)
    beta = np.sort(np.linalg.eigvals(np.linalg.solve(mass, basis.stiffness)).real) ** 0.25
    np.testing.assert_allclose(beta[:3], beams.loaded_roots(3, 0.8, 0.05), rtol=1e-9)


@pytest.mark.parametrize("derivative", range(5))
def test_polynomial_derivatives_against_exact_rationals(derivative):
    k, xi = 29, mp.mpf("0.3")
    with mp.workdps(60):
        shape = lambda s: -mp.sqrt(2 * k + 5) * s**2 * mp.jacobi(k, 0, 4, 2 * s - 1)  # noqa: E731
        exact = float(mp.diff(shape, xi, derivative))
    have = beams.Polynomials(30)(0.3, derivative)[k]
    assert have == pytest.approx(exact, rel=1e-11, abs=1e-11 * 30.0 ** (2 * derivative))


@pytest.mark.parametrize("kind", beams.BASES)
def test_no_shape_functions_at_all(kind):
    basis = beams.basis(kind, 0)
    assert basis.n == 0 and basis.mass.shape == (0, 0) and basis.tip.shape == basis.first.shape == (0,)
    assert basis.phi(np.linspace(0, 1, 6).reshape(2, 3), 1).shape == (2, 3, 0)


def test_basis_is_cached_and_cannot_be_changed():
    assert beams.basis("clamped-free", 3) is beams.basis("clamped-free", 3, tip_mass_ratio=5.0)
    with pytest.raises(ValueError, match="read-only"):
        beams.basis("clamped-free", 3).tip[0] = 1.0
