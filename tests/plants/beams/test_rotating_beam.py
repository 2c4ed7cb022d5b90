"""Rotating beams against reference frequencies, limits and elements."""

import dataclasses
import math

import beam_elements
import numpy as np
import pytest
import scipy.linalg
from evidence import agrees

from pliant.plants import Beam, Payload, SingleLinkArm, beams
from pliant.plants.beams.rotating_beam import rotating_frequencies

LOAD = {"tip_mass": 0.7, "tip_inertia": 0.1, "hub_radius": 0.4}
THICK = {"theory": "timoshenko", "tip_mass": 0.5, "tip_inertia": 0.2, "rotary": 0.01, "shear": 1 / 2000}
# E I = rho A = L = 1, rho I = 0.01, kappa G A = 2000: the beam of timoshenko_check.
SECTION = Beam(length=1.0, area=1.0, I_y=1.0, I_z=0.01, J=1.0, density=1.0, E=100.0, G=2400.0)


@pytest.mark.parametrize("gamma", [0, 4, 8, 12])
@pytest.mark.parametrize("plane", ["flap", "lag"])
def test_reference_frequencies(reference, gamma, plane):
    expected = np.array([float(f) for f in reference("rotating_beam")["gamma"][str(gamma)][plane]])
    agrees(
        rotating_frequencies(gamma, 3, plane),
        expected,
        within=2e-9,
        of="beams.rotating_frequencies",
        what=f"{plane} frequencies at gamma {gamma}",
        source="reference frequencies of ten digits (rotating_beam.json)",
        kind="independent arithmetic",
    )


# gamma: three flap frequencies of a uniform cantilever on a hub without radius. A. D. Wright, C. E. Smith,
# R. W. Thresher and J. L. C. Wang, "Vibration modes of centrifugally stiffened beams", J. Appl. Mech. 49
# (1982), 197-202.
WRIGHT = {
    1: (3.6816, 22.1810, 61.8418),
    2: (4.1373, 22.6149, 62.2732),
    3: (4.7973, 23.3203, 62.9850),
    4: (5.5850, 24.2734, 63.9668),
    5: (6.4495, 25.4461, 65.2050),
    6: (7.3604, 26.8091, 66.6839),
    7: (8.2996, 28.3341, 68.3860),
    8: (9.2568, 29.9954, 70.2930),
    9: (10.2257, 31.7705, 72.3867),
    10: (11.2023, 33.6404, 74.6493),
    11: (12.1843, 35.5890, 77.0638),
    12: (13.1702, 37.6031, 79.6145),
}


@pytest.mark.parametrize("gamma", WRIGHT)
def test_flap_frequencies_as_printed(gamma):
    agrees(
        rotating_frequencies(float(gamma), 3, "flap"),
        WRIGHT[gamma],
        within=6e-5,
        absolute=True,
        of="beams.rotating_frequencies",
        what=f"three flap frequencies at gamma {gamma}",
        source="Wright, Smith, Thresher and Wang (1982)",
        kind="table",
    )


def test_flap_and_lag_differ_by_the_spin_and_no_spin_is_the_cantilever():
    flap, lag = (rotating_frequencies(9.0, 5, plane, tip_mass=0.3) for plane in ("flap", "lag"))
    np.testing.assert_allclose(flap**2 - lag**2, 81.0, rtol=1e-9)
    np.testing.assert_allclose(rotating_frequencies(0.0, 60), beams.roots("clamped-free", 60) ** 2, rtol=1e-11)
    loaded = rotating_frequencies(0.0, 8, tip_mass=0.7, tip_inertia=0.1)
    np.testing.assert_allclose(loaded, beams.loaded_roots(8, 0.7, 0.1) ** 2, rtol=1e-11)


@pytest.mark.parametrize("plane", ["flap", "lag"])
@pytest.mark.parametrize("stiffened", [True, False])
def test_elements_converge_to_it_at_their_order(plane, stiffened):
    exact = rotating_frequencies(20.0, 3, plane, stiffened, **LOAD)
    meshes, errors = np.array([10, 14, 20, 28]), []
    for n in meshes:
        squares = beam_elements.lowest(
            *beam_elements.rotating(20.0, int(n), plane=plane, stiffened=stiffened, **LOAD), 3
        )
        errors.append(squares - exact * np.abs(exact))
    slopes = np.polyfit(np.log(meshes), np.log(np.abs(errors)), 1)[0]
    if not stiffened:  # the first mode of the unloaded matrices converges into rounding
        slopes = slopes[1:]
    np.testing.assert_allclose(slopes, -4, atol=0.4)


@pytest.mark.parametrize("gamma", [1e2, 1e3, 1e4])
def test_fast_spin_is_a_chain(gamma):
    """Without bending stiffness a chain flaps at gamma sqrt(k (2 k - 1)); bending adds of order gamma."""
    flap = rotating_frequencies(gamma, 3)
    chain = gamma * np.sqrt([1.0, 6.0, 15.0])
    assert np.all(flap > chain)
    agrees(
        flap,
        chain,
        within=10 / gamma + 1e-6 if gamma > 100 else 0.06,
        of="beams.rotating_frequencies",
        what=f"flap at gamma {gamma:g}",
        source="hanging chain: gamma sqrt(k (2 k - 1))",
        kind="closed form",
    )


def test_hub_radius_and_tip_mass_by_rayleigh():
    """A rigid hinged bar on a hub, by hand: flap^2 = gamma^2 (1 + 3 r/2) from the stiff first shape w = x."""
    r, gamma = 0.5, 3000.0
    assert rotating_frequencies(gamma, 1, hub_radius=r)[0] == pytest.approx(gamma * math.sqrt(1 + 1.5 * r), rel=5e-3)
    heavy = rotating_frequencies(gamma, 1, tip_mass=1e3, hub_radius=r)[0]
    assert heavy == pytest.approx(gamma * math.sqrt(1 + r), rel=5e-3)


def test_timoshenko_check(reference):
    """Against a geometrically exact model: first-order shear, its share of the shortening included."""
    expected = reference("rotating_beam")["timoshenko_check"]["geometrically_exact"]
    agrees(
        rotating_frequencies(3.0, 3, "lag", **THICK),
        expected,
        within=2e-6,
        of="beams.rotating_frequencies",
        what="thick beam in lag",
        source="geometrically exact finite elements (rotating_beam.json)",
        kind="finer model",
    )


def test_timoshenko_elements_and_limit():
    numbers = {key: THICK[key] for key in ("shear", "rotary", "tip_mass", "tip_inertia")}
    exact = rotating_frequencies(3.0, 3, "lag", **THICK)
    errors = [
        np.sqrt(beam_elements.lowest(*beam_elements.timoshenko(n, gamma=3.0, **numbers), 3)) / exact - 1
        for n in (6, 12, 24)
    ]
    order = np.log2(np.array(errors)[:-1] / np.array(errors)[1:])
    np.testing.assert_allclose(order, 4, atol=0.3)
    for plane in ("flap", "lag"):
        slender = rotating_frequencies(6.0, 3, plane, theory="timoshenko", rotary=1e-12, shear=3e-12)
        np.testing.assert_allclose(slender, rotating_frequencies(6.0, 3, plane), rtol=1e-8)


def test_timoshenko_flap_keeps_the_spin_of_tilted_sections():
    """d(omega^2)/d(gamma^2) at rest by Rayleigh's quotient with the mode of a mesh: tension less rotary psi^2."""
    shear, rotary, small = 0.05, 0.02, 1e-3
    K, M = beam_elements.timoshenko(40, shear=shear, rotary=rotary)
    squares, vectors = scipy.linalg.eigh(K, M)
    mesh, mode = beam_elements.Mesh(40), vectors[:, 0]
    slope, psi = mesh.cubic(1, False), mesh.quadratic(0)
    dw, turn = slope @ mode[: slope.shape[1]], psi @ mode[slope.shape[1] :]
    tension = (1 - mesh.points**2) / 2
    density = tension * (dw**2 - (dw - turn) ** 2) - rotary * turn**2
    expected = mesh.weights @ density / (mode @ M @ mode)
    thick = {"theory": "timoshenko", "rotary": rotary, "shear": shear}
    still, spun = (rotating_frequencies(g, 1, **thick)[0] for g in (0.0, small))
    assert still**2 == pytest.approx(squares[0], rel=1e-6)
    assert (spun**2 - still**2) / small**2 == pytest.approx(expected, rel=1e-3)


@pytest.mark.every(3)
@pytest.mark.parametrize(
    ("basis", "modes", "rtol"), [("payload", 8, 6e-5), ("polynomial", 12, 3e-5), ("clamped-free", 10, 5e-2)]
)
def test_timoshenko_arm_has_the_frequencies(reference, basis, modes, rtol):
    arm = SingleLinkArm(
        link=SECTION,
        theory="timoshenko",
        payload=Payload(mass=0.5, inertia=0.2),
        drive="motion",
        basis=basis,
        modes=modes,
    )
    x = np.zeros(arm.nx)
    x[arm.nx // 2] = 3.0
    expected = reference("rotating_beam")["timoshenko_check"]["geometrically_exact"]
    np.testing.assert_allclose(arm.natural_frequencies(x)[:3], expected, rtol=rtol)
    poles = arm.linearize(x).eigenvalues
    found = np.sort(poles.imag[poles.imag > 0.1])[:3]
    np.testing.assert_allclose(found, arm.natural_frequencies(x)[:3], rtol=1e-8)


def test_timoshenko_arm_is_the_papers_matrices_with_Xi_33_zero():
    """Hub row and elastic rows of the corrected Eqs (15)-(16), integrals by another rule."""
    m, J, L = 0.5, 0.2, 1.0
    arm = SingleLinkArm(link=SECTION, theory="timoshenko", hub_inertia=2.0, payload=Payload(mass=m, inertia=J), modes=3)
    phi = arm.elastic.basis.phi
    x, w = np.polynomial.legendre.leggauss(50)
    x, w = (1 + x) / 2, w / 2
    W, dW, Psi, dPsi = phi(x), phi(x, 1), phi.rotation(x), phi.rotation(x, 1)
    WL, PsiL = phi(1.0), phi.rotation(1.0)

    def gram(f, weight=1.0):
        return f.T @ ((w * weight)[:, None] * f)

    M = arm.mass_matrix(np.zeros(arm.nx))
    assert M[0, 0] == pytest.approx(1 / 3 + 0.01 + 2.0 + J + m * L**2, rel=1e-13)
    np.testing.assert_allclose(
        M[0, 1:], w @ (x[:, None] * W) + m * WL + 0.01 * w @ Psi + J * PsiL, rtol=1e-12, atol=1e-13
    )
    own = gram(W) + m * np.outer(WL, WL) + 0.01 * gram(Psi) + J * np.outer(PsiL, PsiL)
    np.testing.assert_allclose(M[1:, 1:], own, atol=1e-12)
    K = gram(dPsi) + 2000.0 * gram(dW - Psi)
    tension = m * L + (1 - x**2) / 2
    Xi = gram(W) + m * np.outer(WL, WL) - gram(dW, tension) + gram(dW - Psi, tension)
    state = np.zeros(arm.nx)
    state[4] = 3.0
    free = dataclasses.replace(arm, drive="motion")
    stiffness = -M[1:, 1:] @ free.jacobians(state)[0][5:, 1:4]
    np.testing.assert_allclose(stiffness, K - 9.0 * Xi, atol=1e-9 * np.abs(K).max())


def test_timoshenko_arm_tends_to_the_euler_bernoulli_arm():
    slender = Beam.rectangular(1.0, 0.05, 1e-4, beams.STEEL)
    common = {"link": slender, "hub_inertia": 1e-6, "payload": Payload(mass=1e-3), "modes": 3}
    arms = [SingleLinkArm(theory=theory, **common) for theory in ("euler-bernoulli", "timoshenko")]
    frequencies = [arm.natural_frequencies() for arm in arms]
    np.testing.assert_allclose(*frequencies, rtol=1e-6)
    x = np.array([0.1, 0.02, -0.003, 0.001, 1.0, 0.1, -0.2, 0.3])
    np.testing.assert_allclose(arms[0].energy(x), arms[1].energy(x), rtol=1e-6)


def test_hub_radius_of_the_arm_stiffens_as_the_table_says():
    unit = Beam(length=1.0, area=1.0, I_y=1.0, I_z=1.0, J=2.0, density=1.0, E=1.0, G=1.0)
    arm = SingleLinkArm(
        link=unit, drive="motion", basis="polynomial", modes=12, hub_radius=0.4, payload=Payload(mass=0.7, inertia=0.1)
    )
    x = np.zeros(arm.nx)
    x[arm.nx // 2] = 8.0
    expected = rotating_frequencies(8.0, 3, "lag", **LOAD)
    np.testing.assert_allclose(arm.natural_frequencies(x)[:3], expected, rtol=1e-8)
    assert arm.measure(np.zeros(arm.nx))[3] == pytest.approx(1.4)
    np.testing.assert_allclose(arm.outline(np.zeros(arm.nx))[0, [0, -1], 0], [0.4, 1.4], rtol=1e-14)


@pytest.mark.every(2)
@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_spin_up_reproduces_the_reference(reference, theory):
    from pliant.studies.papers.single_link import spin_up

    for kinematics, expected in reference("rotating_beam")["spin_up_50"]["T=1.0"].items():
        found = spin_up(theory, kinematics)
        rtol = 5e-5 if theory == "euler-bernoulli" else 2e-3  # the file's theory is Euler's and Bernoulli's
        np.testing.assert_allclose([found.largest, found.residual, found.frequency], expected, rtol=rtol)


def test_shear_coefficients_are_cowpers():
    steel = beams.Material(density=1.0, E=2.6, G=1.0)  # Poisson's ratio 0.3
    assert Beam.rectangular(1.0, 1.0, 1.0, steel).shear_coefficient == pytest.approx(0.850, abs=5e-4)
    assert Beam.circular(1.0, 1.0, steel).shear_coefficient == pytest.approx(0.886, abs=5e-4)
    assert Beam.tube(1.0, 1.0, 0.9999, steel).shear_coefficient == pytest.approx(0.531, abs=5e-4)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"plane": "edge"}, "rotating_frequencies.plane = 'edge' must be one of 'flap', 'lag'"),
        ({"gamma": -1.0}, "rotating_frequencies.gamma = -1.0 must be within"),
        ({"tip_mass": math.nan}, "rotating_frequencies.tip_mass = nan must be within"),
        ({"shear": 0.1}, "theory = 'euler-bernoulli' must be 'timoshenko'"),
        ({"n": 61}, "rotating_frequencies.n = 61 must be an integer from 0 to 60"),
    ],
)
def test_bad_input_names_field_value_and_range(arguments, text):
    with pytest.raises(ValueError, match=text):
        rotating_frequencies(**{"gamma": 1.0, "n": 2, **arguments})
