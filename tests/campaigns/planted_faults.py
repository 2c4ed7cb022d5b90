"""Faults planted into generated C, and whether the check of compiled code catches them: a seeded campaign.

    python tests/campaigns/planted_faults.py --count 1000

Kernels and faults are tests/cases/kernels.py and planted.py, single and double precision in turn. A fault is real where
it moves a result of the compiled code, at any of POINTS points in the plant's range that the check does not see, by
more than rounding moves any sound kernel there (SOUND); else it is equivalent at this precision, by that evaluation.
The campaign fails where fewer than 95 % of the real ones are caught in either precision, or a sound kernel is refused.
"""

from __future__ import annotations

import dataclasses
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any

import by_seed
import kernels
import numpy as np
import planted

from pliant.plants.native import compiler
from pliant.plants.native.batch_kernels import BatchKernel
from pliant.plants.native.compiler import CompileError
from pliant.plants.native.kernel_loader import CHECKED_AT, Kernel
from pliant.plants.rounding import agreement
from pliant.plants.rounding.agreement import KernelMismatch, Trial, Truth

POINTS, SOUND = 512, 2.0  # points of the evaluation; the largest error of a sound kernel, in what rounding explains
SHARE = 0.95
QUICK = ("-O0",)


@lru_cache(maxsize=64)
def made(name: str, precision: str) -> tuple[BatchKernel, str, list[Trial]]:
    """A kernel with its source and trials."""
    kernel = kernels.small()[name](np.dtype(precision))
    assert kernel.source is not None
    return kernel, kernel.source(), list(kernel.trials())


@lru_cache(maxsize=64)
def truths(name: str, precision: str, lanes: int, seed: int) -> list[Truth]:
    """The truth of all trials at `lanes` points: the check's own for seed 0."""
    kernel, _, trials = made(name, precision)

    def again(trial: Trial) -> Trial:
        other = np.random.default_rng(seed)
        return dataclasses.replace(trial, draw=lambda rng: trial.draw(other)) if seed else trial

    many = [lanes if seed else trial.times * lanes for trial in trials]
    return [agreement.truth(again(trial), kernel.dtype, n, name) for trial, n in zip(trials, many)]


def results(path: Path, name: str, precision: str) -> list[list[np.ndarray]]:
    """What compiled code gives at the points of the evaluation, by trial and output."""
    kernel, _, trials = made(name, precision)
    found = []
    for trial, true in zip(trials, truths(name, precision, POINTS, 7)):
        found.append([np.zeros((v.shape[1], POINTS), dtype=kernel.dtype) for v in true.values])
        Kernel(path, kernel.dtype, kernel.lanes, trial.entry)(true.inputs, found[-1], trial.scalars, trial.count)
    return found


@lru_cache(maxsize=64)
def sound_results(name: str, precision: str) -> list[list[np.ndarray]]:
    """Those of the kernel without a fault, compiled as those with one."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "sound.so")
        path.write_bytes(compiler.build(made(name, precision)[1], QUICK))
        return results(path, name, precision)


def largest(found: list[list[np.ndarray]], name: str, precision: str, exact: bool = False) -> float:
    """How far results are off a sound kernel's, or off the truth, at most, in what rounding explains there."""
    kernel, _, trials = made(name, precision)
    worst = 0.0
    for trial, true, have, sound in zip(
        trials, truths(name, precision, POINTS, 7), found, sound_results(name, precision)
    ):
        for i in trial.compared(len(have)):
            off = have[i].T - (true.values[i] if exact else sound[i].T.astype(true.values[i].dtype))
            z = agreement.ratios(true.values[i] + off, true.values[i], true.spread[i], kernel.dtype)
            worst = max(worst, float(np.where(np.isfinite(z), z, np.inf).max(initial=0.0)))
    return worst


def refusal(path: Path, name: str, precision: str) -> str:
    """What the check says of compiled code; nothing where it lets it pass. The truth is computed once a kernel."""
    kernel, _, trials = made(name, precision)
    lanes = 2 * CHECKED_AT[kernel.dtype]
    known = iter(truths(name, precision, lanes, 0))

    def run(trial: Trial, inputs: list[np.ndarray], results: list[np.ndarray]) -> None:
        Kernel(path, kernel.dtype, kernel.lanes, trial.entry)(inputs, results, trial.scalars, trial.count)

    try:
        agreement.require_agreement(run, trials, kernel.dtype, lanes, name, lambda *a: next(known))
    except KernelMismatch as refused:
        return str(refused)
    return ""


def run(seed: int) -> dict[str, Any]:
    """One fault in one kernel; every 50th seed none."""
    rng = np.random.default_rng(seed)
    names = list(kernels.small())
    name, precision = names[int(rng.integers(len(names)))], ("float64", "float32")[seed % 2]
    if name.endswith(("observations", "newton")):
        precision = "float64"  # there in no other
    kind = list(planted.FAULTS)[int(rng.integers(len(planted.FAULTS)))]
    row: dict[str, Any] = {"seed": seed, "kernel": name, "precision": precision, "fault": kind, "state": "no place"}
    _, source, _ = made(name, precision)
    wrong = source if seed % 50 == 0 else planted.plant(source, kind, rng)
    if wrong is None:
        return row
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"fault{seed}.so")
        try:
            path.write_bytes(compiler.build(wrong, QUICK))
        except CompileError:
            return row | {"state": "does not compile"}
        said, error = refusal(path, name, precision), largest(results(path, name, precision), name, precision)
    if wrong is source:
        error = largest(sound_results(name, precision), name, precision, exact=True)
        return row | {"fault": "none", "state": "refused" if said else "sound", "error": error}
    state = "caught" if said else "equivalent" if error <= SOUND else "missed"
    if said and error <= SOUND:
        state = "caught, though equivalent"
    where = next(b.strip() for a, b in zip(source.split("\n"), wrong.split("\n")) if a != b)
    return row | {"state": state, "error": error, "line": where[:160]}


def shares(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Of the faults that change a result, how many are caught, by precision."""
    found = {}
    for precision in ("float64", "float32"):
        states = [r["state"] for r in rows if r["precision"] == precision]
        real = states.count("caught") + states.count("missed")
        found[precision] = states.count("caught") / real if real else 1.0
    return found


def summary(rows: list[dict[str, Any]]) -> str:
    """Counts by precision."""
    lines = ["precision  planted  real  caught  share  equivalent  sound  refused"]
    for precision, share in shares(rows).items():
        states = [r["state"] for r in rows if r["precision"] == precision]
        n = {s: states.count(s) for s in set(states)}
        caught, missed = n.get("caught", 0), n.get("missed", 0)
        same = n.get("equivalent", 0) + n.get("caught, though equivalent", 0)
        lines.append(
            f"{precision}    {caught + missed + same:5d} {caught + missed:5d} {caught:6d} {share:7.3f} {same:8d} "
            f"{n.get('sound', 0):8d} {n.get('refused', 0):6d}"
        )
    refused = sum(r["state"] == "refused" for r in rows)
    for r in rows:
        if r["state"] == "missed":
            lines.append(
                f"missed: {r['seed']} {r['kernel']} {r['precision']} {r['fault']} {r['error']:.3g} {r['line']}"
            )
    _failed.append(refused > 0 or min(shares(rows).values()) < SHARE)
    return "\n".join(lines)


_failed: list[bool] = []

if __name__ == "__main__":
    by_seed.main(__doc__ or "", 600, run, summary, lambda row: _failed[-1])
