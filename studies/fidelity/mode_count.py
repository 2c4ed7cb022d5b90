"""How many flexible modes a stability answer needs, from linear models alone, checked once by nonlinear simulation."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants import LinearModel, LTVModel, Plant, Trajectory
from pliant.plants.core.argument_gates import require_count, require_function, require_instance, require_number, shown
from pliant.plants.linear.rest_spaces import conserved_by
from pliant.plants.splines.cubic_spline import CubicSpline
from pliant.plants.stability import assess, growth

FACTOR = 2.0  # by which the margins of settled answers differ at most
SAME = 1e-12  # of its largest entry: what a matrix that is constant along a motion changes by


@dataclass(frozen=True)
class ModeCount:
    """The stability answer with one number of flexible modes."""

    modes: int
    states: int
    verdict: str
    margin: float  # [1/s]
    change: float | None  # of the margin when one more mode is taken [1/s]


@dataclass(frozen=True)
class ModesNeeded:
    """How many modes the stability answer needs, and how the nonlinear simulation agrees."""

    modes: int | None  # None: more than tried
    tolerance: float  # [1/s]
    rows: tuple[ModeCount, ...]
    linear_growth: float  # factor by which the worst deviation changes over the nominal, by the linear model ..
    nonlinear_growth: float  # .. and by simulating the plant with and without it
    why: str
    conserved: tuple[str, ...] = ()  # what no mode changes about a rest, left out of verdicts and margins

    @property
    def difference(self) -> float:
        """Relative difference of the two growths."""
        return abs(self.linear_growth - self.nonlinear_growth) / max(self.nonlinear_growth, 1e-300)


def modes_needed(
    plant: Plant,
    nominal: Trajectory | Callable[[Plant], Trajectory],
    tolerance: float,
    *,
    most: int = 6,
    with_modes: Callable[[Plant, int], Plant] | None = None,
    size: float = 1e-6,
    **options: Any,
) -> ModesNeeded:
    """The fewest flexible modes from which on more change neither the verdict nor the margin by `tolerance` [1/s],
    nor, of a stable or unstable one, by a factor of two.

    `nominal`: a motion, of which each variant takes the states that it has, its own further states zero; or a function
    that gives the motion of a variant. Variants have 1 .. `most` modes: `plant.modes`, or `with_modes(plant, n)`. Only
    linear models decide; then the chosen variant is simulated once with a deviation of `size` (of each state's scale)
    in the direction that grows most, and once without. `options` as in `assess`.

    About a rest the answer is of what is not conserved with inputs held, as total momentum is and, where it is zero,
    place and attitude: their eigenvalues are zero with any number of modes, and would hide those that modes change.
    They are named in `conserved`.
    """
    require_instance("modes_needed.plant", plant, Plant)
    if not isinstance(nominal, Trajectory) and (isinstance(nominal, type) or not callable(nominal)):
        raise ValueError(f"modes_needed.nominal = {shown(nominal)} must be a Trajectory, or a function that gives one")
    tolerance = require_number("modes_needed.tolerance", tolerance, "positive", "1/s")
    size = require_number("modes_needed.size", size, "positive")
    most = require_count("modes_needed", "most", most, 1, 1000)
    if with_modes is not None:
        require_function("modes_needed.with_modes", with_modes)
    vary = with_modes or _with_modes
    kept: tuple[str, ...] = ()
    found, variants = [], [vary(plant, n) for n in range(1, most + 1)]
    for variant in variants:
        motion = _nominal_of(variant, nominal)
        model, kept = _changing(variant.linearize_along(motion))
        verdict = assess(model, thorough=False, **options)
        found.append((variant, motion, verdict))
    rows = []
    for n, (variant, _, verdict) in enumerate(found, start=1):
        change = abs(found[n][2].margin - verdict.margin) if n < len(found) else None
        rows.append(ModeCount(n, variant.nx, verdict.verdict, verdict.margin, change))
    chosen = _settled(rows, tolerance)
    variant, motion, verdict = found[(chosen or most) - 1]
    linear, nonlinear = _growths(variant, motion, size)
    last = rows[-1]
    if chosen is None:
        still = f"the margin, {last.margin:.3g} 1/s, still changes by {rows[-2].change:.2g} 1/s" if most > 1 else ""
        why = f"with {most} modes {still}" if most > 1 else "one tried"
    else:
        settled = f"margin within {tolerance:.2g} of {last.margin:.4g} 1/s"
        why = f"with {chosen} of up to {most} modes: {last.verdict}, {settled}"
    if kept:
        led = ", ".join(name.split()[0] for name in kept)
        why += f"; apart from {len(kept)} conserved quantities, led by {led}, where all of them are zero"
    why += f"; the worst deviation changes by a factor of {linear:.4g}, in nonlinear simulation {nonlinear:.4g}"
    return ModesNeeded(chosen, float(tolerance), tuple(rows), linear, nonlinear, why, kept)


def _changing(model: LTVModel) -> tuple[LinearModel | LTVModel, tuple[str, ...]]:
    """About a rest the model where what it conserves with inputs held is zero, and the names of that; a model that
    changes along its motion, or conserves nothing, as it is.
    """
    A = model.A[0]
    if np.abs(model.A - A).max(initial=0.0) > SAME * np.abs(A).max(initial=0.0):
        return model, ()
    found = conserved_by(A, np.zeros((len(A), 0)), None, model.state_names)
    if not found.names or len(found.names) == len(A):
        return model, ()
    left = found.down @ A @ found.up
    return LinearModel.from_matrices(left, np.zeros((len(left), 0))), found.names


def _differ(one: ModeCount, other: ModeCount, tolerance: float) -> bool:
    """Whether two margins of one verdict differ: by `tolerance` [1/s], or, where they tell decay or growth, by FACTOR.

    Margins that fall by factors with each mode are not settled because all of them are small beside the tolerance.
    """
    larger, change = max(abs(one.margin), abs(other.margin)), abs(one.margin - other.margin)
    return change > tolerance or (one.verdict in ("stable", "unstable") and change > (1 - 1 / FACTOR) * larger)


def _settled(rows: Sequence[ModeCount], tolerance: float) -> int | None:
    """The fewest modes whose answer all larger numbers share; the last itself is shown by none."""
    chosen = None
    for row in reversed(rows[:-1]):
        if row.verdict != rows[-1].verdict or _differ(row, rows[-1], tolerance):
            break
        chosen = row.modes
    return chosen


def _with_modes(plant: Any, n: int) -> Any:
    """The plant with n modes in each flexible body."""
    if hasattr(plant, "modes"):
        before = plant.modes
        return dataclasses.replace(plant, modes=(n,) * len(before) if isinstance(before, tuple) else n)
    if hasattr(plant, "appendages"):
        return dataclasses.replace(plant, appendages=tuple(_with_modes(a, n) for a in plant.appendages))
    raise ValueError(f"modes_needed: {type(plant).__name__} has no field modes: give with_modes(plant, n)")


def _nominal_of(plant: Plant, nominal: Any) -> Trajectory:
    if callable(nominal):
        return nominal(plant)
    x = np.zeros((len(nominal.t), plant.nx))
    rate = np.zeros_like(x)
    have = {s.name: k for k, s in enumerate(nominal.states)}
    slope = nominal.derivative()
    for k, signal in enumerate(plant.states):
        if signal.name in have:
            x[:, k], rate[:, k] = nominal.x[:, have[signal.name]], slope[:, have[signal.name]]
    if not set(have) & {s.name for s in plant.states}:
        raise ValueError(f"modes_needed.nominal has states {tuple(have)}, must share some with {plant.label}")
    return Trajectory.from_arrays(nominal.t, x, nominal.u, plant=plant, dx=rate, w=nominal.w, hold=nominal.hold)


def _growths(plant: Plant, motion: Trajectory, size: float) -> tuple[float, float]:
    """Growth of the worst deviation over the nominal: by the linear model, and by two simulations."""

    model = plant.linearize_along(motion)
    linear = growth(model)
    u: Any = CubicSpline(motion.t, motion.u) if motion.u.shape[1] else None
    if motion.hold == "zero-order":
        u = motion.u
    into, _ = _maps(plant, motion.x[0], len(linear.direction))
    start = motion.x[0] + size * into @ linear.direction
    ends = [plant.simulate(x0, u, motion.t, rtol=1e-11, atol=1e-14).x[-1] for x0 in (motion.x[0], start)]
    _, back = _maps(plant, ends[0], len(linear.direction))
    return linear.total, float(np.linalg.norm(back @ (ends[1] - ends[0]) / linear.scale) / size)


def _maps(plant: Any, x: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """From the n deviations of the linear model to those of the states at x (nx,), and back."""
    if n == plant.nx:
        return np.eye(n), np.eye(n)
    return plant.small.forward(x), plant.small.back(x)
