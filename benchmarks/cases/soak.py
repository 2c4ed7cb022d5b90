"""A long run of the vector environment under random actions: numbers stay numbers, memory stays flat, seeds repeat."""

from __future__ import annotations

import hashlib
import os
import resource
import sys
import time
from dataclasses import dataclass

import numpy as np
from harness.sampling import Progress

from pliant.envs.environments.vector_env import PlantVectorEnv

SCENE, LANES, THREADS = "two-link-reach", 1024, 2
STEPS, QUICK = 100_000_000, 2_000_000  # environment steps
REPEATED = 500_000  # environment steps of each of the two runs whose observations are compared
SETTLED = 0.1  # of the run, after which memory is to be flat
GROWTH = 8.0  # [MB] of resident memory that may be gained afterwards


@dataclass(frozen=True)
class Soak:
    """What was seen in a run of `steps` environment steps."""

    steps: int
    lanes: int
    threads: int
    seconds: float
    episodes: int
    diverged: int
    not_finite: int  # numbers among observations and rewards that are not
    memory: tuple[float, ...]  # resident [MB], at a hundred times or fewer
    digests: tuple[str, str]  # of the observations of two runs from one seed

    @property
    def growth(self) -> float:
        """Resident memory gained after the first tenth of the run [MB]."""
        later = self.memory[int(SETTLED * len(self.memory)) :]
        return max(later) - later[0] if later else 0.0

    @property
    def repeats(self) -> bool:
        """Whether the two runs from one seed agree bit for bit."""
        return self.digests[0] == self.digests[1]

    @property
    def passed(self) -> bool:
        return self.not_finite == 0 and self.repeats and self.growth <= GROWTH


def resident() -> float:
    """Resident memory of this process [MB]; its peak where the system does not tell."""
    try:
        with open("/proc/self/statm") as file:
            return int(file.readline().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)


def _random(rng: np.random.Generator, env: PlantVectorEnv) -> np.ndarray:
    shape = env.num_envs, env.scene.plant.nu
    return rng.random(shape, dtype=np.float32) * np.float32(2.0) - np.float32(1.0)


def digest(seed: int, steps: int, lanes: int = LANES, threads: int = THREADS) -> str:
    """SHA-256 of all observations, rewards and ends of a run."""
    env = PlantVectorEnv(SCENE, lanes, randomise=True, threads=threads)
    rng, found = np.random.default_rng(seed), hashlib.sha256()
    found.update(env.reset(seed=seed)[0].tobytes())
    for _ in range(max(1, steps // lanes)):
        for array in env.step(_random(rng, env))[:4]:
            found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def run(steps: int, progress: Progress, lanes: int = LANES, threads: int = THREADS) -> Soak:
    """The soak itself."""
    env = PlantVectorEnv(SCENE, lanes, randomise=True, threads=threads)
    rng, calls = np.random.default_rng(0), -(-steps // lanes)
    env.reset(seed=0)
    episodes = diverged = not_finite = 0
    memory: list[float] = []
    begin = time.perf_counter()
    every = max(1, calls // 100)
    for k in range(calls):
        obs, rewards, terminated, truncated, infos = env.step(_random(rng, env))
        for array in (obs, rewards):
            not_finite += array.size - int(np.count_nonzero(np.isfinite(array)))
        episodes += int(np.count_nonzero(terminated | truncated))
        if "diverged" in infos:
            diverged += int(np.count_nonzero(infos["diverged"]))
        if k % every == 0:
            memory.append(resident())
            progress(k / calls, f"{k * lanes / 1e6:.0f} million steps, {memory[-1]:.0f} MB")
    seconds = time.perf_counter() - begin
    progress(1.0, "")
    short = min(REPEATED, steps)
    digests = digest(1, short, lanes, threads), digest(1, short, lanes, threads)
    return Soak(calls * lanes, lanes, threads, seconds, episodes, diverged, not_finite, tuple(memory), digests)
