"""Where training starts: near the scene's LQR where there is one."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.controllers.analytic_gradients.rollouts import Episodes, Rollouts
from pliant.controllers.analytic_gradients.warm_start import LEAST, begin, law_of
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")


def start(scene, law, lanes=2):
    rollouts = Rollouts(scene, lanes, np.ones(len(scene.observe)))
    own = np.tile(scene.varied_plant.nominal_parameters, (lanes, 1))
    episodes = Episodes(np.tile(scene.initial[0], (lanes, 1)), own, np.zeros(lanes, dtype=int))
    theta = begin(rollouts, law, episodes, np.random.default_rng(0))
    return rollouts, theta, episodes


def test_the_network_does_what_the_law_does() -> None:
    rollouts, theta, episodes = start(SCENE, law_of(SCENE))
    cost, _ = rollouts.cost(theta, episodes)
    assert cost[0] == pytest.approx(3.511, rel=2e-3)  # LQR's, docs/scoreboard


def test_a_law_that_is_cut_off_for_much_of_the_motion() -> None:
    """Spin-up: LQR asks for its limit from the start on. It costs 105.4 (docs/scoreboard).

    What the rounds end at hangs on rounding: 105.8 to 114.7 over fourteen nudges of 1e-12 to 1e-9 and two compilers.
    Fitted to what is cut off, a network costs 377 or more.
    """
    scene = scenes.get("spin-up")
    rollouts, theta, episodes = start(scene, law_of(scene))
    cost, _ = rollouts.cost(theta, episodes)
    assert cost[0] < 1.25 * 105.4


def test_without_a_law_it_holds_the_goals_input() -> None:
    scene = dataclasses.replace(scenes.get("two-link-reach"), duration=0.1, move_time=0.1)
    rollouts, theta, episodes = start(scene, None)
    played = rollouts.play(theta, episodes)
    np.testing.assert_allclose(played.u, np.broadcast_to(scene.target[1], played.u.shape), rtol=1e-12)
    assert rollouts.std.min() > 0 and LEAST < 1


def test_which_law() -> None:
    assert isinstance(law_of(SCENE), LQR)
    assert law_of(scenes.get("slider-crank-run")) is None  # its goal turns
