"""A scene: a plant, a manoeuvre, limits, a cost and a tolerance.

Controllers are scored on it, environments wrap it, the speed-accuracy chart runs it. It names signals, never indices,
so that every fidelity of its plant can play it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, wraps
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from pliant.plants import LinearModel, Plant, Signal, Trajectory
from pliant.plants.core.argument_gates import require_instance, require_names
from pliant.plants.core.parameters import quantity, validate
from pliant.plants.core.signals import index, owned, sealed
from pliant.plants.files.html_tables import SceneTable
from pliant.plants.integration.minimum_jerk import minimum_jerk
from pliant.plants.linear.quadratic_cost import (
    QuadraticCost,
    about_moving_goal,
    following,
    quadratic_cost,
    require_still,
)
from pliant.plants.motions.tabulated_inputs import tabulated

from . import cost
from .checks import checked, rest_point, rows
from .nominal_inputs import nominal_input, steady_motion, told

if TYPE_CHECKING:
    kept_property = property  # what checkers compare with the properties of a protocol
else:
    kept_property = cached_property

Pairs = tuple[tuple[str, float], ...]
Drive = Callable[[Plant, float], np.ndarray]
R = TypeVar("R")

ENVIRONMENTS: dict[str, Callable[..., Any]] = {}  # "vector", "sb3", "puffer", ..: made of a scene by rooms below
__all__ = ["Scene", "minimum_jerk", "once_per_scene"]


def once_per_scene(build: Callable[[Scene], R]) -> Callable[[Scene], R]:
    """Keep what a function makes of a scene with the scene: hashing one takes longer than most that it is used for."""
    key = f"{build.__module__}.{build.__qualname__}"

    @wraps(build)
    def made(scene: Scene) -> R:
        if key not in scene.__dict__:
            scene.__dict__[key] = build(scene)
        return scene.__dict__[key]

    return made


@dataclass(frozen=True, kw_only=True)
class Manoeuvre:
    """The fields of a scene, and what their names and numbers stand for."""

    name: str
    about: str
    plant: Plant
    start: Pairs
    goal: Pairs
    nominal_start: Pairs | None = None  # of the motion that linear models are made along; None: `start`
    start_at_rest: bool = True
    goal_at_rest: bool = True
    goal_rates: Pairs = ()  # [the state's unit/s]; states that no output shows
    drive: Drive | None = None  # (plant, t) -> nominal input (nu,); None: a minimum-jerk motion of the rigid plant
    duration: float = quantity("s", "positive")
    dt: float = quantity("s", "positive", 0.02)  # control period
    substeps: int = 10  # RK4 steps a control period
    move_time: float = quantity("s", "positive", 1.0)  # of the nominal motion from start to goal
    limits: tuple[float, ...]  # largest |u|, in each input's own unit
    bounds: Pairs = ()  # largest |output| [its unit]; beyond it the episode ends
    weights: Pairs = ()
    effort: Pairs = ()
    observe: tuple[str, ...] = ()
    randomise: tuple[tuple[str, float, float], ...] = ()  # parameter, smallest and largest factor
    gusts: Pairs = ()  # largest |disturbance|, constant over an episode, where episodes are randomised
    start_spread: float = quantity("rad", "nonnegative", 0.0)  # uniform, on every coordinate of `start` ..
    spreads: Pairs = ()  # .. but on these [its unit]
    compare: tuple[str, ...] = ("tip_x", "tip_y")  # outputs whose error the chart measures
    tolerance: float = quantity("the unit of compare", "positive", 1e-3)  # largest error of those that it can bear

    @property
    def signals(self) -> tuple[Signal, ...]:
        """What bounds, weights, observe and compare may name: the plant's states, then its outputs."""
        return self.plant.states + self.plant.outputs

    @property
    def unit(self) -> str:
        """Of the compared signals, and so of the tolerance."""
        return self.signals[self.positions(self.compare[:1])[0]].unit

    @cached_property
    def largest_gusts(self) -> np.ndarray:
        """Largest |disturbance| of a randomised episode, shape (nw,)."""
        found = np.zeros(self.plant.nw)
        for name, value in self.gusts:
            found[index(self.plant.disturbances, name, "disturbance")] = value
        return found

    @property
    def spread(self) -> np.ndarray:
        """Largest |deviation| of the start (len(start),) of a randomised episode, each in its own unit."""
        own = dict(self.spreads)
        return np.array([own.get(name, self.start_spread) for name, _ in self.start])

    @property
    def steps(self) -> int:
        """Control periods in an episode."""
        return round(self.duration / self.dt)

    @property
    def times(self) -> np.ndarray:
        """Control times (steps + 1,) [s]."""
        return self.dt * np.arange(self.steps + 1)

    @cached_property
    def varied_plant(self) -> Plant:
        """The plant with the randomised parameters as inputs p, in the order of `randomise`."""
        return self.plant.vary(*(path for path, _, _ in self.randomise))

    @kept_property
    def initial(self) -> tuple[np.ndarray, np.ndarray]:
        """(x, u) at the start: at rest, deflections in equilibrium, or as given."""
        return rest_point(self, "start") if self.start_at_rest else self._given(self.start)

    @cached_property
    def nominal_initial(self) -> tuple[np.ndarray, np.ndarray]:
        """(x, u) at the start of the motion that linear models are made along."""
        return self.initial if self.nominal_start is None else self._given(self.nominal_start)

    @kept_property
    def target(self) -> tuple[np.ndarray, np.ndarray]:
        """(x, u) at the goal: at rest, deflections in equilibrium, or as given."""
        return rest_point(self, "goal") if self.goal_at_rest else self._given(self.goal)

    def _given(self, values: Pairs) -> tuple[np.ndarray, np.ndarray]:
        return self.plant.consistent(self._by_state(values)), np.zeros(self.plant.nu)

    def _by_state(self, values: Pairs) -> np.ndarray:
        """(nx,): the named states as given, the others zero."""
        found = np.zeros(self.plant.nx)
        for name, value in values:
            found[index(self.plant.states, name, f"scene {self.name!r}: state")] = value
        return found

    @cached_property
    def drift(self) -> np.ndarray:
        """d(goal)/dt (nx,): zero but for `goal_rates`."""
        return self._by_state(self.goal_rates)

    @cached_property
    def _following(self) -> frozenset[str]:
        return following(self.plant, *self.target, self.drift) if self.goal_rates else frozenset()

    def positions(self, names: Iterable[str], *, owner: str = "positions.names") -> list[int]:
        """Where the named signals stand in the vector [x; y]; `owner` is what errors call the names."""
        return [index(self.signals, name, f"{owner}: signal") for name in require_names(owner, names, repeated=True)]

    def signal_values(self, x: np.ndarray, y: np.ndarray, names: tuple[str, ...]) -> np.ndarray:
        """The named states or outputs (..., k) from x (..., nx) and y (..., ny)."""
        places = self.positions(names, owner="signal_values.names")
        x, y = rows("signal_values", x=(x, self.plant.nx), y=(y, self.plant.ny))
        return np.concatenate([x, y], axis=-1)[..., places]

    def goal_values(self, names: tuple[str, ...]) -> np.ndarray:
        """The named states or outputs (k,) at the goal, at t = 0, each in its unit."""
        x, u = self.target
        return np.concatenate([x, self.plant.measure(x, u)])[self.positions(names, owner="goal_values.names")]

    def goal_drift(self, names: tuple[str, ...]) -> np.ndarray:
        """d/dt of `goal_values` (k,): of states as in `goal_rates`; ValueError for outputs that follow these."""
        names = require_names("goal_drift.names", names, repeated=True)
        require_still(f"scene {self.name!r}", self._following, names)
        return np.concatenate([self.drift, np.zeros(self.plant.ny)])[self.positions(names, owner="goal_drift.names")]


@dataclass(frozen=True, kw_only=True)
class Scene(Manoeuvre, SceneTable):
    """Drive `plant` from `start` to `goal`, at least cost, within limits.

    Start and goal name coordinates of rest points; joints not named are at zero, what no input drives in equilibrium.
    Or, not `at rest`, they name states, the others zero: a beam let go, a hub that spins. Quaternions are made unit.
    A goal may move steadily: `goal_rates` of its states, from their values at t = 0.

    Cost [-]  sum over control periods of
              dt (sum_i weights_i (z_i - z_i,goal)^2 + sum_j effort_j (u_j - u_j,goal)^2),
              z any states or outputs by name; reward is minus that.
    """

    def __post_init__(self) -> None:
        validate(self)
        for name, value in checked(self).items():
            object.__setattr__(self, name, value)

    def with_plant(self, plant: Plant) -> Scene:
        """The same scene played by another fidelity."""
        return dataclasses.replace(self, plant=require_instance("with_plant.plant", plant, Plant))

    @property
    def weighted(self) -> tuple[str, ...]:
        """The signals that the cost weighs."""
        return tuple(name for name, _ in self.weights)

    @property
    def priced_inputs(self) -> list[int]:
        """Which inputs the cost weighs."""
        return [index(self.plant.inputs, name, "input") for name, _ in self.effort]

    def cost_rate(self, errors: Iterable[Any], excess: Iterable[Any]) -> Any:
        """Cost rate [1/s] from deviations, `errors` of weighted signals, `excess` of inputs: numbers, arrays, SX."""
        return cost.weighed((*self.weights, *self.effort), (*errors, *excess))

    @cached_property
    def cost_origin(self) -> tuple[np.ndarray, np.ndarray]:
        """Values at the goal, at t = 0, of the weighted signals (nz,) and of the priced inputs (k,)."""
        return self.goal_values(self.weighted), self.target[1][self.priced_inputs]

    def stage_cost(self, x: np.ndarray, u: np.ndarray, y: np.ndarray, t: Any = 0.0) -> Any:
        """Cost rate [1/s] at x (..., nx), u (..., nu), y (..., ny) and t (...), which matters where the goal moves."""
        return cost.stage_cost(self, x, u, y, t)

    @kept_property
    def early_end_rate(self) -> float:
        """Cost rate [1/s] added for the time left when an episode ends early, so that ending does not pay."""
        return cost.early_end_rate(self)

    def cost(self, motion: Trajectory) -> float:
        """The scene's cost of a motion sampled at the control times; no unit but that of the weights."""
        return cost.of_motion(self, motion)

    @cached_property
    def goal_model(self) -> LinearModel:
        """The plant's linear model at the goal, f0 less what the goal itself moves at."""
        return about_moving_goal(self.plant.linearize(*self.target), dict(self.goal_rates))

    @cached_property
    def feedback_model(self) -> LinearModel:
        """`goal_model` in states that can be read by name: a spacecraft's attitude outputs, none where it spins."""
        return about_moving_goal(self.plant.feedback_model(*self.target), dict(self.goal_rates))

    def quadratic(self) -> QuadraticCost:
        """Q (n, n), R (nu, nu), N (n, nu): `stage_cost` about the goal, x'Qx + u'Ru + 2 x'Nu, `feedback_model`'s x."""
        return quadratic_cost(self.feedback_model, dict(self.weights), dict(self.effort))

    @kept_property
    def nominal_input(self) -> Callable[[float], np.ndarray]:
        """u(t) (nu,) of the open-loop motion: `drive`, or what takes the rigid plant along a minimum-jerk motion.

        The same inputs drive every fidelity in the speed-accuracy chart. Warns (NominalWarning) beyond `limits`.
        """
        return nominal_input(self)

    def open_loop(self, **options: Any) -> Trajectory:
        """The motion under `nominal_input`; options as in Plant.simulate. NominalWarning where it misses the goal."""
        return told(self, self.plant.simulate(self.initial[0], self.nominal_input, self.times, **options))

    def nominal_motion(self, **options: Any) -> Trajectory:
        """As `open_loop`, from `nominal_start`; inputs that are dear to evaluate come from a table."""
        u = tabulated(self.nominal_input)
        return told(self, self.plant.simulate(self.nominal_initial[0], u, self.times, **options))

    def goal_motion(self) -> Trajectory:
        """The goal as a motion: over one turn where it turns steadily, else at the control times."""
        return steady_motion(self)

    def vector_env(self, num_envs: int, *, randomise: bool = False, **options: Any) -> Any:
        """`num_envs` lanes of this scene as a Gymnasium vector environment, PlantVectorEnv; keywords as there."""
        return ENVIRONMENTS["vector"](self, num_envs, randomise=randomise, **options)

    def sb3_env(self, num_envs: int, *, randomise: bool = False, **options: Any) -> Any:
        """`num_envs` lanes of this scene for Stable-Baselines3, a PlantVecEnv. ImportError without it."""
        return ENVIRONMENTS["sb3"](self, num_envs, randomise=randomise, **options)

    def puffer_env(self, num_envs: int, **options: Any) -> Any:
        """`num_envs` lanes of this scene for PufferLib, a PlantPufferEnv. ImportError without it."""
        return ENVIRONMENTS["puffer"](self, num_envs, **options)

    def differentiable(self, module: Any, lanes: int = 1) -> Any:
        """Rollouts of so many `lanes` with exact gradients, of the module torch or jax that is given.

        >>> import torch; scene.differentiable(torch, lanes=2).lanes
        2
        """
        return ENVIRONMENTS["differentiable"](self, module, lanes)

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: sealed(getattr(self, f.name)) for f in dataclasses.fields(self)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(owned(state))
