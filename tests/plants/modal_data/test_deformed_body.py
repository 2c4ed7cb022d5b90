"""Moments of a body given by its modes as it bends, against sums over its points."""

import casadi as ca
import numpy as np

from pliant.plants import ModalData
from pliant.plants.modal_data.deformed_body import Deformed


def test_moments_are_sums_over_points():
    """S, P, R, Y and m of points r + phi eta - g eta eta/2, the slopes of these by eta."""
    rng = np.random.default_rng(0)
    r, dm, phi = rng.normal(size=(9, 3)), rng.uniform(0.5, 1, 9), rng.normal(size=(2, 9, 3))
    g = rng.normal(size=(2, 2, 9, 3))
    g = g + g.transpose(1, 0, 2, 3)
    data = ModalData.from_nodes(r, dm, phi, frequencies=[3.0, 4.0], shortening=g)
    eta = np.array([0.3, -0.2])
    own = Deformed.of(data, ca.SX(ca.DM(eta)), True)
    p = r + np.einsum("k,kpi->pi", eta, phi) - np.einsum("klpi,k,l->pi", g, eta, eta) / 2
    slopes = phi - np.einsum("klpi,l->kpi", g, eta)
    wanted = (
        dm @ p, np.einsum("p,pi,pj->ij", dm, p, p), np.einsum("p,kpi->ik", dm, slopes),
        np.einsum("p,kpi->ik", dm, np.cross(p, slopes)), np.einsum("p,kpi,lpi->kl", dm, slopes, slopes),
    )  # fmt: skip
    for found, value in zip((own.S, own.P, own.R, own.Y, own.m), wanted, strict=True):
        np.testing.assert_allclose(np.array(ca.DM(ca.densify(found))).reshape(value.shape), value, atol=1e-12)
