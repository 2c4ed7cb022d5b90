"""What a scene is made into for learning: its reward, its sensors, delays and memory, what is drawn, what is told."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_period import enough_substeps
from pliant.plants import NominalWarning, Plant
from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_choice, require_count, require_flag, require_number, shown
from pliant.plants.sensing.sensors import sensors_of

from .actions import KINDS

Array = np.ndarray
REWARDS, CONSTRAINTS = ("cost", "normalised"), ("end", "cost")
DIFFICULTIES = (None, "nominal", "randomised", "hard")
MOST_DELAY, MOST_HISTORY = 1000, 100  # control periods
HARD_SPREAD, HARD_NOISE, HARD_DELAY = 0.3, 0.01, (0, 1)  # of what is uncertain; of a signal's range; periods
MOST_HOLD, MOST_FIDELITIES = 1000, 16
Delay = int | tuple[int, int]


class TaskKeywords(TypedDict, total=False):
    """The fields of `Task`, as environments take them."""

    reward: str
    difficulty: str | None
    sensors: bool
    noise: float
    action_delay: Delay
    observation_delay: Delay
    history: int
    goal_spread: float
    terms: bool
    constraint: str
    actions: str
    hold: int
    fidelities: Any


@dataclass(frozen=True, kw_only=True)
class Task:
    """Keywords of every environment of a scene, single, vector and Stable-Baselines3's.

    reward        "cost": minus what the scene charges. "normalised": in [0, 1], see `rewards`
    difficulty    "nominal": nothing is drawn. "randomised": what the scene draws, as `randomise=True`. "hard": also all
                  that the plant calls uncertain by +-30 %, readings with noise of 1 %, actions late by 0 or 1 period;
                  where `noise` or `action_delay` are given, those
    sensors       True: what is observed are the readings of the plant's own sensors, with a data sheet's noise
    noise         standard deviation of each reading, over the range of its signal in the scene's nominal motion
    action_delay, observation_delay
                  whole control periods from an action to its effect, and from a signal to where it is seen; a pair
                  (least, most) is drawn anew for each episode. Before the first action acts what holds the start
    history       so many former readings and actions follow the reading, newest first, readings before actions; at the
                  start of an episode the first reading, and zeros
    goal_spread   each coordinate of the goal is drawn within so much of the scene's own [its unit], a quaternion made
                  unit; where it is drawn, less the scene's, are the last observations. Pictures show the scene's own
    terms         True: info["reward_terms"] tells what each weighted signal and input adds to minus the stage cost
    constraint    "end": an episode ends where a bounded signal leaves its bound. "cost": it goes on, and
                  info["cost_constraint"] is 1 in a period that ends beyond, 0 in others
    actions       "limits": an action is an input over its limit. "midway": 0 is the input midway between what holds the
                  start and what holds the goal, 1 adds half of the limit, or what reaches both. "nominal": 1 adds 1.25
                  times the most that the scene's nominal inputs differ from there; see `actions`
    hold          so many control periods an action is held: rewards and costs of these are summed (a normalised reward
                  is their mean), readings are the last ones. Where an episode ends sooner, so does the step
    fidelities    models of the machine, of which each episode plays one that is drawn: labels of the plant's `ladder`,
                  words that these begin with ("rigid", "linear"; of several the one whose number of states is nearest
                  to the scene's plant's), "own", or plants; with {"rigid": 1.0, "own": 3.0} by these shares. Signals,
                  goal, cost and limits stay the scene's own; info["fidelity"] is the label, which `reset` takes as an
                  option
    """

    reward: str = "cost"
    difficulty: str | None = None
    sensors: bool = False
    noise: float | None = None
    action_delay: Any = None
    observation_delay: Any = 0
    history: int = 0
    goal_spread: float = 0.0
    terms: bool = False
    constraint: str = "end"
    actions: str = "limits"
    hold: int = 1
    fidelities: Any = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        require_choice("Task", "reward", self.reward, REWARDS)
        require_choice("Task", "difficulty", self.difficulty, DIFFICULTIES)
        require_choice("Task", "constraint", self.constraint, CONSTRAINTS)
        require_choice("Task", "actions", self.actions, KINDS)
        put(self, "sensors", require_flag("Task.sensors", self.sensors))
        put(self, "terms", require_flag("Task.terms", self.terms))
        hard = self.difficulty == "hard"
        noise = self.noise if self.noise is not None else HARD_NOISE if hard and not self.sensors else 0.0
        delay = self.action_delay if self.action_delay is not None else HARD_DELAY if hard else 0
        put(self, "noise", require_number("Task.noise", noise, "nonnegative"))
        put(self, "goal_spread", require_number("Task.goal_spread", self.goal_spread, "nonnegative"))
        put(self, "history", require_count("Task", "history", self.history, 0, MOST_HISTORY))
        put(self, "hold", require_count("Task", "hold", self.hold, 1, MOST_HOLD))
        put(self, "action_delay", _range("action_delay", delay))
        put(self, "observation_delay", _range("observation_delay", self.observation_delay))
        put(self, "fidelities", _shares(self.fidelities))

    def drawn(self, randomise: bool) -> bool:
        """Whether episodes are drawn. ValueError where `randomise` and the difficulty say otherwise."""
        if self.difficulty is None:
            return randomise
        if randomise and self.difficulty == "nominal":
            raise ValueError('Task.difficulty = "nominal" must be "randomised" or "hard" where randomise = True')
        return self.difficulty != "nominal"

    def played(self, scene: Scene) -> Scene:
        """The scene with what its sensors read as observations, and its ranges as the difficulty has them."""
        found = scene
        if self.sensors:
            found = dataclasses.replace(found, observe=tuple(sensor.output for sensor in sensors_of(found.plant)))
        if self.difficulty == "hard":
            found = _hard(found)
        return found

    def deviations(self, scene: Scene) -> Array:
        """Standard deviation (no,) of each reading of the scene as `played`, in its signal's unit."""
        found = np.zeros(len(scene.observe))
        if self.noise:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", NominalWarning)  # of the motion's range alone
                motion = scene.open_loop(method="rk4", step=scene.dt / scene.substeps)
            ranges = np.ptp(scene.signal_values(motion.x, motion.y, scene.observe), axis=0)
            # to three digits: the same on every machine and with every method of integration
            found = self.noise * np.array([float(f"{value:.3g}") for value in ranges])
        if self.sensors:
            own = [sensor.deviation(scene.dt) for sensor in sensors_of(scene.plant)]
            found = np.hypot(found, own)
        return found

    @property
    def plain(self) -> bool:
        """Whether readings and actions pass as they are."""
        late = (*self.action_delay, *self.observation_delay)
        return not (self.noise or self.sensors or self.history or self.goal_spread or any(late))


def _range(name: str, value: Any) -> tuple[int, int]:
    """A number of periods, or the least and the most of them, as a pair."""
    if isinstance(value, (tuple, list)):
        if len(value) != 2:
            raise ValueError(f"Task.{name} = {shown(value)} must be a number of periods or (least, most)")
        least, most = (require_count("Task", name, item, 0, MOST_DELAY) for item in value)
        if least > most:
            raise ValueError(f"Task.{name} = {shown(value)} must be (least, most), the least first")
        return least, most
    count = require_count("Task", name, value, 0, MOST_DELAY)
    return count, count


def _shares(value: Any) -> tuple[tuple[str | Plant, float], ...] | None:
    """Models of a machine, each by a word or itself, with its share of the episodes."""
    if value is None:
        return None
    pairs = list(value.items()) if isinstance(value, Mapping) else value
    if not isinstance(pairs, (tuple, list)) or not 1 <= len(pairs) <= MOST_FIDELITIES:
        raise ValueError(
            f"Task.fidelities = {shown(value)} must be 1 to {MOST_FIDELITIES} labels or plants, or shares of these, or "
            "None"
        )
    found = []
    for pair in pairs:
        what, share = pair if isinstance(pair, (tuple, list)) and len(pair) == 2 else (pair, 1.0)
        if not isinstance(what, (str, Plant)):
            raise ValueError(f"Task.fidelities: {shown(what)} must be a label of the plant's ladder, or a plant")
        name = what if isinstance(what, str) else what.label
        found.append((what, require_number(f"Task.fidelities[{name!r}]", share, "positive")))
    return tuple(found)


def _hard(scene: Scene) -> Scene:
    """The scene with all that its plant calls uncertain drawn too, and as many substeps as that takes."""
    plant = scene.plant
    own = {path: (low, high) for path, low, high in scene.randomise}
    for path in plant.uncertain:
        if parameters.get(plant, path):
            own[path] = (1.0 - HARD_SPREAD, 1.0 + HARD_SPREAD)
    return enough_substeps(dataclasses.replace(scene, randomise=tuple((path, *pair) for path, pair in own.items())))
