"""FlexibleTree against the library's own arms, closed forms, its energies and what every machine in space keeps."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.envs.scenes import Scene
from pliant.plants import (
    Beam,
    ElasticJoint,
    FlexibleTree,
    Joint,
    Payload,
    SingleLinkArm,
    TreeBody,
    TwoLinkArm,
    beams,
)

OFFSET = Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0))
DOWN = (0.0, -9.81, 0.0)


def agree(arm, tree, seed, accelerations=1e-9, jacobians=1e-8):
    """Accelerations, A, B and E at a random state, relative to the largest entry."""
    rng = np.random.default_rng(seed)
    n = len(arm.coordinates)
    size = np.array([1.0 if s.unit == "rad" else 0.01 for s in tree.coordinates])
    x, u = np.r_[size, size] * rng.uniform(-1, 1, 2 * n), rng.uniform(-1, 1, arm.nu)
    given, own = arm.dynamics(x, u), tree.dynamics(x, u)
    np.testing.assert_allclose(own, given, rtol=0, atol=accelerations * np.abs(given).max())
    for a, b in zip(arm.jacobians(x, u)[:2], tree.jacobians(x, u)[:2], strict=True):
        np.testing.assert_allclose(b, a, rtol=0, atol=jacobians * np.abs(a).max())
    np.testing.assert_allclose(tree.mass_matrix(x), arm.mass_matrix(x), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kinematics", ["rigid", "linear", "stiffened"])
@pytest.mark.parametrize("basis", ["polynomial", "clamped-free"])
def test_equals_single_link_arm(kinematics, basis):
    arm = dataclasses.replace(
        SingleLinkArm.textbook(), kinematics=kinematics, basis=basis, modes=3, gravity=9.81, payload=OFFSET
    )
    link = dataclasses.replace(arm.link, damping=3e-4)
    arm = dataclasses.replace(arm, link=link, hub_friction=0.1)
    body = TreeBody(name="link", joint=Joint(name="hub", damping=0.1), inertia=1.3, beam=link, modes=(3, 0, 0, 0))
    options = {"kinematics": kinematics, "basis": basis, "gravity": DOWN, "payload": OFFSET}
    agree(arm, FlexibleTree.serial([body], **options), seed=1)


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
@pytest.mark.parametrize("slope", [True, False])
def test_equals_two_link_arm(kinematics, slope):
    arm = dataclasses.replace(
        TwoLinkArm.textbook(),
        kinematics=kinematics,
        basis="polynomial",
        modes=(2, 3),
        tip_slope=slope,
        hub_inertia=(0.1, 0.02),
        joint_friction=(0.2, 0.1),
        payload=OFFSET,
    )
    first = TreeBody(
        name="one", joint=Joint(name="theta1", damping=0.2), inertia=0.1, beam=arm.link1, modes=(2, 0, 0, 0)
    )
    second = TreeBody(
        name="two",
        joint=Joint(name="theta2", damping=0.1, turned=slope),
        mass=arm.joint_mass,
        inertia=0.02,
        beam=arm.link2,
        modes=(3, 0, 0, 0),
    )
    tree = FlexibleTree.serial([first, second], kinematics=kinematics, gravity=DOWN, payload=OFFSET)
    agree(arm, tree, seed=2)


def test_bends_alike_in_both_planes():
    """A beam turned by a quarter about its axis, with I_y and I_z exchanged, is the same machine."""
    beam = Beam(length=1.0, area=1e-4, I_y=2e-9, I_z=1e-9, J=2e-9, density=2700.0, E=7e10, G=2.7e10)
    turned = dataclasses.replace(beam, I_y=1e-9, I_z=2e-9)
    made = [
        FlexibleTree.serial([TreeBody(name="b", joint=Joint(name="j"), beam=b, beam_rotation=r, modes=m)])
        for b, r, m in ((beam, (0, 0, 0), (2, 1, 1, 1)), (turned, (np.pi / 2, 0, 0), (1, 2, 1, 1)))
    ]
    n = len(made[0].coordinates)
    rng = np.random.default_rng(3)
    q = np.r_[1.0, 0.02 * rng.uniform(-1, 1, n - 1)]
    order, sign = [0, 3, 1, 2, 4, 5], np.array([1, 1, -1, -1, 1, 1.0])  # z there is y here, y there is -z here
    other = sign * q[order]
    given = made[0].dynamics(np.r_[q, q])[n:]
    np.testing.assert_allclose(made[1].dynamics(np.r_[other, other])[n:], sign * given[order], rtol=1e-8, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_nothing_changes_where_base_and_gravity_turn(space, seed):
    """Property: the same machine, its base and gravity turned alike, moves alike; positions turn."""
    rng = np.random.default_rng(seed)
    tree = space()
    rpy = tuple(rng.uniform(-1.2, 1.2, 3))
    cr, cp, cy = np.cos(rpy)
    sr, sp, sy = np.sin(rpy)
    R = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    first = dataclasses.replace(tree.bodies[0], joint=dataclasses.replace(tree.bodies[0].joint, rotation=rpy))
    turned = dataclasses.replace(tree, bodies=(first, *tree.bodies[1:]), gravity=tuple(R @ tree.gravity))
    n = len(tree.coordinates)
    x = np.r_[rng.uniform(-2, 2, 4), 0.02 * rng.uniform(-1, 1, n - 4), rng.uniform(-1, 1, n)]
    u, w = rng.uniform(-1, 1, tree.nu), rng.uniform(-1, 1, tree.nw)
    given = tree.dynamics(x, u, w=w)
    own = turned.dynamics(x, u, w=np.concatenate([R @ part for part in w.reshape(-1, 3)]))
    np.testing.assert_allclose(own, given, rtol=0, atol=1e-9 * np.abs(given).max())
    y, z = tree.measure(x), turned.measure(x)
    at = [s.name for s in tree.outputs].index("tip_x")
    np.testing.assert_allclose(z[at : at + 3], R @ y[at : at + 3], atol=1e-12)


def test_velocities_are_the_rates_of_positions(space):
    tree = space()
    x, u, w = tree.symbols[1:4]
    y = tree.expressions[1]
    rate = ca.Function("rate", [x, u, w], [ca.jtimes(y, x, tree.expressions[0]), y])
    rng = np.random.default_rng(6)
    n = len(tree.coordinates)
    x0 = np.r_[rng.uniform(-1, 1, 4), 0.01 * rng.uniform(-1, 1, n - 4), rng.uniform(-1, 1, n)]
    rates, values = (np.array(v).ravel() for v in rate(x0, np.zeros(tree.nu), np.zeros(tree.nw)))
    names = [s.name for s in tree.outputs]
    for name, other in tree.output_rates.items():
        np.testing.assert_allclose(values[names.index(other)], rates[names.index(name)], rtol=1e-10, atol=1e-12)
    assert len(tree.output_rates) == 4 + 6


def test_momentum_of_a_machine_that_floats_in_the_plane():
    """Two sliders and a hinge let the first body go: momentum and moment of momentum stay, whatever the joints do."""
    free = {"drive": "none"}
    strip = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
    bodies = [
        TreeBody(name="x", joint=Joint(name="x", kind="prismatic", axis=(1, 0, 0), **free)),
        TreeBody(name="y", joint=Joint(name="y", kind="prismatic", axis=(0, 1, 0), **free)),
        TreeBody(name="hub", joint=Joint(name="turn", **free), mass=5.0, inertia=0.4),
        TreeBody(name="one", joint=Joint(name="j1", position=(0.2, 0, 0)), beam=strip, modes=(2, 0, 0, 0)),
        TreeBody(name="two", joint=Joint(name="j2"), beam=strip, modes=(2, 0, 0, 0)),
    ]
    tree = FlexibleTree.serial(bodies, gravity=(0, 0, 0))
    motion = tree.simulate(np.r_[np.zeros(9), 0.1, 0.2, 0.3, np.zeros(6)], [0.3, -0.2], np.linspace(0, 0.5, 6))

    def momenta(x):
        p = tree.mass_matrix(x) @ x[9:]  # of x, y: momentum; of the turn: moment of momentum about the hub
        return p[0], p[1], p[2] + x[0] * p[1] - x[1] * p[0]

    kept = np.array([momenta(x) for x in motion.x])
    np.testing.assert_allclose(kept, kept[:1].repeat(6, axis=0), rtol=0, atol=1e-10 * np.abs(kept).max())


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
@pytest.mark.parametrize("seconds", [1, pytest.param(20, marks=pytest.mark.campaign)])
def test_work_done_equals_energy_gained(space, kinematics, seconds):
    """Every kind of joint and body, an elastic gear, springs and damping, gravity aslant."""
    soft = Beam.rectangular(0.9, 0.04, 0.03, beams.Material(density=2700.0, E=4e9, G=1.6e9, damping=1e-4))
    gear = ElasticJoint(stiffness=30.0, damping=0.02, ratio=20.0, rotor_inertia=1e-5)
    bodies = tuple(
        dataclasses.replace(
            b,
            joint=dataclasses.replace(b.joint, damping=0.3, stiffness=200.0 if b.joint.slides else 8.0, elastic=e),
            beam=b.beam and soft,
            modes=(1, 1, 1, 0),
        )
        for b, e in zip(space().bodies, (gear, None, None, None), strict=True)
    )
    tree = dataclasses.replace(space(kinematics), bodies=bodies, gravity=(0.1, -0.3, -0.5))
    torque = np.array([0.02, 0.5, 0.5, 0.1])
    t = np.linspace(0, seconds, 4 * seconds + 1)
    motion = tree.simulate(np.zeros(tree.nx), lambda t: torque * np.sin(2 * t), t, rtol=1e-9, audit=True)
    assert np.ptp(tree.energy(motion.x)) > 1e-2
    assert motion.stats["energy_balance"] < 1e-9


def test_given_motion_is_an_input():
    strip = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
    body = TreeBody(name="b", joint=Joint(name="j", drive="acceleration"), beam=strip, modes=(2, 0, 0, 0))
    tree = FlexibleTree.serial([body])
    assert tree.inputs[0].name == "j_acceleration"
    assert tree.prescribed == ("j",)
    assert tree.dynamics(np.zeros(6), [2.5])[3] == 2.5


def test_parameters_vary_without_rebuilding(space):
    tree = space().vary("payload.mass", "bodies.0.beam.E", "bodies.1.joint.damping")
    rng = np.random.default_rng(7)
    x = 0.01 * rng.uniform(-1, 1, tree.nx)
    heavier = dataclasses.replace(space(), payload=dataclasses.replace(tree.payload, mass=0.9))
    p = tree.nominal_parameters
    p[0] = 0.9
    np.testing.assert_allclose(tree.dynamics(x, p=p), heavier.dynamics(x), rtol=1e-9, atol=1e-8)


def test_what_follows_from_the_equations(space):
    """Rest, linear models, a native step: as of every plant."""
    tree = FlexibleTree.serial(
        [
            TreeBody(name="a", joint=Joint(name="a", axis=(0, 1, 0)), mass=1.0, centre=(0.5, 0, 0), inertia=0.1),
            TreeBody(name="b", joint=Joint(name="b", axis=(0, 1, 0), position=(1, 0, 0)), mass=1.0, inertia=0.1),
        ]
    )
    x0, u0 = tree.equilibrium(a=0.3, b=-0.2)
    np.testing.assert_allclose(u0, [-(0.5 + 1.0) * 9.81 * np.cos(0.3), 0.0], atol=1e-9)
    model = tree.linearize(x0, u0)
    assert model.A.shape == (4, 4)
    assert model.B.shape == (4, 2)
    step = tree.stepper(1e-3, batch=3)
    np.testing.assert_allclose(step(np.tile(x0, (3, 1)), np.tile(u0, (3, 1))), np.tile(x0, (3, 1)), atol=1e-12)
    assert tree.ladder() == (tree,)
    lines = tree.outline(x0, 5)
    np.testing.assert_allclose(lines[-1][-1], [np.cos(0.3), -np.sin(0.3)], atol=1e-12)


def test_controllers_and_environments_play_it():
    """A scene of it: LQR brings it to the goal, the vector environment steps, a picture has its lines."""
    rod = Beam.tube(0.5, 0.012, 0.01, beams.Material(density=2700.0, E=70e9, G=27e9, damping=3e-4))
    bodies = [
        TreeBody(
            name="a", joint=Joint(name="a", axis=(0, 1, 0), damping=0.5), mass=2.0, centre=(0.2, 0, 0), inertia=0.05
        ),
        TreeBody(name="b", joint=Joint(name="b", axis=(0, 1, 0), position=(0.4, 0, 0)), beam=rod, modes=(0, 1, 0, 0)),
    ]
    tree = FlexibleTree.serial(bodies, payload=Payload(mass=0.5, inertia=0.001))
    scene = Scene(
        name="tree-slew",
        about="a tree goes from rest to rest",
        plant=tree,
        start=(("a", 0.0), ("b", 0.0)),
        goal=(("a", 0.4), ("b", -0.3)),
        duration=1.5,
        limits=(60.0, 30.0),
        weights=(("a", 10.0), ("b", 10.0), ("a_rate", 0.1), ("b_rate", 0.1), ("b_deflection_z", 100.0)),
        effort=(("a_torque", 1e-3), ("b_torque", 1e-3)),
        observe=("a", "b", "a_rate", "b_rate"),
        compare=("tip_x", "tip_z"),
    )
    motion = tree.simulate(scene.initial[0], LQR.for_scene(scene), scene.times, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose([motion["a"][-1], motion["b"][-1]], [0.4, -0.3], atol=1e-3)
    env = scene.vector_env(4)
    env.reset(seed=0)
    observation = env.step(np.zeros((4, 2), dtype=np.float32))[0]
    assert np.isfinite(observation).all()


def test_a_bent_body_is_drawn_bent():
    strip = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
    tree = FlexibleTree.serial(
        [TreeBody(name="b", joint=Joint(name="j"), beam=strip, modes=(1, 1, 0, 0))], kinematics="linear"
    )
    x = np.array([0.4, 0.02, 0.05, 0.0, 0.0, 0.0])
    (line,) = tree.lines(x, 7)
    y = dict(zip((s.name for s in tree.outputs), tree.measure(x), strict=True))
    np.testing.assert_allclose(line[-1], [y["tip_x"], y["tip_y"], y["tip_z"]], atol=1e-12)
    np.testing.assert_allclose(y["tip_z"], y["b_deflection_z"], atol=1e-12)


def test_ranges_tell_of_axial_force_and_slopes():
    """A hanging beam with a load: tension (M + m) g at the root; N/(E A); "linear" also over the buckling load."""
    beam = Beam(length=1.0, area=1e-4, I_y=2e-9, I_z=1e-9, J=2e-9, density=2700.0, E=7e10, G=2.7e10)
    body = TreeBody(name="b", joint=Joint(name="j"), beam=beam, beam_rotation=(0, np.pi / 2, 0), modes=(1, 1, 0, 0))
    tree = FlexibleTree.serial([body], payload=Payload(mass=2.0), kinematics="linear")
    value = ca.Function("f", list(tree.symbols), [ca.vertcat(*[r.value for r in tree.validity])])
    found = np.array(value(0, np.zeros(6), [0.0], np.zeros(6), [])).ravel()
    words = [r.quantity for r in tree.validity]
    strain = found[words.index("axial strain of b in x-y")]
    np.testing.assert_allclose(strain, 9.81 * (2.0 + beam.mass) / (beam.E * beam.area), rtol=1e-12)
    soft, stiff = (found[words.index(f"axial force of b in x-{a} over its buckling load")] for a in "yz")
    np.testing.assert_allclose(soft / stiff, 2.0, rtol=1e-12)
    assert soft > 0.045  # beyond the range: 22 N of about 170
