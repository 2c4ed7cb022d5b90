"""NMPC: on a linear plant one step is the regulator, or linear predictive control; limits and bounds hold; near the
bound in closed loop; a failed program is recorded and the shifted plan goes on.
"""

import copy
import pickle

import numpy as np
import pytest
import scipy.linalg as sla

from pliant.controllers import NMPC, Controller, Objective, optimal
from pliant.controllers.linear_quadratic.state_ahead import StateAhead
from pliant.controllers.solvers.soft_qp import SoftProgram
from pliant.envs import scenes
from pliant.plants import PliantError, TwoLinkArm

REACH, SLEW = scenes.get("two-link-reach"), scenes.get("single-link-slew")


def rk4_map(A: np.ndarray, B: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """x+ = F x + G u of one RK4 step: the exponential's series to its fourth power."""
    wide = np.zeros((5, 5))
    wide[:4, :4], wide[:4, 4:] = h * A, h * B
    power = total = np.eye(5)
    for k in range(1, 5):
        power = power @ wide / k
        total = total + power
    return total[:4, :4], total[:4, 4:]


def riccati_by_scipy(objective: Objective) -> tuple[np.ndarray, ...]:
    """F, G, Q, R, P, K of the cart's regulator."""
    F, G = rk4_map(objective.plant.A, objective.plant.B, objective.dt)
    row = np.array([[1.0, 1.0, 0, 0]])
    Q = objective.dt * (5.0 * row.T @ row + 0.3 * np.diag([0, 0, 1.0, 0]))
    R = objective.dt * np.array([[0.1]])
    P = sla.solve_discrete_are(F, G, Q, R)
    return F, G, Q, R, P, np.linalg.solve(R + G.T @ P @ G, G.T @ P @ F)


def closed_loop(scene, controller):
    """(x, u, cost) of an episode on the scene's plant at the scene's substeps."""
    step = scene.plant.stepper(scene.dt, substeps=scene.substeps)
    x, u = [scene.initial[0]], []
    controller.reset()
    for k in range(scene.steps):
        u.append(controller.act(k * scene.dt, x[-1]))
        x.append(step(x[-1][None], u[-1][None])[0].copy())
    return np.array(x), np.array(u), Objective.of(scene).cost(x, u)


@pytest.mark.campaign
def test_undamped_links_whose_plan_is_rough_are_steered_by_damped_steps():
    arm = TwoLinkArm.textbook()  # motors without inertia, modes up to 117 Hz that nothing damps
    x, u = arm.equilibrium(theta1=-0.9, theta2=0.6)
    start, _ = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)
    weights = {name: weight for name, weight in REACH.weights if name.startswith("theta")}
    given = {"weights": weights, "effort": dict(REACH.effort), "limits": np.outer((-1, 1), REACH.limits)}
    nmpc = NMPC(Objective(plant=arm, x_goal=x, u_goal=u, dt=0.02, **given), 30, starts=(start,))
    step = arm.stepper(0.02, substeps=40)

    y = start
    for k in range(60):
        y = step(y[None], nmpc.act(0.02 * k, y)[None])[0].copy()
    assert np.abs(y - x)[:2].max() < 0.2
    assert nmpc.record.failures == 0 < nmpc.record.damped


def test_damping_leaves_the_regulators_feedback_whole(cart):
    objective = cart()
    K = riccati_by_scipy(objective)[5]
    nmpc = NMPC(objective, 6, substeps=1)
    nmpc.start(0.0, np.zeros(4))
    plan = nmpc.horizon
    plan.hold(True)
    nmpc._program.linearize()
    y = np.array([1.0, -0.3, 0.2, 0.5])
    np.testing.assert_allclose(nmpc.feedback(y), -K @ y, rtol=1e-9)
    plan.u[:] += 1.0  # what the plan then changes by besides that feedback, v, costs sum v'M v: four times that
    besides = []
    for damping in (3.0, 0.0):
        plan.damping = damping
        nmpc._program.linearize()
        d = nmpc._program.solve(np.zeros(4))
        besides.append(d + plan.condensed.states(np.zeros(4), d)[:-1] @ K[0])
    np.testing.assert_allclose(besides[0], besides[1] / 4, rtol=1e-9)


def test_damping_ends_with_calm_plans():
    nmpc = NMPC.for_scene(SLEW, horizon=12)
    nmpc.start(0.0, SLEW.initial[0])
    assert nmpc.horizon.damping == 0.0
    nmpc.horizon.hold(True)
    for k in range(8):
        nmpc.act(k * 0.02, nmpc.horizon.x[0])
    assert nmpc.horizon.damping == 0.0 and nmpc.record.damped == 6


@pytest.mark.parametrize("N", [1, 7, 40])
def test_on_a_linear_plant_without_limits_one_step_is_the_regulator(cart, N):
    objective = cart()
    _, _, _, _, P, K = riccati_by_scipy(objective)
    nmpc = NMPC(objective, N, substeps=1, first_steps=1)
    np.testing.assert_allclose(nmpc.horizon.P, P, rtol=1e-8, atol=1e-10)
    for k, y in enumerate(np.random.default_rng(0).normal(size=(4, 4))):  # far from what was predicted
        np.testing.assert_allclose(nmpc.act(k * objective.dt, y), -K @ y, rtol=1e-9)
    assert nmpc.record.limited == nmpc.record.failures == 0


def test_on_a_linear_plant_with_limits_one_step_is_linear_predictive_control(cart):
    objective = cart(limits=(-0.5, 0.7), bounds={"s_rate": (-0.4, 0.5)})
    P = riccati_by_scipy(objective)[4]
    nmpc = NMPC(objective, 10, substeps=1, first_steps=1)
    for k, y in enumerate(np.array([[1.0, 0, 0, 0], [-1.0, 0.2, 0.1, 0], [2.0, 0.1, -0.3, 0.2]])):
        want = optimal(objective, y, 10, substeps=1, terminal=P, tolerance=1e-10).u[0]
        np.testing.assert_allclose(nmpc.act(k * objective.dt, y), want, atol=1e-7)
    assert nmpc.record.limited == 3 and nmpc.record.violations == 0


def test_a_bound_that_cannot_hold_is_left_as_little_as_can_be_and_recorded(cart):
    objective = cart(limits=(-0.5, 0.5), bounds={"s_rate": (-0.2, 0.2)})
    nmpc = NMPC(objective, 10, substeps=1)
    y = np.array([0.5, 0.0, -0.5, 0.0])  # 0.3 m/s outside, a tenth of that is braked in a period
    u = nmpc.act(0.0, y)
    assert u == pytest.approx([0.5])
    F, G, *_ = riccati_by_scipy(objective)
    assert nmpc.record.violations == 1 and nmpc.record.failures == 0
    assert nmpc.record.worst == pytest.approx([-0.2 - (F @ y + G @ u)[2]], rel=1e-6)


@pytest.mark.parametrize("scene", [SLEW, pytest.param(REACH, marks=pytest.mark.campaign)], ids=lambda s: s.name)
def test_in_closed_loop_it_is_near_the_full_information_bound(scene):
    nmpc = NMPC.for_scene(scene)
    _, u, cost = closed_loop(scene, nmpc)
    whole = NMPC(Objective.of(scene), scene.steps, substeps=scene.substeps, terminal=None)
    bound = whole.iterate(scene.initial[0], tolerance=1e-7)  # the optimum: test_gauss_newton.py
    assert bound.cost * (1 - 1e-9) < cost < 1.002 * bound.cost
    assert (np.abs(u) <= scene.limits).all() and np.abs(u).max(axis=0) == pytest.approx(scene.limits)
    assert nmpc.record.calls == scene.steps and nmpc.record.limited > 0
    assert nmpc.record.failures == nmpc.record.violations == 0
    assert nmpc.record.preparation > 0 and nmpc.record.feedback > 0


def test_a_failed_program_takes_the_shifted_plan_and_says_so():
    nmpc = NMPC.for_scene(SLEW, horizon=12)
    step = SLEW.plant.stepper(SLEW.dt, substeps=nmpc.substeps)
    x = SLEW.initial[0]
    for k in range(3):
        x = step(x[None], nmpc.act(k * SLEW.dt, x)[None])[0].copy()
    plan, works = nmpc.horizon.u.copy(), nmpc._program.solver
    nmpc._program.solver = SoftProgram(works.n, works.m, penalty=works.penalty, iteration_limit=0)
    for k in range(3, 9):
        nmpc._program.linearize()
        u = nmpc.act(k * SLEW.dt, x)
        np.testing.assert_array_equal(u, plan[k - 3])
        assert (nmpc.record.failures, nmpc.record.in_a_row, nmpc.record.why) == (k - 2, k - 2, "iteration limit")
        x = step(x[None], u[None])[0].copy()
    assert nmpc.horizon.damping > 0
    nmpc._program.solver = works
    nmpc._program.linearize()
    u = nmpc.act(9 * SLEW.dt, x)
    assert nmpc.record.in_a_row == 0 and nmpc.record.failures == 6
    assert np.abs(u - plan[6]) < 0.02 * SLEW.limits[0]  # the plan went on as it should have, and so does the feedback


def test_a_plan_that_is_no_motion_is_given_up_and_said():
    nmpc = NMPC.for_scene(SLEW, horizon=12)
    x = SLEW.initial[0]
    nmpc.act(0.0, x)
    nmpc.horizon.x[3] = 1e200
    nmpc._program.linearize()
    planned = nmpc.horizon.u[0].copy()
    np.testing.assert_array_equal(nmpc.act(0.02, x), planned)
    assert nmpc.record.failures == 1 and nmpc.record.why == "the plan is no motion that can be linearised"
    for k in range(2, 5):
        nmpc.act(k * 0.02, x)
    assert nmpc.record.failures == 1
    np.testing.assert_allclose(nmpc.iterate(x).u, NMPC.for_scene(SLEW, horizon=12).iterate(x).u, atol=1e-5)


def test_feedback_and_preparation_are_an_act_and_reset_forgets():
    nmpc, parts = (NMPC.for_scene(REACH, horizon=8) for _ in range(2))
    assert isinstance(nmpc, Controller) and nmpc.reads == tuple(s.name for s in REACH.plant.states)
    with pytest.raises(PliantError, match=r"start\(t, y\) makes the first"):
        parts.feedback(REACH.initial[0])
    parts.start(0.0, REACH.initial[0])
    with pytest.raises(PliantError, match="follows a feedback"):
        parts.prepare()
    rng = np.random.default_rng(1)
    readings = REACH.initial[0] + 1e-3 * rng.standard_normal((4, REACH.plant.nx))
    first = [nmpc.act(k * nmpc.dt, y) for k, y in enumerate(readings)]
    parts.reset()
    parts.start(0.0, readings[0])
    for y, u in zip(readings, first):
        np.testing.assert_array_equal(parts.feedback(y), u)
        parts.prepare()
    nmpc.reset()
    assert nmpc.record.calls == 0
    np.testing.assert_array_equal([nmpc.act(k * nmpc.dt, y) for k, y in enumerate(readings)], first)
    twins = (copy.copy(nmpc), copy.deepcopy(nmpc), pickle.loads(pickle.dumps(nmpc)))  # go on, apart from it
    ahead = [twin.act(4 * nmpc.dt, readings[0]) for twin in twins]
    on = nmpc.act(4 * nmpc.dt, readings[0])
    for u in ahead:
        np.testing.assert_allclose(u, on, rtol=1e-9)
    again = pickle.loads(pickle.dumps(nmpc))
    again.reset()
    np.testing.assert_array_equal([again.act(k * nmpc.dt, y) for k, y in enumerate(readings)], first)


def test_it_steers_a_simulation():
    nmpc = NMPC.for_scene(SLEW, horizon=10)
    motion = SLEW.plant.simulate(SLEW.initial[0], nmpc, SLEW.times[:101], rtol=1e-7, atol=1e-9)
    assert abs(motion["hub_angle"][-1] - 1.0) < 0.01


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"effort": {}}, r"NMPC\.objective\.effort = \{\} must price every input: force"),
        ({"horizon": 0}, r"NMPC\.horizon = 0 must be an integer from 1"),
        ({"penalty": 0.0}, r"NMPC\.penalty = 0\.0 must be > 0"),
        ({"first_steps": 0}, r"NMPC\.first_steps = 0 must be an integer from 1"),
        ({"iteration_limit": -1}, r"NMPC\.iteration_limit = -1 must be an integer from 0"),
        ({"terminal": "zero"}, r"NMPC\.terminal = 'zero' must be one of 'riccati'"),
        ({"terminal": -np.eye(4)}, r"NMPC\.terminal has eigenvalue -1, must be >= 0"),
        ({"terminal": np.eye(3)}, r"NMPC\.terminal has shape \(3, 3\), must be \(4, 4\)"),
    ],
)
def test_bad_input(cart, change, message):
    with pytest.raises(ValueError, match=message):
        given = {"horizon": 5, "substeps": 1, **change}
        NMPC(cart(effort=given.pop("effort", {"force": 0.1})), **given)


def test_bad_measurement(cart):
    nmpc = NMPC(cart(), 5, substeps=1)
    with pytest.raises(ValueError, match=r"NMPC\.y\[1\] = nan must be finite"):
        nmpc.act(0.0, np.array([0, np.nan, 0, 0]))


def test_long_horizons_give_the_inputs_of_short_ones_to_rounding(monkeypatch) -> None:
    """Condensed from the end and solved by its factors where nothing binds, by DAQP where a limit does."""
    from pliant.controllers.nmpc import condensing

    y = REACH.initial[0]
    want = NMPC.for_scene(REACH, 30)
    monkeypatch.setattr(condensing, "LONG", 0)
    found = NMPC.for_scene(REACH, 30)
    assert found.horizon.condensed.long and not want.horizon.condensed.long
    for k, shift in enumerate((0.0, 0.0, 0.4, 0.0)):  # the third takes an input to its limit
        x = y + shift * (np.arange(len(y)) < 2)
        u = want.act(k * REACH.dt, x)
        np.testing.assert_allclose(found.act(k * REACH.dt, x), u, atol=1e-7 * max(REACH.limits))
    assert found.record.limited == want.record.limited


def test_a_delay_is_met_by_planning_from_the_state_ahead():
    """The input is that of an NMPC without delay at the state that the plant will be in, plan for plan."""
    late, plain = NMPC.for_scene(SLEW, delay=1.5), NMPC.for_scene(SLEW)
    x, held = SLEW.initial[0], np.clip(SLEW.initial[1], -SLEW.limits[0], SLEW.limits[0])
    ahead = StateAhead(SLEW.plant, SLEW.dt, 1.5, late.substeps, held)
    for k in range(4):
        u = late.act(k * SLEW.dt, x)
        np.testing.assert_allclose(u, plain.act((k + 1.5) * SLEW.dt, ahead(x)), rtol=1e-12, atol=1e-12)
        ahead.remember(u)
        x = SLEW.plant.stepper(SLEW.dt, substeps=10)(x[None], ahead.first)[0]
    with pytest.raises(ValueError, match=r"NMPC\.delay"):
        NMPC.for_scene(SLEW, delay=-0.5)
    with pytest.raises(ValueError, match=r"NMPC\.delay"):
        NMPC.for_scene(SLEW, delay=(1.0, 0.5))


def test_of_a_range_of_delays_it_plans_for_a_quarter():
    range_, one = NMPC.for_scene(SLEW, delay=(0.5, 2.5)), NMPC.for_scene(SLEW, delay=1.0)
    assert range_.delay == one.delay == 1.0
    np.testing.assert_array_equal(range_.act(0.0, SLEW.initial[0]), one.act(0.0, SLEW.initial[0]))
