"""Joints and the inputs that move them, read off the cheapest variant of a plant."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.joint_control.collocation import (
    accelerations,
    loop_eigenvalues,
    rigid_inertia,
    rigid_state,
    sharing,
)
from pliant.plants import LargeDeflectionBeam, LinearModel, PliantError, TwoLinkArm

ARM = TwoLinkArm.textbook()


@pytest.mark.parametrize("theta2", [0.0, 0.6, -2.0])
def test_rigid_inertia_is_that_of_two_rigid_links(theta2):
    """M11 = J1 + J2 + .. + 2 k cos(theta2) and so on, written out for uniform rods with point masses (Craig 1989)."""
    m1, m2, mj, mp, jp = ARM.link1.mass, ARM.link2.mass, ARM.joint_mass, ARM.payload.mass, ARM.payload.inertia
    L1, L2 = ARM.link1.length, ARM.link2.length
    far = m2 * L2**2 / 3 + mp * L2**2 + jp
    near = m1 * L1**2 / 3 + (mj + m2 + mp) * L1**2
    k = L1 * (m2 * L2 / 2 + mp * L2) * np.cos(theta2)
    want = np.array([[near + far + 2 * k, far + k], [far + k, far]])
    x0 = np.zeros(ARM.nx)
    x0[1] = theta2
    np.testing.assert_allclose(rigid_inertia(ARM, x0, np.zeros(2), ("theta1_rate", "theta2_rate")), want, rtol=1e-9)


def test_forces_at_a_tip_move_no_joint_one_by_one():
    beam = dataclasses.replace(LargeDeflectionBeam.textbook(), planar=False)
    with pytest.raises(PliantError, match=r"do not move .* one by one"):
        accelerations(beam, {}, np.zeros(3), ("bend1_rate", "flap1_rate", "twist1_rate"))


def test_eigenvalues_of_a_held_loop_tend_to_those_of_the_continuous_one():
    """A double integrator with u = -4 x - 4 v has a double root at -2; held over h it is off by O(h)."""
    model = LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], states=["x", "v"])
    K, reads = np.array([[4.0, 5.0]]), ("x", "v")  # roots -1 and -4
    want = np.array([-4.0, -1.0])
    np.testing.assert_allclose(np.sort(loop_eigenvalues(model, K, reads, None).real), want, rtol=1e-12)
    off = [np.abs(np.sort(loop_eigenvalues(model, K, reads, h).real) - want).max() for h in (0.02, 0.01)]
    assert 1.8 < off[0] / off[1] < 2.2


def test_inputs_that_share_joints_give_the_least_that_moves_one():
    """Two equal pushes on one mass: half each (least squares); more joints than inputs cannot be moved one by one."""
    model = LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [2.0, 2.0]], states=["x", "v"])
    np.testing.assert_allclose(sharing(model, ("v",)), [[0.25], [0.25]])
    with pytest.raises(PliantError, match="one by one"):
        sharing(model, ("x", "v"))


def test_the_state_of_the_rigid_variant_is_by_name():
    plant = TwoLinkArm.textbook()
    x = np.arange(plant.nx) / 10
    known = dict(zip((s.name for s in plant.states), x))
    np.testing.assert_array_equal(rigid_state(plant, x), [known[s.name] for s in plant.ladder()[0].states])
