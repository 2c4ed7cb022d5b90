"""How the work of a tree's equations grows with its bodies."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, ElasticJoint, FlexibleTree, Joint, Payload, TreeBody

BOOM = Beam(length=3.0, area=8e-5, I_y=1e-10, I_z=2.7e-9, J=4e-10, density=2700.0, E=70e9, G=26e9)


def star(arms: int, modes: tuple[int, ...] = (1, 1, 0, 0)) -> FlexibleTree:
    """Hinged booms on a free platform."""
    made = tuple(
        TreeBody(
            name=f"b{k}", parent="base", joint=Joint(name=f"j{k}", position=(0.1 * k, 1, 0)), beam=BOOM, modes=modes
        )
        for k in range(arms)
    )
    return FlexibleTree(bodies=made, base="free", platform=Payload(mass=500.0, inertia=200.0), gravity=(0, 0, 0))


def operations(tree: FlexibleTree) -> int:
    a = ca.cse(tree.symbolic.solved(*tree.symbols[:4])[0])
    return ca.Function("a", list(tree.symbols[:4]), [a]).n_instructions()


def test_work_grows_with_the_number_of_branches() -> None:
    few, some, many = (operations(star(n)) for n in (2, 4, 8))
    assert many - some == pytest.approx(2 * (some - few), rel=0.1)


def test_leaves_are_eliminated_first() -> None:
    """L then has nothing between branches, as M; motors are first, for they share no inertia with anything."""
    gear = ElasticJoint(stiffness=900.0, damping=0.2, ratio=60.0, rotor_inertia=1e-4)
    tree = star(3)
    first = tree.bodies[0]
    geared = TreeBody(name="g", parent="b0", joint=Joint(name="jg", elastic=gear, station=1.0), mass=1.0, inertia=0.1)
    tree = FlexibleTree(bodies=(first, geared, *tree.bodies[1:]), platform=tree.platform, base="free")
    n = len(tree.speeds)
    order = tree.elimination(n)
    assert sorted(order) == list(range(n)) and tree.speeds[order[0]].name == "jg_motor_rate"
    M = tree.mass_matrix(tree.state())
    branch = [k for i in (1, 2) for k, s in enumerate(tree.speeds) if s.name.startswith((f"j{i}", f"b{i}"))]
    assert len(branch) == 6
    for rows, apart in ((order, True), (list(range(n)), False)):
        L = np.linalg.cholesky(M[np.ix_(rows, rows)])
        first, other = ([rows.index(k) for k in part] for part in (branch[:3], branch[3:]))
        crossed = np.abs([*L[np.ix_(first, other)].ravel(), *L[np.ix_(other, first)].ravel()]).max()
        assert (crossed == 0) == apart
