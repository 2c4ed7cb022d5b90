"""Learning: PPO's steps a second, and what PPO reaches beside LQR.

`rows` is a part of the whole measurement. Run by itself, `PYTHONPATH=benchmarks python -m cases.learning`, this trains
every seed on every scene and writes results/learning.json and learning.md; runs that are in the folder already are
read, not made again.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy and torch are loaded

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from harness import sampling, table

from pliant.controllers import rl
from pliant.controllers.analytic_gradients.rollouts import Episodes, Rollouts
from pliant.controllers.analytic_gradients.step_adjoints import StepAdjoints
from pliant.controllers.learning.policy import FOLDER, Policy
from pliant.envs import Scene, scenes
from pliant.envs.environments.env import PlantEnv
from pliant.plants.files.atomic_files import write_text
from pliant.plants.files.whole_folders import renewed
from pliant.plants.integration.step_sensitivities import StepSensitivities
from pliant.studies.commands import console
from pliant.studies.commands.train import draw, lqr_cost
from pliant.studies.common import machine

GROUP, SCENE, LANES = "learning", "two-link-reach", 1024
PLIANT, SYNC = "PPO on Pliant's vector environment", "PPO on Gymnasium's SyncVectorEnv of the same environment"
GRADIENT, GRADIENT_LANES = "a gradient of whole episodes (apg): 150 periods, 12 states", 32
STEPS_BACK, STEPS_FORMED = "of it, the steps forward and backward", "the same steps with dx+/dx and dx+/du formed"
ASKED_RATE, ASKED_RATIO, ASKED_SECONDS = 40_000, 2.0, 600.0
SCENES, STEPS, SEEDS = ("single-link-slew", "two-link-reach"), 8_000_000, (0, 1, 2)
PACKAGES = ("pliant", "stable-baselines3", "torch", "numpy", "gymnasium")


def sync_env(scene: Scene, num_envs: int) -> Any:
    """Gymnasium's SyncVectorEnv of the single environment, as Stable-Baselines3's VecEnv."""
    from gymnasium.vector import AutoresetMode, SyncVectorEnv
    from stable_baselines3.common.vec_env import VecEnv

    class Lanes(VecEnv):
        def __init__(self) -> None:
            make = partial(PlantEnv, scene, randomise=True, dtype=np.float32)
            self.render_mode = None
            self.vector = SyncVectorEnv([make] * num_envs, autoreset_mode=AutoresetMode.SAME_STEP)
            super().__init__(num_envs, self.vector.single_observation_space, self.vector.single_action_space)

        def reset(self) -> np.ndarray:
            return self.vector.reset(seed=0)[0]

        def step_async(self, actions: np.ndarray) -> None:
            self._actions = actions

        def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
            obs, rewards, terminated, truncated, ended = self.vector.step(self._actions)
            dones, infos = terminated | truncated, [{} for _ in range(num_envs)]
            for i in np.flatnonzero(dones):
                infos[i] = {
                    "terminal_observation": ended["final_obs"][i],
                    "TimeLimit.truncated": bool(truncated[i]),
                }
            return obs, rewards.astype(np.float32), dones, infos

        def close(self) -> None:
            self.vector.close()

        def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
            return [getattr(self, attr_name, None)] * num_envs

        def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
            raise NotImplementedError

        def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
            raise NotImplementedError

        def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
            return [False] * num_envs

    return Lanes()


def _ppo(make: Callable[[], Any], threads: int) -> sampling.Sampler:
    """Steps a second of whole iterations: rollout, inference, learning, with training's own settings."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.logger import Logger
    from stable_baselines3.common.vec_env import VecNormalize

    settings = rl.PPOSettings(num_envs=LANES)
    env = VecNormalize(make(), gamma=settings.gamma)
    model = PPO(
        "MlpPolicy",
        env,
        n_steps=settings.n_steps,
        batch_size=settings.batch_size,
        n_epochs=settings.n_epochs,
        learning_rate=settings.learning_rate,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        policy_kwargs={"net_arch": [settings.width] * 2, "log_std_init": float(np.log(settings.noise))},
        seed=0,
        device="cpu",
    )
    model.set_logger(Logger(None, []))

    def work() -> int:
        torch.set_num_threads(threads)
        before = model.num_timesteps
        model.learn(settings.n_steps * LANES, reset_num_timesteps=False)
        return model.num_timesteps - before

    return sampling.rate_of(work)


def _gradient(lanes: int) -> sampling.Sampler:
    """Seconds of a whole gradient of analytic policy gradients: forward, backward, 150 periods of 12 states."""
    scene = scenes.get(SCENE)
    rollouts = Rollouts(scene, lanes, np.ones(len(scene.observe)))
    theta = rollouts.network.start(np.random.default_rng(0))
    start, own = np.tile(scene.initial[0], (lanes, 1)), np.tile(scene.varied_plant.nominal_parameters, (lanes, 1))
    episodes = Episodes(start, own, np.zeros(lanes, dtype=int))
    return sampling.time_of(lambda: rollouts(theta, episodes))


def _stepped(lanes: int, formed: bool) -> sampling.Sampler:
    """Seconds of an episode's steps and of what takes slopes back through them, by adjoints or by derivatives."""
    scene = scenes.get(SCENE)
    plant, u = scene.varied_plant, np.zeros((lanes, scene.plant.nu))
    start, slope = np.tile(scene.initial[0], (lanes, 1)), np.ones((lanes, scene.plant.nx))
    own = {"substeps": scene.substeps, "batch": lanes}
    forward, derivatives = plant.stepper(scene.dt, check=False, **own), StepSensitivities(plant, scene.dt, **own)
    back = StepAdjoints(plant, scene.dt, **own)

    def by_derivatives() -> None:
        for _ in range(scene.steps):
            _, A, B = derivatives(start, u)
            np.matmul(slope[:, None], A), np.matmul(slope[:, None], B)

    def by_adjoints() -> None:
        for _ in range(scene.steps):
            forward(start, u)
            back(start, u, slope)

    return sampling.time_of(by_derivatives if formed else by_adjoints)


def cases() -> list[sampling.Case]:
    """PPO on both versions of the environment, with one torch thread and with all processors."""
    scene = scenes.get(SCENE)

    def case(name: str, make: Callable[[], Any], threads: int) -> sampling.Case:
        # Where Stable-Baselines3 is missing the row says so, as for a peer
        peer = partial(_ppo, make, threads)
        return sampling.Case(group=GROUP, name=name, prepare=peer, threads=threads, lanes=LANES, peer=True)

    counts = sorted({1, machine.cores()})
    ours = [case(PLIANT, partial(scene.sb3_env, LANES, randomise=True, threads=n), n) for n in counts]
    step = partial(_gradient, GRADIENT_LANES)
    made = {GRADIENT: step} | {
        name: partial(_stepped, GRADIENT_LANES, formed) for name, formed in ((STEPS_BACK, False), (STEPS_FORMED, True))
    }
    options = {"group": GROUP, "unit": sampling.TIME, "lanes": GRADIENT_LANES}
    own = [sampling.Case(name=name, prepare=prepare, **options) for name, prepare in made.items()]
    return [*ours, case(SYNC, partial(sync_env, scene, LANES), 1), *own]


def rows(quick: bool) -> list[dict[str, Any]]:
    """The fields of sampling.Row, one dictionary a row."""
    with console.bar("learning") as progress:
        return [asdict(row) for row in sampling.measure(cases(), 3 if quick else 5, 1.0 if quick else 4.0, progress)]


def run(scene: Scene, seed: int, steps: int, folder: Path) -> dict[str, Any]:
    """One training, or what a former one left in `folder`."""
    words = f"pliant train {scene.name} --algorithm ppo --seed {seed} --steps {steps} --threads 1"
    path = folder / rl.CURVE
    have = rl.read_curve(path)[-1].steps if path.is_file() else -1
    if have < steps:
        with console.bar(f"train {scene.name}") as tell:
            options = {"seed": seed, "steps": steps, "threads": 1, "folder": folder, "resume": have >= 0}
            found = rl.train(scene, **options, command=words, progress=tell)
        draw(scene, "ppo", found, folder)
    policy, curve = Policy.load(folder / rl.POLICY), rl.read_curve(path)
    twice = 2 * (lqr_cost(scene) or np.inf)
    reached = next((p.seconds for p in curve if p.cost <= twice), None)
    return {
        "seed": seed,
        "cost": policy.made["cost"],
        "steps": curve[-1].steps,
        "seconds": curve[-1].seconds,
        "seconds_to_twice_lqr": reached,
        "folder": folder.name,
        "command": words,
    }


def results(scene: Scene, seeds: list[int], steps: int, folder: Path) -> dict[str, Any]:
    """All seeds on one scene, beside LQR."""
    made = [run(scene, seed, steps, folder / f"{scene.name}-{seed}") for seed in seeds]
    lqr, costs = lqr_cost(scene), [m["cost"] for m in made]
    assert lqr is not None
    return {
        "scene": scene.name,
        "lqr_cost": lqr,
        "median_cost": median(costs),
        "median_ratio": median(costs) / lqr,
        "range_of_ratio": [min(costs) / lqr, max(costs) / lqr],
        "longest_seconds": max(m["seconds"] for m in made),
        "runs": made,
    }


def ship(found: dict[str, Any], folder: Path) -> None:
    """Save the policy of the median seed among the package's own."""
    chosen = sorted(found["runs"], key=lambda m: m["cost"])[len(found["runs"]) // 2]
    Policy.load(folder / chosen["folder"] / rl.POLICY).save(FOLDER / found["scene"])
    found["shipped_seed"] = chosen["seed"]


def markdown(found: list[dict[str, Any]], rates: list[dict[str, Any]], about: dict[str, str]) -> str:
    """The table."""
    head = ["scene", "LQR's cost", "PPO's cost, median", "times LQR's: median (range)", "longest run", "to twice LQR's"]
    lines = []
    for f in found:
        low, high = f["range_of_ratio"]
        to_twice = [r["seconds_to_twice_lqr"] for r in f["runs"]]
        late = "not by every seed" if None in to_twice else f"{min(to_twice):.0f} to {max(to_twice):.0f} s"
        ratio = f"{f['median_ratio']:.2f} ({low:.2f} to {high:.2f})"
        costs = f"{f['lqr_cost']:.3f}", f"{f['median_cost']:.3f}"
        lines.append([f["scene"], *costs, ratio, f"{f['longest_seconds']:.0f} s", late])
    text = ["# Learning", "", "PPO by `pliant train`; costs are of the scene as it is, nothing drawn at random.", ""]
    text += table._grid(head, lines, 1)
    good = all(f["range_of_ratio"][1] <= ASKED_RATIO and f["longest_seconds"] <= ASKED_SECONDS for f in found)
    text += ["", f"Asked: at most {ASKED_RATIO:g} times LQR's cost in at most {ASKED_SECONDS:g} s, by every seed. "]
    text[-1] += "It holds." if good else "**It does not hold.**"
    text += ["", f"Steps a second with {LANES:,} lanes, {SCENE} (asked: at least {ASKED_RATE:,}):", ""]
    lines = [
        [r["name"], str(r["threads"]), table.number(median(r["samples"])), _range(r["samples"])]
        if r["samples"]
        else [r["name"], str(r["threads"]), r["failure"] or "-", ""]
        for r in rates
        if r["unit"] == sampling.RATE
    ]
    text += table._grid(["", "torch threads", "steps/s, median", "range"], lines, 1)
    others = [value for r in rates for value in r["others"]]
    if others:
        text += ["", f"Other processes used {np.mean(others):.2f} processors meanwhile, {max(others):.2f} at most."]
    text += ["", "On a busy machine several torch threads wait for each other: `pliant train` then takes one."]
    text += ["", "## Runs", ""]
    lines = [
        [
            r["command"],
            "yes" if r["seed"] == f["shipped_seed"] else "",
            f"{r['cost']:.3f}",
            f"{r['seconds']:.0f}",
            table.number(r["steps"] / r["seconds"]),
        ]
        for f in found
        for r in f["runs"]
    ]
    text += table._grid(["command", "shipped", "cost", "seconds", "steps/s, all included"], lines, 2)
    text += ["", "## Machine", "", *table._grid(["", ""], [[k, v] for k, v in about.items()], 2), ""]
    return "\n".join(text)


def _range(values: list[float]) -> str:
    return f"{table.number(min(values))} to {table.number(max(values))}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--steps", type=int, default=STEPS, help="of each run")
    parser.add_argument("--runs", type=Path, default=Path("build/learning"), help="folder of the runs")
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "results", help="folder of the tables")
    parser.add_argument("--ship", action="store_true", help="save the median seeds' policies into the package")
    given = parser.parse_args()
    found = [results(scenes.get(name), given.seeds, given.steps, given.runs) for name in SCENES]
    for f in found:
        f["shipped_seed"] = None
        if given.ship:
            ship(f, given.runs)
    rates = rows(quick=False)
    described = {k: v for k, v in machine.describe().items() if k in ("processor", "cores", "system", "python")}
    described |= {name: machine.version(name) for name in PACKAGES}
    content = {"about": described, "scenes": found, "rates": rates}
    text = markdown(found, rates, described)
    with renewed(given.out) as made:
        write_text(made / "learning.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
        write_text(made / "learning.md", text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
