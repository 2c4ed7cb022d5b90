"""Many environments of one scene at once: dynamics, observation, cost and limits of the whole batch in one kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from pliant.envs.mixtures import MixedStarts, MixedStep, Mixture
from pliant.envs.rendering import Renderer
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.lane_starts import LaneStarts
from pliant.envs.tasks import Channel, Task, TaskKeywords, infos
from pliant.envs.tasks.actions import placed
from pliant.plants.core.argument_gates import require_choice, require_count, require_flag
from pliant.plants.native.batch_kernels import FEW, as_dtype
from pliant.plants.native.thread_pool import available

from . import arguments
from .held_periods import HeldPeriods

Array = np.ndarray
MODES = tuple(AutoresetMode)
NO_LANES = np.zeros(0, dtype=int)


class PlantVectorEnv(HeldPeriods):
    """`num_envs` lanes of a scene; see PlantEnv for action, observation, reward and the ends of an episode.

    | what         | is                                                                        | shape            |
    |--------------|---------------------------------------------------------------------------|------------------|
    | actions      | inputs over scene.limits, clipped to [-1, 1]                              | (num_envs, nu)   |
    | observations | scene.observe less their values at the goal, `dtype`                      | (num_envs, no)   |
    | rewards      | -dt * stage cost, and the charge for an early end                         | (num_envs,)      |

    autoreset_mode  "NextStep" (default): the step after an episode's end ignores its action and returns the new start,
                    with reward 0. "SameStep": the new start comes at once, and infos["final_obs"] holds the last
                    observation, infos["final_info"] what belongs to it. "Disabled": reset(options={"reset_mask": mask})
                    starts lanes again
    randomise       draws start, parameters and disturbances of every episode of every lane, see `reset` for seeds
    dtype           float64, or float32 for observations and physics in single precision
    threads         None: all processors for large batches
    max_episode_steps  actions after which an episode is truncated; None: the scene's, which is also the most
    task            what else a scene can be made into: `reward="normalised"`, sensors with their noise, delays, memory,
                    drawn goals, `difficulty`; see `Task`. With terms=True infos hold "reward_terms", with
                    constraint="cost" "cost_constraint", of every lane that plays
    render_mode     "rgb_array": `render` gives a picture of every lane
    infos           of episodes that end in this step, each (num_envs,) with a mask "_" + its name: "cost",
                    "early_end_cost", "diverged"; with "SameStep" also in "final_info", as are their "parameters".
                    "parameters": by name, (num_envs,), where an episode begins or ends, as "fidelity", the label of the
                    model, where that is drawn. "validity" (num_envs,): where
                    a lane lies outside a range of the plant's `validity`, the largest value over its limit, above 1
    """

    metadata = {"render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(
        self,
        scene: str | Scene,
        num_envs: int = 1,
        *,
        randomise: bool = False,
        dtype: type | str = np.float64,
        threads: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        **task: Unpack[TaskKeywords],
    ) -> None:
        owner = "PlantVectorEnv"
        self.task = made = Task(**task)
        self.scene = scene = made.played(arguments.require_scene(owner, scene))
        self.num_envs = require_count(owner, "num_envs", num_envs, 1, 10_000_000)
        require_choice(owner, "render_mode", render_mode, (None, "rgb_array"))
        require_choice(owner, "autoreset_mode", autoreset_mode, (*MODES, *(m.value for m in MODES)))
        self._steps = arguments.require_length(owner, scene, max_episode_steps, made.hold)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {
            **self.metadata,
            "autoreset_mode": self.autoreset_mode,
            "render_fps": max(1, round(1 / (made.hold * scene.dt))),
        }
        self.randomise = made.drawn(require_flag(f"{owner}.randomise", randomise))
        self.render_mode = render_mode
        self._dtype = as_dtype(dtype, owner)
        if threads is None:
            threads = available() if self.num_envs >= FEW else 1
        threads = require_count(owner, "threads", threads, 1, 10_000)
        if made.fidelities is None:
            self._mixture, self._starts = None, LaneStarts(scene, self.num_envs)
            self._step = ControlStep(scene, self.num_envs, self._dtype, threads)
        else:
            self._mixture = Mixture(scene, made.fidelities, self.num_envs)
            self._starts = MixedStarts(self._mixture)
            self._step = MixedStep(self._mixture, self._dtype, threads)
        self.single_action_space = spaces.Box(-1.0, 1.0, (scene.plant.nu,), np.float32)
        self._channel = None if made.plain else Channel(scene, made, self.num_envs)
        width = len(scene.observe) if self._channel is None else self._channel.width
        self.single_observation_space = spaces.Box(-np.inf, np.inf, (width,), self._dtype.type)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._shape = self.num_envs, scene.plant.nu
        self._names = scene.varied_plant.varied
        self._done = np.zeros(self.num_envs, dtype=np.int64)
        self._over = np.ones(self.num_envs, dtype=bool)
        self.begun = False
        self._varied = False  # whether some lane has had other parameters than the plant's own
        self._obs = np.zeros((self.num_envs, len(scene.observe)), dtype=self._dtype)
        self._seen = self._obs if self._channel is None else np.zeros((self.num_envs, width), dtype=self._dtype)
        self._pictures: list[Renderer] = []
        self._total = np.zeros(self.num_envs)  # what each lane's episode has cost, for its picture
        self.marks = {}

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start all lanes, or those of options["reset_mask"] (num_envs,) bool, of which one must be True.

        seed     an integer s >= 0 seeds lane i with s + i; a sequence of num_envs of them, or of None, each lane with
                 its own. Lane i then plays the episodes of PlantEnv.reset(seed=its seed), whatever the others do. Lanes
                 that no seed was given draw from one stream. With a mask, only lanes that start are seeded
        options  "state" (nx,) or (num_envs, nx) to start from, and "parameters", a number or (num_envs,) by name,
                 each instead of what was drawn; where fidelities are drawn, no "state" but "fidelity", one or a lane's

        ValueError names what is not so; nothing has changed then.
        """
        owner, n = "PlantVectorEnv.reset", self.num_envs
        seeds = arguments.require_seeds(owner, seed, n)
        options = arguments.require_options(owner, options, ("reset_mask", *arguments.known(self._mixture)))
        lanes = np.arange(n)
        if "reset_mask" in options:
            lanes = arguments.require_mask(owner, options["reset_mask"], n)
            if len(lanes) < n:
                self._require_begun("reset")  # of some lanes only
        given = arguments.require_starts(owner, self.scene, options, n, self._mixture)
        if isinstance(seeds, int):
            self._np_random, self._np_random_seed = seeding.np_random(seeds)
            return self.restart(lanes, range(seeds, seeds + n), given)
        return self.restart(lanes, seeds or [None] * n, given)

    @property
    def action_map(self) -> tuple[Array, Array]:
        """(m, r), each (nu,), over the limits: actions a ask for m + r a.

        Example
        -------
        >>> scene.vector_env(1).action_map[1].tolist()
        [1.0]
        """
        return placed(self.scene, self.task.actions)

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Hold `actions` (num_envs, nu) for `task.hold` control periods in every lane."""
        obs, reward, terminated, truncated, valid, ended, begun = self.advance(actions)
        n, names, found = self.num_envs, self._names, valid
        if ended is not None:
            found = infos.of_end(n, ended) | valid
            if self.autoreset_mode == AutoresetMode.SAME_STEP:
                found |= infos.of_both(n, ended, names, valid, obs)
            else:
                begun = np.concatenate([begun, ended.lanes])
        if len(begun):
            found |= self.told_of(begun)
        return obs, reward, terminated, truncated, found

    def advance(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any], infos.Ended | None, Array]:
        """`step`, with what infos are made of: what is told of single lanes (where ranges of validity are left, terms,
        constraints), the episodes that end, the lanes where one begins.
        """
        self._require_begun("step")
        actions = arguments.require_actions("PlantVectorEnv.step", "actions", actions, self._shape)
        waiting = self._over.nonzero()[0]
        if len(waiting) and self.autoreset_mode == AutoresetMode.DISABLED:
            raise gymnasium.error.ResetNeeded(
                f"PlantVectorEnv.step: lane {waiting[0]} is over; reset it with options={{'reset_mask': ...}}"
            )
        played = self._held(actions, waiting)
        over, ended = played.terminated | played.truncated, None
        if np.count_nonzero(over):
            lanes = over.nonzero()[0]
            charged = np.zeros(len(lanes)) if played.early is None else played.early[lanes]
            cost, diverged = played.cost[lanes], played.diverged[lanes]
            own = None if self._mixture is None else self.fidelities[lanes]
            ended = infos.Ended(lanes, cost, charged, diverged, self._seen[lanes], self.parameters_of(lanes), own)
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            waiting = NO_LANES if ended is None else ended.lanes
        else:
            self._over = over
        if len(waiting):
            self._start(waiting)
        told = played.told
        return self._seen.copy(), played.reward, played.terminated, played.truncated, told, ended, waiting
