"""The mass matrix of composite bodies is that of the velocities of all mass."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.multibody_recursion.composite import mass_matrix
from pliant.plants.multibody_recursion.kinematics import twists


@pytest.mark.parametrize("kinematics", ["rigid", "linear", "stiffened"])
def test_kinetic_energy_of_every_node(space, kinematics):
    """T = sum of (m v.v + 2 v.(omega x S + S') + omega.J omega + 2 omega.H + eta'.M eta')/2."""
    tree = space(kinematics)
    q, v = ca.SX.sym("q", len(tree.coordinates)), ca.SX.sym("v", len(tree.coordinates))
    walk = tree._walk(q, v)
    T = ca.SX(0)
    for k, (node, twist) in enumerate(zip(walk.tree.nodes, twists(walk), strict=True)):
        if node.inertia is None:
            continue
        body, (omega, u) = node.inertia, twist
        if node.beam is not None:
            eta, rate = walk.bent(k)
            body = body + node.beam.inertia(eta)
            for one, by in zip(node.beam.coupling(eta), ca.vertsplit(rate) if rate.shape[0] else (), strict=True):
                T += by * (ca.dot(u, one.f) + ca.dot(omega, one.n))
            T += ca.dot(rate, node.beam.mass(eta) @ rate) / 2
        P = body.matrix()
        T += body.m * ca.dot(u, u) / 2 + ca.dot(u, ca.cross(omega, body.S))
        T += ((P[0, 0] + P[1, 1] + P[2, 2]) * ca.dot(omega, omega) - ca.dot(omega, P @ omega)) / 2
    M = ca.hessian(T, v)[0]
    found = ca.Function("f", [q, v], [mass_matrix(walk), M])
    rng = np.random.default_rng(0)
    n = q.shape[0]
    own, wanted = found(np.r_[rng.uniform(-2, 2, 4), 0.02 * rng.normal(size=n - 4)], np.zeros(n))
    np.testing.assert_allclose(np.array(own), np.array(wanted), atol=1e-12)
