"""Scenes: fields checked, cost by hand, documented tables true, random starts at rest and reproducible."""

import dataclasses
import pickle
import re

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.simulation.episode_start import draw, initial_states
from pliant.plants import EquilibriumError, Trajectory
from pliant.plants.core.minimum_jerk import minimum_jerk

NAMES = scenes.names()
WORDS = {"sag": "deflection", "hanging": "", "speed": "angle_rate"}  # in place of a goal's number: ending of the signal


def table_rows(scene_name: str) -> dict[str, list[list[str]]]:
    """The Markdown tables of a scene's docstring: {first heading: rows of cells}."""
    found: dict[str, list[list[str]]] = {}
    for block in re.split(r"\n\s*\n", scenes.SCENES[scene_name].__doc__ or ""):
        rows = [[c.strip() for c in line.strip().strip("|").split("|")] for line in block.splitlines() if "|" in line]
        if rows:
            found[rows[0][0]] = rows[2:]
    return found


@pytest.mark.parametrize("name", NAMES)
def test_documented_tables_are_the_scene(name: str) -> None:
    scene, tables = scenes.get(name), table_rows(name)
    units = {s.name: s.unit for s in scene.signals + scene.plant.inputs}
    assert list(tables) == ["observation", "action", "cost of the deviation in", "ends beyond"]
    assert all(row[1] == units[row[0].split(" - ")[0]] for rows in tables.values() for row in rows)

    goals = dict(zip(scene.observe, scene.goal_values(scene.observe)))
    assert [row[0].split(" - ")[0] for row in tables["observation"]] == list(scene.observe)
    for cell, *_ in tables["observation"]:
        signal, _, goal = cell.partition(" - ")
        if goal in WORDS:
            assert signal.endswith(WORDS[goal]) and abs(goals[signal]) > 1e-3
        else:
            assert goals[signal] == pytest.approx(float(goal or 0.0), abs=1e-12)
    assert [(n, float(low), float(high)) for n, _, low, high in tables["action"]] == [
        (s.name, -limit, limit) for s, limit in zip(scene.plant.inputs, scene.limits)
    ]
    assert [(n, float(v)) for n, _, v in tables["cost of the deviation in"]] == [
        *scene.weights,
        *scene.effort,
    ]
    assert [(n, float(v)) for n, _, v in tables["ends beyond"]] == list(scene.bounds)
    said = scenes.SCENES[name].__doc__ or ""
    assert re.search(rf"\b(in|for) {scene.duration:g} s\b", said) and f"control period {scene.dt:g} s" in said


def test_cost_of_a_constant_motion_by_hand() -> None:
    """Held at x with a constant torque: duration times the weighted squares."""
    scene = scenes.get("single-link-slew")
    t = scene.times
    x = np.zeros((len(t), scene.plant.nx))
    x[:, 0], x[:, 3] = 0.4, 0.5  # hub angle and its rate
    u = np.full((len(t), 1), 7.0)
    motion = Trajectory.from_arrays(t, x, u, plant=scene.plant)
    by_hand = 3.0 * (10.0 * 0.6**2 + 0.1 * 0.5**2 + 2e-3 * 7.0**2)
    assert scene.cost(motion) == pytest.approx(by_hand, rel=1e-12)


def test_early_end_rate_by_hand() -> None:
    """Unbounded angle at its start and spread, bounded signals at their bounds, the torque at its limit."""
    by_hand = 10.0 * 1.1**2 + 0.1 * 12.0**2 + 100.0 * 0.3**2 + 0.1 * 0.0 + 2e-3 * 40.0**2
    assert scenes.get("single-link-slew").early_end_rate == pytest.approx(by_hand, rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_overrides_and_pickle(name: str) -> None:
    short = max(0.5, 2 * scenes.get(name).dt)
    scene = scenes.get(name, duration=short)
    assert scene.steps == round(short / scene.dt) and scenes.get(name).duration >= 1.0
    assert scene.nominal_input(0.1).shape == (scene.plant.nu,)  # caches a closure, which must not travel
    assert pickle.loads(pickle.dumps(scene)) == scene


def test_minimum_jerk_derivatives() -> None:
    s, h = np.linspace(0.1, 0.9, 9), 1e-5
    for k in (0, 1):
        slope = (minimum_jerk(s + h)[k] - minimum_jerk(s - h)[k]) / (2 * h)
        np.testing.assert_allclose(slope, minimum_jerk(s)[k + 1], atol=1e-8)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"limits": (40.0,)}, "limits"),
        ({"limits": (0.0, 1.0)}, "limits"),
        ({"substeps": 0}, "substeps"),
        ({"dt": -0.1}, "dt"),
        ({"duration": 0.001}, "duration"),
        ({"bounds": (("theta1_rate", 0.0),)}, "bounds theta1_rate = 0.0"),
        ({"bounds": (("theta9", 1.0),)}, "theta9"),
        ({"weights": (("theta1", -1.0),)}, "weights theta1 = -1.0"),
        ({"start": (("theta1", np.nan),)}, "start theta1 = nan"),
        ({"effort": (("tau1", 0.0),)}, "effort tau1"),
        ({"observe": ("tip_z",)}, "tip_z"),
        ({"randomise": (("payload.colour", 0.5, 2.0),)}, "colour"),
        ({"randomise": (("payload.mass", 2.0, 0.5),)}, "payload.mass"),
        ({"start_spread": -0.1}, "start_spread"),
        ({"spreads": (("theta1", -0.1),)}, "spreads theta1 = -0.1"),
        ({"goal_rates": (("tip_x", 0.1),)}, "tip_x"),
        ({"nominal_start": (("theta9", 0.1),)}, "theta9"),
        ({"colour": 3}, "colour"),
    ],
)
def test_bad_fields_are_named(changes: dict, says: str) -> None:
    with pytest.raises(ValueError, match=re.escape(says)):
        scenes.get("two-link-reach", **changes)


def test_unknown_scene_lists_the_known() -> None:
    with pytest.raises(ValueError, match="single-link-slew"):
        scenes.get("three-link-reach")


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
