"""What motions of trees with bases and joints of every kind keep: momentum, energy, the sight of who turns along."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, ElasticJoint, FlexibleTree, Frame, Joint, Payload, Sliding, TreeBody, beams
from pliant.plants.core.quaternions import matrix_of, product, quaternion

SOFT = Beam.rectangular(0.9, 0.04, 0.03, beams.Material(density=2700.0, E=4e9, G=1.6e9, damping=1e-4))
J0 = ((0.5, 0.02, -0.03), (0.02, 0.6, 0.04), (-0.03, 0.04, 0.4))
LONG = pytest.mark.campaign
HUB = Payload(mass=6.0, inertia=J0, offset=(0.1, 0.05, -0.05))


def craft(kinematics="stiffened", **changes):
    """A free base with an elastic hinge, a beam, a ball on its end with a second beam, and a slider."""
    gear = ElasticJoint(stiffness=30.0, damping=0.02, ratio=20.0, rotor_inertia=1e-5)
    bodies = (
        TreeBody(
            name="upper",
            joint=Joint(name="hinge", axis=(0.0, 0.6, 0.8), position=(0.2, 0.1, 0.0), elastic=gear),
            beam=SOFT,
            modes=(1, 1, 1, 0),
        ),
        TreeBody(
            name="fore",
            joint=Joint(name="ball", kind="spherical", rotation=(0.3, -0.2, 0.4)),
            beam=SOFT,
            modes=(1, 1, 0, 0),
        ),
        TreeBody(
            name="slide",
            parent="base",
            joint=Joint(name="slide", kind="prismatic", axis=(0.0, 1.0, 0.0)),
            mass=0.5,
            inertia=0.01,
        ),
    )
    options = {"base": "free", "platform": HUB, "tip": "fore", "payload": Payload(mass=0.2, inertia=0.001)}
    return FlexibleTree(bodies=bodies, kinematics=kinematics, **{"gravity": (0, 0, 0), **options, **changes})


def moved(tree, seed, bend=0.005):
    """A random state, its beams bent a little."""
    rng = np.random.default_rng(seed)
    n, m, k = len(tree.coordinates), len(tree.speeds), len(tree.beyond) - len(tree.motors)
    q = np.r_[rng.uniform(-1, 1, n - k), bend * rng.uniform(-1, 1, k)]
    if tree.motors:
        (motor,) = (i for i, s in enumerate(tree.coordinates) if s.name == "hinge_motor")
        q[motor] = 20.0 * q[[s.name for s in tree.coordinates].index("hinge")]
    return tree.consistent(np.r_[q, 0.5 * rng.uniform(-1, 1, m - k), bend * rng.uniform(-1, 1, k)])


def momenta(tree, x):
    """Of a free base: linear, and angular about the origin, in the axes that do not move."""
    p = tree.mass_matrix(x) @ x[len(tree.coordinates) :]
    return np.r_[p[:3], matrix_of(x[3:7]) @ p[3:6] + np.cross(x[:3], p[:3])]


@pytest.mark.parametrize("kinematics", ["stiffened", *(pytest.param(k, marks=LONG) for k in ("rigid", "linear"))])
def test_momentum_of_a_free_base(kinematics):
    """Whatever motors and joints do."""
    tree = craft(kinematics)
    push = np.array([0.02, 0.3, -0.2, 0.1, 0.4])
    motion = tree.simulate(moved(tree, 0), lambda t: push * np.cos(3 * t), np.linspace(0, 0.1, 5), rtol=1e-12)
    kept = np.array([momenta(tree, x) for x in motion.x])
    assert np.ptp(motion.x[:, 7]) > 0.005
    np.testing.assert_allclose(kept, kept[:1].repeat(5, axis=0), rtol=0, atol=1e-10 * np.abs(kept).max())


KINDS = {
    "revolute": {"axis": (0.6, 0.0, 0.8)},
    "prismatic": {},
    "spherical": {},
    "planar": {"sliding": Sliding(stiffness=60.0, damping=1.0)},
    "free": {"sliding": Sliding(stiffness=60.0, damping=1.0)},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seconds", [pytest.param(20, marks=LONG)])
def test_work_done_equals_energy_gained(kind, seconds):
    """Beams on either side of each kind of joint, stops and friction in it."""
    held = {"stiffness": 8.0, "damping": 0.2, "friction": 0.1, "friction_rate": 0.3, "upper": 0.3, "stop_width": 0.1}
    held["stiffness"] = 60.0 if kind == "prismatic" else 8.0
    bodies = [
        TreeBody(name="one", joint=Joint(name="h", damping=0.3, stiffness=8.0), beam=SOFT, modes=(1, 1, 0, 0)),
        TreeBody(
            name="two",
            joint=Joint(name="j", kind=kind, stop_stiffness=50.0, **held, **KINDS[kind]),
            beam=SOFT,
            modes=(1, 1, 0, 0),
        ),
    ]
    tree = FlexibleTree.serial(bodies, gravity=(0.1, -0.3, -0.5))
    push = np.linspace(0.3, 0.6, tree.nu)
    t = np.linspace(0, seconds, 9)
    options = {"rtol": 1e-10, "atol": 1e-12, "audit": True}
    motion = tree.simulate(tree.rest_state, lambda t: push * np.sin(2 * t), t, **options)
    assert np.ptp(tree.energy(motion.x)) > 1e-3
    assert motion.stats["energy_balance"] < 1e-9


def test_a_planar_joint_between_beams_keeps_the_balance():
    test_work_done_equals_energy_gained("planar", 0.4)


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=LONG) for k in (1, 2))])
def test_nothing_changes_where_base_and_gravity_turn(seed):
    """Property: turned with gravity, loads and its place, a free machine moves alike."""
    tree = craft(
        gravity=(1.0, -2.0, -9.0), loads=("tip", "eye"), frames=(Frame(name="eye", body="upper", station=0.4),)
    )
    turn = quaternion(np.random.default_rng(seed).normal(size=3))
    R, n, m = matrix_of(turn), len(tree.coordinates), len(tree.speeds)
    rng = np.random.default_rng(seed + 10)
    x, u, w = moved(tree, seed), rng.uniform(-1, 1, tree.nu), rng.uniform(-1, 1, tree.nw)
    y = x.copy()
    y[:3], y[3:7], y[n : n + 3] = R @ x[:3], product(turn, x[3:7]), R @ x[n : n + 3]
    turned = dataclasses.replace(tree, gravity=tuple(R @ tree.gravity))
    own = turned.dynamics(y, u, w=np.concatenate([R @ part for part in w.reshape(-1, 3)]))[n:]
    given = tree.dynamics(x, u, w=w)[n:]
    given[:3] = R @ given[:3]
    assert len(given) == m
    np.testing.assert_allclose(own, given, rtol=0, atol=1e-9 * np.abs(given).max())


def test_the_reaction_is_what_moves_the_base():
    """Newton and Euler of the platform alone, about its origin in its own axes: what a satellite feels of its arm."""
    tree = craft(devices=("reaction",), gravity=(0.3, -0.2, -1.0))
    x, rng, n = moved(tree, 3), np.random.default_rng(4), len(tree.coordinates)
    u, w = rng.uniform(-1, 1, tree.nu), rng.uniform(-1, 1, tree.nw)
    a = tree.dynamics(x, u, w=w)[n:]
    R, omega, alpha = matrix_of(x[3:7]), x[n + 3 : n + 6], a[3:6]
    c, m = np.array(HUB.offset), HUB.mass
    felt = R.T @ (a[:3] - tree.gravity)
    J = np.array(J0) + m * (c @ c * np.eye(3) - np.outer(c, c))
    force = m * (felt + np.cross(alpha, c) + np.cross(omega, np.cross(omega, c)))
    torque = J @ alpha + np.cross(omega, J @ omega) + m * np.cross(c, felt)
    own = tree.measure(x, u, w=w)[-6:]
    np.testing.assert_allclose(own, np.r_[force, torque], rtol=0, atol=1e-9 * np.abs(force).max())


def test_the_reaction_is_the_rate_of_momentum():
    """Of all that stands on a base that is pushed along x, y, z: the momentum by these shifts, and its exact rate."""
    tree = craft("linear", base="driven", platform=Payload(), base_freedoms=("x", "y", "z"), devices=("reaction",))
    _, x, u, w, _ = tree.symbols
    rate, y = tree.expressions
    momentum = (tree.equations(0, x, u, w)[0] @ x[len(tree.coordinates) :])[:3]
    both = ca.Function("f", [x, u, w], [ca.jtimes(momentum, x, rate), y[-6:-3]])
    given = moved(tree, 5), np.r_[0.5, -0.3, 0.2, 0.02, 0.3, -0.2, 0.1, 0.4], np.zeros(tree.nw)
    wanted, own = (np.array(v).ravel() for v in both(*given))
    np.testing.assert_allclose(own, -wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


def test_orientation_of_places():
    """2 q* dq/dt is what the gyro reads there."""
    frames = (Frame(name="eye", body="upper", station=0.4, rotation=(0.3, 0.2, 0.1)),)
    tree = craft("linear", devices=("orientation", "gyro"), frames=frames)
    x, u, w = tree.symbols[1:4]
    rate, y = tree.expressions
    names = [s.name for s in tree.outputs]
    turning = ca.Function("f", [x, u, w], [ca.jtimes(y, x, rate), y])
    given = [np.array(v).ravel() for v in turning(moved(tree, 6), np.zeros(tree.nu), np.zeros(tree.nw))]
    dy, values = given
    for place in tree.places:
        at = names.index(f"{place}_quaternion_0")
        q, dq = values[at : at + 4], dy[at : at + 4]
        gyro = values[names.index(f"{place}_gyro_x") :][:3]
        np.testing.assert_allclose(np.linalg.norm(q), 1.0, atol=1e-12)
        omega = 2 * product(q * [1, -1, -1, -1], dq)  # 2 q* dq/dt
        np.testing.assert_allclose(omega, np.r_[0.0, gyro], atol=1e-6)


def test_turned_twice_the_sign_has_changed_and_nothing_jumped():
    tree = FlexibleTree.serial(
        [TreeBody(name="a", joint=Joint(name="a"), mass=1.0, inertia=0.1)], devices=("orientation",)
    )
    angles = np.linspace(0, 2 * np.pi, 41)
    q = tree.measure(np.stack([angles, np.zeros(41)], axis=1))[:, -4:]
    np.testing.assert_allclose(q, np.stack([np.cos(angles / 2), 0 * q[:, 1], 0 * q[:, 1], np.sin(angles / 2)], axis=1))
