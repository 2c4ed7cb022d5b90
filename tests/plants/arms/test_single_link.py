"""SingleLinkArm against closed-form roots, a rotating beam's frequencies and its own prescribed motion."""

import dataclasses

import numpy as np
import pytest
from evidence import agrees
from scipy.interpolate import CubicSpline

from pliant.plants import Beam, Material, Payload, SingleLinkArm, beams

ARM = SingleLinkArm.textbook()
HELD = ("hub_angle",)
UNIT = Beam(length=1.0, area=1.0, I_y=1.0, I_z=1.0, J=2.0, density=1.0, E=1.0, G=1.0)


def unit(**changes):
    """Length, linear density and E I all one: frequencies are lambda^2, and a hub rate is gamma."""
    return SingleLinkArm(link=UNIT, hub_inertia=1.0, **changes)


def bending_roots(case):
    """lambda of a case without offset, bending only: the torsion roots tan and cot know are left out."""
    chi, mu = case["params"]["chi"], case["params"]["mu"]
    roots = np.array([float(r) for r in case["lambda"]])
    turns = roots**2 * chi * mu / (np.pi / 2)  # odd integers for torsion with a free end
    return roots[np.abs(turns - np.round(turns)) > 1e-6]


@pytest.mark.parametrize("case", ["i_plain", "ii_Mt1"])
def test_frequencies_with_a_centred_payload(reference, case):
    found = reference("offset_payload")["cases"][case]
    expected = bending_roots(found)
    assert len(expected) == 4
    arm = unit(payload=Payload(mass=found["params"]["Mt"]), basis="payload", modes=4)
    agrees(
        arm.natural_frequencies(locked=HELD),
        expected**2,
        within=1e-8,
        of="SingleLinkArm",
        what=f"frequencies, {case}",
        source="Ritz model in 60 digits (offset_payload.json)",
        kind="independent arithmetic",
    )
    driven = dataclasses.replace(arm, drive="motion")
    np.testing.assert_allclose(driven.natural_frequencies(), expected**2, rtol=1e-8)


@pytest.mark.parametrize("gamma", [0, 4, 8, 12])
def test_stiffened_link_on_a_turning_hub_has_the_lag_frequencies(reference, gamma):
    expected = np.array([float(f) for f in reference("rotating_beam")["gamma"][str(gamma)]["lag"]])
    arm = unit(basis="polynomial", modes=12, kinematics="stiffened", drive="motion")
    x = np.zeros(arm.nx)
    x[arm.nx // 2] = gamma
    poles = arm.linearize(x).eigenvalues
    bending = np.sort(poles.imag[poles.imag > 0.5])[:3]
    agrees(
        bending,
        expected,
        within=1e-8,
        of="SingleLinkArm",
        what=f"poles on a hub turning at gamma {gamma}",
        source="reference frequencies of ten digits (rotating_beam.json)",
        kind="independent arithmetic",
    )
    np.testing.assert_allclose(arm.natural_frequencies(x)[:3], expected, rtol=1e-8)
    # Without shortening lag^2 = omega^2 - gamma^2.
    still = np.array([float(f) for f in reference("rotating_beam")["gamma"]["0"]["lag"]])
    squares = np.sign(expected) * still**2 - gamma**2
    loose = dataclasses.replace(arm, kinematics="linear").natural_frequencies(x)[:3]
    agrees(
        loose * np.abs(loose),
        squares,
        within=1e-8,
        of="SingleLinkArm",
        what=f"squares without stiffening at gamma {gamma}",
        source="omega^2 - gamma^2",
        kind="closed form",
    )


def test_geometric_stiffness_is_the_papers_with_payload(random_state):
    """Xi22 = int rho A W W^T + m W_L W_L^T - int vartheta W' W'^T, vartheta = m L + rho A (L^2 - x^2)/2."""
    m, gamma = 0.7, 3.0
    arm = unit(payload=Payload(mass=m), basis="polynomial", modes=4, drive="motion")
    phi = arm.elastic.basis.phi
    x, w = np.polynomial.legendre.leggauss(20)
    x, w = (1 + x) / 2, w / 2
    value, slope, curvature, end = phi(x), phi(x, 1), phi(x, 2), phi(1.0)
    Xi = value.T @ (w[:, None] * value) + m * np.outer(end, end)
    Xi -= slope.T @ ((w * (m + (1 - x**2) / 2))[:, None] * slope)
    K = curvature.T @ (w[:, None] * curvature)
    M = value.T @ (w[:, None] * value) + m * np.outer(end, end)
    state = np.zeros(arm.nx)
    state[arm.nx // 2] = gamma
    stiffness = -M @ arm.jacobians(state)[0][6:, 1:5]
    np.testing.assert_allclose(stiffness, K - gamma**2 * Xi, rtol=0, atol=1e-10 * np.abs(K).max())


@pytest.mark.every(2)
@pytest.mark.parametrize(
    ("payload", "rate"),
    [(Payload(mass=1.0), -3), (Payload(mass=1.0, inertia=0.3), -1)],
    ids=["mass", "inertia"],
)
def test_clamped_free_modes_converge_at_the_rate_of_what_they_miss(payload, rate):
    """A carried mass puts a jump into phi''' of the tip, a carried inertia into phi'': N^-3 and N^-1."""
    exact = unit(payload=payload, basis="payload", modes=2).natural_frequencies(locked=HELD)[0]
    counts = np.array([8, 12, 18, 27])
    errors = [
        unit(payload=payload, basis="clamped-free", modes=int(n)).natural_frequencies(locked=HELD)[0] / exact - 1
        for n in counts
    ]
    assert min(errors) > 0
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(rate, abs=0.1 * abs(rate))


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
@pytest.mark.parametrize("offset", [(0.2, 0.0, 0.0), (-0.3, 0.1, 0.0), (0.0, 0.4, 0.0)])
def test_payload_modes_know_the_offset_of_the_mass_centre(offset, theory):
    """As `frequencies` tells them; the two theories agree to (radius of gyration/length)^2 beta^2 = 1e-4 or so."""
    slender = Beam.rectangular(1.0, width=0.01, depth=0.003, material=beams.STEEL)
    payload = Payload(mass=3.0 * slender.mass, inertia=0.1 * slender.mass, offset=offset)
    arm = SingleLinkArm(link=slender, hub_inertia=1.0, payload=payload, basis="payload", modes=3, theory=theory)
    exact = beams.frequencies(arm.link, 3, payload=payload)
    within = {"euler-bernoulli": 1e-9, "timoshenko": 1e-3}[theory]
    np.testing.assert_allclose(arm.natural_frequencies(locked=HELD), exact, rtol=within)


def test_ladder_of_free_tip_modes_ends_where_the_payload_is_known():
    """A heavy payload: rungs of free-tip modes agree within 0.5 % and are 1 % off; the last is exact."""
    arm = unit(payload=Payload(mass=1.0, inertia=0.3), basis="clamped-free")
    exact = beams.frequencies(arm.link, 1, payload=arm.payload)[0]
    steps = [step for step in arm.ladder() if step.kinematics == "stiffened"][-3:]
    three, four, last = (step.natural_frequencies(locked=HELD)[0] / exact - 1 for step in steps)
    assert three - four < 0.005 and four > 0.01 and abs(last) < 1e-9
    assert steps[-1].basis == "payload"


def reaction(free, driven, x, acceleration):
    """The hub torques (B,) [N m] under which the free arm has these hub accelerations (B, 1) at x (B, nx)."""
    n = free.nx // 2
    change = driven.dynamics(x, acceleration)[:, n:] - free.dynamics(x)[:, n:]
    torque = np.einsum("bij,bj->bi", free.mass_matrix(x), change)
    assert np.abs(torque[:, 1:]).max(initial=0.0) < 1e-9 * np.abs(torque).max()  # the hub alone is pushed
    return torque[:, 0]


@pytest.mark.every(3)
@pytest.mark.parametrize("kinematics", ["rigid", "linear", "stiffened"])
def test_driven_hub_and_its_reaction_torque_give_the_same_motion(kinematics):
    free = dataclasses.replace(
        ARM,
        kinematics=kinematics,
        gravity=9.81,
        hub_friction=0.3,
        link=dataclasses.replace(ARM.link, damping=1e-4),
        payload=Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.02, 0.0)),
    )
    driven = dataclasses.replace(free, drive="motion")
    times = np.linspace(0, 1, 2001)
    acceleration = 3 * np.sin(4 * times)[:, None]
    known = driven.simulate(np.zeros(free.nx), lambda t: [3 * np.sin(4 * t)], times)
    np.testing.assert_allclose(known["hub_angle_rate"], 0.75 * (1 - np.cos(4 * times)), atol=1e-10)
    torque = reaction(free, driven, known.x, acceleration)
    np.testing.assert_allclose(
        free.dynamics(known.x, torque[:, None]), known.dx, rtol=0, atol=1e-9 * np.abs(known.dx).max()
    )
    spline = CubicSpline(times, torque)
    again = free.simulate(np.zeros(free.nx), lambda t: [spline(t)], times[::40])
    np.testing.assert_allclose(again.x, known.x[::40], rtol=0, atol=2e-7)


def test_power_of_a_driven_hub_is_its_reaction_times_its_rate(random_state):
    free = dataclasses.replace(ARM, gravity=9.81, hub_friction=0.2)
    driven = dataclasses.replace(free, drive="motion")
    x = random_state(driven, 5)
    put_in, lost = driven.power(x, [2.0])
    rate = x[driven.nx // 2]
    assert put_in == pytest.approx(reaction(free, driven, x[None], [[2.0]])[0] * rate, rel=1e-9)
    assert lost == pytest.approx(0.2 * rate**2, rel=1e-12)


def test_rigid_link_is_a_pendulum():
    arm = dataclasses.replace(ARM, kinematics="rigid", gravity=9.81)
    inertia = arm.hub_inertia + arm.link.mass / 3 + arm.payload.mass + arm.payload.inertia_z
    moment = arm.link.mass / 2 + arm.payload.mass
    for angle in (-1.0, 0.3):
        expected = (2.0 - 9.81 * moment * np.cos(angle)) / inertia
        assert arm.dynamics([angle, 0.5], [2.0])[1] == pytest.approx(expected, rel=1e-13)


def test_tip_deflection_under_a_tip_force_is_the_cantilevers():
    """F L^3/(3 E I) at the tip, from the equilibrium with the hub held."""
    arm = dataclasses.replace(ARM, basis="polynomial")
    M, free = arm.mass_matrix(np.zeros(6)), arm.dynamics(np.zeros(6), [0.0], w=[0.0, 5.0])[3:]
    K = -M @ arm.jacobians(np.zeros(6))[0][3:, :3]
    bent = np.linalg.solve(K[1:, 1:], (M @ free)[1:])
    tip = arm.measure([0.0, *bent, 0.0, 0.0, 0.0])[1]
    assert tip == pytest.approx(5.0 / (3 * arm.link.EI), rel=1e-10)


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_spin_up_to_fifty_radians_a_second(reference, kinematics):
    """Steel (7800 kg/m^3), one second, cycloidal: the linear model shows twice the deflection, not less."""
    largest, residual, frequency = reference("rotating_beam")["spin_up_50"]["T=1.0"][kinematics]
    steel = Material(density=7800.0, E=210e9, G=81e9)
    link = Beam.rectangular(1.0, width=0.05, depth=0.01, material=steel)
    arm = SingleLinkArm(link=link, kinematics=kinematics, drive="motion", modes=4)
    x = np.zeros(arm.nx)

    def law(t):
        return [50.0 * (1 - np.cos(2 * np.pi * t)) if t < 1 else 0.0]

    motion = arm.simulate(x, law, np.linspace(0, 3, 3001), rtol=1e-9)
    tip = np.abs(motion["tip_deflection"])
    assert motion["hub_angle_rate"][-1] == pytest.approx(50.0, rel=1e-8)
    assert tip.max() == pytest.approx(largest, rel=3e-4)
    assert tip[motion.t >= 1].max() == pytest.approx(residual, rel=3e-4)
    x[arm.nx // 2] = 50.0
    assert arm.natural_frequencies(x)[0] / (2 * np.pi) == pytest.approx(frequency, rel=1e-4)


def test_ladder_starts_rigid_and_every_step_has_its_own_label():
    ladder = ARM.ladder()
    labels = [step.label for step in ladder]
    assert labels[0] == "rigid" and len(set(labels)) == len(labels)
    assert [step.nx for step in ladder] == [2, 4, 6, 4, 6, 8, 10, 6, 8, 10]
    assert all(step.outputs == ARM.outputs for step in ladder)
