"""Modes of a beam with an offset payload: orthonormal, and solutions of the field equations."""

import math

import numpy as np
import pytest
from payload_cases import CASES, COUPLED, random_system, system

from pliant.plants import beams
from pliant.plants.beams.offset_payload_roots import OffsetPayload


@pytest.mark.every(3)
@pytest.mark.parametrize("case", [*CASES, "coupled"])
def test_modes_are_orthonormal_and_carry_their_frequencies(reference, case):
    p = COUPLED if case == "coupled" else reference("offset_payload")["cases"][case]["params"]
    modes = system(p).shapes(60)
    np.testing.assert_allclose(modes.mass, np.eye(60), atol=1e-10)
    scaled = modes.stiffness / np.outer(modes.roots, modes.roots) ** 2
    np.testing.assert_allclose(scaled, np.eye(60), atol=1e-10)
    twisting = modes.torsion_share > 1 - 1e-6
    assert np.all(np.where(twisting, modes.torsion(0.0, 1), modes.bending(0.0, 2)) > 0)


@pytest.mark.parametrize("seed", range(12))
def test_modes_meet_the_field_equations_and_the_ends(seed):
    s = random_system(np.random.default_rng(seed))
    modes = s.shapes(10)
    xi, lam = np.linspace(0, 1, 9), modes.roots
    kappa = lam**2 * s.chi * s.mu
    V, G = modes.bending(xi, 0), modes.torsion(xi)
    size = np.abs(V).max(axis=0) + np.abs(G).max(axis=0)
    np.testing.assert_allclose(modes.bending(xi, 4) / lam**4, V, atol=1e-12 * size.max())
    np.testing.assert_allclose(modes.torsion(xi, 2) / kappa**2, -G, atol=1e-12 * size.max())
    np.testing.assert_allclose([V[0], modes.bending(0.0, 1), G[0]], 0, atol=1e-9 * (size * lam).max())
    tip = np.stack([modes.bending(1.0), modes.bending(1.0, 1), modes.torsion(1.0)])
    load = s.tip_mass @ tip
    ends = np.stack(
        [
            modes.bending(1.0, 3) / lam**4 + load[0],
            modes.bending(1.0, 2) / lam**4 - load[1],
            modes.torsion(1.0, 1) / (s.chi**2 * lam**4) - load[2],
        ]
    )
    np.testing.assert_allclose(ends, 0, atol=1e-8 * (1 + np.abs(load).max() + np.abs(tip).max()))


def test_coefficients_of_eqs_9_to_11_with_their_corrections():
    """B/A2 and A1/A2 of the printed cosh and sinh shapes, against our modes."""
    p = COUPLED
    Mt, ax, ay, az, Ixx, _, Ixz, chi, mu = (p[k] for k in COUPLED)
    modes = system(p).shapes(6)
    for k, lam in enumerate(modes.roots):
        s, c, sh, ch = math.sin(lam), math.cos(lam), math.sinh(lam), math.cosh(lam)
        su, cu = math.sin(lam**2 * chi * mu), math.cos(lam**2 * chi * mu)
        D0, aa = mu * cu - chi * Ixx * lam**2 * su, ay**2 + az**2
        F_cr, F_cc = s * ch + c * sh, 1 - c * ch
        mixed = lam**2 * (ax * D0 + chi * lam**2 * az * Ixz * su)
        B = -4 * chi * lam**2 * (lam * (Ixz + Mt * ax * az) * F_cr + Mt * (az * s * sh - lam**2 * Ixz * F_cc))
        A1 = (
            2 * D0 * (sh - s)
            + 2 * Mt * (chi * lam**2 * aa * su * (s - sh) + mixed * (s + sh) - lam * D0 * (c - ch))
            + 2 * chi * ay**2 * lam**3 * Mt**2 * su * (c - ch - ax * lam * (s + sh))
        )
        Den = (
            -2 * D0 * (c + ch)
            + 2 * Mt * (chi * aa * lam**2 * su * (c + ch) + lam * D0 * (s - sh) + mixed * (c - ch))
            + 2 * chi * ay**2 * lam**3 * Mt**2 * su * (sh - s + ax * lam * (ch - c))
        )
        # A2 from V''(0) = -2 lam^2 A2, A1 from V'''(0) = -2 lam^3 A1.
        A2 = -modes.bending(0.0, 2)[k] / (2 * lam**2)
        assert -modes.bending(0.0, 3)[k] / (2 * lam**3) / A2 == pytest.approx(A1 / Den, rel=1e-8)
        twist = modes.torsion(0.0, 1)[k] / (lam**2 * chi * mu)
        assert twist / A2 == pytest.approx(B / Den, rel=1e-8)


def test_without_coupling_it_is_bending_and_torsion_side_by_side():
    s = OffsetPayload(mass=0.8, inertia=(0.0, 0.05, 0.0), offset=(0.2, 0.0, 0.0), chi=1.3, mu=0.04)
    bending = beams.loaded_roots(10, 0.8, 0.05 + 0.8 * 0.04, 0.8 * 0.2)
    torsion = np.sqrt((np.arange(10) + 0.5) * math.pi / (1.3 * 0.04))
    both = np.sort(np.concatenate([bending, torsion]))[:10]
    np.testing.assert_allclose(s.roots(10), both, rtol=1e-14)
