"""Gauss-Newton steps to convergence: direct optimal control as IPOPT finds it, and its costates."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.controllers import NMPC, Objective
from pliant.controllers.nmpc import gauss_newton
from pliant.controllers.solvers.daqp_model import CURVATURE
from pliant.envs import scenes
from pliant.plants import Plant, PliantError, Signal

REACH, SLEW = scenes.get("two-link-reach"), scenes.get("single-link-slew")


class Pendulum(Plant):
    """Upside down and weakly driven: it must swing to and fro to come up."""

    states = (Signal("angle", "rad"), Signal("angle_rate", "rad/s"))
    inputs = (Signal("torque", "N m"),)
    outputs = (Signal("height", "m"),)
    disturbances = ()
    label = "pendulum"

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], 9.81 * ca.sin(x[0]) - 0.1 * x[1] + u)

    def output(self, t, x, u, w):
        return ca.cos(x[0])

    def ladder(self):
        return (self,)


def optimum(objective: Objective, x0, N, substeps, P=None, guess=None):
    """(x, u, cost) by CasADi and IPOPT: multiple shooting, bounds held, derivatives and Hessian CasADi's own."""
    plant = objective.plant
    _, x, u, w, p = plant.symbols
    z, low, high = objective.bounded_expression
    wanted = [plant.expressions[0], ca.sumsqr(objective.residual_expression), z]
    quiet = [ca.DM.zeros(plant.nw), ca.DM(plant.nominal_parameters)]
    rate, charge, z = ca.substitute(wanted, [w, p], quiet)
    f, stage = ca.Function("f", [x, u], ca.cse([rate])), ca.Function("stage", [x, u], [charge, z])
    X, U, h = ca.MX.sym("x", plant.nx), ca.MX.sym("u", plant.nu), objective.dt / substeps
    y = X
    for _ in range(substeps):
        k1 = f(y, U)
        k2 = f(y + h / 2 * k1, U)
        k3 = f(y + h / 2 * k2, U)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(y + h * k3, U))
    F = ca.Function("F", [X, U], [y])
    opti = ca.Opti()
    xs, us = opti.variable(plant.nx, N + 1), opti.variable(plant.nu, N)
    opti.subject_to(xs[:, 0] == x0)
    J = 0
    for k in range(N):
        cost, value = stage(xs[:, k], us[:, k])
        J += objective.dt * cost
        opti.subject_to(xs[:, k + 1] == F(xs[:, k], us[:, k]))
        for i in np.flatnonzero(np.isfinite(objective.limits[1])):
            opti.subject_to(opti.bounded(objective.limits[0][i], us[int(i), k], objective.limits[1][i]))
        if k and len(low):
            opti.subject_to(opti.bounded(low, value, high))
    if P is not None:
        J += ca.bilin(P, xs[:, N] - objective.x_goal, xs[:, N] - objective.x_goal)
    opti.minimize(J)
    line = x0 + (objective.x_goal - x0) * np.linspace(0, 1, N + 1)[:, None], np.tile(objective.u_goal, (N, 1))
    for variable, first in zip((xs, us), line if guess is None else guess):
        opti.set_initial(variable, first.T)
    ipopt = {"print_level": 0, "tol": 1e-11, "dual_inf_tol": 1e-10, "bound_relax_factor": 0.0, "sb": "yes"}
    opti.solver("ipopt", {"print_time": False}, ipopt)
    found = opti.solve()
    return found.value(xs).reshape(plant.nx, -1).T, found.value(us).reshape(plant.nu, -1).T, found.value(J)


@pytest.mark.parametrize(
    ("scene", "N"), [pytest.param(SLEW, 30, id="slew"), pytest.param(REACH, 12, id="reach", marks=pytest.mark.campaign)]
)
def test_converged_is_direct_optimal_control(scene, N):
    nmpc = NMPC.for_scene(scene, horizon=N)
    found = nmpc.iterate(scene.initial[0], tolerance=1e-10)
    x, u, cost = optimum(nmpc.objective, scene.initial[0], N, nmpc.substeps, nmpc.horizon.P)
    np.testing.assert_allclose(found.u, u, atol=1e-6)
    np.testing.assert_allclose(found.x, x, atol=1e-6)
    assert found.cost == pytest.approx(cost, rel=1e-9)
    assert np.abs(u).max(axis=0) == pytest.approx(scene.limits)  # which bind


def test_converged_with_binding_bounds_is_the_optimum_that_holds_them():
    scene = dataclasses.replace(SLEW, bounds=(("tip_deflection", 0.01), ("hub_angle_rate", 1.8)))
    nmpc = NMPC.for_scene(scene, horizon=30)
    found = nmpc.iterate(scene.initial[0], tolerance=1e-10)
    _, u, cost = optimum(nmpc.objective, scene.initial[0], 30, nmpc.substeps, nmpc.horizon.P)
    np.testing.assert_allclose(found.u, u, atol=1e-6)
    assert found.cost == pytest.approx(cost, rel=1e-9)
    y = scene.plant.measure(found.x[1:-1], found.u[1:])
    bent = scene.signal_values(found.x[1:-1], y, ("tip_deflection", "hub_angle_rate"))
    assert np.abs(bent).max(axis=0) == pytest.approx([0.01, 1.8], rel=1e-9)


def test_shorter_steps_find_an_optimum_that_full_ones_do_not(monkeypatch):
    objective = Objective(
        plant=Pendulum(),
        x_goal=np.zeros(2),
        u_goal=np.zeros(1),
        weights={"angle": 10.0, "angle_rate": 0.1},
        effort={"torque": 0.01},
        dt=0.05,
        limits=(-8.0, 8.0),
    )
    nmpc, start = NMPC(objective, 40, substeps=1), np.array([1.0, 0.0])
    found = nmpc.iterate(start)
    _, u, cost = optimum(objective, start, 40, 1, nmpc.horizon.P, guess=(found.x, found.u))
    np.testing.assert_allclose(found.u, u, atol=1e-6)
    assert found.cost == pytest.approx(cost, rel=1e-9) and np.abs(found.u).max() == pytest.approx(8.0)
    nmpc.reset()
    monkeypatch.setattr(gauss_newton, "HALVINGS", 0)
    with pytest.raises(PliantError, match="no step along the last direction is an improvement"):
        nmpc.iterate(start)


def test_costates_are_the_slopes_of_the_optimal_cost():
    scene = dataclasses.replace(SLEW, bounds=(("tip_deflection", 0.01),))
    nmpc, start, h = NMPC.for_scene(scene, horizon=12), scene.initial[0], 1e-5
    nmpc.iterate(start)
    program, plan = nmpc._program, nmpc.horizon
    d = program.solve(np.zeros(scene.plant.nx))
    assert program.multipliers().any()  # the bound binds
    found = gauss_newton.costates(program, plan.condensed.states(np.zeros(scene.plant.nx), d), d)[0]
    stage = plan.condensed
    slope = stage.dynamics[0, :, : scene.plant.nx].T @ found
    slope += 2 * stage.residual[0, :, : scene.plant.nx].T @ stage.residual[0, :, scene.plant.nx]
    for i in (0, 1, 3):
        ends = [nmpc.iterate(start + sign * h * np.eye(scene.plant.nx)[i]).cost for sign in (1, -1)]
        assert slope[i] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-4)


def test_iterate_says_that_it_has_not_converged():
    nmpc = NMPC.for_scene(SLEW, horizon=30)
    with pytest.raises(PliantError, match="inputs still change by"):
        nmpc.iterate(SLEW.initial[0], limit=1)


def test_merit_is_the_cost_the_gaps_and_the_bounds(cart):
    nmpc = NMPC(cart(bounds={"s_rate": (-0.2, 0.2)}), 4, substeps=1, penalty=100.0)
    plan, weight = nmpc.horizon, np.array([1.0, 2.0, 3.0, 4.0])
    plan.x[:] = [0.0, 0.0, 0.5, 0.0]  # 1.5 half ranges outside, at three nodes; 0.05 m short at every step
    nmpc._program.linearize()
    x_next, _, _ = nmpc.horizon.steps(plan.x[:-1], plan.u)
    gaps = np.abs(x_next - plan.x[1:]).sum(axis=0)
    assert gaps[0] == pytest.approx(0.2)
    outside = 100.0 * (3 * 1.5 + CURVATURE * 3 * 1.5**2 / 2)
    assert gauss_newton._merit(nmpc._program, weight) == pytest.approx(plan.cost() + weight @ gaps + outside, rel=1e-12)
