"""Scenes: fields checked, cost by hand, documented tables true, random starts at rest and reproducible."""

import dataclasses
import pickle
import re

import gymnasium
import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.scenes import registry
from pliant.plants.core import imports
from pliant.plants.integration.minimum_jerk import minimum_jerk

NAMES = tuple(scenes.SCENES)
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
    returns = tables.pop("policy")  # held against the pages' in tests/studies/scene_pages
    assert [row[0] for row in returns][-3:] == ["LQR", "zero actions", "random actions"]
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


@pytest.fixture
def own(monkeypatch):
    """A scene of one's own, and a registry that forgets it."""
    monkeypatch.setattr(registry, "_registered", {})
    monkeypatch.setattr(registry, "_made", dict(registry._made))
    monkeypatch.setattr(gymnasium.envs.registration, "registry", dict(gymnasium.registry))
    monkeypatch.setattr(gymnasium, "registry", gymnasium.envs.registration.registry)
    return dataclasses.replace(scenes.get("two-link-reach"), name="far-reach", duration=4.0)


def test_a_registered_scene_has_its_name_and_its_environment(own) -> None:
    scenes.register(own)
    scenes.register(dataclasses.replace(own))  # an equal one: nothing changes
    assert scenes.names()[-1] == "far-reach" and scenes.get("far-reach") == own
    assert gymnasium.make("pliant/FarReach-v0").unwrapped.scene == own
    longer = dataclasses.replace(own, duration=5.0)
    with pytest.raises(ValueError, match="'far-reach' is another scene's, must be new unless replace=True"):
        scenes.register(longer)
    scenes.register(longer, replace=True)
    assert gymnasium.make("pliant/FarReach-v0").unwrapped.scene is longer is scenes.get("far-reach")


def test_names_that_no_folder_or_environment_could_have_are_refused(own) -> None:
    for name in ("Far", "../far", "far reach", "far--reach", "a" * 101):
        with pytest.raises(ValueError, match=r"register: scene.name = .* must be words of a-z"):
            scenes.register(dataclasses.replace(own, name=name))
    with pytest.raises(ValueError, match="must have a name of its own"):
        scenes.register(scenes.get("two-link-reach"))
    scenes.register(dataclasses.replace(own, name="a-1b"))
    with pytest.raises(ValueError, match=r"'a1b': its environment 'pliant/A1b-v0' is that of 'a-1b'"):
        scenes.register(dataclasses.replace(own, name="a1b"))


class Entry:
    """As an installed package's entry point."""

    def __init__(self, name, found):
        self.name, self.found, self.value, self.dist = name, found, "cranes:it", None

    def load(self):
        if isinstance(self.found, Exception):
            raise self.found
        return self.found


def test_scenes_of_packages_are_known_by_their_entry_points(own, monkeypatch) -> None:
    broken = ImportError("no module named 'x'")
    entries = [Entry("far-reach", own), Entry("near-reach", lambda mass=1.0: own), Entry("broken", broken)]
    entries += [Entry("two-link-reach", broken), Entry("Bad Name", own), Entry("number", 3)]
    monkeypatch.setattr(imports.metadata, "entry_points", lambda group: entries)
    imports.offered.cache_clear()
    try:
        assert scenes.names()[len(scenes.SCENES) :] == ("far-reach", "near-reach", "broken", "number")
        assert scenes.get("far-reach") == own and registry.keywords("near-reach") == {"mass": 1.0}
        for name, words in (("near-reach", "calls itself 'far-reach'"), ("broken", "'broken' of package .* no module")):
            with pytest.raises(ValueError, match=words):
                scenes.get(name)
        with pytest.raises(ValueError, match="= 3 must be a Scene or make one"):
            scenes.get("number")
    finally:
        monkeypatch.undo()
        imports.offered.cache_clear()
