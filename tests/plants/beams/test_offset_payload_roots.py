"""Roots of a clamped beam with an offset payload, none missed."""

import math

import beam_elements
import mpmath as mp
import numpy as np
import pytest
from evidence import agrees
from payload_cases import CASES, COUPLED, random_system, system

from pliant.plants import beams
from pliant.plants.beams.offset_payload_roots import OffsetPayload


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
    agrees(  # the file's digits end there
        roots,
        expected,
        within=1e-11,
        absolute=True,
        of="beams.clamped_payload_roots",
        what=f"six roots, {case}",
        source="Ritz model in 60 digits, 200 beam elements (offset_payload.json)",
        kind="independent arithmetic",
    )


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


@pytest.mark.parametrize(
    ("seed", "payloads"), [pytest.param(4, 60, id="60"), pytest.param(5, 500, id="500", marks=pytest.mark.campaign)]
)
def test_no_root_missed_in_random_payloads(seed, payloads):
    """Each count is checked by Sylvester's inertia of a mesh, in the widest gap among the last roots."""
    rng = np.random.default_rng(seed)
    for k in range(payloads):
        s = random_system(rng)
        roots = s.roots(14)
        gap = 8 + int(np.argmax(np.diff(roots)[8:]))
        at = roots[gap] + 0.6 * (roots[gap + 1] - roots[gap])  # elements lie above the truth
        K, M = beam_elements.bending_torsion(s, 24)
        assert beam_elements.count_below(K, M, at**4) == gap + 1 == len(s.roots_between(0.0, at)), (k, s)
        meshed = beam_elements.lowest(K, M, gap + 1) ** 0.25
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
