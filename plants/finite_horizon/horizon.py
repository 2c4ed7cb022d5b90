"""What a motion that ends allows: how far disturbances and deviations at its start push its outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_instance, require_mapping
from pliant.plants.core.signals import OwnsArrays, Signal, names, rows_by_name
from pliant.plants.linear.ltv import LTVModel

from . import pushed_outputs
from .amplification import Amplification, amplification, check_growth
from .asked import Asked, asked, energy, listed, not_negative, said, within
from .energy_gain import Gain, energy_gain
from .second_order import beyond_linear
from .stretches import Stretches

Array = np.ndarray
FINER = 40  # times looked at about the largest


@dataclass(frozen=True, eq=False)
class FiniteHorizon(OwnsArrays):
    """Numbers of one motion, of its linear model: of the plant to first order in what disturbs it.

    t (nt,) [s]: between these times disturbances are held. `limits` of disturbances [their units]; `scale`: sizes that
    count as one. Gains by L2 norm are per unit sqrt(s) of the disturbances over their sizes. Each number is found when
    it is first asked for.
    """

    t: Array = field(repr=False)
    outputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    limits: dict[str, float]
    scale: dict[str, float]
    _on: Stretches = field(repr=False)
    _unit: Array = field(repr=False)  # (nz,) [its unit] of the outputs of `_on` by its disturbances

    @cached_property
    def l2(self) -> Gain:
        """From the L2 norm of w / scale to that of z / scale."""
        found, size = energy_gain(self._on), float((self._unit / self._sizes(self.outputs))[0])
        return Gain(found.lower * size, found.upper * size, found.disturbance * self._sizes(self.disturbances))

    @cached_property
    def end(self) -> Mapping[str, Gain]:
        """From the L2 norm of w / scale to |z_i| at the end [its unit]."""
        sizes, upper = self._by_energy
        last, most = len(self._on.h), np.where(np.isfinite(upper[-1]), sizes[-1], np.inf)
        return {s.name: self._pushed(i, last, float(most[i])) for i, s in enumerate(self.outputs)}

    @cached_property
    def peak(self) -> Mapping[str, Gain]:
        """To the largest |z_i| over the motion."""
        sizes, upper = self._by_energy
        at, most = sizes.argmax(axis=0), upper.max(axis=0)
        return {s.name: self._pushed(i, int(at[i]), float(most[i])) for i, s in enumerate(self.outputs)}

    @property
    def by_energy(self) -> Mapping[str, Array]:
        """(nt,) the most |z_i| at each time by disturbances of unit energy; what passes through is left out."""
        return {s.name: self._by_energy[0][:, i] * self._unit[i] for i, s in enumerate(self.outputs)}

    @cached_property
    def bounded(self) -> Mapping[str, Gain]:
        """The largest |z_i| where |w_j| <= limits; where t_tube is not t, of those times and of more about the largest
        of them.
        """
        at, most, beside = self._by_bounds
        looked, within = [at] * most.shape[1], list(most.T)
        if len(at) < len(self.t):
            looked = [_about(at, int(best)) for best in most.argmax(axis=0)]
            rows = np.repeat(np.arange(len(looked)), [len(near) for near in looked])
            finer = pushed_outputs.bounded_at(self._on, self._allowed, np.concatenate(looked), rows)
            within = [finer[rows == i] for i in range(len(looked))]
        beside = np.maximum(beside, most.max(axis=0))
        return {s.name: self._by_limits(i, looked[i], within[i], float(beside[i])) for i, s in enumerate(self.outputs)}

    @property
    def t_tube(self) -> Array:
        """(nk,) [s] the times of `tube`: all of t, or some where that would be much work."""
        return np.asarray(self.t[self._by_bounds[0]])

    @cached_property
    def tube(self) -> Mapping[str, Array]:
        """(nk, 2) between which z_i stays at `t_tube` where |w_j| <= limits."""
        known, (at, most, _) = names((*self._on.model.states, *self._on.model.outputs)), self._by_bounds
        y = pushed_outputs.nominal(self._on, [known.index(s.name) for s in self.outputs])[at]
        sides = np.array([-1.0, 1.0])
        return {s.name: y[:, i, None] + most[:, i, None] * self._unit[i] * sides for i, s in enumerate(self.outputs)}

    @cached_property
    def from_start(self) -> Mapping[str, Array]:
        """(nt,) the most |z_i| from a start off by |x / scale| <= 1."""
        found = pushed_outputs.from_start(self._on, self._sizes(self._on.model.states))
        seen = self._unit / self._on.driven
        return {s.name: found[:, i] * seen[i] for i, s in enumerate(self.outputs)}

    @cached_property
    def amplification(self) -> Amplification:
        """sup |Phi(t, s)| in the given scale."""
        return amplification(self._on, self._sizes(self._on.model.states))

    @cached_property
    def _by_energy(self) -> tuple[Array, Array]:
        return pushed_outputs.by_energy(self._on)

    @cached_property
    def _by_bounds(self) -> tuple[Array, Array, Array]:
        at = pushed_outputs.looked_at(self._on)
        return (at, *pushed_outputs.by_bounded(self._on, self._allowed, at))

    @property
    def _allowed(self) -> Array:
        return np.array([self.limits[s.name] / self.scale[s.name] for s in self.disturbances])

    def _sizes(self, signals: Sequence[Signal]) -> Array:
        return np.array([self.scale[s.name] for s in signals])

    def _pushed(self, row: int, at: int, most: float) -> Gain:
        worst, lower = pushed_outputs.worst_of_energy(self._on, at, row)
        unit, w = self._unit[row], self._sizes(self.disturbances)
        return Gain(lower * unit, max(most, lower) * unit, worst * w, float(self.t[at]))

    def _by_limits(self, row: int, at: Array, most: Array, beside: float) -> Gain:
        """Of the most at the ends `at`, beside what it is elsewhere."""
        top, furthest = int(at[most.argmax()]), float(most.max())
        worst, lower = pushed_outputs.worst_bounded(self._on, top, row, self._allowed)
        unit, w = self._unit[row], self._sizes(self.disturbances)
        furthest = max(furthest, beside, lower)
        return Gain(lower * unit, furthest * unit, worst * w, float(self.t[top]))

    def deviation(self, intensity: Mapping[str, float], start: Mapping[str, float] | None = None) -> Array:
        """Standard deviations (nt, nz) [unit of the output] under white noise and a start that is not known.

        intensity: of disturbances by name, the root of their power spectral density, two-sided [unit sqrt(s)]; start:
        standard deviations of states by name. Those that are not named are zero.

        >>> horizon.deviation({"tip_force_y": 0.01}, {"theta1": 1e-3})[-1]
        """
        model, known = self._on.model, names(self.disturbances)
        noise = require_mapping("deviation.intensity", intensity, known, "disturbance")
        states = names(model.states)
        first = require_mapping("deviation.start", {} if start is None else start, states, "state")
        root = np.array([not_negative("deviation.intensity", n, noise.get(n, 0.0)) for n in known])
        P0 = np.diag([not_negative("deviation.start", n, first.get(n, 0.0)) ** 2 for n in states])
        seen = rows_by_name(model, names(self.outputs)).C
        own = Stretches(model, _into(model, self.disturbances) * root, seen, np.zeros((*seen.shape[:2], len(root))))
        W, C = pushed_outputs.gramians(own, P0), own.nodes[1]
        return np.sqrt(np.maximum(np.einsum("kij,kjl,kil->ki", C, W, C), 0.0))

    def to_json(self) -> dict[str, Any]:
        """Bounds by output, units, what they are for; what is not finite is None."""

        def known(gain: Gain) -> dict[str, Any]:
            return {"lower": gain.lower, "upper": gain.upper if np.isfinite(gain.upper) else None, "time": gain.time}

        numbers = {"end": self.end, "peak": self.peak, "bounded": self.bounded}
        return {
            "seconds": float(self.t[-1] - self.t[0]),
            "disturbances": {s.name: {"unit": s.unit, "limit": self.limits[s.name]} for s in self.disturbances},
            "outputs": {
                s.name: {"unit": s.unit, **{key: known(by[s.name]) for key, by in numbers.items()}}
                for s in self.outputs
            },
            "left_out": None if self.left_out is None else {k: _known(v) for k, v in self.left_out.items()},
            "scale": {s.name: self.scale[s.name] for s in (*self.outputs, *self.disturbances)},
        }

    @property
    def limits_said(self) -> str:
        """What bounded disturbances keep within: "at most 1 N of each"."""
        return within(self.disturbances, self.limits)

    def rows(self) -> list[tuple[str, ...]]:
        """Of each output the bounds by unit energy and within the limits with their units, and when it is furthest."""
        return [
            (s.name, *(said(v, s.unit) for g in (peak, held) for v in (g.upper, g.lower)), f"{held.time:.4g} s")
            for s, peak, held in zip(self.outputs, self.peak.values(), self.bounded.values(), strict=True)
        ]

    @property
    def furthest(self) -> Signal:
        """The output that is pushed furthest beside its size."""
        return max(self.outputs, key=lambda s: self._reach(s) / self.scale[s.name])

    def _reach(self, signal: Signal) -> float:
        """[its unit] By unit energy, or within the limits where what passes through has no bound by energy."""
        most = self.peak[signal.name].upper
        return most if np.isfinite(most) else self.bounded[signal.name].upper

    @property
    def left_out(self) -> Mapping[str, float] | None:
        """By "peak" and "bounded": what the linear model leaves out of the output that is pushed furthest under the
        disturbance that pushes it, to second order [its unit], an estimate. None where the plant is not known.
        """
        return self._beyond[0]

    @property
    def trusted(self) -> bool:
        """Whether nothing is seen that keeps the linear model from numbers as large as these; `words` say what is."""
        return not self._beyond[1]

    @cached_property
    def _beyond(self) -> tuple[Mapping[str, float] | None, str]:
        pushes = {kind: getattr(self, kind)[self.furthest.name] for kind in ("peak", "bounded")}
        return beyond_linear(self._on.model, self.t, self.disturbances, self.furthest, pushes)

    @property
    def words(self) -> str:
        """What an engineer would write of the output that is pushed furthest beside its size."""
        most, (held, impulse) = self.furthest, (by[self.furthest.name] for by in (self.bounded, self.peak))
        limits = within(self.disturbances, self.limits)
        looked = "" if len(self.t_tube) == len(self.t) else f" at the {len(self.t_tube)} times looked at"
        if np.isfinite(impulse.upper):
            first = f"{energy(self.disturbances, self.scale)} move {most.name} by at most"
            lets = f"{first} {said(impulse.upper, most.unit)}, and {limits} by at most"
        else:
            lets = f"{listed([s.name for s in self.disturbances])}, {limits}, move {most.name} by at most"
        over = f"Over its {self.t[-1] - self.t[0]:.4g} s the motion lets"
        return f"{over} {lets} {said(held.upper, most.unit)}{looked}{self._beyond[1]}"


def finite_horizon(
    model: LTVModel,
    *,
    outputs: Sequence[str] | None = None,
    disturbances: Sequence[str] | None = None,
    limits: Mapping[str, float] | None = None,
    scale: Mapping[str, float] | None = None,
) -> FiniteHorizon:
    """How far disturbances and deviations at the start can push the outputs of a motion before it ends.

    outputs: names of outputs or states (None: the model's outputs); disturbances: of disturbances or inputs (None: all
    disturbances). limits: the largest absolute value of disturbances by name [their units], 1 where it is not given.
    scale: what counts as one, of outputs (tolerances), disturbances and states, 1 where it is not given. ValueError for
    names that the model does not have, where its fastest mode needs more than 40,000 stretches, and where deviations
    grow beyond the range of numbers.

    Sources: Green and Limebeer, "Linear Robust Control" (1995), sections 3.7 and 4.3; Seiler, Moore, Meissen, Arcak and
    Packard, "Finite horizon robustness analysis of LTV systems using integral quadratic constraints" (2019).

    Example
    -------
    >>> along = plant.linearize_along(motion)
    >>> horizon = finite_horizon(along, outputs=["tip_y"], disturbances=["tip_force_y"], limits={"tip_force_y": 2.0})
    >>> print(horizon.words, horizon.l2.lower, horizon.l2.upper, horizon.bounded["tip_y"].upper)
    """
    model = require_instance("finite_horizon.model", model, LTVModel)
    return numbers(asked(model, outputs, disturbances, limits, scale))


def numbers(of: Asked) -> FiniteHorizon:
    """The same of what was checked."""
    model, signals, shown, sizes, rows = of.model, of.disturbances, of.outputs, of.scale, of.rows
    known = (*model.disturbances, *model.inputs)
    w, z, x = (np.array([sizes[s.name] for s in of]) for of in (signals, shown, model.states))
    direct = np.concatenate([rows.F, rows.D], axis=-1)[..., [known.index(s) for s in signals]]
    into, sees = _into(model, signals) * w, rows.C / z[:, None]
    e, c = (float(np.abs(M).max(initial=0.0)) or 1.0 for M in (into, sees))  # so that no square leaves the numbers
    on = Stretches(model, into / e, sees / c, direct * w / z[:, None] / (e * c), driven=e)
    check_growth(on, x)
    return FiniteHorizon(on.t, shown, signals, of.limits, sizes, on, z * e * c)


def _about(at: Array, best: int) -> Array:
    """Ends of stretches, FINER + 1 at most, from the one before at[best] of those looked at to the one behind."""
    first, last = int(at[max(best - 1, 0)]), int(at[min(best + 1, len(at) - 1)])
    return np.asarray(np.unique(np.linspace(first, last, min(last - first, FINER) + 1).round().astype(int)))


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _into(model: LTVModel, signals: Sequence[Signal]) -> Array:
    """[E, B] of the named disturbances and inputs, (nt, nx, nw)."""
    known = (*model.disturbances, *model.inputs)
    return np.concatenate([model.E, model.B], axis=-1)[..., [known.index(s) for s in signals]]
