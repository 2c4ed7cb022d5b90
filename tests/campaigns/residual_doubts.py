"""How often is a fit doubted, whose data are sound, and how often one whose data are not?

    python tests/campaigns/residual_doubts.py --runs 400

A spring under a force that changes its sign at random, its place read at n times with white noise; three parameters are
estimated, the noise given or estimated with them. Broken kinds, in standard deviations of that noise: an offset of 3, a
drift to 3 at the end, further noise of AR(0.9) and deviation 1, or all noise of that kind, readings one sample late.
`10 x 40` are ten motions of 40 samples, all of the kind. With 12 samples and no noise given none can be tested: doubted.

A row a kind and a number of samples: the share of runs that are doubted, and of the parameters for which an interval was
claimed, in all runs, the share that is outside of it. Fails where sound data are doubted in more than LARGEST of the
runs with chance's three deviations, or intervals of sound data miss more often than 5 % with the same.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping

import numpy as np
from scipy.signal import lfilter
from springs import NOISE, SPRING, TRUE, VARIED

from pliant.plants import Experiment, identify

FROM = {"mass": 2.4, "damping": 1.1, "stiffness": 44.0}
SIGMA = NOISE["place"]
SAMPLES = (12, 20, 40, 100, 400, "10 x 40")
LARGEST = 0.05
Fault = Callable[[np.ndarray, np.random.Generator], np.ndarray]


def autoregressive(n: int, rng: np.random.Generator, a: float = 0.9) -> np.ndarray:
    """(n,) of deviation one, e_k = a e_(k-1) + white noise, begun long before."""
    return lfilter([np.sqrt(1 - a**2)], [1.0, -a], rng.standard_normal(n + 100))[100:]


def white(y: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return y + SIGMA * rng.standard_normal(len(y))


KINDS: Mapping[str, Fault] = {
    "sound": white,
    "offset 3": lambda y, rng: white(y, rng) + 3 * SIGMA,
    "drift 3": lambda y, rng: white(y, rng) + 3 * SIGMA * np.linspace(0.0, 1.0, len(y)),
    "AR(0.9) added": lambda y, rng: white(y, rng) + SIGMA * autoregressive(len(y), rng),
    "AR(0.9)": lambda y, rng: y + SIGMA * autoregressive(len(y), rng),
    "late": lambda y, rng: white(np.append(y[:1], y[:-1]), rng),
}


def motion(n: int, seed: list[int], fault: Fault) -> Experiment:
    """n samples of 2 s, 4 s where there are more than 40, and what the sensor reads."""
    t, rng = np.linspace(0.0, 2.0 if n <= 40 else 4.0, n), np.random.default_rng(seed)
    force = np.cumprod(np.where(rng.uniform(size=n) < 0.3, -1.0, 1.0))[:, None]
    true = SPRING.simulate(np.zeros(2), force, t)["place"]
    return Experiment(t=t, u=force, measured={"place": fault(true, rng)}, start=np.zeros(2))


def shares(samples: int | str, kind: str, runs: int, given: bool, seed: int = 0) -> tuple[float, float, int]:
    """(doubted of runs, outside of claimed, claimed) by n samples or "10 x 40"."""
    doubted, outside, claimed = 0, 0, 0
    for k in range(runs):
        n, count = (samples, 1) if isinstance(samples, int) else (40, 10)
        motions = [motion(n, [seed, k, i], KINDS[kind]) for i in range(count)]
        found = identify(VARIED, motions, start=FROM, noise={"place": SIGMA} if given else None)
        doubted += not found.trusted
        for name, (low, high) in found.intervals.items():
            if np.isfinite(high - low):
                claimed, outside = claimed + 1, outside + (not low <= TRUE[name] <= high)
    return doubted / runs, outside / max(1, claimed), claimed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    told = parser.parse_args()
    began, good = time.monotonic(), True
    print("noise      samples  kind            doubted  missed of claimed")
    for given in (False, True):
        for samples in SAMPLES:
            for kind in told.kinds:
                doubted, outside, claimed = shares(samples, kind, told.runs, given, told.seed)
                word = "given" if given else "estimated"
                part = f"{100 * outside:.1f} % of {claimed}" if claimed else "none claimed"
                print(f"{word:9s}  {samples!s:>7s}  {kind:14s} {100 * doubted:6.1f} %  {part}", flush=True)
                if kind == "sound" and (given or samples != 12):
                    chance = 3 * np.sqrt(0.05 * 0.95 / told.runs)
                    good = good and doubted <= LARGEST + chance and outside <= 0.05 + chance
    print(f"{time.monotonic() - began:.0f} s")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
