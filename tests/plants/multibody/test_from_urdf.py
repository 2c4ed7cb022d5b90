"""FlexibleTree.from_urdf: rigid machines against Pinocchio, flexible links in the place of the file's, refusals."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from evidence import agrees

from pliant.plants import Beam, ElasticJoint, FlexibleTree, beams

FILES = {
    "panda": "panda_description/urdf/panda.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "double pendulum": "double_pendulum_description/urdf/double_pendulum.urdf",
}
ARM = """<robot name="arm">
  <link name="base_link"/>
  <link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
    <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <link name="tool0"/>
  <joint name="shoulder" type="revolute"><parent link="base_link"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="50" velocity="3"/><dynamics damping="0.5" friction="0.1"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tool0"/><origin xyz="0.4 0 0"/></joint>
</robot>"""
TUBE = Beam.tube(0.4, 0.02, 0.016, beams.ALUMINIUM)


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    return path


class Pinocchio:
    """The same machine there, in this tree's order of joints."""

    def __init__(self, path, tree):
        self.pin = pytest.importorskip("pinocchio")
        self.tree, self.model = tree, self.pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        self.joints = [self.model.joints[self.model.getJointId(j.name)] for j in tree.moving]
        self.v_at = [j.idx_v for j in self.joints]

    def state(self, x):
        n = len(self.joints)
        q, v = self.pin.neutral(self.model), np.zeros(self.model.nv)
        for joint, angle in zip(self.joints, x[:n], strict=True):
            q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (np.cos(angle), np.sin(angle))
        v[self.v_at] = x[n:]
        return q, v

    def torque(self, x, u):
        """The motors' less damping and friction, which Pinocchio's algorithms leave out."""
        rate, found = x[len(self.joints) :], np.zeros(self.model.nv)
        lost = [j.damping * r + j.friction * r / np.hypot(r, j.friction_rate) for j, r in zip(self.tree.moving, rate)]
        found[self.v_at] = u - np.array(lost)
        return found

    def by_joints(self, M):
        return M[np.ix_(self.v_at, self.v_at)]


@pytest.mark.parametrize(("name", "states"), [("panda", 200), ("ur5", 200), ("double pendulum", 200)])
def test_rigid_machines_are_pinocchios(robots, name, states):
    """M, bias, accelerations to 1e-10, A, B to 1e-8 of its analytical derivatives (pin 4.1, example-robot-data 6)."""
    path = robots / FILES[name]
    tree = FlexibleTree.from_urdf(path, mimic="free")
    frictionless = tuple(
        dataclasses.replace(b, joint=dataclasses.replace(b.joint, damping=0.0, friction=0.0)) for b in tree.bodies
    )
    smooth = dataclasses.replace(tree, bodies=frictionless)
    peer, n, rng = Pinocchio(path, tree), len(tree.moving), np.random.default_rng(0)
    pin = peer.pin
    pairs = {"accelerations": [], "mass matrix": [], "bias": [], "derivatives of the accelerations": []}

    def pair(what, found, wanted):
        size = np.abs(wanted).max()
        pairs[what].append((np.ravel(found) / size, np.ravel(wanted) / size))

    for k in range(states):
        x, u = rng.uniform(-2, 2, 2 * n), rng.uniform(-5, 5, n)
        q, v = peer.state(x)
        M = np.triu(pin.crba(peer.model, peer.data, q))
        M = peer.by_joints(M + np.triu(M, 1).T)
        pair("mass matrix", tree.mass_matrix(x), M)
        bias = pin.nonLinearEffects(peer.model, peer.data, q, v)[peer.v_at]
        rest = smooth.dynamics(x)[n:]
        pair("bias", -M @ rest, bias)
        wanted = pin.aba(peer.model, peer.data, q, v, peer.torque(x, u))[peer.v_at]
        pair("accelerations", tree.dynamics(x, u)[n:], wanted)
        if k < 5:
            torque = np.zeros(peer.model.nv)
            torque[peer.v_at] = u
            pin.computeABADerivatives(peer.model, peer.data, q, v, torque)
            blocks = [peer.by_joints(J) for J in (peer.data.ddq_dq, peer.data.ddq_dv, peer.data.Minv)]
            blocks[2] = np.triu(blocks[2]) + np.triu(blocks[2], 1).T if name == "double pendulum" else np.linalg.inv(M)
            A, B = smooth.jacobians(x, u)[:2]
            pair("derivatives of the accelerations", np.hstack([A, B])[n:], np.hstack(blocks))
    for what, many in pairs.items():
        agrees(
            *np.hstack(many),
            within=1e-8 if "derivatives" in what else 1e-10,
            absolute=True,
            of="FlexibleTree",
            what=f"{what} of {name} from its URDF file, over the largest",
            source="Pinocchio 4.1",
            kind="other program",
        )


def test_places_are_pinocchios(robots):
    path = robots / FILES["ur5"]
    tree = FlexibleTree.from_urdf(path, tip="tool0")
    peer, rng = Pinocchio(path, tree), np.random.default_rng(1)
    x = rng.uniform(-2, 2, tree.nx)
    q, _ = peer.state(x)
    peer.pin.framesForwardKinematics(peer.model, peer.data, q)
    there = peer.data.oMf[peer.model.getFrameId("tool0")].translation
    y = dict(zip((s.name for s in tree.outputs), tree.measure(x), strict=True))
    agrees(
        [y["tip_x"], y["tip_y"], y["tip_z"]],
        there,
        within=1e-12,
        absolute=True,
        of="FlexibleTree",
        what="place of ur5's tool [m]",
        source="Pinocchio 4.1",
        kind="other program",
    )


def test_order_names_and_limits(arm):
    tree = FlexibleTree.from_urdf(arm, tip="tool0", drives={"elbow": "none"})
    assert [s.name for s in tree.states] == ["shoulder", "elbow", "shoulder_rate", "elbow_rate"]
    assert [s.name for s in tree.inputs] == ["shoulder_torque"]
    shoulder = tree.moving[0]
    assert (shoulder.lower, shoulder.upper, shoulder.effort, shoulder.speed) == (-1.0, 2.0, 50.0, 3.0)
    assert (shoulder.damping, shoulder.friction) == (0.5, 0.1)
    names = [s.name for s in tree.outputs]
    y = tree.measure(np.zeros(4))
    np.testing.assert_allclose([y[names.index(f"tip_{a}")] for a in "xyz"], [0.4, 0.0, 0.5], atol=1e-15)


def test_a_link_that_bends(arm):
    """The beam lies from elbow to flange; without modes it is a rigid rod: m L^2/3 about the elbow."""
    gear = ElasticJoint(stiffness=1e3, rotor_inertia=1e-4, ratio=50.0)
    options = {"flexible": {"fore": TUBE}, "joints": {"elbow": gear}, "tip": "tool0"}
    tree = FlexibleTree.from_urdf(arm, **options)
    names = [s.name for s in tree.coordinates]
    assert names == ["shoulder", "elbow", "elbow_motor", "fore_y1", "fore_y2", "fore_z1", "fore_z2", "fore_twist1"]
    rigid = dataclasses.replace(tree, kinematics="rigid")
    M = rigid.mass_matrix(np.zeros(rigid.nx))
    np.testing.assert_allclose(M[1, 1], TUBE.mass * 0.4**2 / 3, rtol=1e-12)
    y = dict(zip((s.name for s in tree.outputs), tree.measure(np.zeros(tree.nx)), strict=True))
    np.testing.assert_allclose([y["tip_x"], y["tip_y"], y["tip_z"]], [0.4, 0.0, 0.5], atol=1e-15)
    bent = FlexibleTree.from_urdf(arm, **options, modes={"fore": (1, 0, 0, 0)})
    assert [s.name for s in bent.coordinates][3:] == ["fore_y1"]


REFUSED = {
    "no such link": ({"flexible": {"for": TUBE}}, r"from_urdf\.flexible: link 'for' must be one of upper, fore, tool0"),
    "no beam": ({"flexible": {"fore": 0.4}}, r"from_urdf\.flexible\['fore'\] = 0\.4 must be a Beam"),
    "length": (
        {"flexible": {"fore": dataclasses.replace(TUBE, length=0.5)}},
        r"\.flexible\['fore'\]\.length = 0\.5 must be the distance of its joints, 0\.4 \[m\], to joint 'flange'",
    ),
    "base bends": ({"flexible": {"base_link": TUBE}}, r"link 'base_link' must be one of upper, fore, tool0"),
    "no such joint": (
        {"joints": {"wrist": ElasticJoint(stiffness=1.0, rotor_inertia=1.0)}},
        r"joint that moves 'wrist' must be one of shoulder, elbow",
    ),
    "fixed joint": (
        {"joints": {"flange": ElasticJoint(stiffness=1.0, rotor_inertia=1.0)}},
        r"joint that moves 'flange' must be one of",
    ),
    "no gear": ({"joints": {"elbow": 5}}, r"from_urdf\.joints\['elbow'\] = 5 must be an ElasticJoint"),
    "no such tip": ({"tip": "tool"}, r"from_urdf\.tip = 'tool' must be a link: base_link, upper, fore, tool0"),
    "modes of a rigid link": (
        {"modes": {"fore": (1, 0, 0, 0)}},
        r"\.modes: flexible link 'fore' must be one of",
    ),
    "three counts": (
        {"flexible": {"fore": TUBE}, "modes": {"fore": (1, 0, 0)}},
        r"TreeBody\.modes = \(1, 0, 0\) must be 4 integers",
    ),
    "drive": ({"drives": {"elbow": "belt"}}, r"from_urdf\.drives\['elbow'\] = 'belt' must be one of torque"),
    "drive of none": ({"drives": {"knee": "none"}}, r"from_urdf\.drives: joint that moves 'knee' must be one of"),
    "mimic": ({"mimic": "yes"}, r"from_urdf\.mimic = 'yes' must be one of 'refused', 'free'"),
    "gravity": ({"gravity": (0, 0, np.nan)}, r"FlexibleTree\.gravity\[2\] = nan must be a finite number"),
    "kinematics": ({"kinematics": "exact"}, r"FlexibleTree\.kinematics = 'exact' must be one of"),
    "a motor given motion": (
        {"joints": {"elbow": ElasticJoint(stiffness=1.0, rotor_inertia=1.0)}, "drives": {"elbow": "acceleration"}},
        r"Joint\.elastic of joint 'elbow' must be None where kind = 'revolute', drive = 'acceleration'",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(arm, name):
    options, words = REFUSED[name]
    with pytest.raises(ValueError, match=words):
        FlexibleTree.from_urdf(arm, **options)


def operations(tree):
    """Of a right-hand side without loads at the tip."""
    _, x, u, w, _ = tree.symbols
    [rate] = ca.substitute([tree.expressions[0]], [w], [ca.SX.zeros(tree.nw)])
    f = ca.Function("f", [x, u], [ca.cse(rate)])
    return f.n_instructions() - f.nnz_in() - f.nnz_out()


def test_operations_of_a_right_hand_side(robots):
    """A plain projection of the bodies' Jacobians has 1,371 for six rigid joints, 3,829 with four bending modes."""
    path = robots / FILES["ur5"]
    assert operations(FlexibleTree.from_urdf(path)) < 900
    beam = Beam.tube(float(np.hypot(0.1197, 0.425)), 0.1, 0.09, beams.ALUMINIUM)
    options = {"flexible": {"upper_arm_link": beam}, "modes": {"upper_arm_link": (2, 2, 0, 0)}, "tip": "tool0"}
    assert operations(FlexibleTree.from_urdf(path, **options, kinematics="linear")) < 2400
    assert operations(FlexibleTree.from_urdf(path, **options)) < 2700


LACKING = {  # what these files lack: bodies, a joint that moves, a mass beyond a joint, a link
    "quadrotor_base.urdf": r"bodies = \(\) must be one body at least",
    "iris_simple.urdf": "must have a joint that moves",
    "romeo.urdf": "of mass = 0.0 and nothing heavier beyond it",
    "romeo_laas_small.urdf": "of mass = 0.0 and nothing heavier beyond it",
    "ur3.urdf": "has no <link>",
}


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::UserWarning")  # inertias that are repaired
def test_every_robot_of_the_collection_is_pinocchios_or_refused_by_the_name_of_what_it_lacks(robots):
    """69 files of example-robot-data 6.0.0, up to 202 states: M and M a + bias = torque at one random state."""
    files, compared = sorted(robots.glob("**/*.urdf")), 0
    for file in files:
        if file.name in LACKING:
            with pytest.raises(ValueError, match=LACKING[file.name]):
                FlexibleTree.from_urdf(file, mimic="free", inertias="repair")
            continue
        tree = FlexibleTree.from_urdf(file, mimic="free", inertias="repair")
        rng, n = np.random.default_rng(len(tree.moving)), len(tree.moving)
        x, u = rng.uniform(-1, 1, 2 * n), rng.uniform(-5, 5, n)
        found = tree.dynamics(x, u)[n:]
        assert np.isfinite(found).all(), file.name
        if tree.repairs:
            continue
        peer = Pinocchio(file, tree)
        q, v = peer.state(x)
        M = np.triu(peer.pin.crba(peer.model, peer.data, q))
        M = peer.by_joints(M + np.triu(M, 1).T)
        np.testing.assert_allclose(tree.mass_matrix(x), M, rtol=0, atol=1e-10 * np.abs(M).max(), err_msg=file.name)
        left = peer.torque(x, u)[peer.v_at] - peer.pin.nonLinearEffects(peer.model, peer.data, q, v)[peer.v_at]
        size = (np.abs(M) @ np.abs(found)).max()
        np.testing.assert_allclose(M @ found, left, rtol=0, atol=1e-10 * size, err_msg=file.name)
        compared += 1
    assert len(files) >= 60 and compared >= 40
