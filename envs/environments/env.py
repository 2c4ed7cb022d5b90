"""A scene as a Gymnasium environment, and its registered id."""

from __future__ import annotations

from typing import Any, Unpack, cast

import gymnasium
import numpy as np
from gymnasium import spaces

from pliant.envs.mixtures import MixedStarts, Mixture
from pliant.envs.rendering import Renderer, renderer
from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.control_period import check_substep, reach_function
from pliant.envs.simulation.cost_terms import cost_terms, term_names
from pliant.envs.simulation.episode_start import early_end_cost
from pliant.envs.simulation.lane_starts import LaneStarts
from pliant.envs.tasks import Channel, Task, TaskKeywords, normalised, shares
from pliant.envs.tasks.infos import of_both_infos
from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_flag
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.native.batch_kernels import as_dtype
from pliant.plants.validity.ranges import left_at

from . import arguments
from .specification import Specified

NO_LANES, ONE = np.zeros(0, dtype=int), np.zeros(1, dtype=int)


class PlantEnv(Specified, OwnsArrays, gymnasium.Env[np.ndarray, np.ndarray]):
    """Drive a scene's plant from its start to its goal.

    | what        | is                                                             | unit, range          |
    |-------------|----------------------------------------------------------------|----------------------|
    | action      | inputs over scene.limits, float32; clipped to its range        | [-1, 1]              |
    | observation | scene.observe less their values at the goal, `dtype`           | the signals' own     |
    | reward      | -dt * stage cost at the period's start, with the clipped input | what Scene.cost sums |
    | terminated  | a bounded signal left its bound, or the state diverged         | scene.bounds         |
    | truncated   | the time is over                                               | scene.steps periods  |

    Signal by signal, with units: the docstring of each scene in pliant.envs.scenes.SCENES. Goal values are
    those of the scene's own plant, also where parameters are drawn.

    Ending early does not pay: the last reward also charges, for every period left, dt times
    (scene.early_end_rate + the stage cost of that last period). A diverged state is not shown: the last
    finite observation comes again.

    info: "cost" what the scene charges, -reward unless `reward="normalised"`; "early_end_cost" the part of it charged
    for the time left; "cost_constraint" 1 where a bound is left, else 0 (what Safety-Gymnasium calls cost); "diverged";
    "parameters", the values of the randomised parameters by name. "validity" is there only where the state lies outside
    a range of plant.validity: for each, farthest first, its quantity, size, range and the kinematics that hold.

    randomise  False: the scene's own start and parameters, every episode the same. True: both drawn at each
               reset from `np_random` alone, uniformly within scene.start_spread and scene.randomise's factors
    task       what else a scene can be made into: `reward="normalised"`, sensors with their noise, delays, memory,
               drawn goals, `difficulty`; see `Task`
    options of reset: "state" (nx,) to start from, "parameters" by name, each instead of what was drawn; where
               fidelities are drawn, no "state" but "fidelity", which info has too

    `gymnasium.make(..., max_episode_steps=n)` ends episodes after n actions, where that is sooner than the scene does.
    A longer one does not lengthen them: make the environment of a scene with a longer `duration`.
    """

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 50}  # noqa: RUF012

    def __init__(
        self,
        scene: str | Scene,
        *,
        randomise: bool = False,
        dtype: type | str = np.float64,
        render_mode: str | None = None,
        **task: Unpack[TaskKeywords],
    ) -> None:
        self.task = made = Task(**task)
        self.scene = scene = made.played(arguments.require_scene("PlantEnv", scene))
        parameters.require_choice("PlantEnv", "render_mode", render_mode, (None, *self.metadata["render_modes"]))
        kind = as_dtype(dtype, "PlantEnv")
        self.randomise, self.render_mode = made.drawn(require_flag("PlantEnv.randomise", randomise)), render_mode
        self.metadata = {**self.metadata, "render_fps": max(1, round(1 / (made.hold * scene.dt)))}
        self.action_space = spaces.Box(-1.0, 1.0, (scene.plant.nu,), np.float32)
        self._channel = None if made.plain else Channel(scene, made, 1)
        width = len(scene.observe) if self._channel is None else self._channel.width
        self.observation_space = spaces.Box(-np.inf, np.inf, (width,), kind.type)
        self._dtype = kind.type
        check_substep(scene, self.randomise)
        self._mixture = None if made.fidelities is None else Mixture(scene, made.fidelities, 1)
        self._starts = LaneStarts(scene, 1) if self._mixture is None else MixedStarts(self._mixture)
        played = (scene,) if self._mixture is None else self._mixture.scenes
        self._steps_on = [ControlStep(own, 1, kind, threads=1, alike=True, goal=scene) for own in played]
        self._step = self._steps_on[0]
        self._idle, self._steps = np.zeros(scene.plant.nu), scene.steps
        self._over, self._begun, self._renderer = True, False, cast(Renderer | None, None)

    def _require_begun(self, asked: str) -> None:
        if not self._begun:
            raise gymnasium.error.ResetNeeded(f"PlantEnv.{asked}: no episode has begun; call reset first")

    @property
    def state(self) -> np.ndarray:
        """The plant's state x (nx,), a copy. ResetNeeded before the first reset."""
        self._require_begun("state")
        return self._x.astype(float)

    @property
    def time(self) -> float:
        """Time since the episode's start [s]. ResetNeeded before the first reset."""
        self._require_begun("time")
        return self._done * self.scene.dt

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode; see the class for what `options` may hold. `seed` is an integer >= 0, or None.

        The observation (n,), in the units of the class's table.
        """
        owner, scene = "PlantEnv.reset", self.scene
        seed = arguments.require_seed(owner, seed)
        mixture, options = self._mixture, arguments.require_options(owner, options, arguments.known(self._mixture))
        given = arguments.require_start(owner, scene, options, mixture)  # all is checked before anything changes
        super().reset(seed=seed)
        if mixture is not None and seed is not None:
            mixture.seed(ONE, [seed])
        begun = self._starts.begin(ONE, self.randomise, [given] if given else None, lambda: self.np_random)
        step = self._step = self._steps_on[0 if mixture is None else mixture.rung[0]]
        x, obs, w, p = begun[0][0, : len(step.x)], *(rows[0] for rows in begun[1:])
        step.x[:], step.w[:], step.p[:] = x[:, None], w[:, None], p[:, None]
        self._x, self._u = x.astype(self._dtype), self._idle
        self._drawn = dict(zip(self._starts.names, p.astype(self._dtype).tolist()))  # those it is played with
        self._done, self._over, self._begun, self._total = 0, False, True, 0.0
        self._obs = obs.astype(self._dtype)
        self._seen = self._obs if self._channel is None else self._first_seen(self._channel, seed)
        if self._renderer is not None:
            self._renderer.clear()
        if self.render_mode == "human":
            self.render()
        return self._seen.astype(self._dtype), self._info(0.0, 0.0, False, _reach(step.scene)(x, self._idle, w, p)[0])

    def _first_seen(self, channel: Channel, seed: int | None) -> np.ndarray:
        """What is read first of an episode; a seed, or the first episode, begins the channel's random numbers."""
        if seed is not None or channel.unseeded(ONE):
            channel.seed(ONE, [seed if seed is not None else self.np_random.integers(2**62)])
        shown, references = channel.begin(ONE, self._obs[None].astype(float))
        if references is not None:
            for step in self._steps_on:
                step.aim(np.arange(step.lanes), np.repeat(references, step.lanes, axis=0))
        return shown[0].astype(self._dtype)

    def _info(self, cost: float, early: float, diverged: bool, reach: np.ndarray) -> dict[str, Any]:
        info: dict[str, Any] = {"cost": cost, "early_end_cost": early, "diverged": diverged}
        info |= {"cost_constraint": 0.0, "parameters": self._drawn.copy()}
        if self._mixture is not None:
            info["fidelity"] = str(self._mixture.labels[self._mixture.rung[0]])
        if reach[0] > 1.0 and not diverged:
            info["validity"] = _left(self._step, self.time, self._u)
        return info

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Hold `action` (nu,) for `task.hold` control periods; see the class for what comes back."""
        if self._over:
            raise gymnasium.error.ResetNeeded("PlantEnv.step: no episode is running; call reset first")
        task = self.task
        action = arguments.require_actions("PlantEnv.step", "action", action, self._idle.shape).astype(float)
        action = shares(self.scene, task.actions, action)
        reward, terminated, info = self._period(action)
        for _ in range(1, task.hold):
            if not self._over:
                more, terminated, later = self._period(action)
                reward, info = reward + more, of_both_infos(info, later)
        if task.reward != "cost":
            reward /= task.hold
        seen = self._obs if self._channel is None else self._seen
        return seen.copy(), reward, terminated, self._over and not terminated, info

    def _period(self, action: np.ndarray) -> tuple[float, bool, dict[str, Any]]:
        """(reward, whether the episode ended early, info) of one control period."""
        step, channel, task = self._step, self._channel, self.task
        if channel is not None:
            action = channel.act(action[None])[0]
        step.action[:] = action[:, None]
        step.begin(self._done)
        terms = _terms(step, action) if task.terms else None
        unsound, outside = step.run()
        diverged, cost, early, beyond = bool(unsound[0]), float(step.cost[0]), 0.0, bool(outside[0])
        self._done += 1
        terminated = diverged or (beyond and task.constraint == "end")
        reward = None if task.reward == "cost" else float(normalised(self.scene, step.cost[0], terminated))
        if terminated:
            early = early_end_cost(self.scene, self._done, cost)
            cost += early
        if not diverged:
            self._x, self._obs, self._u = step.x[:, 0].copy(), step.obs[:, 0].copy(), action
        self._over = terminated or self._done == self._steps
        self._total += cost
        if self.render_mode == "human":
            self.render()
        info = self._info(cost, early, diverged, step.reach)
        info["cost_constraint"] = float(beyond or diverged)
        if terms is not None:
            info["reward_terms"] = terms
        if channel is not None:
            self._seen = channel.see(self._obs[None], NO_LANES)[0].astype(self._dtype)
        return 0.0 - cost if reward is None else reward, terminated, info  # no -0 where nothing is charged

    def render(self) -> np.ndarray | None:
        """The plant, its goal and its tip's path: an image (height, width, 3) uint8, or drawn in a window."""
        if self.render_mode is None:
            gymnasium.logger.warn('PlantEnv.render: make the environment with render_mode="rgb_array" or "human"')
            return None
        self._require_begun("render")
        played = self._step.scene
        if self._renderer is not None and self._renderer.scene is not played:  # another model is played
            self.close()
        if self._renderer is None:
            self._renderer = renderer(played, window=self.render_mode == "human")
        return self._renderer.draw(self._x, self._u, self.time, self._total)

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


@once_per_scene
def _reach(scene: Scene) -> NumericFunction:
    return NumericFunction(reach_function(scene))


def _left(step: ControlStep, time: float, action: np.ndarray) -> list[dict[str, Any]]:
    """The ranges of the plant's validity that are left, farthest first."""
    u = np.clip(action, -1.0, 1.0) * step.scene.limits
    x, w, p = (a[:, 0].astype(float) for a in (step.x, step.w, step.p))
    return [left.to_json() for left in left_at(step.scene.varied_plant, time, x, u, w=w, p=p)]


def _terms(step: ControlStep, action: np.ndarray) -> dict[str, float]:
    """What each term adds to minus the stage cost of the period that begins."""
    scene = step.scene
    u = (np.clip(action, -1.0, 1.0) * scene.limits)[None]
    x, ref, w, p = (a[:, :1].T.astype(float) for a in (step.x, step.ref, step.w, step.p))
    names = term_names(scene)  # none where nothing is weighed
    return dict(zip(names, (0.0 - cost_terms(scene)(x, u, ref, w, p)[0][0]).tolist())) if names else {}
