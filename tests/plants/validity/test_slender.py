"""The limits of small slopes and axial forces, against closed forms; what they claim, on a sample of the campaign."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
import validity
from scipy.integrate import solve_bvp

from pliant.plants import Beam, Material, Payload, SingleLinkArm, SliderCrank, Trajectory, TwoLinkArm, beams
from pliant.plants.validity import slender
from pliant.plants.validity.ranges import values

LINK = Beam.rectangular(1.0, width=0.05, depth=0.005, material=Material(density=2700.0, E=70e9, G=27e9))
LINEAR = SingleLinkArm(link=LINK, kinematics="linear", basis="clamped-free", modes=6, drive="motion")


def reached(plant, state, w=None):
    """{quantity: value} at a state given by name."""
    x = np.zeros(plant.nx)
    for name, value in state.items():
        x[[s.name for s in plant.states].index(name)] = value
    motion = Trajectory.from_arrays([0.0, 1.0], [x, x], plant=plant, w=None if w is None else [w, w])
    return dict(zip((r.quantity for r in plant.validity), values(plant, motion)[0], strict=True))


def test_at_the_slope_limit_the_elastica_is_four_per_cent_stiffer() -> None:
    """theta'' = -a cos theta, theta(0) = 0, theta'(1) = 0: the linear beam's largest slope is a/2, its tip at a/3."""
    a, xi = 2 * slender.SLOPE, np.linspace(0.0, 1.0, 50)
    found = solve_bvp(
        lambda s, z: np.array([z[1], -a * np.cos(z[0]), np.sin(z[0])]),
        lambda b, e: np.array([b[0], e[1], b[2]]),
        xi,
        np.array([a * (xi - xi**2 / 2), a * (1 - xi), a * xi**2 / 2]),
        tol=1e-9,
    )
    error = a / 3 / found.y[2, -1] - 1
    assert 0.035 < error < 0.05
    assert LINEAR.validity[0].limit == slender.SLOPE


def test_spin_is_told_by_southwells_coefficient() -> None:
    """omega^2 = omega_1^2 + c Omega^2 across the plane of rotation, by `rotating_frequencies`; no shape takes more."""
    still, spun = (beams.rotating_frequencies(gamma, 1)[0] for gamma in (0.0, 0.1))
    southwell = (spun**2 - still**2) / 0.1**2
    first = LINEAR.natural_frequencies()[0]
    found = reached(LINEAR, {"hub_angle_rate": 0.2 * first})["axial force of the link over its buckling load"]
    assert southwell * 0.04 <= found < 1.05 * southwell * 0.04
    assert found > slender.AXIAL > found / 1.15  # the range ends just below a fifth


def test_a_force_along_the_link_is_told_by_eulers_load() -> None:
    euler = np.pi**2 * LINK.EI / (4 * LINK.length**2)
    for sign in (1.0, -1.0):
        found = reached(LINEAR, {}, [sign * 0.1 * euler, 3.0])
        assert found["axial force of the link over its buckling load"] == pytest.approx(0.1, rel=1e-3)
        assert found["axial strain of the link"] == pytest.approx(0.1 * euler / (LINK.E * LINK.area), rel=1e-12)


def test_weight_and_spin_of_two_links_are_forces_on_the_first() -> None:
    """Stretched downwards, second link turning at 3 rad/s: by hand."""
    arm = dataclasses.replace(TwoLinkArm.textbook(), modes=(4, 4))
    found = reached(arm, {"theta1": -np.pi / 2, "theta2_rate": 3.0})
    m, L = arm.link1.mass, 1.0
    beyond = arm.joint_mass + m + arm.payload.mass
    out = (m / 2 + arm.payload.mass) * L * 9.0
    force = (m + beyond) * 9.81 + out
    assert found["axial strain of link 1"] == pytest.approx(force / (arm.link1.E * arm.link1.area), rel=1e-12)
    euler = np.pi**2 * arm.link1.EI / 4
    tip = (beyond * 9.81 + out) / euler
    assert tip < found["axial force of link 1 over its buckling load"] < tip + m * 9.81 / (7.8 * arm.link1.EI) * 1.05


def test_a_rod_between_pins_is_told_by_its_axial_force() -> None:
    """80 N on the slider of a rod along the line of thrust, at rest: Euler's load of two pins."""
    crank = dataclasses.replace(
        SliderCrank.textbook(), kinematics="linear", crank_speed=None, force=80.0, dry_friction=0.0, modes=1
    )
    found = reached(crank, {})
    rod = crank.rod
    assert found["axial force of the rod over its buckling load"] == pytest.approx(
        80.0 * rod.length**2 / (np.pi**2 * rod.EI), rel=1e-9
    )


def test_slopes_and_shortening_are_those_of_the_outline() -> None:
    arm = SingleLinkArm(link=LINK, basis="polynomial", modes=3)
    x = np.zeros(arm.nx)
    x[1:4] = 0.05, -0.02, 0.01
    line = arm.outline(x, 2001)[0]
    turned = np.abs(np.diff(line[:, 1])) / (1.0 / 2000)
    link = dataclasses.replace(arm, kinematics="linear")
    found = reached(link, dict(zip(("eta1", "eta2", "eta3"), x[1:4])))
    assert found["slope of the link"] == pytest.approx(turned.max(), rel=0.02)
    assert found["shortening of the link over its length"] == pytest.approx(1.0 - line[-1, 0], rel=1e-6)


def test_shear_counts_the_turn_of_the_sections_too() -> None:
    arm = SingleLinkArm(link=LINK, theory="timoshenko", payload=Payload(mass=0.1), modes=2)
    link, q = arm.elastic, ca.DM([0.1, 0.0])
    phi = link.basis.phi
    most = max(np.abs(f[:, 0]).max() for f in (phi(slender.STATIONS, 1), phi.rotation(slender.STATIONS))) * 0.1
    assert float(ca.evalf(slender.slopes(link, ca.SX(q)))) == pytest.approx(most, rel=1e-12)


def test_what_is_claimed_holds_on_a_sample_of_random_machines() -> None:
    """tests/campaigns/validity.py tries hundreds."""
    rows = [validity.run(seed) for seed in range(9)]
    assert [r["wrong"] for r in rows if r["wrong"]] == []
    assert sum(r["found"] == "kept" for r in rows) > 2 and sum(r["found"] == "left" for r in rows) > 2
