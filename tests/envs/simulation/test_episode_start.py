"""How an episode starts: draws within their ranges, at rest there."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.simulation.episode_start import draw, initial_states
from pliant.plants import EquilibriumError

NAMES = scenes.names()


@pytest.mark.parametrize("name", NAMES)
def test_draws_fill_their_ranges(name: str) -> None:
    scene = scenes.get(name)
    starts, _, p = draw(scene, np.random.default_rng(1), 4000)
    own = np.array([value for _, value in scene.start])
    assert starts.shape == (4000, len(own)) and (np.abs(starts - own) <= scene.spread * (1 + 1e-12)).all()
    np.testing.assert_allclose(np.abs(starts - own).max(axis=0), scene.spread, rtol=0.01)
    factors = p / scene.varied_plant.nominal_parameters
    for column, (_, low, high) in zip(factors.T, scene.randomise):
        assert low <= column.min() < low + 0.01 and high - 0.01 < column.max() <= high
        assert column.mean() == pytest.approx((low + high) / 2, abs=0.01)


@pytest.mark.parametrize("name", NAMES)
def test_initial_states_are_the_plants_equilibria(name: str) -> None:
    """Against Plant.equilibrium, which solves the full equations by another Newton method; or the states as given."""
    scene = scenes.get(name)
    starts, _, p = draw(scene, np.random.default_rng(2), 40)
    own = np.array([value for _, value in scene.start])
    starts[:8] = own + np.logspace(-9, -2, 8)[:, None]  # lanes that need fewer of Newton's steps than others
    x = initial_states(scene, starts, p)
    for k in range(0, 40, 8):
        held = {name: value for (name, _), value in zip(scene.start, starts[k])}
        if scene.start_at_rest:
            wanted = scene.varied_plant.equilibrium(held, p=p[k])[0]
        else:
            wanted = scene.plant.consistent(np.array([held.get(s.name, 0.0) for s in scene.plant.states]))
        np.testing.assert_allclose(x[k], wanted, atol=1e-12)
    for lanes in (1, 2, 3, 4, 5, 6, 7, 17):  # a lane's digits depend neither on its place nor on its company
        np.testing.assert_array_equal(initial_states(scene, starts[:lanes][::-1], p[:lanes][::-1])[::-1], x[:lanes])


def test_initial_states_without_balanced_inputs() -> None:
    """One angle held of two, no torque: the slower general search."""
    scene = scenes.get("two-link-reach", start=(("theta1", -np.pi / 2),))
    x = initial_states(scene, np.array([[-np.pi / 2]]), np.array([[0.4]]))[0]
    assert np.abs(scene.varied_plant.dynamics(x, p=[0.4])).max() < 1e-8


def test_initial_states_check_their_input() -> None:
    scene = scenes.get("two-link-reach")
    with pytest.raises(ValueError, match="starts has shape"):
        initial_states(scene, np.zeros((3, 1)), np.ones((3, 1)))
    with pytest.raises(ValueError, match="p has shape"):
        initial_states(scene, np.zeros((3, 2)), np.ones((2, 1)))
    with pytest.raises(ValueError, match="finite"):
        initial_states(scene, np.full((3, 2), np.nan), np.ones((3, 1)))
    soft = dataclasses.replace(scene.plant.link1, E=0.0 + 1e-6)
    limp = scene.with_plant(dataclasses.replace(scene.plant, link1=soft, kinematics="linear"))
    with pytest.raises(EquilibriumError):
        initial_states(limp, np.array([[0.3, 0.2]]), np.array([[0.5]]))


def test_a_rigid_arm_has_no_free_coordinates():
    """Its rest at any hub angle is that angle, by hand."""
    slew = scenes.get("single-link-slew")
    rigid = dataclasses.replace(slew, plant=slew.plant.ladder()[0], randomise=())
    starts = np.array([[0.1], [-0.2]])
    np.testing.assert_allclose(initial_states(rigid, starts, np.zeros((2, 0))), [[0.1, 0.0], [-0.2, 0.0]], atol=1e-14)
