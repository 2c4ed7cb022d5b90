"""Regulation of the slider-crank's cycle, held against a long horizon, and against the nonlinear plant."""

import numpy as np
import pytest

from pliant.controllers import PeriodicLQR, riccati
from pliant.controllers.base.objective import Objective
from pliant.controllers.cycles.cycle import deviations, turning, whole_turns
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.envs import scenes
from pliant.plants import EquilibriumError
from pliant.plants.slider_crank.steady_cycles import steady_cycle


@pytest.fixture(scope="module")
def scene():
    return scenes.get("slider-crank-run")


@pytest.fixture(scope="module")
def law(scene):
    return PeriodicLQR.for_scene(scene)


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


def test_held_against_a_long_horizon(scene, law):
    """The same gains and costs as three times three turns of the time-varying regulator, by square roots."""
    cycle = deviations(scene)
    A, B, Q, R, N = (np.tile(M, (3, 1, 1)) for M in cycle.system)
    long, made = riccati.dtvlqr(A, B, Q, R, N), law.regulator
    T = len(made.K)
    assert pytest.approx(long.K[:T], rel=1e-6, abs=1e-8 * np.abs(made.K).max()) == made.K
    assert pytest.approx(long.P[:T], rel=1e-6, abs=1e-8 * np.abs(made.P).max()) == made.P
    assert law.K[:, :, law.angle] == pytest.approx(0.0)


def test_goals_that_are_no_cycle_are_refused():
    with pytest.raises(EquilibriumError, match="no cycle"):
        PeriodicLQR.for_scene(scenes.get("single-link-slew"))
    with pytest.raises(EquilibriumError, match="whole control periods"):
        whole_turns(np.pi, 0.1)
    assert whole_turns(1.0, 0.0625) == (1, 16) and whole_turns(5 / 12, 0.005) == (3, 250)


def test_turning(scene):
    j, rate = turning(scene)
    assert scene.plant.states[j].name == "crank_angle" and rate == pytest.approx(144 * np.pi / 30)
