"""Rigid trees with free bases, balls, planar and free joints against Pinocchio (pin 4.1): M, bias, accelerations, A, B.

There the speeds of a free joint are those of its origin in its own axes, here in the axes before: v_pin = R^T v. A
ball's are the same in both. Tangents are small turns in the axes beyond, as here.
"""

import dataclasses

import numpy as np
import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody
from pliant.plants.core.quaternions import matrix_of, rates, skew

UR5 = "ur_description/urdf/ur5_robot.urdf"
PANDA = "panda_description/urdf/panda.urdf"
J0 = ((0.05, 0.002, -0.003), (0.002, 0.06, 0.004), (-0.003, 0.004, 0.04))


def chain(base="fixed"):
    """Balls, a planar and a free joint within the tree, branches, nothing aligned."""
    rng = np.random.default_rng(0)
    kinds = (("spherical", "base"), ("revolute", "b0"), ("planar", "b1"), ("free", "b2"), ("spherical", "b1"))
    bodies = []
    for k, (kind, parent) in enumerate(kinds):
        place = {"position": tuple(0.3 * rng.normal(size=3)), "rotation": tuple(rng.uniform(-1, 1, 3))}
        joint = Joint(name=f"j{k}", kind=kind, axis=(0.0, 0.0, 1.0), **place)
        made = {"mass": 1.0 + k, "centre": tuple(0.2 * rng.normal(size=3)), "inertia": J0}
        bodies.append(TreeBody(name=f"b{k}", joint=joint, parent=parent, **made))
    hub = Payload(mass=4.0, inertia=J0, offset=(0.1, 0.0, -0.05)) if base == "free" else Payload()
    return FlexibleTree(bodies=tuple(bodies), base=base, platform=hub)


class Peer:
    """The same machine there."""

    def __init__(self, pin, model, tree, names):
        self.pin, self.model, self.tree, self.data = pin, model, tree, model.createData()
        self.at = []  # (slot, indices of its speeds there, indices of its configuration there)
        for slot in tree.slots:
            joints = [model.joints[model.getJointId(n)] for n in names(slot)]
            v = [j.idx_v + k for j in joints for k in range(j.nv)]
            self.at.append((slot, v, [(j.idx_q, j.nq) for j in joints]))
        self.order = [k for _, v, _ in self.at for k in v]

    def configuration(self, x):
        q = self.pin.neutral(self.model)
        for slot, _, places in self.at:
            own = x[slot.q :]
            if slot.joint.kind in ("free", "spherical"):
                ((at, n),) = places
                shift = own[: n - 4]
                w, *vector = own[n - 4 : n]
                q[at : at + n] = [*shift, *vector, w]
            else:
                for value, (at, n) in zip(own, places, strict=False):
                    q[at : at + n] = value if n == 1 else (np.cos(value), np.sin(value))
        return q

    def free(self, x):
        """(rows of shifts, rows of turns, R, R^T v, omega) of free joints, in the order of this tree's speeds."""
        n = len(self.tree.coordinates)
        for slot in self.tree.slots:
            if slot.joint.kind == "free":
                R = matrix_of(x[slot.q + 3 : slot.q + 7])
                v = x[n + slot.v : n + slot.v + 6]
                yield slice(slot.v, slot.v + 3), slice(slot.v + 3, slot.v + 6), R, R.T @ v[:3], v[3:]

    def sent(self, x):
        """J with v_pin = J v, in the order of this tree's speeds."""
        J = np.eye(len(self.order))
        for shift, _, R, _, _ in self.free(x):
            J[shift, shift] = R.T
        return J

    def there(self, v):
        found = np.zeros(self.model.nv)
        found[self.order] = v
        return found

    def here(self, M):
        return M[np.ix_(self.order, self.order)]

    def accelerations(self, x, a):
        """Of this tree from those there, given in its order."""
        found = a.copy()
        for shift, _, R, v, w in self.free(x):
            found[shift] = R @ (a[shift] + np.cross(w, v))
        return found

    def slopes(self, x, a, dq, dv):
        """Of the accelerations by small turns and shifts, and by speeds: here, from those there."""
        by_q, by_v = dq @ self.sent(x), dv @ self.sent(x)
        for _, turn, _, v, _ in self.free(x):
            by_q[:, turn] += dv[:, turn.start - 3 : turn.start] @ skew(v)
        for shift, turn, R, v, w in self.free(x):
            by_q[shift], by_v[shift] = R @ by_q[shift], R @ by_v[shift]
            by_q[shift, turn] += skew(R @ v) @ R @ skew(w) - R @ skew(a[shift])
            by_v[shift, shift] += skew(R @ w)
            by_v[shift, turn] -= skew(R @ v) @ R
        return by_q, by_v

    def compare(self, states, seed):
        pin, tree, rng = self.pin, self.tree, np.random.default_rng(seed)
        n, m = len(tree.coordinates), len(tree.speeds)
        for k in range(states):
            x = tree.consistent(np.r_[rng.normal(size=n), rng.uniform(-2, 2, m)])
            u = rng.uniform(-5, 5, tree.nu)
            q, J = self.configuration(x), self.sent(x)
            v = self.there(J @ x[n:])
            force = np.zeros(m)
            force[[i for _, i in tree._inputs]] = u
            M = np.triu(pin.crba(self.model, self.data, q))
            M = self.here(M + np.triu(M, 1).T)
            close(tree.mass_matrix(x), J.T @ M @ J, 1e-10)
            tau = self.there(np.linalg.solve(J.T, force))
            a = np.array(pin.aba(self.model, self.data, q, v, tau))[self.order]
            close(tree.dynamics(x, u)[n:], self.accelerations(x, a), 1e-10)
            bias = np.array(pin.nonLinearEffects(self.model, self.data, q, v))[self.order]
            rest = self.accelerations(x, -np.linalg.solve(M, bias))
            close(tree.mass_matrix(x) @ tree.dynamics(x)[n:], J.T @ M @ J @ rest, 1e-10)
            if k < 5:
                self.linear(x, u, q, v, tau, a)

    def linear(self, x, u, q, v, tau, a):
        tree, n = self.tree, len(self.tree.coordinates)
        self.pin.computeABADerivatives(self.model, self.data, q, v, tau)
        dq, dv = self.here(self.data.ddq_dq), self.here(self.data.ddq_dv)
        # generalised forces of shifts are constant in the axes before: those there turn with the joint
        by_q, by_v = self.slopes(x, a, dq, dv)
        minv = np.linalg.inv(tree.mass_matrix(x))
        force = np.zeros(len(self.order))
        force[[i for _, i in tree._inputs]] = u
        for shift, turn, R, _, _ in self.free(x):
            by_q[:, turn] += minv[:, shift] @ R @ skew(R.T @ force[shift])
        A, B = tree.jacobians(x, u)[:2]
        T = np.zeros((tree.nx, len(self.order)))
        for slot in tree.slots:
            for k in range({"free": 3, "planar": 3, "spherical": 0}.get(slot.joint.kind, 1)):
                T[slot.q + k, slot.v + k] = 1.0
            if slot.turn is not None:
                at, to = slot.turn
                T[at : at + 4, to : to + 3] = rates(x[at : at + 4]) / 2
        close((A @ T)[n:], by_q, 1e-8)
        close(A[n:, n:], by_v, 1e-8)
        close(B[n:], minv[:, [i for _, i in tree._inputs]], 1e-8)


def close(found, wanted, relative):
    np.testing.assert_allclose(found, wanted, rtol=0, atol=relative * np.abs(wanted).max())


@pytest.mark.parametrize("path", [UR5, PANDA])
def test_robots_on_a_free_base_are_pinocchios(robots, path):
    pin = pytest.importorskip("pinocchio")
    tree = FlexibleTree.from_urdf(robots / path, mimic="free", base="free")
    bodies = tuple(
        dataclasses.replace(b, joint=dataclasses.replace(b.joint, damping=0.0, friction=0.0)) for b in tree.bodies
    )
    tree = dataclasses.replace(tree, bodies=bodies)
    model = pin.buildModelFromUrdf(str(robots / path), pin.JointModelFreeFlyer())
    Peer(pin, model, tree, lambda s: ["root_joint" if s.joint.name == tree.root else s.joint.name]).compare(200, 0)


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_balls_and_planes_are_pinocchios(base):
    pin = pytest.importorskip("pinocchio")
    tree, model = chain(base), pin.Model()
    known = {"base": 0}
    kinds = {
        "spherical": [pin.JointModelSpherical()],
        "revolute": [pin.JointModelRZ()],
        "planar": [pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ()],
        "free": [pin.JointModelFreeFlyer()],
    }
    for body in (*tree.ground, *tree.bodies):
        joint, parent = body.joint, known.get(body.parent, 0)
        place = pin.SE3(pin.rpy.rpyToMatrix(*map(float, joint.rotation)), np.array(joint.position))
        for i, own in enumerate(kinds[joint.kind]):
            parent = model.addJoint(parent, own, place, f"{joint.name}{i or ''}")
            place = pin.SE3.Identity()
        inertia = pin.Inertia(body.mass, np.array(body.centre), np.array(body.inertia))
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        known[body.name] = parent
    count = {"planar": 3}
    peer = Peer(pin, model, tree, lambda s: [f"{s.joint.name}{i or ''}" for i in range(count.get(s.joint.kind, 1))])
    peer.compare(200, 1)
