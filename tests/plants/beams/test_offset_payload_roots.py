"""Bending and torsion with an offset payload: reference digits, our own elements, and no root missed."""

import math

import mpmath as mp
import numpy as np
import pytest

from pliant.plants import Beam, Payload, beams
from pliant.plants.beams import reference_finite_elements
from pliant.plants.beams.offset_payload_roots import OffsetPayload
from pliant.plants.beams.section import STEEL

CASES = (
    "i_plain",
    "ii_Mt1",
    "iii_Ixx0.005_Izz0.05",
    "iii_Ixx0.05_Izz0.05",
    "iii_Ixx0.5_Izz0.005",
    "iii_Ixx0.5_Izz0.5",
)
COUPLED = {
    "Mt": 1.0,
    "ax": 0.1,
    "ay": 0.05,
    "az": 0.3,
    "Ixx": 0.4,
    "Izz": 0.1,
    "Ixz": 0.1,
    "chi": 1.5,
    "mu": 0.05,
}


def system(p):
    return OffsetPayload(
        mass=p["Mt"],
        offset=(p["ax"], p["ay"], p["az"]),
        inertia=(p["Ixx"], p["Izz"], p["Ixz"]),
        chi=p["chi"],
        mu=p["mu"],
    )


def random_system(rng):
    """Light and heavy, centred and offset, thin and thick: moments of a rigid body, sometimes none."""
    A = rng.normal(size=(3, 3))
    spread = A @ A.T
    inertia = (np.trace(spread) * np.eye(3) - spread) * 10 ** rng.uniform(-4, 1) * rng.integers(0, 2)
    return OffsetPayload(
        mass=10 ** rng.uniform(-3, 2) * rng.integers(0, 4) / 2,
        offset=tuple(rng.uniform(-0.4, 0.4, 3) * rng.integers(0, 2, 3)),
        inertia=inertia,
        chi=10 ** rng.uniform(-0.3, 0.5),
        mu=10 ** rng.uniform(-2, -0.7),
    )


@pytest.mark.parametrize("case", CASES)
def test_reference_roots(reference, case):
    found = reference("offset_payload")["cases"][case]
    expected = np.array([float(v) for v in found["lambda"]])
    p = found["params"]
    roots = beams.clamped_payload_roots(
        6,
        mass=p["Mt"],
        offset=(p["ax"], p["ay"], p["az"]),
        inertia=(p["Ixx"], p["Izz"], p["Ixz"]),
        chi=p["chi"],
        mu=p["mu"],
    )
    np.testing.assert_allclose(roots, expected, rtol=0, atol=1e-11)  # the file's digits end there


def eq7(p, lam):
    """Eq (7) as printed, in mpmath."""
    Mt, ax, ay, az, Ixx, Izz, Ixz, chi, mu = (mp.mpf(str(p[k])) for k in COUPLED)
    x, z, q = Ixx + Mt * (ay**2 + az**2), Izz + Mt * (ax**2 + ay**2), Ixz + Mt * ax * az
    s, c, sh, ch = mp.sin(lam), mp.cos(lam), mp.sinh(lam), mp.cosh(lam)
    su, cu = mp.sin(lam**2 * chi * mu), mp.cos(lam**2 * chi * mu)
    F_cf, F_cr, F_cs, F_cc = 1 + c * ch, s * ch + c * sh, s * ch - c * sh, 1 - c * ch
    det = x * z - q * q
    once = (
        lam * mu * cu * F_cs
        + 2 * lam**2 * mu * ax * cu * s * sh
        - lam**3 * chi * x * su * F_cs
        - lam**4 * mu * z * cu * F_cc
        + 2 * lam**4 * chi * su * (az * q - ax * x) * s * sh
        + lam**6 * chi * su * det * F_cc
    )
    twice = (
        lam**3 * chi * az**2 * su * F_cs
        + lam**4 * mu * ax**2 * cu * F_cc
        - lam**6 * chi * su * (ax**2 * x - 2 * ax * az * q + az**2 * z) * F_cc
    )
    return (
        mu * cu * F_cf
        - lam**2 * chi * x * su * F_cf
        - lam**3 * mu * z * cu * F_cr
        + lam**5 * chi * su * det * F_cr
        - Mt * once
        - Mt**2 * twice
    )


def test_equation_is_eq_7_as_printed_times_a_positive_factor():
    s = system(COUPLED)
    lam = np.linspace(0.6, 44.0, 37)
    with mp.workdps(60):
        printed = np.array([float(eq7(COUPLED, mp.mpf(float(v))) * mp.exp(-mp.mpf(float(v)))) for v in lam])
    ours = s.equation(lam) * np.where(lam < 1, np.exp(-lam), 1.0)  # the factor of small lambda is one
    ratio = printed / ours  # of determinants, mu chi/kappa apart
    np.testing.assert_allclose(ratio * lam**2, ratio[0] * lam[0] ** 2, rtol=1e-9)
    assert np.all(np.isfinite(s.equation(np.array([400.0, 800.0]))))  # the printed form overflows at 670


@pytest.mark.parametrize("case", CASES)
def test_beam_elements_converge_to_the_roots_at_their_order(reference, case):
    s = system(reference("offset_payload")["cases"][case]["params"])
    roots = s.roots(6)
    meshes = np.array([8, 12, 16, 24])
    errors = np.array(
        [
            reference_finite_elements.lowest(*reference_finite_elements.bending_torsion(s, int(n)), 6) ** 0.25 / roots
            - 1
            for n in meshes
        ]
    )
    assert np.all(errors > -1e-10) and np.all(errors[-1] < 1e-4)  # from above, as Ritz's do
    seen = errors[-1] > 1e-8
    assert seen.sum() >= 3
    order = np.polyfit(np.log(meshes), np.log(errors[:, seen]), 1)[0]
    np.testing.assert_allclose(order, -4, atol=0.35)


def test_no_root_missed_in_500_random_payloads():
    """Each count is checked by Sylvester's inertia of a mesh, in the widest gap among the last roots."""
    rng = np.random.default_rng(4)
    for k in range(500):
        s = random_system(rng)
        roots = s.roots(14)
        gap = 8 + int(np.argmax(np.diff(roots)[8:]))
        at = roots[gap] + 0.6 * (roots[gap + 1] - roots[gap])  # elements lie above the truth
        K, M = reference_finite_elements.bending_torsion(s, 24)
        assert reference_finite_elements.count_below(K, M, at**4) == gap + 1 == len(s.roots_between(0.0, at)), (k, s)
        meshed = reference_finite_elements.lowest(K, M, gap + 1) ** 0.25
        np.testing.assert_allclose(meshed, roots[: gap + 1], rtol=0.02, err_msg=str((k, s)))


def test_count_agrees_with_its_own_roots_everywhere():
    rng = np.random.default_rng(7)
    for _ in range(30):
        s = random_system(rng)
        roots = s.roots(60)
        lam = rng.uniform(0.01, roots[-1], 400)
        np.testing.assert_array_equal(s.count(lam), np.searchsorted(roots, lam))
    band = s.roots_between(roots[10] * (1 - 1e-9), roots[20] * (1 - 1e-9))
    np.testing.assert_array_equal(band, roots[10:20])


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


def test_coupled_frequencies_have_units():
    """A heavy body on a short arm across a thin tube turns it: omega^2 = G J/(L I_xx), torsion alone."""
    tube = Beam.tube(0.5, 0.01, 0.009, STEEL)
    disc = Payload(mass=0.0, inertia=((1.0, 0, 0), (0, 0.5, 0), (0, 0, 0.5)))
    first = beams.coupled_frequencies(tube, 1, disc)[0]
    assert first == pytest.approx(math.sqrt(tube.GJ / tube.length / 1.0), rel=1e-4)
    plain = beams.coupled_frequencies(tube, 1, Payload())
    np.testing.assert_allclose(plain, beams.frequencies(tube, 1), rtol=1e-14)
    centred = Payload(mass=0.3, inertia=1e-9)
    np.testing.assert_allclose(
        beams.coupled_frequencies(tube, 2, centred), beams.frequencies(tube, 2, payload=centred), rtol=1e-12
    )


def test_a_tensor_is_the_papers_three_numbers():
    tensor = ((0.4, 0.0, -0.1), (0.0, 0.45, 0.0), (-0.1, 0.0, 0.1))
    a = OffsetPayload(mass=1.0, inertia=tensor, offset=(0.1, 0.05, 0.3), chi=1.5, mu=0.05)
    np.testing.assert_array_equal(a.tip_mass, system(COUPLED).tip_mass)


@pytest.mark.parametrize(
    "changes, text",
    [
        ({"mass": -1.0}, "OffsetPayload.mass = -1.0 must be within"),
        ({"mu": 0.0}, "OffsetPayload.mu = 0.0 must be within"),
        ({"chi": math.nan}, "OffsetPayload.chi = nan must be within"),
        ({"offset": (0.0, 1.0)}, "OffsetPayload.offset"),
        ({"inertia": (0.1, 0.1, 0.2)}, r"I_xz within \+-sqrt"),
        ({"inertia": -1.0}, "moments within"),
        ({"inertia": (1.0, 2.0)}, "a number, three or 3 x 3"),
        ({"n": 201}, "clamped_payload_roots.n = 201 must be an integer from 0 to 200"),
    ],
)
def test_bad_input_names_field_value_and_range(changes, text):
    with pytest.raises(ValueError, match=text):
        beams.clamped_payload_roots(changes.pop("n", 3), **{"chi": 1.0, "mu": 0.05, **changes})
