"""Inertial forces at accelerations that are given, against the mass matrix and bias from energies, and points."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import ModalData
from pliant.plants.core.quaternions import cross
from pliant.plants.modal_data.deformed_body import Deformed
from pliant.plants.modal_data.inertial_forces import inertial_forces

RNG = np.random.default_rng(0)
R, DM, PHI = RNG.normal(size=(9, 3)), RNG.uniform(0.5, 1.0, 9), RNG.normal(size=(2, 9, 3))
G = RNG.normal(size=(2, 2, 9, 3))
DATA = ModalData.from_nodes(R, DM, PHI, frequencies=[3.0, 4.0], shortening=G + G.transpose(1, 0, 2, 3))
MOVING = [RNG.normal(size=n) for n in (2, 2, 2, 3, 3, 3)]  # eta, rate, acceleration, omega, of the origin, alpha


def forces(n, stiffened):
    symbols = [ca.SX.sym("s", len(v) if k > 2 else n) for k, v in enumerate(MOVING)]
    found = ca.Function("found", symbols, [ca.densify(inertial_forces(DATA, *symbols, stiffened))])
    return np.array(found(*(v if k > 2 else v[:n] for k, v in enumerate(MOVING))))[:, 0]


def lagranges_bias(own, omega, eta, rate):
    """Of the energy by Lagrange's equations in quasi-coordinates (Hamel): what M_A (a0, alpha, d2eta/dt2) lacks of the
    rates of the linear, angular and modal momentum.
    """
    p, h = cross(omega) @ own.S + own.R @ rate, own.tensor @ omega + own.Y @ rate
    if not eta.shape[0]:
        return ca.vertcat(cross(omega) @ p, cross(omega) @ h)
    T = ca.dot(omega, own.tensor @ omega) / 2 + ca.dot(rate, own.Y.T @ omega) + ca.dot(rate, own.m @ rate) / 2
    along = ca.jtimes(ca.vertcat(p, h, own.Y.T @ omega + own.m @ rate), eta, rate)
    return along + ca.vertcat(cross(omega) @ p, cross(omega) @ h, -ca.gradient(T, eta))


@pytest.mark.parametrize("stiffened", [False, True])
@pytest.mark.parametrize("n", [0, 1, 2])
def test_they_are_the_mass_matrix_times_accelerations_and_the_bias(n, stiffened):
    eta, rate, moved, omega, origin, alpha = (ca.SX(ca.DM(v)) for v in MOVING)
    symbol = ca.SX.sym("eta", n)
    own = Deformed.of(DATA, symbol, stiffened)
    whole = own.matrix @ ca.vertcat(origin, alpha, moved[:n]) + lagranges_bias(own, omega, symbol, rate[:n])
    expected = np.array(ca.DM(ca.substitute(ca.densify(whole), symbol, eta[:n])))[:, 0]
    np.testing.assert_allclose(forces(n, stiffened), expected, atol=1e-12 * np.abs(expected).max())


def test_they_are_sums_over_points():
    """int a dm, int s x a dm and int (ds/deta) . a dm with s = r + phi eta - g eta eta / 2."""
    eta, rate, moved, omega, origin, alpha = MOVING
    g = G + G.transpose(1, 0, 2, 3)
    slopes = PHI - np.einsum("klpi,l->kpi", g, eta)
    s = R + np.einsum("k,kpi->pi", eta, PHI) - np.einsum("klpi,k,l->pi", g, eta, eta) / 2
    ds = np.einsum("k,kpi->pi", rate, slopes)
    dds = np.einsum("k,kpi->pi", moved, slopes) - np.einsum("klpi,k,l->pi", g, rate, rate)
    a = origin + np.cross(alpha, s) + np.cross(omega, np.cross(omega, s)) + 2 * np.cross(omega, ds) + dds
    wanted = np.concatenate([DM @ a, DM @ np.cross(s, a), np.einsum("p,kpi,pi->k", DM, slopes, a)])
    np.testing.assert_allclose(forces(2, True), wanted, atol=1e-12 * np.abs(wanted).max())
