"""A beam in space against the sum over its own mass points: each a section's place, differentiated by CasADi."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.multibody_parts.tree_beam import TreeBeam

BEAM = Beam(length=1.3, area=2e-4, I_y=3e-9, I_z=5e-9, J=6e-9, density=2700.0, E=7e10, G=2.7e10)
X, W = np.polynomial.legendre.leggauss(24)
XI, W = (1 + X) / 2, W / 2
COUNTS = (2, 1, 1, 2)


def points(beam, eta, rate):
    """Places of the mass points (3, N) and their rates within the root's axes."""
    found = [beam.section(float(xi), eta, rate) for xi in XI]
    return [s.shift for s in found], [s.shift_rate for s in found]


@pytest.mark.parametrize("basis", ["polynomial", "clamped-free"])
def test_integrals_are_sums_over_points(basis):
    beam = TreeBeam(BEAM, COUNTS, basis, False)
    eta = ca.SX(ca.DM([0.02, -0.01, 0.03, 0.1, 0.004, -0.003]))
    shift, _ = points(beam, eta, ca.SX.zeros(6))
    p, dm = np.array([np.array(ca.DM(s)).ravel() for s in shift]), BEAM.mass * W
    own = beam.inertia(eta)
    np.testing.assert_allclose(np.array(ca.DM(own.S)).ravel(), dm @ p, atol=1e-13)
    P = np.einsum("p,pi,pj->ij", dm, p, p)
    half = BEAM.density * BEAM.polar_moment * BEAM.length / 2
    found = np.array(ca.DM(own.matrix())) - np.diag([-half, half, half])
    np.testing.assert_allclose(found, P, atol=1e-13)


def test_coupling_is_the_sum_over_points():
    """(dS/deta_k, int p x dp/deta_k dm), torsion's apart."""
    beam, symbol = TreeBeam(BEAM, (2, 1, 0, 2), "polynomial", False), ca.SX.sym("eta", 5)
    shift, _ = points(beam, symbol, ca.SX.zeros(5))
    dm, at = BEAM.mass * W, [0.02, -0.01, 0.03, 0.004, -0.003]
    f = sum((m * ca.jacobian(s, symbol) for m, s in zip(dm, shift, strict=True)), ca.SX(3, 5))
    n = sum(
        (m * ca.horzcat(*[ca.cross(s, ca.jacobian(s, symbol)[:, k]) for k in range(5)]) for m, s in zip(dm, shift)),
        ca.SX(3, 5),
    )
    own = beam.coupling(symbol)
    found = ca.Function("f", [symbol], [f, n, ca.horzcat(*[w.f for w in own]), ca.horzcat(*[w.n for w in own])])
    f, n, g, h = (np.array(v) for v in found(at))
    np.testing.assert_allclose(g, f, atol=1e-13)
    np.testing.assert_allclose(h, n, atol=1e-13)


@pytest.mark.parametrize("xi", [0.0, 0.4, 1.0])
def test_sections_move_as_they_say(xi):
    """Rates and accelerations of the stiffened section are the derivatives of its place."""
    beam = TreeBeam(BEAM, COUNTS, "polynomial", True)
    eta, rate = ca.SX.sym("eta", 6), ca.SX.sym("rate", 6)
    s = beam.section(xi, eta, rate)
    place = ca.vertcat(s.shift, s.turn)
    moved = ca.jtimes(place, eta, rate)
    lacking = [
        ca.vertcat(s.shift_rate, s.turn_rate) - moved,
        s.T - ca.jacobian(place, eta),
        s.shift_bias - ca.jtimes(moved[:3], eta, rate),
    ]
    rng = np.random.default_rng(2)
    for value in ca.Function("f", [eta, rate], lacking)(rng.normal(size=6), rng.normal(size=6)):
        np.testing.assert_allclose(np.array(value), 0.0, atol=1e-12)


def test_shortening_of_the_tip():
    """s = 1/2 int u'^2 dx: for u = c x^2, 2 c^2 L^3/3."""
    beam = TreeBeam(BEAM, (1, 0, 0, 0), "polynomial", True)
    c = float(beam.bent_bases[0].tip[0]) * 0.05 / BEAM.length**2  # the first polynomial is x^2
    shift = np.array(ca.DM(beam.section(1.0, ca.SX(0.05), ca.SX(0)).shift)).ravel()
    np.testing.assert_allclose(BEAM.length - shift[0], 2 * c**2 * BEAM.length**3 / 3, rtol=1e-12)
