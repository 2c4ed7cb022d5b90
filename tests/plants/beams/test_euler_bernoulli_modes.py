"""Closed-form modes against 40-digit arithmetic, finite elements and reference roots."""

import json
import math
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from evidence import agrees
from scipy.linalg import eigh

from pliant.plants.beams import euler_bernoulli_modes

REFERENCE = Path(__file__).parents[2] / "reference"
LOADS = [
    (0.0, 0.0, 0.0),
    (0.3, 0.01, 0.0),
    (1.0, 0.2, 0.3),
    (50.0, 7.0, -9.0),
    (0.0, 3.0, 0.0),
    (1e6, 1e5, 0.0),
]


@pytest.fixture(autouse=True)
def forty_digits_after_cancellation():
    with mp.workdps(320):  # cosh of root 200 is 1e272
        yield


def characteristic(boundary):
    """The textbook equations, whose roots are the betas."""
    return {
        "clamped-free": lambda b: mp.cos(b) * mp.cosh(b) + 1,
        "clamped-clamped": lambda b: mp.cos(b) * mp.cosh(b) - 1,
        "pinned-free": lambda b: mp.sin(b) * mp.cosh(b) - mp.cos(b) * mp.sinh(b),
        "pinned-pinned": lambda b: mp.sin(b),
    }[boundary]


def loaded_characteristic(b, mass, inertia, coupling):
    c, s, ch, sh = mp.cos(b), mp.sin(b), mp.cosh(b), mp.sinh(b)
    tip = mp.matrix([[mass, coupling], [coupling, inertia]]) * b**4
    curvature = lambda p, q: b**2 * (ch + c) * p + b**2 * (sh + s) * q  # noqa: E731
    shear = lambda p, q: b**3 * (sh - s) * p + b**3 * (ch + c) * q  # noqa: E731
    rows = []
    for p, q in ((1, 0), (0, 1)):  # phi = p (cosh - cos) + q (sinh - sin)
        value = (ch - c) * p + (sh - s) * q
        slope = b * (sh + s) * p + b * (ch - c) * q
        load = tip * mp.matrix([value, slope])
        rows.append([shear(p, q) + load[0], curvature(p, q) - load[1]])
    return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]


@pytest.mark.parametrize("boundary", euler_bernoulli_modes.BOUNDARIES)
def test_roots_bracket_a_sign_change_of_the_textbook_equation_up_to_mode_200(boundary):
    f = characteristic(boundary)
    beta = euler_bernoulli_modes.roots(boundary, 200)
    for b in beta:
        wide = 3e-16 * mp.mpf(b)
        assert f(b - wide) * f(b + wide) < 0
    assert np.all(np.diff(beta) > 2.7)  # none missed: beyond the first, they lie pi apart
    assert np.all(np.diff(beta) < 3.3) and beta[0] < 4.8


def exact_clamped_free_root(k):
    """Root k from 1, by the equation divided by cosh at mpmath's precision."""
    return mp.findroot(lambda b: mp.cos(b) + mp.sech(b), (k - 0.5) * math.pi + (0.3 if k == 1 else 0))


def test_clamped_free_frequencies_to_1e_12_up_to_mode_200():
    with mp.workdps(40):
        exact = np.array([float(exact_clamped_free_root(k) ** 2) for k in range(1, 201)])
    agrees(
        euler_bernoulli_modes.roots("clamped-free", 200) ** 2,
        exact,
        within=1e-14,
        of="beams.roots",
        what="200 frequencies, clamped-free",
        source="cos + sech = 0, Blevins (1979), table 8-1, by mpmath",
        kind="closed form",
    )


BLEVINS = {  # R. D. Blevins, "Formulas for Natural Frequency and Mode Shape", 1979, table 8-1
    "clamped-free": (1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839),
    "clamped-clamped": (4.73004074, 7.85320462, 10.9956079, 14.1371655, 17.2787597),
    "pinned-free": (3.92660231, 7.06858275, 10.21017612, 13.35176878, 16.49336143),
}


@pytest.mark.parametrize("boundary", BLEVINS)
def test_roots_as_tabulated(boundary):
    agrees(
        euler_bernoulli_modes.roots(boundary, 5),
        BLEVINS[boundary],
        within=7e-8,  # the third of clamped-clamped is 10.99560784, printed one unit higher
        absolute=True,
        of="beams.roots",
        what=f"five roots, {boundary}",
        source="Blevins (1979), table 8-1",
        kind="table",
    )


@pytest.mark.parametrize("load", LOADS)
def test_loaded_roots_bracket_a_sign_change(load):
    for b in euler_bernoulli_modes.loaded_roots(200, *load)[[0, 1, 2, 3, 10, 50, 199]]:
        wide = 4e-15 * mp.mpf(b)
        assert loaded_characteristic(b - wide, *load) * loaded_characteristic(b + wide, *load) < 0


def finite_elements(mass, inertia, coupling, elements=40, held=2):
    """beta of a clamped (held=1: pinned) beam of cubic elements with a loaded tip: high by O(h^4), 8e-5 at mode 10."""
    h, n = 1 / elements, 2 * elements + 2
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2]]) / h**3
    k = np.vstack([k, -k[0], [6 / h**2, 2 / h, -6 / h**2, 4 / h]])
    m = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2]])
    m = np.vstack([m, [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]) * h / 420
    K, M = np.zeros((n, n)), np.zeros((n, n))
    for e in range(elements):
        at = np.s_[2 * e : 2 * e + 4]
        K[at, at] += k
        M[at, at] += m
    M[-2:, -2:] += [[mass, coupling], [coupling, inertia]]
    return eigh(K[held:, held:], M[held:, held:], eigvals_only=True)[2 - held :] ** 0.25


def test_random_loads_agree_with_finite_elements_so_no_root_is_missed():
    rng = np.random.default_rng(7)
    for _ in range(25):
        mass, inertia = 10.0 ** rng.uniform(-4, 3, 2)
        coupling = rng.uniform(-0.99, 0.99) * math.sqrt(mass * inertia)
        beta = euler_bernoulli_modes.loaded_roots(10, mass, inertia, coupling)
        agrees(
            beta,
            finite_elements(mass, inertia, coupling)[:10],
            within=1e-4,
            of="beams.loaded_roots",
            what="ten roots under a random load",
            source="40 cubic finite elements",
            kind="finer model",
        )


def test_pinned_loaded_roots_agree_with_finite_elements_so_no_root_is_missed():
    rng = np.random.default_rng(8)
    for _ in range(25):
        mass, inertia = 10.0 ** rng.uniform(-4, 3, 2)
        coupling = rng.uniform(-0.99, 0.99) * math.sqrt(mass * inertia)
        beta = euler_bernoulli_modes.pinned_loaded_roots(9, mass, inertia, coupling)
        np.testing.assert_allclose(beta, finite_elements(mass, inertia, coupling, held=1)[:9], rtol=1e-4)
    bare = euler_bernoulli_modes.pinned_loaded_roots(60, 0.0, 0.0)
    np.testing.assert_allclose(bare, euler_bernoulli_modes.roots("pinned-free", 60), rtol=1e-15)


@pytest.mark.parametrize("load", LOADS)
def test_pinned_loaded_shapes_meet_their_ends(load):
    mass, inertia, coupling = load
    phi = euler_bernoulli_modes.shapes("pinned-payload", 6, mass=mass, inertia=inertia, coupling=coupling)
    size = phi.roots ** np.arange(4)[:, None]
    root, tip = (np.array([phi(xi, d) for d in range(4)]) / size for xi in (0.0, 1.0))
    np.testing.assert_allclose(root[[0, 2]], 0.0, atol=1e-13)
    b = phi.roots
    force = tip[3] + b * mass * tip[0] + b**2 * coupling * tip[1]
    moment = tip[2] - b**2 * coupling * tip[0] - b**3 * inertia * tip[1]
    np.testing.assert_allclose(force, 0.0, atol=1e-13 * (1 + b.max() * mass + b.max() ** 2 * abs(coupling)))
    np.testing.assert_allclose(moment, 0.0, atol=1e-13 * (1 + b.max() ** 2 * abs(coupling) + b.max() ** 3 * inertia))


def test_count_steps_by_one_at_every_loaded_root():
    for load in LOADS:
        beta = euler_bernoulli_modes.loaded_roots(200, *load)
        np.testing.assert_array_equal(euler_bernoulli_modes.count_loaded(beta * (1 - 1e-12), *load), np.arange(200))
        np.testing.assert_array_equal(euler_bernoulli_modes.count_loaded(beta * (1 + 1e-12), *load), np.arange(1, 201))


def test_roots_of_the_published_payload_cases():
    cases = json.loads((REFERENCE / "offset_payload.json").read_text())["cases"]
    for name in ("i_plain", "ii_Mt1"):
        mass, every = cases[name]["params"]["Mt"], np.array(cases[name]["lambda"], dtype=float)
        torsion = [2, 4]  # (k - 1/2) pi = chi mu lambda^2
        np.testing.assert_allclose(
            euler_bernoulli_modes.loaded_roots(4, mass, 0.0), np.delete(every, torsion), rtol=1e-12
        )


def test_a_tip_mass_without_end_is_a_clamped_beam_with_a_pinned_tip():
    np.testing.assert_allclose(
        euler_bernoulli_modes.loaded_roots(6, 1e12, 0.0)[1:], euler_bernoulli_modes.roots("pinned-free", 5), rtol=1e-10
    )
    np.testing.assert_allclose(
        euler_bernoulli_modes.loaded_roots(6, 1e12, 1e12)[2:],
        euler_bernoulli_modes.roots("clamped-clamped", 4),
        rtol=1e-10,
    )


def textbook_shape(k, xi, derivative):
    """Mode k from 1 of the clamped-free beam at mpmath's precision."""
    b = exact_clamped_free_root(k)
    sigma = (mp.sinh(b) - mp.sin(b)) / (mp.cosh(b) + mp.cos(b))
    z = b * mp.mpf(xi)
    even, odd = (mp.cosh, mp.sinh) if derivative % 2 == 0 else (mp.sinh, mp.cosh)
    turn = derivative * mp.pi / 2
    value = even(z) - mp.cos(z + turn) - sigma * (odd(z) - mp.sin(z + turn))
    return float(value * b**derivative), float(b**derivative)


@pytest.mark.every(3)
@pytest.mark.parametrize("k", [1, 2, 14, 60, 200])
@pytest.mark.parametrize("derivative", range(5))
def test_shapes_against_the_textbook_form_at_320_digits(k, derivative):
    phi = euler_bernoulli_modes.shapes("clamped-free", 200)
    for xi in (0.0, 1e-3, 0.1, 0.37, 0.5, 0.9, 0.999, 1.0):
        exact, scale = textbook_shape(k, xi, derivative)
        assert phi(xi, derivative)[k - 1] == pytest.approx(exact, abs=3e-13 * scale)


@pytest.mark.parametrize("load", LOADS)
def test_loaded_shapes_are_orthogonal_in_the_mass_of_beam_and_load(load):
    mass, inertia, coupling = load
    phi = euler_bernoulli_modes.shapes("payload", 20, mass=mass, inertia=inertia, coupling=coupling)
    xi, w = euler_bernoulli_modes.quadrature(20)
    tip = np.stack([phi(1.0), phi(1.0, 1)])
    M = phi(xi).T @ (w[:, None] * phi(xi)) + tip.T @ [[mass, coupling], [coupling, inertia]] @ tip
    K = phi(xi, 2).T @ (w[:, None] * phi(xi, 2))
    size = np.sqrt(np.outer(np.diag(M), np.diag(M)))
    np.testing.assert_allclose(M / size, np.eye(20), atol=1e-10)
    stiff = np.sqrt(np.outer(np.diag(K), np.diag(K)))
    np.testing.assert_allclose(K / stiff, np.eye(20), atol=1e-10)
    np.testing.assert_allclose(np.diag(K) / np.diag(M), phi.roots**4, rtol=1e-9)


def test_very_heavy_load_has_the_static_cubic_as_first_mode():
    phi = euler_bernoulli_modes.shapes("payload", 1, mass=1e10)
    xi = np.linspace(0, 1, 9)
    static = xi**2 * (3 - xi) * math.sqrt(35 / 33)  # int (3 xi^2 - xi^3)^2 = 33/35
    np.testing.assert_allclose(phi(xi)[:, 0], static, rtol=1e-9)


@pytest.mark.parametrize("boundary", [*euler_bernoulli_modes.BOUNDARIES, "payload"])
def test_derivatives_are_derivatives_and_shapes_solve_the_beam_equation(boundary):
    phi = euler_bernoulli_modes.shapes(boundary, 5, mass=200.0 if boundary == "payload" else 0.0)  # first root below 1
    xi, h = np.linspace(0.05, 0.95, 7), 1e-5
    for d in range(4):
        slope = (phi(xi + h, d) - phi(xi - h, d)) / (2 * h)
        np.testing.assert_allclose(slope, phi(xi, d + 1), atol=1e-6 * np.abs(phi(xi, d + 1)).max())
    np.testing.assert_allclose(phi(xi, 4), phi.roots**4 * phi(xi), atol=1e-11 * phi.roots[-1] ** 4)


def test_bad_input_names_field_value_and_range():
    for call, text in [
        (lambda: euler_bernoulli_modes.roots("free-free", 2), "boundary = 'free-free'"),
        (lambda: euler_bernoulli_modes.roots("clamped-free", 201), "n = 201 .* 0 to 200"),
        (lambda: euler_bernoulli_modes.loaded_roots(2, -1.0, 0.0), "mass = -1.0 must be within"),
        (lambda: euler_bernoulli_modes.loaded_roots(2, 1.0, math.nan), "inertia = nan"),
        (lambda: euler_bernoulli_modes.loaded_roots(2, 1.0, 1.0, 1.5), "coupling = 1.5"),
        (lambda: euler_bernoulli_modes.shapes("clamped-free", 2)(1.2), r"xi = .*1.2.* \[0, 1\]"),
        (lambda: euler_bernoulli_modes.shapes("clamped-free", 2)(math.nan), "xi = .*nan"),
        (lambda: euler_bernoulli_modes.shapes("clamped-free", 2)(0.5, 5), "derivative = 5"),
    ]:
        with pytest.raises(ValueError, match=text):
            call()
