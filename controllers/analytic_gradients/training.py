"""A run of analytic policy gradients: `rl.train(scene, "apg")`.

It begins with a network that does what the scene's LQR does, and follows the gradient of the mean cost of episodes,
whose starts, parameters, delays and noise are drawn anew each time. Where no network comes within a permille of that
law on the scene as it is, the law itself is what is found. Deterministic by its seed where `steps` are given, also over
a kill: the checkpoint holds all that it goes on from.
"""

from __future__ import annotations

import dataclasses
import time
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from pliant.controllers.base.controller import Controller
from pliant.controllers.learning.evaluation import Evaluation, Training, evaluate
from pliant.controllers.learning.policy import Policy
from pliant.controllers.learning.settings import CURVE, CURVE_FORMAT, FLOOR, POLICY, APGSettings, Progress
from pliant.plants.files import sealed_json

from . import kept_law, run_files, warm_start
from .adam import Adam
from .rollouts import Episodes, Rollouts

Array = np.ndarray
EVALUATIONS = 60  # of a run
POOL = 256  # episodes that lanes are drawn from
PACKAGES = ("pliant", "numpy", "casadi")
NO_TORCH = "no torch: NumPy and the native step, one thread"


def learn(
    scene: Any,
    settings: APGSettings,
    *,
    seed: int,
    seconds: float | None,
    steps: int | None,
    folder: Path | None,
    resume: bool,
    command: str,
    progress: Progress,
) -> Training:
    """`rl.train(scene, "apg")` with everything said. ValueError where the scene's goal moves."""
    begin = time.perf_counter()
    if scene.goal_rates:
        raise ValueError(
            f"train: scene {scene.name!r} has goal_rates = {scene.goal_rates}: apg needs a goal that stands"
        )
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        if not resume and run_files.exists(folder):
            raise ValueError(f"train: folder = {str(folder)!r} holds a run: go on with resume=True, or name another")
    run = Run(scene, settings, seed, folder, (seconds, steps), command, begin)
    progress(0.0, "playing the scene's law")
    law = warm_start.law_of(scene)
    run.judge_law(law)
    if resume:
        run.resume()
    else:
        run.begin_from(law)
        run.judge()
    ready = run.spent
    run.go_on(progress)
    run.judge()
    progress(1.0, f"cost {run.best_cost:.4g}")
    assert run.best is not None
    idle = ready if run.stamp == 0 else None
    words = kept_law.words(bool(run.best.made.get("law")), run.best_cost, run.law_cost, idle)
    told = tuple(run.curve), run.stamp, run.spent, run.rate, NO_TORCH
    return Training(run.best, run.best_cost, *told, law_cost=run.law_cost, words=words)


class Run:
    """One run: the episodes that it draws from, the method, what it has found so far."""

    def __init__(
        self,
        scene: Any,
        settings: APGSettings,
        seed: int,
        folder: Path | None,
        budget: tuple[float | None, int | None],
        command: str,
        begin: float,
    ) -> None:
        self.scene, self.settings, self.folder, self.begin = scene, settings, folder, begin
        self.seconds, self.steps = budget
        self.made = {
            "command": command,
            "scene": scene.name,
            "algorithm": "apg",
            "seed": seed,
            "budget": {"seconds": self.seconds, "steps": self.steps},
            "settings": dataclasses.asdict(settings),
            "versions": {name: metadata.version(name) for name in PACKAGES},
        }
        self.seed, self.rng = seed, np.random.default_rng(seed)
        ones = np.ones(len(scene.observe))
        self.rollouts = Rollouts(scene, settings.num_envs, ones, width=settings.width, history=settings.history)
        self.pool_x, self.pool_p = _pool(scene, seed)
        self.judged = self._drawn(np.random.default_rng([seed, 1]))  # the same all the time
        self.adam = Adam.start(np.zeros(self.rollouts.network.size))
        self.curve: list[Evaluation] = []
        self.best: Policy | None = None
        self.best_score = self.best_cost = np.inf
        self.law_cost: float | None = None
        self.stamp, self.former, self.rate = 0, 0.0, 0.0
        self._judge = scene.vector_env(1, threads=1)

    @property
    def spent(self) -> float:
        """Seconds so far, former runs included."""
        return self.former + time.perf_counter() - self.begin

    @property
    def share(self) -> float:
        """Of the budget."""
        if self.steps is not None:
            return min(self.stamp / self.steps, 1.0)
        assert self.seconds is not None
        return min(self.spent / self.seconds, 1.0)

    @property
    def suffers(self) -> bool:
        """Whether lanes meet more than the scene's own start and parameters."""
        return bool(self.settings.delay or self.settings.noise)

    def judge_law(self, law: Controller | None) -> None:
        """What the law costs on the scene as it is; there it is the first that a network has to beat."""
        policy = kept_law.as_policy(law, self.scene, {**self.made, "law": "lqr"})
        if policy is None:
            return
        cost = evaluate(policy, self.scene, self._judge)
        self.law_cost = cost
        if not self.suffers:
            made = {**policy.made, **dataclasses.asdict(Evaluation(0, round(self.spent, 2), cost))}
            self.best, self.best_cost = dataclasses.replace(policy, made=made), cost
            self.best_score = kept_law.CLOSE * cost

    def begin_from(self, law: Controller | None) -> None:
        """A network that does what the scene's law does on undelayed episodes."""
        lanes = self.settings.num_envs
        calm = Episodes(self.pool_x[:lanes], self.pool_p[:lanes], np.zeros(lanes, dtype=int))
        theta = warm_start.begin(self.rollouts, law, calm, self.rng)
        self.adam = Adam.start(theta)

    def go_on(self, progress: Progress) -> None:
        """Step after step until the budget is spent; an evaluation now and then."""
        periods = self.settings.num_envs * self.scene.steps
        first, since, told = self.stamp, time.perf_counter(), 0.0
        following = (int(self.share * EVALUATIONS) + 1) / EVALUATIONS
        while (share := self.share) < 1.0:
            if share >= following:
                self.judge()
                following = (int(share * EVALUATIONS) + 1) / EVALUATIONS
            episodes = self._drawn(self.rng)
            cost, gradient = self.rollouts(self.adam.theta, episodes)
            rate = self.settings.learning_rate * max(FLOOR, 0.5 + 0.5 * np.cos(np.pi * share))
            self.adam.step(_mean(cost), gradient, rate, partial(self._before, episodes))
            self.stamp += periods
            if time.perf_counter() - told > 0.2:
                told = time.perf_counter()
                progress(share, f"{self.stamp / periods:.0f} gradients, cost {self.best_cost:.5g}")
        self.rate = (self.stamp - first) / max(time.perf_counter() - since, 1e-9)

    def _before(self, episodes: Episodes) -> float:
        """What these cost at the last good numbers."""
        return _mean(self.rollouts.cost(self.adam.good, episodes)[0])

    def judge(self) -> None:
        """Evaluate the policy as it is; keep it if it is the best; save everything."""
        policy = self._policy()
        cost = evaluate(policy, self.scene, self._judge)
        score = cost
        if self.suffers:
            own, near = self.rollouts.cost(self.adam.theta, self.judged)
            score = float(np.mean(own + near))
        point = Evaluation(self.stamp, round(self.spent, 2), cost)
        self.curve.append(point)
        better = self.best is None or score < self.best_score
        if better:
            made = {**self.made, **dataclasses.asdict(point)}
            self.best, self.best_score, self.best_cost = dataclasses.replace(policy, made=made), score, cost
        if self.folder is None:
            return
        assert self.best is not None
        run_files.save(self.folder, self._kept(), self.adam, self.rng, self.rollouts.std, self.best)
        if better or len(self.curve) == 1:
            self.best.save(self.folder / POLICY)
        sealed_json.save(self.folder / CURVE, {"format": CURVE_FORMAT, **self._told()})

    def resume(self) -> None:
        """Go on from the folder's checkpoint. ValueError unless it is of the same scene and settings."""
        assert self.folder is not None
        words, self.adam, self.rng, self.rollouts.std, self.best = run_files.load(self.folder)
        for name in ("scene", "settings", "seed"):
            if words[name] != self.made[name]:
                raise ValueError(f"resume: the checkpoint's {name} = {words[name]!r} must be {self.made[name]!r}")
        if len(self.adam.theta) != self.rollouts.network.size:
            raise ValueError(f"resume: {len(self.adam.theta)} numbers must be {self.rollouts.network.size}")
        self.curve = [Evaluation(**point) for point in words["curve"]]
        self.best_cost, self.best_score = words["best_cost"], words["best_score"]
        self.stamp, self.former = words["stamp"], words["spent"]

    def _told(self) -> dict[str, Any]:
        return {
            "scene": self.scene.name,
            "algorithm": "apg",
            "best_cost": self.best_cost,
            "spent": self.spent,
            "curve": [dataclasses.asdict(p) for p in self.curve],
        }

    def _kept(self) -> dict[str, Any]:
        own = {"settings": self.made["settings"], "seed": self.seed, "stamp": self.stamp, "best_score": self.best_score}
        return {**self._told(), **own}

    def _drawn(self, rng: np.random.Generator) -> Episodes:
        """Episodes of the pool; lane 0 is the scene as it is."""
        lanes, settings = self.settings.num_envs, self.settings
        picked = rng.integers(0, len(self.pool_x), lanes)
        picked[0] = 0
        delay = rng.integers(0, settings.delay + 1, lanes)
        delay[0] = 0
        noise = None
        if settings.noise:
            noise = settings.noise * rng.standard_normal((self.scene.steps, lanes, len(self.scene.observe)))
            noise[:, 0] = 0.0
        return Episodes(self.pool_x[picked], self.pool_p[picked], delay, noise)

    def _policy(self) -> Policy:
        layers, scene = self.rollouts.network.layers(self.adam.theta.copy()), self.scene
        return Policy(
            weights=(layers.W1, layers.W2, layers.W3),
            biases=(layers.b1, layers.b2, layers.b3),
            mean=np.zeros(len(scene.observe)),
            std=self.rollouts.std,
            scene=scene.name,
            reads=scene.observe,
            goal=scene.goal_values(scene.observe),
            inputs=tuple(signal.name for signal in scene.plant.inputs),
            limits=np.array(scene.limits),
            dt=scene.dt,
            history=self.settings.history,
            made=self.made,
        )


def _mean(cost: Array) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.mean(cost))


def _pool(scene: Any, seed: int) -> tuple[Array, Array]:
    """States (POOL, nx) and parameters (POOL, np) that the environment draws; the first are the scene's own."""
    plant = scene.varied_plant
    env = scene.vector_env(POOL, randomise=True, threads=1)
    _, told = env.reset(seed=seed)
    p = np.tile(plant.nominal_parameters, (POOL, 1))
    for i, name in enumerate(plant.varied):
        p[:, i] = told["parameters"][name]
    x = env.states.copy()
    env.close()
    x[0], p[0] = scene.initial[0], plant.nominal_parameters
    return x, p
