"""TVLQR: the steady regulator on a long horizon, costs rolled out, nominals that are not motions, phase, funnel."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR, Controller, riccati
from pliant.controllers.base.objective import Objective
from pliant.controllers.linear_quadratic.tvlqr import TVLQR
from pliant.controllers.optimal_control.nominal_motions import rigid_nominal
from pliant.controllers.optimal_control.optimal import optimal
from pliant.controllers.optimal_control.plan import plan
from pliant.envs import scenes
from pliant.plants import Trajectory
from pliant.plants.core.errors import EquilibriumError
from pliant.plants.linear.ltv import LTVModel

SLEW = scenes.get("single-link-slew")
FREE = dataclasses.replace(SLEW, limits=(1e4,))
ARM = SLEW.plant


def run(scene, controller, x0=None, plant=None):
    start = scene.initial[0] if x0 is None else x0
    return (plant or scene.plant).simulate(start, controller, scene.times, method="rk4", step=scene.dt / scene.substeps)


def constant(model, nodes, dt):
    n, m, p = len(model.states), len(model.inputs), len(model.outputs)
    stack = (np.tile(v, (nodes, 1, 1)) for v in (model.A, model.B, model.E, model.C, model.D, model.F))
    rest = (np.zeros((nodes, n)), np.tile(model.x0, (nodes, 1)), np.tile(model.u0, (nodes, 1)), np.zeros((nodes, p)))
    t = dt * np.arange(nodes)
    assert m == 1
    return LTVModel(t, *stack, *rest, model.states, model.inputs, model.disturbances, model.outputs)


def test_of_a_constant_model_tends_to_the_sampled_regulator():
    model, (Q, R, _) = ARM.linearize(*SLEW.target), SLEW.quadratic()
    steady = LQR.design(model, Q, R, dt=0.02)
    found = TVLQR.design(constant(model, 1501, 0.02), Q, R)
    np.testing.assert_allclose(found.K[0], steady.K, atol=1e-9 * np.abs(steady.K).max())
    x = model.x0 + 0.01 * np.arange(1.0, 7.0)
    np.testing.assert_allclose(found.act(0.0, x), steady.act(0.0, x), rtol=1e-9)
    assert found.cost_to_go(0, x) == pytest.approx(steady.cost_to_go(x), rel=1e-9)


def test_rolled_cost_is_the_cost_to_go_on_a_nominal_that_is_no_motion():
    # The linear model rolled by its own simulation (Magnus steps); c(t) from a rigid nominal.
    ltv = ARM.linearize_along(rigid_nominal(SLEW))
    (Q, R, _), end = SLEW.quadratic(), np.eye(6)
    law = TVLQR.design(ltv, Q, R, end=end)
    fine = riccati.sampled_along(ltv, Q, R)
    A, B, c = ltv.transition()
    for start in (np.zeros(6), 0.02 * np.arange(6.0)):
        e, cost = start, 0.0
        for k in range(len(A)):
            u = law.act(ltv.t[k], ltv.x[k] + e)
            du = u - (ltv.u[k] + ltv.u[k + 1]) / 2
            cost += e @ fine.Q[k] @ e + du @ fine.R[k] @ du + 2 * e @ fine.N[k] @ du
            cost += 2 * (fine.q[k] @ e + fine.s[k] @ du) + fine.r[k]
            e = A[k] @ e + B[k] @ du + c[k]
        assert cost + e @ end @ e == pytest.approx(law.cost_to_go(0, ltv.x[0] + start), rel=1e-8)
    assert law.cost_to_go(0, ltv.x[0]) > 1e-6  # what the affine term alone costs


def test_cost_on_the_plant_is_the_cost_to_go_to_second_order():
    law = TVLQR.for_scene(FREE)
    Q, R, N = Objective.of(FREE).quadratic()
    steps, ratios = len(law.x) - 1, []
    for size in (4e-3, 2e-3, 1e-3):
        start = FREE.initial[0] + size * np.array([1.0, 0.1, 0.02, 1.0, 0.3, 0.2])
        motion = run(FREE, law, start)
        dx, du = motion.x[:-1].copy(), motion.u[:-1].copy()
        dx[:steps] -= law.x[:-1]
        du[:steps] -= law.u[:-1]
        dx[steps:] -= FREE.target[0]
        cost = FREE.dt * sum(x @ Q @ x + u @ R @ u + 2 * x @ N @ u for x, u in zip(dx, du))
        ratios.append(cost / law.cost_to_go(0, start) - 1)
    assert np.abs(ratios[-1]) < 3e-4 and abs(ratios[0] / ratios[-1]) > 2.5  # the rest falls with the deviation


def test_nominal_of_the_plant_itself_is_followed_exactly_then_the_goal_is_held():
    law = TVLQR.for_scene(SLEW)
    assert isinstance(law, Controller) and law.reads == tuple(s.name for s in ARM.states)
    motion = run(SLEW, law)
    np.testing.assert_allclose(motion.x[: len(law.nominal)], law.nominal, atol=1e-10)
    np.testing.assert_allclose(motion.x[-1], SLEW.target[0], atol=1e-10)


def test_rigid_nominal_gets_the_feedforward_that_it_lacks():
    law = TVLQR.for_scene(SLEW, nominal="rigid")
    motion = run(SLEW, law)
    T = len(law.nominal)
    missed = np.abs(motion.x[: T - 1] - law.x[:-1]).max()
    lacked = np.abs(law.nominal - law.x)[:-1].max()
    assert lacked > 5e-3 and missed < 0.05 * lacked  # x* is where the plant goes: its bending is known beforehand
    assert np.abs(motion.x[-1] - SLEW.target[0]).max() < 1e-3


def test_disturbed_start_is_regulated_and_feedback_pays():
    law, start = TVLQR.for_scene(SLEW), SLEW.initial[0] + np.array([0.05, 0, 0, 0.2, 0, 0])
    motion = run(SLEW, law, start)
    open_loop = ARM.simulate(start, np.vstack([law.u[:-1], np.zeros((101, 1))]), SLEW.times, method="rk4", step=0.002)
    assert np.abs(motion.x[-1] - SLEW.target[0]).max() < 1e-3 < 0.05 < np.abs(open_loop.x[-1] - SLEW.target[0]).max()


def test_phase_is_the_clock_on_the_nominal_and_waits_for_a_plant_that_lags():
    by_time, by_phase = TVLQR.for_scene(SLEW), TVLQR.for_scene(SLEW, index="phase")
    np.testing.assert_allclose(run(SLEW, by_phase).x, run(SLEW, by_time).x, atol=1e-9)
    motions = []
    for law in (by_time, by_phase):
        law.reset()
        x, step, largest = SLEW.initial[0][None].copy(), ARM.stepper(SLEW.dt, substeps=SLEW.substeps), 0.0
        for k in range(250):
            u = law.act(k * SLEW.dt, x[0])
            if k >= 20:  # a brake holds the arm for the first 0.4 s
                x = np.ascontiguousarray(step(x, u[None]))
                largest = max(largest, float(np.abs(u).max()))
        motions.append((largest, np.abs(x[0] - SLEW.target[0]).max()))
    (clock, end), (waiting, other) = motions
    assert clock == 40.0 and waiting < 30.0 and max(end, other) < 1e-3


def test_reset_returns_to_the_start():
    law = TVLQR.for_scene(SLEW, index="phase")
    first = law.act(0.0, SLEW.initial[0])
    for k in range(30):
        law.act(k * 0.02, law.x[min(k, 50)])
    assert law.phase > 20
    law.reset()
    np.testing.assert_array_equal(law.act(0.0, SLEW.initial[0]), first)


def on_edge(law, k, rng):
    """A state on the boundary of the funnel at node k."""
    L = np.linalg.cholesky(law.funnel.P[k])
    e = np.linalg.solve(L.T, rng.normal(size=6))
    return law.funnel.x[k] + e * np.sqrt(law.funnel.level[k] / (e @ law.funnel.P[k] @ e))


def test_inside_the_funnel_no_input_of_the_linear_model_reaches_a_limit():
    ltv = ARM.linearize_along(ARM.simulate(SLEW.initial[0], SLEW.nominal_input, SLEW.times[:51]))
    model, (Q, R, _) = ARM.linearize(*SLEW.target), SLEW.quadratic()
    steady = LQR.design(model, Q, R, dt=SLEW.dt)
    law = TVLQR.design(ltv, Q, R, end=steady.P, hold=(steady.K, *SLEW.target), limits=(-40.0, 40.0))
    A, B, c = ltv.transition()
    tail, rng, closest = riccati.sampled(model.A, model.B, Q, R, dt=SLEW.dt), np.random.default_rng(0), np.inf
    for _ in range(200):
        k = int(rng.integers(0, len(A)))
        x = on_edge(law, k, rng)
        assert law.funnel.use(law.dt * k, x) == pytest.approx(1.0, rel=1e-6)
        for j in range(k, k + 100):
            u = law._offsets[min(j, len(A))] - law.K[min(j, len(A))] @ x
            closest = min(closest, 40.0 - np.abs(u).max())
            if j < len(A):
                du = u - (ltv.u[j] + ltv.u[j + 1]) / 2
                x = ltv.x[j + 1] + A[j] @ (x - ltv.x[j]) + B[j] @ du + c[j]
            else:
                x = SLEW.target[0] + tail.A @ (x - SLEW.target[0]) + tail.B @ u
    assert closest > -1e-9
    assert np.all(np.diff(law.funnel.level) >= 0)  # what holds from a node on holds from every later one
    k = len(A)  # the bound is attained: at the goal, along K P^-1
    worst = np.linalg.solve(law.funnel.P[k], law.K[k][0])
    worst *= np.sqrt(law.funnel.level[k] / (worst @ law.funnel.P[k] @ worst))
    assert np.abs(law._offsets[k] - law.K[k] @ (law.funnel.x[k] + worst)).max() == pytest.approx(40.0, rel=1e-9)


def test_funnel_on_the_plant_itself():
    law, rng, worst = TVLQR.for_scene(SLEW), np.random.default_rng(1), 0.0
    for _ in range(20):
        start = on_edge(law, 0, rng)
        assert law.funnel.inside(0.0, start) is (law.funnel.use(0.0, start) <= 1.0)
        worst = max(worst, np.abs(run(SLEW, law, start).u).max())
    assert worst < 40.0
    assert law.funnel.inside(0.0, SLEW.initial[0]) and not law.funnel.inside(0.0, SLEW.initial[0] + 1.0)


def test_nominal_at_its_limit_has_no_funnel():
    found = optimal(Objective.of(SLEW), SLEW.initial[0], SLEW.steps)  # starts at 40 N m
    funnel = TVLQR.for_scene(SLEW, nominal=found).funnel
    assert funnel.level[0] < 1e-6 * funnel.level[-1] and not funnel.inside(0.0, SLEW.initial[0] + 1e-3)


def test_least_cost_nominal_costs_little_more_than_the_bound():
    law = TVLQR.for_scene(SLEW, nominal="optimal")
    best = optimal(Objective.of(SLEW), SLEW.initial[0], SLEW.steps).cost
    assert best < SLEW.cost(run(SLEW, law)) < 1.02 * best


def test_trajectory_on_other_times_is_resampled():
    motion = plan(SLEW)
    fine = ARM.simulate(motion.x[0], motion.trajectory(ARM).u, motion.t, method="rk4", step=0.002)
    law = TVLQR.along(ARM, fine, np.eye(6), np.eye(1), dt=SLEW.dt)
    with pytest.raises(ValueError, match=r"control period must be dt = 0\.01 s"):
        TVLQR.along(ARM, motion, np.eye(6), np.eye(1), dt=0.01)
    coarse = TVLQR.along(ARM, rigid_nominal(SLEW), np.eye(6), np.eye(1), dt=0.01)
    assert len(law.nominal) == 51 and len(coarse.nominal) == 101


def test_errors():
    with pytest.raises(EquilibriumError, match="no equilibrium"):
        TVLQR.for_scene(scenes.get("slider-crank-run"))
    with pytest.raises(ValueError, match=r"nominal = 'best' must be one of 'plan', 'optimal', 'rigid'"):
        TVLQR.for_scene(SLEW, nominal="best")
    with pytest.raises(ValueError, match=r"TVLQR.index = 'clock' must be one of 'time', 'phase'"):
        TVLQR.for_scene(SLEW, index="clock")
    with pytest.raises(ValueError, match=r"TVLQR.y\[2\] = nan must be finite"):
        TVLQR.for_scene(SLEW).act(0.0, np.array([0, 0, np.nan, 0, 0, 0]))
    short = Trajectory.from_arrays([0.0, 0.005], np.zeros((2, 6)), plant=ARM)
    with pytest.raises(ValueError, match=r"the nominal takes 0\.005 s, must be at least dt = 0\.02 s"):
        TVLQR.along(ARM, short, np.eye(6), np.eye(1), dt=0.02)
