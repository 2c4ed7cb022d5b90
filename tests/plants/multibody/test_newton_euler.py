"""Forces at rest are weights; wrenches work as positions change."""

import casadi as ca
import numpy as np

from pliant.plants.multibody.kinematics import weight_energy
from pliant.plants.multibody.newton_euler import forces, work


def test_weight(space):
    tree = space("linear")
    n = len(tree.coordinates)
    q, still = ca.SX.sym("q", n), ca.SX.zeros(n)
    g = ca.SX(ca.DM([1.0, -2.0, 3.0]))
    walk = tree._walk(q, still)
    f = ca.Function("f", [q], [forces(walk, g, {}), ca.gradient(weight_energy(walk, g), q)])
    own, wanted = f(np.r_[np.arange(4.0), 0.01 * np.arange(n - 4)])
    np.testing.assert_allclose(np.array(own), np.array(wanted), atol=1e-12)


def test_a_force_at_a_frame(space):
    """J^T F with J the derivative of the frame's place."""
    tree = space()
    x = 0.01 * np.arange(tree.nx)
    symbols = tree.symbols
    n = len(tree.coordinates)
    q, v = symbols[1][:n], symbols[1][n:]
    names = [s.name for s in tree.outputs]
    for place, at in (("tip", 0), ("middle", 6)):
        w = ca.SX.zeros(tree.nw)
        w[at : at + 3] = ca.SX(ca.DM([1.0, 2.0, 3.0]))
        Q = tree.generalized_force(symbols[0], q, v, ca.SX.zeros(tree.nu), w)
        row = names.index(f"{place}_x")
        position = tree.expressions[1][row : row + 3]
        wanted = ca.jtimes(position, q, ca.SX(ca.DM([1.0, 2.0, 3.0])), True)
        own, other = ca.Function("f", [symbols[1]], [Q, wanted])(x)
        np.testing.assert_allclose(np.array(own), np.array(other), atol=1e-12)


def test_nothing_works_without_wrenches(space):
    tree = space("rigid")
    walk = tree._walk(ca.SX.sym("q", 4), ca.SX.zeros(4))
    assert work(walk, {}).is_zero()
