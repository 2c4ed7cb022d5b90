"""Outputs that machines have sensors for: root curvature, tip accelerometer, tip gyro."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam, LargeDeflectionBeam, Payload, SingleLinkArm, TwoLinkArm

G = 9.81
LINK = dataclasses.replace(SingleLinkArm.textbook(), gravity=G)
ARM = TwoLinkArm.textbook()
OFFSET = Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0))
ARMS = {
    "one": LINK,
    "one driven": dataclasses.replace(LINK, drive="motion"),
    "one pinned": dataclasses.replace(LINK, frame="pinned", hub_radius=0.1, payload=OFFSET),
    "two": ARM,
    "two stiffened": dataclasses.replace(ARM, kinematics="stiffened", basis="payload", payload=OFFSET, modes=(1, 2)),
}


def column(plant, name):
    return [s.name for s in plant.outputs].index(name)


def tip_section(plant, x):
    """Angle [rad] of the tip's section, from the coordinates and the shapes' end slopes."""
    if isinstance(plant, SingleLinkArm):
        q = plant.clamped_map @ x[: plant.nx // 2]
        return q[0] + plant.elastic.basis.tip_slope @ q[1:] / plant.link.length
    q, n1 = x[: plant.nx // 2], plant.mode_counts[0]
    slopes = [link.basis.tip_slope / link.beam.length for link in plant.links]
    return q[0] + q[1] + slopes[0] @ q[2 : 2 + n1] + slopes[1] @ q[2 + n1 :]


@pytest.mark.parametrize("name", list(ARMS))
def test_accelerometer_reads_what_the_tips_path_says(name, random_state):
    """Fourth-order second difference of the simulated path, less gravity, across the section."""
    plant = ARMS[name]
    x, u, w = random_state(plant, 5, 0.5), np.full(plant.nu, 0.7), np.array([0.3, -0.4])
    h = 1e-4
    path = plant.simulate(x, u, h * np.arange(5), w=w, rtol=1e-12, atol=1e-14)
    middle = path.x[2]
    at = [column(plant, "tip_x"), column(plant, "tip_y")]
    a = np.array([-1, 16, -30, 16, -1]) @ path.y[:, at] / (12 * h**2)
    angle = tip_section(plant, middle)
    expected = np.cos(angle) * (a[1] + plant.gravity) - np.sin(angle) * a[0]
    found = plant.measure(middle, u, w=w)[column(plant, "tip_acceleration")]
    assert abs(expected) > 1 and found == pytest.approx(expected, rel=2e-4)


def test_accelerometer_at_rest_reads_gravity_across_the_sagging_section():
    x, u = LINK.equilibrium(hub_angle=0.3)
    found = LINK.measure(x, u)[column(LINK, "tip_acceleration")]
    assert found == pytest.approx(G * np.cos(tip_section(LINK, x)), rel=1e-12)
    assert tip_section(LINK, x) < 0.3


def test_root_curvature_of_a_hanging_load_is_its_moment_over_EI():
    """Cantilever with weight and payload, M = g (m L + rho A L^2/2); modal curvature converges with the modes."""
    errors, long = [], dataclasses.replace(LINK, link=dataclasses.replace(LINK.link, length=1.3))
    for modes in (2, 4, 8):
        arm = dataclasses.replace(long, kinematics="linear", basis="polynomial", modes=modes)
        x, u = arm.equilibrium(hub_angle=0.0)
        link = arm.link
        moment = -G * (arm.payload.mass * link.length + link.mass * link.length / 2)
        errors.append(arm.measure(x, u)[column(arm, "root_curvature")] * link.EI / moment - 1)
    assert abs(errors[-1]) < 1e-8 and 1e-3 < abs(errors[0]) < 0.2
    sheared = dataclasses.replace(long, kinematics="linear", basis="polynomial", modes=5, theory="timoshenko")
    x, u = sheared.equilibrium(hub_angle=0.0)
    assert sheared.measure(x, u)[column(sheared, "root_curvature")] * link.EI == pytest.approx(moment, rel=1e-6)


def test_root_curvatures_of_the_arm_carry_what_is_beyond_them():
    """The joint torque is the moment at the root, but for the sag, which moves the loads by its own size."""
    factors, errors = np.array([4.0, 40.0]), []
    for factor in factors:
        stiff = dataclasses.replace(ARM.link1, E=factor * ARM.link1.E)
        arm = dataclasses.replace(ARM, link1=stiff, link2=stiff, basis="polynomial", modes=(4, 4))
        x, u = arm.equilibrium(theta1=0.2, theta2=-0.4)
        found = arm.measure(x, u)[[column(arm, "root1_curvature"), column(arm, "root2_curvature")]]
        errors.append(found * stiff.EI / -u - 1)
    errors = np.abs(errors)
    assert (errors[1] < 1e-3).all() and (errors[1] < 0.11 * errors[0] + 1e-9).all()


@pytest.mark.every(2)
@pytest.mark.parametrize("kinematics", ["strain", "substructured"])
@pytest.mark.parametrize("planar", [True, False])
def test_root_curvature_and_gyro_of_the_large_beam(kinematics, planar):
    """A tip force along y on a stiff cantilever: curvature P L/(E I), linear theory; gyro = slope of tip_angle."""
    beam = Beam.circular(2.0, 0.05, LargeDeflectionBeam.textbook().beam)
    plant = LargeDeflectionBeam(
        beam=beam, gravity=(0.0, 0.0, 0.0), basis="polynomial", kinematics=kinematics, modes=2, planar=planar, twists=0
    )
    if kinematics == "substructured":
        plant = dataclasses.replace(plant, segments=2)
    force = np.zeros(plant.nu)
    force[1] = 1.0
    x, _ = plant.equilibrium({s.name: v for s, v in zip(plant.inputs, force)})
    found = plant.measure(x, force)[column(plant, "root_curvature")]
    assert found * beam.EI == pytest.approx(2.0, rel=2e-3)
    rng = np.random.default_rng(2)
    x, h = 0.2 * rng.uniform(-1, 1, plant.nx), 1e-5
    rate = np.zeros(plant.nx)
    rate[: plant.nx // 2] = x[plant.nx // 2 :]
    at = column(plant, "tip_angle")
    slope = (plant.measure(x + h * rate)[at] - plant.measure(x - h * rate)[at]) / (2 * h)
    assert plant.measure(x)[column(plant, "tip_angle_rate")] == pytest.approx(slope, rel=1e-6)


def test_driven_beam_has_them_too():
    plant = dataclasses.replace(LargeDeflectionBeam.textbook(), root="driven", gravity=(0.0, 0.0, 0.0))
    x = np.zeros(plant.nx)
    x[plant.nx // 2] = 0.4  # the hub turns, straight
    y = plant.measure(x)
    assert y[column(plant, "tip_angle_rate")] == pytest.approx(0.4)
    assert y[column(plant, "root_curvature")] == 0.0
