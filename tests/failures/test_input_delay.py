"""Input delay of one and two periods: the regulator that ignores it loses its stability, and there is a cure.

The scene's LQR on two-link-reach holds its design model; with every input one period (20 ms) late it drives the elbow
past its bound. Pliant says so before any simulation: the model with the delay as states has an eigenvalue outside the
unit circle. The same regulator on the predicted state holds, within 2 % of the least cost that the delay leaves.
"""

import dataclasses

import numpy as np
import pytest
import scipy.linalg as sla

from pliant.controllers import LQR, Predictive, delayed
from pliant.controllers.analysis.loops import loop
from pliant.controllers.analysis.margins import margins
from pliant.controllers.linear_quadratic.delay import delay_margin, predictive_gain, radius
from pliant.envs import scenes
from pliant.plants import LinearModel
from pliant.studies.closed_loop.evaluation_scene import finer, play
from pliant.studies.closed_loop.optimal_bound import bound
from pliant.studies.closed_loop.rollout import nominal, rollout

REACH, SLEW = scenes.get("two-link-reach"), scenes.get("single-link-slew")


def model_of(scene):
    """The sampled model about the goal, on which LQR.for_scene is designed."""
    return scene.plant.linearize(*scene.target).discretize(scene.dt)


def late(played, periods):
    return dataclasses.replace(nominal(played), delay=periods)


@pytest.mark.every(2)
@pytest.mark.parametrize("periods", [1, 2])
def test_the_naive_regulator_fails(periods):
    played, law = play(REACH), LQR.for_scene(REACH)
    assert rollout(played, law).failure == ""
    run = rollout(played, law, late(played, periods))
    assert "beyond its bound" in run.failure and run.cost > 50 * rollout(played, law).cost


def test_slower_loop_bears_one_period_at_a_price_and_not_two():
    played, law = play(SLEW), LQR.for_scene(SLEW)
    costs = [rollout(played, law, late(played, periods)).cost for periods in (0, 1, 2)]
    assert costs[1] < 1.1 * costs[0] and costs[2] > 5 * costs[0]


@pytest.mark.parametrize(("scene", "bears"), [(REACH, 0), (SLEW, 1)], ids=lambda v: getattr(v, "name", ""))
def test_it_is_noticed_before_any_simulation(scene, bears):
    law, model = LQR.for_scene(scene), model_of(scene)
    assert radius(model, law.K, bears) < 1 < radius(model, law.K, bears + 1)
    assert delay_margin(model, law.K) == bears
    one_loop_at_a_time = min(c.delay for c in margins(loop(scene.plant.linearize(*scene.target), law)).channels)
    assert one_loop_at_a_time < (bears + 1) * scene.dt


@pytest.mark.campaign
@pytest.mark.parametrize("periods", [pytest.param(1, marks=pytest.mark.campaign), 2])
@pytest.mark.parametrize(
    "more",
    [pytest.param(False, id="design model"), pytest.param(True, id="finer plant", marks=pytest.mark.campaign)],
)
def test_the_predicted_state_holds_near_the_bound(periods, more):
    played = play(REACH, finer(REACH.plant) if more else None)
    law = Predictive.for_scene(REACH, delay=periods)
    run = rollout(played, law, late(played, periods))
    best, _, u = bound(played, late(played, periods), LQR.for_scene(REACH))
    assert run.failure == "" and best * (1 - 1e-6) < run.cost < 1.02 * best
    assert np.allclose(run.u[:periods], u[:periods])


@pytest.mark.every(3)
@pytest.mark.parametrize("periods", [0, 1, 3])
def test_prediction_is_the_optimal_regulator_of_the_delayed_model(periods):
    """The stabilising solution of the augmented Riccati equation, by fixed-point iteration, against K [A^n .. B]."""
    model, law = model_of(SLEW), LQR.for_scene(SLEW)
    weights = dict(SLEW.weights)
    known = [s.name for s in SLEW.signals]
    rows = np.vstack([np.eye(6), SLEW.plant.linearize(*SLEW.target).C])[[known.index(n) for n in weights]]
    A, B = SLEW.plant.linearize(*SLEW.target).A, SLEW.plant.linearize(*SLEW.target).B
    Q, R = rows.T @ np.diag(list(weights.values())) @ rows, np.diag([SLEW.effort[0][1]])
    fine = 2000  # cost of a period with the input held, by the midpoint rule
    cost = np.zeros((7, 7))
    for k in range(fine):
        F = sla.expm(np.block([[A, B], [np.zeros((1, 7))]]) * SLEW.dt * (k + 0.5) / fine)
        cost += F.T @ sla.block_diag(Q, R) @ F * SLEW.dt / fine
    big, nz = delayed(model, periods), 6 + periods
    charge = np.zeros((nz + 1, nz + 1))
    acts = [*range(6), 6]  # z = [x; oldest input ..], then the new input, which is the one that acts without delay
    charge[np.ix_(acts, acts)] = cost
    P = np.zeros((nz, nz))
    G = np.hstack([big.A, big.B])
    for _ in range(4000):
        H = charge + G.T @ P @ G
        K = np.linalg.solve(H[nz:, nz:] + 1e-12 * np.eye(1), H[nz:, :nz])
        P = H[:nz, :nz] - H[:nz, nz:] @ K
    assert np.allclose(predictive_gain(model, law.K, periods), K, rtol=1e-4, atol=1e-5 * np.abs(K).max())


def test_delayed_model_is_the_model_with_its_input_shifted():
    rng = np.random.default_rng(0)
    model = model_of(REACH)
    u = rng.standard_normal((30, 2))
    shifted = np.vstack([np.zeros((3, 2)), u[:-3]])
    t = REACH.dt * np.arange(30)
    x, y = model.simulate(np.ones(12), shifted, t)
    big = delayed(model, 3)
    z, seen = big.simulate(np.concatenate([np.ones(12), np.zeros(6)]), u, t)
    assert np.allclose(z[:, :12], x, atol=1e-9) and np.allclose(seen, y, atol=1e-7)
    assert big.state_names[12:] == tuple(f"tau{i} {k} late" for k in (3, 2, 1) for i in (1, 2))
    assert delayed(model, 0) is model


def test_radius_of_a_loop_that_can_be_done_by_hand():
    """x+ = x + u, u = -k x one period late: z^2 - z + k = 0, so |z| = sqrt(k) above k = 1/4, stable until k = 1."""
    model = LinearModel.from_matrices([[1.0]], [[1.0]], dt=1.0)
    assert radius(model, [[0.5]], 1) == pytest.approx(np.sqrt(0.5))
    assert radius(model, [[0.99]], 1) < 1 < radius(model, [[1.01]], 1)
    assert delay_margin(model, [[0.9]]) == 1 and delay_margin(model, [[2.1]]) == -1


def test_bad_input():
    with pytest.raises(ValueError, match=r"model\.dt = None must be a sampling time"):
        delayed(REACH.plant.linearize(*REACH.target), 1)
    with pytest.raises(ValueError, match=r"delayed\.periods = -1"):
        delayed(model_of(REACH), -1)
    with pytest.raises(ValueError, match=r"Predictive\.delay = 0"):
        Predictive.for_scene(REACH, delay=0)
