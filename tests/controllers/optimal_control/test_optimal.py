"""Multiple shooting: discrete LQR where the plant is linear, optimality by rolling, limits, failures."""

import dataclasses
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

from pliant.controllers.base.objective import Objective
from pliant.controllers.optimal_control.optimal import bound, optimal
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.envs import scenes
from pliant.plants import Plant, Signal
from pliant.plants.core.errors import InfeasibleError

SLEW = scenes.get("single-link-slew")
GOAL = np.array([0.3, 0.0, 0.0, 0.0])


@dataclass(frozen=True, kw_only=True)
class TwoMasses(Plant):
    """Two carts of 1 kg with a spring of 40 N/m between; the force acts on the first."""

    states = (Signal("p1", "m"), Signal("p2", "m"), Signal("v1", "m/s"), Signal("v2", "m/s"))
    inputs = (Signal("force", "N"),)
    disturbances = (Signal("wind", "N"),)
    outputs = (Signal("gap", "m"),)
    label = "two carts"

    def ode(self, t, x, u, w):
        pull = 40.0 * (x[1] - x[0])
        return ca.vertcat(x[2], x[3], pull + u[0], w[0] - pull)

    def output(self, t, x, u, w):
        return ca.vertcat(x[1] - x[0])

    def ladder(self):
        return (self,)


CARTS = TwoMasses()
WEIGHTS = {"p1": 3.0, "p2": 2.0, "v1": 0.5, "gap": 20.0}


def carts(**changes):
    given = {"weights": WEIGHTS, "effort": {"force": 0.01}, "dt": 0.05}
    return Objective(plant=CARTS, x_goal=[0.3, 0.3, 0, 0], u_goal=[0.0], **{**given, **changes})


def finite_horizon_lqr(objective, steps, substeps, P):
    """P_0 and the gains (steps, nu, nx) of the textbook recursion, on the RK4 polynomial of the exact exponential."""
    A, B = CARTS.jacobians(np.zeros(4), np.zeros(1))[:2]
    wide = np.zeros((5, 5))
    wide[:4] = np.hstack([A, B]) * objective.dt / substeps
    step = sum(np.linalg.matrix_power(wide, k) / d for k, d in enumerate((1, 1, 2, 6, 24)))
    step = np.linalg.matrix_power(step, substeps)
    A, B, dt = step[:4, :4], step[:4, 4:], objective.dt
    row = np.array([-1.0, 1, 0, 0])
    Q, R = dt * (np.diag([3.0, 2.0, 0.5, 0.0]) + 20.0 * np.outer(row, row)), dt * np.array([[0.01]])
    gains = []
    for _ in range(steps):
        K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
        P = Q + A.T @ P @ (A - B @ K)
        gains.append(K)
    return P, np.array(gains[::-1])


@pytest.mark.parametrize("solver", ["ipopt", "fatrop"])
@pytest.mark.parametrize("hessian", ["gauss-newton", "exact"])
def test_linear_plant_without_limits_is_the_finite_horizon_regulator(solver, hessian):
    objective, steps, end = carts(), 60, np.diag([4.0, 3.0, 2.0, 1.0])
    found = optimal(objective, np.zeros(4), steps, substeps=3, terminal=end, solver=solver, hessian=hessian)
    P, gains = finite_horizon_lqr(objective, steps, 3, end)
    error = -objective.x_goal
    assert found.cost == pytest.approx(error @ P @ error, rel=1e-8)
    np.testing.assert_allclose(found.u[0], -gains[0] @ error, rtol=1e-7)
    np.testing.assert_allclose(
        found.u[:, 0], -np.einsum("kij,kj->ki", gains, found.x[:-1] - objective.x_goal)[:, 0], atol=1e-7
    )
    P1, _ = finite_horizon_lqr(objective, steps - 1, 3, end)
    np.testing.assert_allclose(found.costate[0], 2 * P1 @ (found.x[1] - objective.x_goal), atol=1e-7)
    assert found.defect < 1e-12 and found.stationarity < 1e-8


def rolled(scene, u):
    """Costs of inputs u (B, N, nu) on the scene's plant, stepped by the native batch kernel."""
    objective, B = Objective.of(scene), len(u)
    step = scene.plant.stepper(scene.dt, batch=B, substeps=scene.substeps)
    x, cost = np.tile(scene.initial[0], (B, 1)), np.zeros(B)
    for k in range(u.shape[1]):
        cost += scene.dt * objective.rate(x, u[:, k])
        x = step(x, u[:, k])
    return cost


def test_no_perturbation_of_the_slew_costs_less():
    scene = dataclasses.replace(SLEW, limits=(200.0,))  # out of reach: the cost is stationary in every input
    found = bound(scene, tolerance=1e-10)
    assert np.abs(found.u).max() < 150
    d = np.random.default_rng(0).normal(size=(64, *found.u.shape))
    d /= np.sqrt((d**2).sum(axis=(1, 2)))[:, None, None]
    base = rolled(scene, found.u[None])[0]
    assert base == pytest.approx(found.cost, rel=1e-12)
    for size in (1e-3, 1.0):
        ahead, behind = (rolled(scene, found.u + s * d) - base for s in (size, -size))
        assert min(ahead.min(), behind.min()) > 0
        slope, curvature = (ahead - behind) / (2 * size), (ahead + behind) / size**2
        assert np.abs(slope).max() < 1e-7 + 0.05 * size * curvature.min()


def test_binding_limit_is_kept_and_no_allowed_perturbation_costs_less():
    scene = dataclasses.replace(SLEW, limits=(3.0,))
    found = bound(scene, tolerance=1e-10)
    assert found.u.max() <= 3.0 and found.u.max() > 3.0 - 1e-6 and found.cost > bound(SLEW).cost * 1.01
    d = np.random.default_rng(1).normal(size=(64, *found.u.shape))
    for size in (1e-4, 1e-2, 0.5):
        assert rolled(scene, np.clip(found.u + size * d, -3.0, 3.0)).min() >= found.cost * (1 - 1e-9)


@pytest.mark.campaign
def test_exact_and_gauss_newton_hessians_and_both_solvers_meet():
    costs = [
        bound(SLEW, solver=s, hessian=h, tolerance=1e-9).cost
        for s, h in (("ipopt", "exact"), ("fatrop", "gauss-newton"))
    ]
    np.testing.assert_allclose(costs, costs[0], rtol=1e-9)


def test_scene_charges_the_bound_the_same():
    found = bound(SLEW)
    motion = found.trajectory(SLEW.plant)
    assert SLEW.cost(motion) == pytest.approx(found.cost, rel=1e-12)
    again = SLEW.plant.simulate(found.x[0], motion.u, SLEW.times, method="rk4", step=SLEW.dt / SLEW.substeps)
    np.testing.assert_allclose(again.x, found.x, atol=1e-9)


def test_bounds_are_hard_and_the_end_is_met():
    objective = dataclasses.replace(
        Objective.of(SLEW), bounds={"tip_deflection": (-0.005, 0.005), "hub_angle_rate": (-2, 0.8)}
    )
    found = optimal(objective, SLEW.initial[0], 125, terminal="goal")
    motion = found.trajectory(SLEW.plant)
    assert np.abs(motion["tip_deflection"]).max() == pytest.approx(0.005, abs=1e-6)
    assert np.abs(motion["tip_deflection"]).max() <= 0.005 + 1e-9
    assert motion["hub_angle_rate"].max() <= 0.8
    np.testing.assert_allclose(found.x[-1], SLEW.target[0], atol=1e-9)


def test_output_that_an_input_enters_is_bounded_at_every_start_of_a_period():
    free = optimal(Objective.of(SLEW), SLEW.initial[0], 60)
    assert np.abs(free.trajectory(SLEW.plant)["tip_acceleration"]).max() > 4.0
    objective = dataclasses.replace(Objective.of(SLEW), bounds={"tip_acceleration": (-4.0, 4.0)})
    motion = optimal(objective, SLEW.initial[0], 60).trajectory(SLEW.plant)
    assert np.abs(motion["tip_acceleration"][:-1]).max() <= 4.0 + 1e-9


def test_a_start_beyond_a_bound_is_given_and_comes_back_within():
    start = SLEW.plant.equilibrium(hub_angle=0.0)[0] + np.array([0, 0.0005, 0, 0, 0, 0])
    y = SLEW.plant.measure(start, np.zeros(1))[[s.name for s in SLEW.plant.outputs].index("tip_deflection")]
    objective = dataclasses.replace(Objective.of(SLEW), bounds={"tip_deflection": (-0.9 * abs(y), 0.9 * abs(y))})
    found = optimal(objective, start, 60)
    assert np.abs(found.trajectory(SLEW.plant)["tip_deflection"][1:]).max() <= 0.9 * abs(y) + 1e-9


def test_a_guess_saves_iterations_and_changes_nothing():
    objective = Objective.of(SLEW)
    cold = optimal(objective, SLEW.initial[0], 100)
    for guess in (cold, (cold.x, cold.u)):
        warm = optimal(objective, SLEW.initial[0], 100, guess=guess)
        assert warm.iterations < cold.iterations and warm.cost == pytest.approx(cold.cost, rel=1e-8)


@pytest.mark.campaign
def test_disturbance_and_parameters_enter():
    still = optimal(carts(), np.zeros(4), 40)
    assert optimal(carts(), np.zeros(4), 40, w=[0.5]).cost > still.cost * 1.01
    objective = dataclasses.replace(Objective.of(SLEW), plant=SLEW.plant.vary("hub_friction"))
    given = optimal(objective, SLEW.initial[0], 60, p=[5.0]).cost
    built = dataclasses.replace(objective, plant=dataclasses.replace(SLEW.plant, hub_friction=5.0))
    assert given == pytest.approx(optimal(built, SLEW.initial[0], 60).cost, rel=1e-9)


def test_period_derivatives_against_central_differences():
    plant, rng = SLEW.plant, np.random.default_rng(3)
    periods = HeldSteps(plant, 0.02, 4, np.zeros(3), np.zeros(plant.nw), plant.nominal_parameters)
    x, u, m = 0.05 * rng.normal(size=(3, plant.nx)), rng.normal(size=(3, plant.nu)), rng.normal(size=(3, plant.nx))
    found = periods.slopes(x, u, keep=True)
    reference = plant.stepper(0.02, batch=3, substeps=4)(x, u)
    np.testing.assert_allclose(found.end, reference, atol=1e-13)
    np.testing.assert_allclose(found.end, periods.ends(x, u), atol=1e-13)
    H, h = found.hessian(m), 1e-5
    for k, dz in enumerate(h * np.eye(plant.nx + plant.nu)):
        ahead, behind = (periods.slopes(x + s * dz[: plant.nx], u + s * dz[plant.nx :]) for s in (1, -1))
        np.testing.assert_allclose((ahead.end - behind.end) / (2 * h), found.slope[:, :, k], rtol=1e-6, atol=1e-7)
        row = np.einsum("bi,bij->bj", m, (ahead.slope - behind.slope) / (2 * h))
        np.testing.assert_allclose(row, H[:, k], atol=1e-6 * np.abs(H).max())


@pytest.mark.every(2)
@pytest.mark.parametrize("solver", ["ipopt", "fatrop"])
def test_what_cannot_be_done_says_what_is_violated(solver):
    objective = dataclasses.replace(Objective.of(SLEW), bounds={"hub_angle": (-1.0, 0.5)})
    with pytest.raises(InfeasibleError, match=r"hub_angle at the goal violated by 0\.\d+ at 1\.2 s") as caught:
        optimal(objective, SLEW.initial[0], 60, terminal="goal", solver=solver)
    assert solver in str(caught.value) and "iterations with" in str(caught.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"steps": 0}, r"optimal.steps = 0 must be an integer from 1"),
        ({"solver": "snopt"}, r"optimal.solver = 'snopt' must be one of 'ipopt', 'fatrop'"),
        ({"hessian": "bfgs"}, r"optimal.hessian = 'bfgs' must be one of"),
        ({"terminal": "rest"}, r"optimal.terminal = 'rest' must be one of 'goal'"),
        ({"terminal": np.eye(2)}, r"optimal.terminal has shape \(2, 2\), must be \(4, 4\)"),
        ({"x0": np.zeros(3)}, r"optimal.x0 has shape \(3,\), must be \(4,\)"),
        ({"guess": (np.zeros((4, 4)), np.zeros((5, 1)))}, r"optimal.guess x has shape \(4, 4\), must be \(6, 4\)"),
        ({"substeps": 0}, r"substeps = 0 must be an integer"),
        ({"w": [1.0, 2.0]}, r"optimal.w has shape \(2,\), must be \(1,\)"),
    ],
)
def test_bad_input(change, message):
    with pytest.raises(ValueError, match=message):
        optimal(carts(), **{"x0": np.zeros(4), "steps": 5, **change})
