"""Arms of exact rotations: their equations are those of the energies; two links with a locked joint are one beam."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from euler_elastica import elastica
from scipy.optimize import root

from pliant.plants import Beam, LagrangianPlant, Payload, SingleLinkArm, TwoLinkArm, beams
from pliant.plants.beams import STEEL

LOAD = Payload(mass=0.6, inertia=0.003, offset=(0.05, -0.08, 0.0))
ONE = dataclasses.replace(
    SingleLinkArm.textbook(), kinematics="strain", payload=LOAD, gravity=9.81, hub_radius=0.2, hub_friction=0.1
)
TWO = dataclasses.replace(
    TwoLinkArm.textbook(),
    kinematics="strain",
    basis="polynomial",
    payload=LOAD,
    hub_inertia=(0.1, 0.02),
    joint_friction=(0.1, 0.2),
    modes=(2, 1),
)
ARMS = {
    "one": ONE,
    "one driven": dataclasses.replace(ONE, drive="motion", hub_radius=0.0),
    "one varied": ONE.vary("link.length", "payload.mass", "hub_radius"),
    "one of many modes": dataclasses.replace(ONE, modes=7),
    "two": TWO,
    "two no slope": dataclasses.replace(TWO, tip_slope=False),
    "two one-sided": dataclasses.replace(TWO, modes=(0, 2)),
    "two varied": TWO.vary("link1.length", "link2.density", "payload.offset.0"),
}


@pytest.mark.parametrize("name", list(ARMS))
def test_equations_are_those_of_the_energies(name):
    """Against the base class's derivatives of T, V and the losses."""
    arm = ARMS[name]
    t, x, u, w, p = arm.symbols
    derived = ca.Function("derived", [x, u, w, p], list(LagrangianPlant.equations(arm.symbolic, t, x, u, w)))
    built = ca.Function("built", [x, u, w, p], list(arm.symbolic.equations(t, x, u, w)))
    rng = np.random.default_rng(1)
    at = [0.3 * rng.uniform(-1, 1, k) for k in (arm.nx, arm.nu, arm.nw)]
    for expected, got in zip(derived(*at, arm.nominal_parameters), built(*at, arm.nominal_parameters)):
        scale = np.abs(np.asarray(expected)).max()
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("arm", [ONE, TWO], ids=["one", "two"])
def test_energy_changes_by_what_is_put_in(arm):
    """Undamped and let go from a bent rest: no energy is made."""
    arm = dataclasses.replace(arm, **({"hub_friction": 0.0} if arm.nu == 1 else {"joint_friction": (0.0, 0.0)}))
    x = np.zeros(arm.nx)
    x[arm.nu] = 0.3
    motion = arm.simulate(x, None, np.linspace(0.0, 0.3, 31), rtol=1e-9, atol=1e-11)
    energy = arm.energy(motion.x)
    assert np.abs(energy - energy[0]).max() < 1e-7 * arm.kinetic(motion.x).max()


def test_free_arm_keeps_its_angular_momentum():
    """No gravity, no torque: the hub's row of M v."""
    arm = dataclasses.replace(ONE, gravity=0.0, hub_friction=0.0)
    x = np.zeros(arm.nx)
    x[1], x[arm.nx // 2] = 0.3, 5.0
    motion = arm.simulate(x, None, np.linspace(0.0, 0.3, 31), rtol=1e-9, atol=1e-11)
    n = arm.nx // 2
    momentum = np.array([(arm.mass_matrix(z) @ z[n:])[0] for z in motion.x])
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-7)


HALF = Beam.circular(1.0, 0.01, STEEL)
BOTH = dataclasses.replace(HALF, length=2.0)
LOCKED = TwoLinkArm(link1=HALF, link2=HALF, gravity=0.0, kinematics="strain", basis="polynomial", modes=(4, 4))


def test_locked_joint_makes_one_beam_of_two_links():
    """Frequencies of the clamped beam of both lengths; sections turn, which lowers them by about (omega r/c)^2/2."""
    found = LOCKED.natural_frequencies(locked=("theta1", "theta2"))[:2]
    np.testing.assert_allclose(found, beams.frequencies(BOTH, 2), rtol=5e-5)


@pytest.mark.parametrize("load", [1.0, 10.0])
def test_locked_joint_bends_as_the_elastica(load):
    """A dead force across the tip of both, by elliptic integrals."""
    force, n = load * BOTH.EI / 2.0**2, LOCKED.nx // 2
    x = np.zeros(LOCKED.nx)
    for scale in np.linspace(0.1, 1.0, 10):

        def lacking(q: np.ndarray, w: np.ndarray) -> np.ndarray:
            at = np.concatenate([[0.0, 0.0], q, np.zeros(n)])
            return (LOCKED.mass_matrix(at) @ LOCKED.dynamics(at, w=w)[n:])[2:]

        x[2:n] = root(lacking, x[2:n], args=(np.array([0.0, scale * force]),), tol=1e-12).x
    got = dict(zip((s.name for s in LOCKED.outputs), LOCKED.measure(x)))
    along, across, _ = elastica(load)
    np.testing.assert_allclose([got["tip_x"] / 2.0, got["tip_y"] / 2.0], [along, across], rtol=0, atol=1e-5)


@pytest.mark.parametrize("arm", [ONE, TWO], ids=["one", "two"])
def test_straight_links_turn_as_rigid_ones(arm):
    """What stiffness without end leaves: the joints' part of the straight arm's inertia; sections turn too."""
    stays = {"kinematics": "rigid"} if arm.nu == 1 else {"kinematics": "linear", "reduction": "rigid"}
    rigid = dataclasses.replace(arm, **stays)
    k, joints = arm.nu, np.array([0.4, -1.1])[: arm.nu]
    x, y = np.zeros(arm.nx), np.zeros(rigid.nx)
    x[:k] = y[:k] = joints
    own = [b.density * b.I_z * b.length for b in ([arm.link] if k == 1 else [arm.link1, arm.link2])]
    sections = np.array(own) if k == 1 else np.array([[sum(own), own[1]], [own[1], own[1]]])
    np.testing.assert_allclose(arm.mass_matrix(x)[:k, :k], rigid.mass_matrix(y) + sections, rtol=1e-12)
