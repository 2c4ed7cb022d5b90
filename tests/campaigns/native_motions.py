"""Compiled motions against the virtual machine's: random plants, inputs, times and steps by seed.

python tests/campaigns/native_motions.py --count 60 --out build/native_motions.jsonl

Both do the same operations, in another order. How far rounding may part them is measured on the virtual machine itself:
the start is moved by NUDGE of its size, in random directions, and what that grows to, per unit, times what rounding may
move a step by, times the steps, bounds the difference. An adaptive motion may choose other steps besides: it is within
what its tolerance leaves, by the same growth.
"""

import os
import time
import warnings
from contextlib import contextmanager
from unittest import mock

import by_seed
import numpy as np
from oscillators import Oscillator, Scalar

from pliant.plants import SingleLinkArm, SliderCrank
from pliant.plants.core.errors import PliantError
from pliant.plants.integration.step_maps import step_limit
from pliant.plants.motions import compile_rule

FEW = 5  # steps by which rounding moves where a motion that runs away has no finite result any more
VAGUE = 1e-3  # a bound that tells nothing: a motion in which rounding grows so far
METHODS = ("rk4", "rk8", "rosenbrock", "dop853", "rodas5p")
ADAPTIVE = METHODS[3:]
INPUTS = ("held", "constant", "function", "controller", "none")
NUDGE, ROUNDED = 1e-7, 200 * np.finfo(float).eps  # of the state's size; by which rounding moves a step of it
PLANTS = (
    lambda rng: Oscillator(omega=float(10 ** rng.uniform(-1, 2)), zeta=float(rng.uniform(0, 0.5))),
    lambda rng: Scalar(rate=float(-(10 ** rng.uniform(-1, 1)))),
    lambda rng: SingleLinkArm.textbook().ladder()[0],
    lambda rng: SingleLinkArm.textbook().ladder()[1],
    lambda rng: SliderCrank.textbook(),
)


@contextmanager
def by(native: bool):
    """Motions within are compiled at once, or stay on the virtual machine."""
    free = {"COMPILING": (0.0, 0.0), "LOOKING": (0.0, 0.0)}
    with mock.patch.dict(os.environ, {"PLIANT_NATIVE": "01"[native]}), mock.patch.multiple(compile_rule, **free):
        yield


def growth(plant, x0, u, t, **options) -> float:
    """How many times a small change of the start grows, at most, on the virtual machine."""
    rng, size = np.random.default_rng(1), np.abs(x0).max() + 1e-3
    with by(native=False):
        base, most = plant.simulate(x0, u, t, **options).x, 1.0
        for _ in range(2):
            moved = plant.simulate(x0 + NUDGE * size * rng.choice([-1.0, 1.0], plant.nx), u, t, **options).x
            most = max(most, float(np.abs(moved - base).max()) / (NUDGE * size))
    return most


def parted(plant, x0, u, t, **options) -> tuple[float, float, dict]:
    """The largest difference of the two, and its bound; both in the state's own size; the compiled motion's stats."""
    with by(native=False):
        slow = plant.simulate(x0, u, t, **options)
    with by(native=True):
        fast = plant.simulate(x0, u, t, **options)
    size = max(float(np.abs(slow.x).max()), 1e-3)
    grown = growth(plant, x0, u, t, **options)
    bound = ROUNDED * grown * max(slow.stats["steps"], fast.stats["steps"])
    if options["method"] in ADAPTIVE and slow.stats["steps"] != fast.stats["steps"]:
        bound += grown * options.get("rtol", 1e-10) * max(slow.stats["steps"], fast.stats["steps"])
    far = max(float(np.abs(getattr(slow, a) - getattr(fast, a)).max()) / scale for a, scale in (("x", size),))
    rate = max(float(np.abs(slow.dx).max()), 1e-3)
    far = max(far, float(np.abs(slow.dx - fast.dx).max()) / rate / max(1.0, rate / size))
    return far, bound, dict(fast.stats)


class Damper:
    """Pushes against what it reads."""

    def __init__(self, plant, dt):
        self.dt, self.reads, self.nu = dt, (plant.states[-1].name,), plant.nu

    def act(self, t, y):
        return np.full(self.nu, -0.01 * np.tanh(y[0]) + 0.01 * np.sin(t))


def stop(plant, x0, u, t, native: bool, **options) -> PliantError | None:
    """What ends the motion, if anything does."""
    with by(native):
        try:
            plant.simulate(x0, u, t, **options)
        except PliantError as stopped:
            return stopped
    return None


def same_end(slow: PliantError | None, fast: PliantError | None, step: float) -> bool:
    """Whether both stop, within a few steps. Why is told from a state that has run away: to no digit."""
    times = [end.time for end in (slow, fast) if hasattr(end, "time")]
    return slow is not None and fast is not None and (len(times) < 2 or abs(times[0] - times[1]) <= FEW * step)


def run(seed: int) -> by_seed.Row:
    began, rng = time.perf_counter(), np.random.default_rng(seed)
    plant = PLANTS[rng.integers(len(PLANTS))](rng)
    method, kind = METHODS[rng.integers(len(METHODS))], INPUTS[rng.integers(len(INPUTS))]
    x0 = plant.rest_state + 0.01 * rng.uniform(-1.0, 1.0, plant.nx)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        limit = min(0.05, step_limit(plant, x0, method if method in ("rk4", "rk8") else "rk4"))
        step = float(limit * rng.uniform(0.1, 0.8))
        gaps = step * rng.choice([0.3, 1.0, 2.5, 7.0], rng.integers(3, 40))
        t = float(rng.choice([0.0, -1.0, 5.0])) + np.concatenate([[0.0], np.cumsum(gaps)])
        u = {
            "held": 0.01 * rng.normal(size=(len(t), plant.nu)),
            "constant": 0.01 * rng.normal(size=plant.nu),
            "function": lambda s: np.full(plant.nu, 0.01 * np.sin(3 * s)),
            "controller": Damper(plant, 3 * step),
            "none": None,
        }[kind]
        options = {"method": method, "step": None if method in ADAPTIVE else step}
        if plant.nw:
            options["w"] = 0.01 * rng.normal(size=plant.nw)
        row = {"seed": seed, "plant": type(plant).__name__, "method": method, "input": kind, "rows": len(t)}
        ends = [stop(plant, x0, u, t, native, **options) for native in (False, True)]
        if any(ends):
            told = " / ".join(str(end)[:80] for end in ends)
            return {**row, "native": None, "right": same_end(*ends, step), "stopped": told, "seconds": 0.0}
        far, bound, stats = parted(plant, x0, u, t, **options)
    expected = not (method in ADAPTIVE and kind == "function")
    right = (far <= bound or bound > VAGUE) and stats["native"] == expected
    row |= {"far": far, "bound": bound, "native": stats["native"], "right": bool(right)}
    return {**row, "seconds": round(time.perf_counter() - began, 3)}


def summary(rows: list[by_seed.Row]) -> str:
    told = [r for r in rows if r["native"] is not None]
    worst = max((r["far"] / r["bound"] for r in told), default=0.0)
    wrong, vague = [r["seed"] for r in rows if not r["right"]], sum(r["bound"] > VAGUE for r in told)
    text = (
        f"{len(rows)} motions, {sum(r['native'] for r in told)} compiled, {len(rows) - len(told)} stopped in both ways"
    )
    text += f", {vague} too wild to tell: largest difference {worst:.2g} of what rounding explains, "
    return text + f"{len(wrong)} wrong {wrong[:10]}"


if __name__ == "__main__":
    by_seed.main(__doc__, 200, run, summary, lambda row: not row["right"])
