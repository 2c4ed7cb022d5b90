"""Does compiled code compute what its CasADi functions say? Its results against theirs in extended precision.

Of every component at every point the error |native - true| is set against s, the larger of how far rounding moves that
component (`Arithmetic`, at the kernel's precision) and of half a unit in its last place: z = error / s. Refused is code
with z > MOST at one point, or with a root mean square over the points above TOGETHER in one component: an error that is
small at each point but everywhere. Code that does the same operations in any order has z of about 0.2; 2.0 and 0.61 at
most over every kind of kernel of nine scenes, in both precisions, by gcc, clang and gcc for x86-64-v3
(tests/campaigns/sound_kernels.py), 2.2 for the arms and beams of every size: the limits stand 2.5 times above, for
kernels that nobody has tried.

A point tells nothing where the true value is not finite, or where rounding takes a digit in ten of it: Newton steps
that diverge, mass matrices that are nearly singular. Others are drawn in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.errors import PliantError

from .extended_evaluation import Arithmetic

Array = np.ndarray
Reference = Callable[..., Sequence[Array]]  # (inputs (B, n) ..., scalars, count) -> outputs (B, m)
Written = Callable[[Callable[..., Any]], Reference]  # from what makes functions numeric: NumericFunction, Arithmetic
Draw = Callable[[np.random.Generator], Sequence[Array]]  # inputs (n, m) at m points by chance
MOST, TOGETHER = 6.0, 1.5  # largest z at a point, largest root mean square of z over the points
LOST = 0.1  # of a value that rounding may take at a point that tells something
ROUNDS = 8  # of drawing points


class KernelMismatch(PliantError):
    """A compiled kernel disagrees with the virtual machine's operations; it was not published."""


@dataclass(frozen=True)
class Trial:
    """A way to call a kernel: its `entry`, what it should compute, inputs, scalars, count; outputs compared, () all.

    At `times` as many points as others: what is quickly computed, and has branches that few points take.
    """

    written: Written
    draw: Draw
    scalars: Sequence[float] = ()
    count: int = 1
    entry: str = "run"
    outputs: tuple[int, ...] = ()
    times: int = 1

    def compared(self, count: int) -> tuple[int, ...]:
        """Which of `count` outputs are compared."""
        return self.outputs or tuple(range(count))


@dataclass(frozen=True)
class Truth:
    """At the points `inputs` [(n, lanes) ..]: exact outputs and how far rounding moves them [(lanes, m) ..]."""

    inputs: list[Array]
    values: list[Array]
    spread: list[Array]

    @property
    def says_something(self) -> bool:
        """Whether rounding leaves a digit of any value."""
        return any((s <= LOST * np.abs(v)).any() for v, s in zip(self.values, self.spread))


def truth(trial: Trial, dtype: np.dtype, lanes: int, name: str) -> Truth:
    """The true outputs of a trial at `lanes` points that tell something; KernelMismatch where there are none."""
    arithmetic, rng = Arithmetic(dtype, lanes), np.random.default_rng(0)
    reference = trial.written(arithmetic)
    found: list[tuple[list[Array], list[Array], list[Array]]] = []  # of each round, what tells something
    count, pool, at = 0, _points(trial, rng, lanes), 0
    for _ in range(ROUNDS):
        if at + lanes > pool[0].shape[1]:
            pool, at = _points(trial, rng, lanes), 0
        inputs = [np.ascontiguousarray(a[:, at : at + lanes], dtype=dtype) for a in pool]
        at += lanes
        scalars = [float(dtype.type(s)) for s in trial.scalars]
        with np.errstate(all="ignore"):
            outputs = reference(*[arithmetic.spread(a.T) for a in inputs], scalars, trial.count)
            values, spread = map(list, zip(*[arithmetic.statistics(np.asarray(o)) for o in outputs]))
            compared = trial.compared(len(values))
            all_values, all_spread = (np.concatenate([v[i] for i in compared], axis=1) for v in (values, spread))
            tells = _tells(all_values, all_spread, dtype)
        found.append(([a[:, tells] for a in inputs], [v[tells] for v in values], [s[tells] for s in spread]))
        count += int(tells.sum())
        if count >= lanes // 2:
            break
    if not count:
        raise KernelMismatch(
            f"{name} could not be compared with the virtual machine: at none of {lanes * ROUNDS} points by chance are "
            "its values finite; it is not used"
        )
    take = np.arange(lanes) % count  # the same ones again where some tell nothing
    joined = [
        [np.concatenate(parts, axis=axis) for parts in zip(*group)] for group, axis in zip(zip(*found), (1, 0, 0))
    ]
    return Truth(
        [np.ascontiguousarray(a[:, take]) for a in joined[0]], *[[a[take] for a in group] for group in joined[1:]]
    )


def _points(trial: Trial, rng: np.random.Generator, lanes: int) -> list[Array]:
    """Inputs (n, at least lanes) of a trial."""
    drawn = [trial.draw(rng)]
    while sum(points[0].shape[1] for points in drawn) < lanes:
        drawn.append(trial.draw(rng))
    return [np.concatenate(parts, axis=1) for parts in zip(*drawn)]


def _tells(values: Array, spread: Array, dtype: np.dtype) -> Array:
    """Which rows are finite, within the format, and good to a digit where most rows are."""
    size = np.abs(values)
    finite = (np.isfinite(size) & np.isfinite(spread) & (size < 0.01 * np.finfo(dtype).max)).all(axis=1)
    if not finite.any():
        return finite
    lost = spread > LOST * (size + np.median(size[finite], axis=0)) + np.finfo(dtype).tiny
    mostly = lost[finite].mean(axis=0) > 0.5  # what is left of a Newton step that has converged, say
    return finite & ~lost[:, ~mostly].any(axis=1)


def ratios(native: Array, true: Array, spread: Array, dtype: np.dtype) -> Array:
    """z of native results (lanes, m): their errors in what rounding explains."""
    info = np.finfo(dtype)
    own = np.maximum(spread, 0.5 * float(info.eps) * np.abs(true)) + float(info.tiny)
    with np.errstate(all="ignore"):
        return (np.abs(native - true) / own).astype(float)


def require_agreement(
    run: Callable[[Trial, list[Array], list[Array]], None],
    trials: Sequence[Trial],
    dtype: np.dtype,
    lanes: int,
    name: str,
    known_truth: Callable[[Trial, np.dtype, int, str], Truth] = truth,
) -> tuple[float, float]:
    """Largest z at a point and root mean square of z of a sound kernel; KernelMismatch otherwise.

    run(trial, inputs (n, lanes), results (m, lanes)) fills the results.
    """
    worst, said = [0.0, 0.0], False
    for trial in trials:
        known = known_truth(trial, dtype, trial.times * lanes, name)
        said |= known.says_something
        results = [np.zeros((v.shape[1], trial.times * lanes), dtype=dtype) for v in known.values]
        run(trial, known.inputs, results)
        for i, (have, true, spread) in enumerate(zip(results, known.values, known.spread)):
            if not have.size or i not in trial.compared(len(results)):
                continue
            z = ratios(have.T, true, spread, dtype)
            with np.errstate(over="ignore", invalid="ignore"):
                most, together = z.max(axis=0), np.sqrt((z**2).mean(axis=0))
            measure = np.nan_to_num(np.maximum(most / MOST, together / TOGETHER), nan=np.inf)  # NaN disagrees
            if measure.max() > 1.0:
                row = int(measure.argmax())
                share = np.abs(have.T - true)[:, row].max() / max(np.abs(true[:, row]).max(), np.finfo(dtype).tiny)
                part = "" if trial.entry == "run" else f" of its {trial.entry}"
                if not np.isfinite(have[row]).all():
                    raise KernelMismatch(
                        f"compiled code of {name} disagrees with the virtual machine: output {i}, row {row}{part}, is "
                        "no number at points of the trial where it should be; it is not used (they are drawn about the "
                        "plant's rest_state, zero where it has none: is its mass matrix lost near there?)"
                    )
                raise KernelMismatch(
                    f"compiled code of {name} disagrees with the virtual machine by {float(share):.2g} in output {i}, "
                    f"row {row}{part}, {most[row]:.3g} times what rounding explains; it is not used (another compiler, "
                    "CC=..., may do better)"
                )
            worst = [max(worst[0], float(most.max())), max(worst[1], float(together.max()))]
    if not said:
        raise KernelMismatch(
            f"{name} could not be compared with the virtual machine: rounding in {dtype.name} leaves no digit of any "
            "of its values; it is not used"
        )
    return worst[0], worst[1]


def of_function(function: ca.Function) -> Written:
    """What a kernel computes that is a function once a lane: outputs flat, column after column."""

    def written(numeric: Callable[..., Any] = NumericFunction) -> Reference:
        f = numeric(function)

        def reference(*values: Any) -> Sequence[Array]:
            arrays = values[:-2]
            found = f(*arrays, batch=len(arrays[0]))
            return [v.transpose(0, 2, 1).reshape(len(v), -1) if v.ndim == 3 else v for v in found]

        return reference

    return written
