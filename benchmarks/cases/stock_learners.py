"""Stable-Baselines3's PPO and SAC with their defaults on scenes of arms, as docs/learning.md tells.

`PYTHONPATH=benchmarks python -m cases.stock_learners [--scenes A B] [--learners ppo sac]` trains each, seed by seed,
for --steps actions at most. A run ends where its policy costs a share of 1 / --until of what doing nothing does, on the
scene as it is, in its own cost. Every evaluation is written to results/stock_learners.json, and stock_learners.md is
made; runs that are there, ended, are not made again.
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

HOLD = {  # control periods of an action: about 30 actions an episode
    "single-link-slew": 5,
    "single-link-slew-gentle": 5,
    "two-link-reach": 5,
    "two-link-reach-weak": 5,
    "flexible-joint-slew": 3,
    "three-link-flexible": 12,
    "six-axis-pick": 6,
}
LANES = {"ppo": 2, "sac": 8}
EVERY, ASKED = 8192, 5.0  # actions between evaluations; times that nothing must cost as much
RESULTS = Path(__file__).parents[1] / "results"


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
    """Train, and tell(steps, cost, processor seconds, ended) at every evaluation; end where the cost is `least`."""
    import torch
    from stable_baselines3 import PPO, SAC
    from stable_baselines3.common.callbacks import BaseCallback

    torch.set_num_threads(1)
    begin, task = time.process_time(), {"actions": "midway", "hold": HOLD[scene.name]}

    class Evaluated(BaseCallback):
        following = EVERY

        def _on_step(self) -> bool:
            if self.num_timesteps < self.following:
                return True
            self.following += EVERY
            alone = scene.vector_env(1, **task)
            cost = played(alone, lambda obs: self.model.predict(obs, deterministic=True)[0])
            ended = cost <= least or self.num_timesteps >= steps
            tell(self.num_timesteps, cost, time.process_time() - begin, ended)
            return not ended

    env = scene.sb3_env(LANES[learner], randomise=True, reward="normalised", **task)
    made = {"ppo": PPO, "sac": SAC}[learner]("MlpPolicy", env, seed=seed, device="cpu")
    made.learn(10 * steps, callback=Evaluated())


def table(runs: list[dict[str, Any]], about: dict[str, Any]) -> list[str]:
    """Markdown: a row a run."""
    lines = [
        "| scene | learner | seed | hold | actions | s | cost | doing nothing | ratio | LQR | five times |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |",
    ]
    for run in sorted(runs, key=lambda r: (list(HOLD).index(r["scene"]), r["learner"], r["seed"])):
        none, law = about[run["scene"]]["nothing"], about[run["scene"]]["lqr"]
        last, ratio = run["curve"][-1], none / run["curve"][-1]["cost"]
        lqr = "-" if law is None else f"{law:.3g}"
        told = "yes" if ratio >= ASKED else "not yet" if not run["ended"] else "no"
        lines.append(
            f"| {run['scene']} | {run['learner'].upper()} | {run['seed']} | {HOLD[run['scene']]} | {last['steps']:,} | "
            f"{last['seconds']:.0f} | {last['cost']:.3g} | {none:.3g} | {ratio:.1f} | {lqr} | {told} |"
        )
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", default=list(HOLD), choices=list(HOLD))
    parser.add_argument("--learners", nargs="+", default=list(LANES), choices=list(LANES))
    parser.add_argument("--seeds", type=int, nargs="+", default=[0])
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--until", type=float, default=6.0)
    parser.add_argument("--out", type=Path, default=RESULTS)
    given = parser.parse_args()
    path = given.out / "stock_learners.json"
    for name in given.scenes:
        for learner in given.learners:
            for seed in given.seeds:
                _run(path, name, learner, seed, given.steps, given.until)
    return 0


def _run(path: Path, name: str, learner: str, seed: int, steps: int, until: float) -> None:
    """One run, unless it is there."""
    scene, key = scenes.get(name), {"scene": name, "learner": learner, "seed": seed}
    found: Any = {"runs": [], "about": {}}

    def read() -> Any:
        return json.loads(path.read_text("utf-8")) if path.is_file() else found

    if any(run["ended"] for run in read()["runs"] if all(run[k] == v for k, v in key.items())):
        return
    about = {"nothing": nothing(scene), "lqr": lqr_cost(scene)}
    curve: list[dict[str, float]] = []

    def tell(actions: int, cost: float, seconds: float, ended: bool) -> None:
        curve.append({"steps": actions, "cost": cost, "seconds": round(seconds, 1)})
        print(f"{name} {learner} {seed}: {actions} actions, cost {cost:.4g} of {about['nothing']:.4g}", flush=True)
        now = read()  # another process may have written since
        now["runs"] = [run for run in now["runs"] if any(run[k] != v for k, v in key.items())]
        now["runs"].append({**key, "asked": steps, "until": until, "ended": ended, "curve": curve})
        now["about"][name], now["machine"] = about, machine.describe()
        write_text(path, json.dumps(now, indent=1) + "\n")
        head = ["# Stock learners", "", "Processor seconds of one thread, on a machine that others kept busy.", ""]
        write_text(path.with_suffix(".md"), "\n".join([*head, *table(now["runs"], now["about"]), ""]))

    learned(scene, learner, seed, steps, about["nothing"] / until, tell)


if __name__ == "__main__":
    sys.exit(main())
