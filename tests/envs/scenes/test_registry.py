"""Scenes: fields checked, cost by hand, documented tables true, random starts at rest and reproducible."""

import pickle
import re

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants.integration.minimum_jerk import minimum_jerk

NAMES = scenes.names()
WORDS = {"sag": "deflection", "hanging": "", "speed": "angle_rate"}  # in place of a goal's number: in the signal's name


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
            assert WORDS[goal] in signal and abs(goals[signal]) > 1e-5
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


def test_unknown_scene_lists_the_known() -> None:
    with pytest.raises(ValueError, match="single-link-slew"):
        scenes.get("three-link-reach")
