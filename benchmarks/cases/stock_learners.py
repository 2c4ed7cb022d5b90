"""Stable-Baselines3's PPO and SAC with their defaults on scenes of arms, as docs/learning.md tells.

`PYTHONPATH=benchmarks python -m cases.stock_learners [--scenes A B] [--learners ppo sac]` trains each, seed by seed,
for --steps actions, and evaluates the policy on the scene as it is, in its own cost, every 8,192 and at the end. With
--until N a run ends sooner: where its policy costs 1 / N of what doing nothing does. Every evaluation is written to
results/stock_learners.json, and stock_learners.md is made; a run that was broken off begins again, one that is there to
its end is not made again. docs/figures/stock-learners.png shows all; --show makes table and picture anew, and trains
nothing.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy and torch are loaded

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from pliant.envs import Scene, scenes
from pliant.plants.files.atomic_files import write_text
from pliant.studies.commands.train import lqr_cost
from pliant.studies.common import machine
from pliant.studies.figures import style

TASKS: dict[str, Any] = {  # about 30 actions an episode; "nominal" where limits are far from what the motion takes
    "single-link-slew": {"hold": 5, "actions": "midway"},
    "single-link-slew-gentle": {"hold": 5, "actions": "midway"},
    "two-link-reach": {"hold": 5, "actions": "midway"},
    "two-link-reach-weak": {"hold": 5, "actions": "midway"},
    "flexible-joint-slew": {"hold": 3, "actions": "midway"},
    "three-link-flexible": {"hold": 12, "actions": "midway"},
    "six-axis-pick": {"hold": 12, "actions": "nominal"},
    "spin-up": {"hold": 25, "actions": "nominal"},
}
SCALED = ("sac",)  # learners that read through VecNormalize: the motor of flexible-joint-slew turns 100 times its joint
LANES = {"ppo": 2, "sac": 16}
OWN: dict[tuple[str, str], dict[str, Any]] = {  # where a learner has others; lanes too
    ("single-link-slew", "sac"): {"lanes": 8},
    ("single-link-slew-gentle", "sac"): {"lanes": 8},
    ("six-axis-pick", "sac"): {"hold": 5},
    ("spin-up", "sac"): {"lanes": 8},
}
EVERY, ASKED = 8192, 5.0  # actions between evaluations; times that nothing must cost as much
HERE = Path(__file__).parents[1]


def task_of(name: str, learner: str) -> tuple[dict[str, Any], int]:
    """Keywords of the environment, and how many lanes."""
    own = dict(OWN.get((name, learner), {}))
    lanes = own.pop("lanes", LANES[learner])
    return {**TASKS[name], **own}, lanes


def played(lanes: Any, act: Any) -> float:
    """The cost of an episode of one lane from the scene's own start, act(observations (1, no)) -> actions (1, nu)."""
    obs, _ = lanes.reset(seed=0)
    cost, done = 0.0, np.zeros(1, bool)
    while not done[0]:
        obs, reward, ended, over, _ = lanes.step(act(obs.astype(np.float32)))
        cost, done = cost - float(reward[0]), ended | over
    return cost


def nothing(scene: Scene) -> float:
    """What it costs to leave all inputs at zero."""
    return played(scene.vector_env(1), lambda obs: np.zeros((1, scene.plant.nu)))


def learned(scene: Scene, learner: str, seed: int, steps: int, least: float, tell: Any) -> None:
    """Train, and tell(actions, cost, processor seconds, ended) at every evaluation; stop at a cost of `least`."""
    import torch
    from stable_baselines3 import PPO, SAC
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.vec_env import VecNormalize

    torch.set_num_threads(1)
    begin, (task, lanes) = time.process_time(), task_of(scene.name, learner)

    env: Any = scene.sb3_env(lanes, randomise=True, reward="normalised", **task)
    if learner in SCALED:
        env = VecNormalize(env, norm_reward=False)
    read = env.normalize_obs if learner in SCALED else lambda obs: obs

    def evaluated(model: Any, last: bool) -> bool:
        cost = played(scene.vector_env(1, **task), lambda obs: model.predict(read(obs), deterministic=True)[0])
        ended = last or cost <= least
        tell(model.num_timesteps, cost, time.process_time() - begin, ended)
        return ended

    class Evaluated(BaseCallback):
        following, ended = EVERY, False

        def _on_step(self) -> bool:
            if self.num_timesteps >= self.following:
                self.following += EVERY
                self.ended = evaluated(self.model, False)
            return not self.ended

    made = {"ppo": PPO, "sac": SAC}[learner]("MlpPolicy", env, seed=seed, device="cpu")
    watch = Evaluated()
    made.learn(steps, callback=watch)
    if not watch.ended:
        evaluated(made, True)


def table(runs: list[dict[str, Any]], about: dict[str, Any]) -> list[str]:
    """Markdown: a row a run."""
    heads = ["scene", "learner", "seed", "lanes", "hold, actions=", "actions", "s", "cost at the end", "least", "after"]
    heads += ["doing nothing", "LQR", "ratio at the end", "of the least", "five times"]
    lines = [f"| {' | '.join(heads)} |", f"| --- | --- | ---: | ---: | --- |{' ---: |' * (len(heads) - 6)} --- |"]
    for run in sorted(runs, key=lambda r: (list(TASKS).index(r["scene"]), r["learner"], r["seed"])):
        none, law, curve = about[run["scene"]]["nothing"], about[run["scene"]]["lqr"], run["curve"]
        last, best = curve[-1], min(curve, key=lambda point: point["cost"])
        task, whole = run["task"], last["steps"] >= run["asked"]
        scaled = ", scaled" if run["scaled"] else ""
        end = "" if whole else f", stopped at {run['until']:g} times" if run["ended"] else ", broken off"
        cells = [
            run["scene"],
            run["learner"].upper(),
            run["seed"],
            run["lanes"],
            f"{task['hold']}, {task['actions']}{scaled}",
        ]
        cells += [f"{last['steps']:,}{end}", f"{last['seconds']:.0f}", f"{last['cost']:.3g}", f"{best['cost']:.3g}"]
        cells += [f"{best['steps']:,}", f"{none:.3g}", "-" if law is None else f"{law:.3g}"]
        cells += [f"{none / last['cost']:.1f}", f"{none / best['cost']:.1f}"]
        lines.append(f"| {' | '.join(map(str, cells))} | {_when([none / point['cost'] for point in curve], curve)} |")
    return lines


def _when(ratios: list[float], curve: list[dict[str, Any]]) -> str:
    """From which evaluation on all have five times, else how many have."""
    enough = [ratio >= ASKED for ratio in ratios]
    if not any(enough):
        return "no"
    if not enough[-1]:
        return f"in {sum(enough)} of {len(enough)}"
    first = len(enough) - enough[::-1].index(False) if not all(enough) else 0
    return f"from {curve[first]['steps']:,} on"


@style.styled
def picture(runs: list[dict[str, Any]], about: dict[str, Any]) -> Any:
    """Times that doing nothing costs as much as the policy, over the actions played, a panel a learner."""
    figure, axes = style.panels(len(LANES), height=3.4)
    for axis, learner in zip(axes, LANES):
        for k, name in enumerate(TASKS):
            curves = [run["curve"] for run in runs if (run["scene"], run["learner"]) == (name, learner)]
            for curve in curves:
                ratios = [about[name]["nothing"] / point["cost"] for point in curve]
                first = name if curve is curves[0] else None
                colour, dash = style.COLOURS[k % len(style.COLOURS)], ("-", "--")[k // len(style.COLOURS)]
                axis.plot([point["steps"] / 1000 for point in curve], ratios, dash, color=colour, label=first)
        axis.axhline(ASKED, color="0.4", linestyle=":")
        axis.set_xlabel("actions [thousand]")
        axis.set_ylabel("cost of doing nothing over the policy's [-]")
        axis.set_title(learner.upper())
        axis.legend(fontsize="x-small")
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", default=list(TASKS), choices=list(TASKS))
    parser.add_argument("--learners", nargs="+", default=list(LANES), choices=list(LANES))
    parser.add_argument("--seeds", type=int, nargs="+", default=[0])
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--until", type=float, default=None)
    parser.add_argument("--out", type=Path, default=HERE / "results")
    parser.add_argument("--show", action="store_true")
    parser.add_argument("--picture", type=Path, default=HERE.parent / "docs" / "figures" / "stock-learners.png")
    given = parser.parse_args()
    path = given.out / "stock_learners.json"
    for name in () if given.show else given.scenes:
        for learner in given.learners:
            for seed in given.seeds:
                _run(path, name, learner, seed, given.steps, given.until)
    found = json.loads(path.read_text("utf-8"))
    _write_table(path, found)
    style.save(picture(found["runs"], found["about"]), given.picture)
    return 0


def _write_table(path: Path, found: Any) -> None:
    head = ["# Stock learners", "", "Processor seconds of one thread, on a machine that others kept busy.", ""]
    write_text(path.with_suffix(".md"), "\n".join([*head, *table(found["runs"], found["about"]), ""]))


def _run(path: Path, name: str, learner: str, seed: int, steps: int, until: float | None) -> None:
    """One run, unless it is there."""
    scene, key = scenes.get(name), {"scene": name, "learner": learner, "seed": seed}
    found: Any = {"runs": [], "about": {}}

    def read() -> Any:
        return json.loads(path.read_text("utf-8")) if path.is_file() else found

    there = [run for run in read()["runs"] if all(run[k] == v for k, v in key.items())]
    if any(run["ended"] and run["until"] == until and run["asked"] >= steps for run in there):
        return
    about, (task, lanes) = {"nothing": nothing(scene), "lqr": lqr_cost(scene)}, task_of(name, learner)
    curve: list[dict[str, float]] = []

    def tell(actions: int, cost: float, seconds: float, ended: bool) -> None:
        curve.append({"steps": actions, "cost": cost, "seconds": round(seconds, 1)})
        print(f"{name} {learner} {seed}: {actions} actions, cost {cost:.4g} of {about['nothing']:.4g}", flush=True)
        now = read()  # another process may have written since
        now["runs"] = [run for run in now["runs"] if any(run[k] != v for k, v in key.items())]
        told = {"asked": steps, "until": until, "ended": ended, "curve": curve}
        now["runs"].append({**key, "lanes": lanes, "task": task, "scaled": learner in SCALED, **told})
        now["about"][name], now["machine"] = about, machine.describe()
        write_text(path, json.dumps(now, indent=1) + "\n")
        _write_table(path, now)

    learned(scene, learner, seed, steps, 0.0 if until is None else about["nothing"] / until, tell)


if __name__ == "__main__":
    sys.exit(main())
