"""M a = r of Lagrangian plants and of the spacecraft alike: slopes, accelerations along a nominal, ends."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import FlexibleSpacecraft, MassMatrixError, SingleLinkArm, TwoLinkArm
from pliant.plants.dynamics.mechanical import MechanicalPlant

PLANTS = (TwoLinkArm.textbook(), SingleLinkArm.textbook(), FlexibleSpacecraft.textbook())
PLANTS = tuple(p.ladder()[0] if isinstance(p, FlexibleSpacecraft) else p for p in PLANTS)


def point(plant):
    rng = np.random.default_rng(5)
    x = plant.consistent(0.02 * rng.normal(size=plant.nx))
    return x, rng.normal(size=plant.nu)


@pytest.mark.parametrize("plant", PLANTS, ids=lambda p: type(p).__name__)
def test_slopes_are_central_differences_of_the_rate(plant):
    x, u = point(plant)
    J = ca.Function("J", list(plant.symbols), [plant.slopes()])
    found = np.array(J(0.0, x, u, np.zeros(plant.nw), []))
    z, h = np.append(x, u), 1e-6
    rounded = 8 * np.finfo(float).eps * np.abs(plant.dynamics(x, u)).max() / h  # some eps of the largest rate, over 2 h
    for k in range(len(z)):
        d = np.zeros(len(z))
        d[k] = h
        ahead, back = (plant.dynamics((z + s * d)[: plant.nx], (z + s * d)[plant.nx :]) for s in (1, -1))
        wanted = (ahead - back) / (2 * h)
        np.testing.assert_allclose(found[:, k], wanted, atol=1e-6 * max(1.0, np.abs(wanted).max()) + rounded)


@pytest.mark.parametrize("plant", PLANTS, ids=lambda p: type(p).__name__)
def test_positions_come_first_and_move_at_rates_that_are_states(plant):
    """dx/dt of what is in coordinates_slice depends on no input, whatever the state."""
    x, _ = point(plant)
    B = plant.jacobians(x)[1]
    assert not B[plant.coordinates_slice].any()
    assert B[plant.coordinates_slice.stop :].any()


@pytest.mark.parametrize("plant", PLANTS[:2], ids=lambda p: type(p).__name__)
def test_what_must_vanish_at_rest_is_forces(plant):
    """M a: the columns of B become the generalised forces of the inputs, which have unit entries."""
    x, u = point(plant)
    n = plant.coordinates_slice.stop
    pushed = plant.rest_conditions().slopes(x, u)[:, plant.nx :]
    assert np.abs(pushed[:n]).max() == 0.0
    np.testing.assert_allclose(pushed[n:].sum(axis=0).max(), 1.0, atol=1e-9)


@pytest.mark.parametrize("plant", PLANTS[:2], ids=lambda p: type(p).__name__)
def test_the_linear_model_at_rest_is_the_one_from_all_equations(plant):
    """`jacobians`, which differentiates the whole of f, where `at_rest` may use forces at rest alone."""
    x, u = plant.equilibrium({s.name: 0.3 for s in plant.states[: plant.nu]})
    A = plant.jacobians(x, u)[0]
    np.testing.assert_allclose(plant.rest_conditions().states(x, u), A, atol=1e-9 * np.abs(A).max())
    scale = np.abs(plant.rest_conditions().slopes(x, u)).max()
    np.testing.assert_allclose(plant.rest_conditions().forces(x, u, x), 0.0, atol=1e-9 * scale)


def test_a_stop_is_explained_where_the_mass_matrix_is_lost_and_not_elsewhere():
    """Without the inertia that deflection adds, the arm bent at its elbow loses definiteness near 0.6 mm; see
    tests/failures/test_reduction.py.
    """
    arm = dataclasses.replace(PLANTS[0], modes=(2, 2), reduction="rigid-inertia")
    assert isinstance(arm, MechanicalPlant)
    rest, bent = np.zeros(arm.nx), np.zeros(arm.nx)
    rest[1] = bent[1] = np.pi / 2
    bent[[2, 4]] = -0.4e-3
    assert arm.explain_stop(rest[None], rest, None, None) is None
    for passed, last in ((bent[None], bent), (rest[None], bent)):
        with pytest.raises(MassMatrixError, match="rigid-inertia is not positive definite"):
            arm.explain_stop(passed, last, None, None)
    assert arm.explain_stop(rest[None], np.full(arm.nx, np.nan), None, None) is None


def test_of_a_batch_the_state_that_has_lost_its_mass_matrix_is_given():
    arm = dataclasses.replace(PLANTS[0], modes=(2, 2), reduction="rigid-inertia")
    x = np.zeros((3, arm.nx))
    x[:, 1] = np.pi / 2
    x[2, [2, 4]] = -0.4e-3  # as above
    with pytest.raises(MassMatrixError) as lost:
        arm.dynamics(x)
    np.testing.assert_array_equal(lost.value.state, x[2])


def test_rigid_motions_are_left_out_of_the_frequencies_unless_asked_for():
    arm = SingleLinkArm.textbook()  # a free hub: one rigid turn
    free, all_of_it = arm.natural_frequencies(), arm.natural_frequencies(rigid=True)
    assert len(all_of_it) == len(free) + 1 == arm.nx // 2
    assert abs(all_of_it[0]) < 1e-6 * free[0] and free[0] > 1.0
