"""Regulation of the slider-crank's cycle, held against a long horizon, and against the nonlinear plant."""

import numpy as np
import pytest

from pliant.controllers import PeriodicLQR, riccati
from pliant.controllers.base.objective import Objective
from pliant.controllers.cycles.cycle import deviations, of_cycle, turning
from pliant.controllers.cycles.periodic_lqr import of_draws
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.envs import scenes
from pliant.plants import EquilibriumError
from pliant.plants.slider_crank.steady_cycles import steady_cycle


def played(scene, law, x, steps):
    """States (steps + 1, nx) and inputs of the nonlinear plant, sampled and held."""
    plant, about, xs, us = scene.plant, Objective.of(scene), [x], []
    for k in range(steps):
        us.append(law.act(k * scene.dt, xs[-1]))
        step = HeldSteps(plant, scene.dt, scene.substeps, np.zeros(1), np.zeros(plant.nw), plant.nominal_parameters)
        xs.append(step.ends(xs[-1][None], us[-1][None])[0])
    x, u = np.array(xs), np.array(us)
    angle = x[:, turning(scene)[0]]
    turns = np.floor((angle[-1] - angle[0]) / (2 * np.pi) + 1e-3)  # the mean is over whole turns, not over steps
    end = np.interp(angle[0] + turns * 2 * np.pi, angle, np.arange(steps + 1.0))
    total = np.concatenate([[0.0], about.rate(x[:-1], u).cumsum()])
    return x, u, np.interp(end, np.arange(steps + 1.0), total) / max(end, 1.0)


def test_the_cycle_is_the_plants_own(scene, law):
    """x* against `steady_cycle`, by trigonometric polynomials instead of shooting."""
    cycle = steady_cycle(scene.plant, points=721)
    for name in law.reads[1:3]:
        j = law.reads.index(name)
        wanted = np.interp(law.x[:, law.angle], cycle["crank_angle"], cycle[name])
        assert law.x[:, j] == pytest.approx(wanted, abs=2e-3 * np.abs(wanted).max())


def test_every_multiplier_is_below_one(law):
    assert law.turns == 3 and len(law.x) == 250  # 3 turns at 144 rpm are 250 periods of 5 ms
    assert len(law.multipliers) == law.x.shape[1] - 1 and law.multipliers.max() < 0.2
    assert law.regulator.residual < 1e-10


def test_a_deviation_decays_on_the_plant_as_the_multipliers_say(scene, law):
    """Crank speed off by 1e-4: after a turn what is left is the largest multiplier's share or less."""
    start = law.x[0].copy()
    far = start.copy()
    far[law.reads.index("crank_angle_rate")] *= 1 + 1e-4
    turn = 83
    near, _, _ = played(scene, law, start, turn)
    off, _, _ = played(scene, law, far, turn)
    j = law.reads.index("crank_angle_rate")
    left = (off - near)[-1, j] / (off - near)[0, j]
    assert abs(left) < 3 * law.multipliers[0]


@pytest.mark.campaign
def test_its_mean_cost_is_below_that_of_the_free_cycle(scene, law):
    """By what second order predicts of the orbit that it settles to, within 5 %."""
    start = law.x[0]
    settled, _, _ = played(scene, law, start, 84)
    _, _, cost = played(scene, law, settled[-1], 252)
    cycle, made, about = deviations(scene), law.regulator, Objective.of(scene)
    free = about.rate(cycle.x, np.tile(about.u_goal, (len(cycle.x), 1))).mean()
    A, _, Q, R, N = cycle.system
    xi, v = made.orbit, -np.einsum("kij,kj->ki", made.K, made.orbit) - made.k
    change = sum(
        np.einsum(*terms).sum()
        for terms in (
            ("ki,kij,kj->k", xi, Q, xi),
            ("ki,kij,kj->k", v, R, v),
            ("ki,kij,kj->k", 2 * xi, N, v),
            ("ki,ki->k", 2 * cycle.q, xi),
            ("ki,ki->k", 2 * cycle.s, v),
        )
    )
    predicted = change / scene.dt / len(A)
    assert predicted < 0 and cost - free == pytest.approx(predicted, rel=0.05)


def test_held_against_a_long_horizon(cycle, law):
    """Two turns' gains and costs are those of the time-varying regulator over four, by square roots."""
    A, B, Q, R, N = (np.concatenate([M, M])[:334] for M in of_cycle(cycle, 1.0).system)
    long, made = riccati.dtvlqr(A, B, Q, R, N), law.regulator
    assert pytest.approx(long.K[:167], rel=1e-6, abs=1e-8 * np.abs(made.K).max()) == made.K[:167]
    assert pytest.approx(long.P[:167], rel=1e-6, abs=1e-8 * np.abs(made.P).max()) == made.P[:167]
    assert law.K[:, :, law.angle] == pytest.approx(0.0)


def test_inputs_a_whole_period_late_are_met_by_the_state_ahead(cycle, law):
    """ "Every stabilizing dead-time controller has an observer-predictor-based structure" (Mirkin and Raskin 2003): the
    gain without delay on the state that the input will meet."""
    made, _ = of_draws(cycle, (1.0, 1.0), 1.0, [None])
    A, B = of_cycle(cycle, 1.0).system[:2]
    wanted = np.roll(law.regulator.K, -1, axis=0) @ np.concatenate([A, B], axis=2)
    assert pytest.approx(wanted, rel=1e-8, abs=1e-9 * np.abs(wanted).max()) == made.K


def test_a_range_of_delays_bears_every_one_that_stays(scene, cycle):
    made = PeriodicLQR.about(cycle, 1.0, (0.0, 1.0))
    assert made.K.shape == (250, 1, 7) and made.multipliers[0] < 0.01
    for delay in (0.0, 0.3, 1.0):
        around = np.eye(6)
        for k, step in enumerate(cycle.late(delay, 1).step):
            around = (step[:, :6] - step[:, 6:] @ made.regulator.K[k]) @ around
        assert np.abs(np.linalg.eigvals(around)).max() ** (1 / 3) <= made.multipliers[0] * (1 + 1e-6)
    u = [made.act(0.0, cycle.x[k] + [0, 0, 0, 0.1, 0, 0]) for k in range(2)]
    made.reset()
    assert made.act(0.0, cycle.x[1] + [0, 0, 0, 0.1, 0, 0]) != u[1]  # it knows what is on its way
    again = PeriodicLQR.about(cycle, 1.0, (0.0, 1.0))
    again.act(0.0, cycle.x[0] + [0, 0, 0, 0.1, 0, 0])
    assert again.act(0.0, cycle.x[1] + [0, 0, 0, 0.1, 0, 0]) == u[1]


def test_one_gain_for_machines_of_a_box_is_stable_on_its_corners(scene, cycle):
    made = PeriodicLQR.about(cycle, 1.0, (0.0, 0.0), {"rod.E": (0.7, 1.3)})
    varied = scene.plant.vary("rod.E")
    for factor in (0.7, 1.0, 1.3):
        step, around = cycle.late(0.0, 0, machine=(varied, varied.nominal_parameters * factor)).step, np.eye(5)
        for k in range(250):
            around = (step[k, :, :5] - step[k, :, 5:] @ made.regulator.K[k]) @ around
        assert np.abs(np.linalg.eigvals(around)).max() ** (1 / 3) <= made.multipliers[0] * (1 + 1e-6) < 0.1


def test_goals_that_are_no_cycle_are_refused():
    with pytest.raises(EquilibriumError, match="no cycle"):
        PeriodicLQR.for_scene(scenes.get("single-link-slew"))
