"""What a motion that ends allows: how far disturbances and deviations at its start push its outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.argument_gates import require_instance, require_mapping, require_names, require_number
from pliant.plants.core.signals import OwnsArrays, Signal, index, names, rows_by_name
from pliant.plants.linear.ltv import LTVModel

from . import pushed_outputs
from .amplification import Amplification, amplification
from .energy_gain import Gain, energy_gain
from .stretches import Stretches

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class FiniteHorizon(OwnsArrays):
    """Numbers of one motion, of its linear model: of the plant to first order in what disturbs it.

    t (nt,) [s]: between these times disturbances are held. `limits` of disturbances [their units]; `scale`: sizes that
    count as one. Gains by L2 norm are per unit sqrt(s) of the disturbances over their sizes.
    """

    t: Array = field(repr=False)
    outputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    limits: dict[str, float]
    scale: dict[str, float]
    l2: Gain  # from the L2 norm of w / scale to that of z / scale
    end: Mapping[str, Gain]  # from the L2 norm of w / scale to |z_i| at the end [its unit]
    peak: Mapping[str, Gain]  # to the largest |z_i| over the motion
    bounded: Mapping[str, Gain]  # the largest |z_i| over the motion where |w_j| <= limits
    tube: Mapping[str, Array] = field(repr=False)  # (nt, 2) between which z_i stays where |w_j| <= limits
    from_start: Mapping[str, Array] = field(repr=False)  # (nt,) the most |z_i| from a start off by |x / scale| <= 1
    amplification: Amplification
    _on: Stretches = field(repr=False)

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
        root = np.array([_not_negative("deviation.intensity", n, noise.get(n, 0.0)) for n in known])
        P0 = np.diag([_not_negative("deviation.start", n, first.get(n, 0.0)) ** 2 for n in states])
        seen = rows_by_name(model, names(self.outputs)).C
        own = Stretches(model, _into(model, self.disturbances) * root, seen, np.zeros((*seen.shape[:2], len(root))))
        W, C = pushed_outputs.gramians(own, P0), own.nodes[2]
        return np.sqrt(np.maximum(np.einsum("kij,kjl,kil->ki", C, W, C), 0.0))

    @property
    def words(self) -> str:
        """What an engineer would write of the output that is pushed furthest beside its size."""
        worst = max(self.outputs, key=lambda s: self.bounded[s.name].lower / self.scale[s.name])
        held, impulse, unit = self.bounded[worst.name], self.peak[worst.name], _of(worst.unit)
        within = ", ".join(f"|{s.name}| <= {self.limits[s.name]:g}{_of(s.unit)}" for s in self.disturbances)
        size = ", ".join(f"{self.scale[s.name]:g}{_of(s.unit)} of {s.name}" for s in self.disturbances)
        grown = self.amplification
        energy = (
            f"as much energy as {size} for one second moves it by at most {impulse.upper:.3g}{unit}"
            if np.isfinite(impulse.upper)
            else "what passes through to it without delay has no bound by energy"
        )
        return (
            f"Within {self.t[-1] - self.t[0]:g} s, disturbances {within} move {worst.name} by at most "
            f"{held.upper:.3g}{unit}, at {held.time:.3g} s; {energy}. A deviation grows {grown.factor:.3g}-fold at "
            f"most, from {grown.start:.3g} to {grown.end:.3g} s."
        )


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
    seen = names(model.outputs) if outputs is None else require_names("finite_horizon.outputs", outputs)
    known = (*model.disturbances, *model.inputs)
    pushing = (
        model.disturbance_names
        if disturbances is None
        else require_names("finite_horizon.disturbances", disturbances, names(known), "disturbance or input")
    )
    for word, given in (("outputs", seen), ("disturbances", pushing)):
        if not given:
            raise ValueError(f"finite_horizon.{word} = () must name one or more")
    signals = tuple(known[index(known, n, "disturbance or input")] for n in pushing)
    rows = rows_by_name(model, seen)
    shown = tuple((model.states + model.outputs)[k] for k in rows.at)
    sizes = _by_name("scale", scale, {*names(model.states), *names(shown), *names(signals)})
    most = _by_name("limits", limits, set(pushing))
    w, z, x = (np.array([sizes[s.name] for s in of]) for of in (signals, shown, model.states))
    direct = np.concatenate([rows.F, rows.D], axis=-1)[..., [known.index(s) for s in signals]]
    into, sees = _into(model, signals) * w, rows.C / z[:, None]
    e, c = (float(np.abs(M).max(initial=0.0)) or 1.0 for M in (into, sees))  # so that no square leaves the numbers
    on = Stretches(model, into / e, sees / c, direct * w / z[:, None] / (e * c))
    grown = amplification(on, x)
    l2 = energy_gain(on)
    furthest, upper = pushed_outputs.by_energy(on, pushed_outputs.gramians(on))
    allowed = np.array([most[s.name] for s in signals])
    bounded, beside = pushed_outputs.by_bounded(on, allowed / w)
    unit = z * e * c

    def by_energy(row: int, at: int, most_of: float) -> Gain:
        worst, lower = pushed_outputs.worst_of_energy(on, at, row)
        return Gain(lower * unit[row], max(most_of, lower) * unit[row], worst * w, float(on.t[at]))

    def by_bound(row: int) -> Gain:
        at = int(bounded[:, row].argmax())
        worst, lower = pushed_outputs.worst_bounded(on, at, row, allowed / w)
        furthest = max(float(bounded[at, row]), float(beside[row]), lower)
        return Gain(lower * unit[row], furthest * unit[row], worst * w, float(on.t[at]))

    y = pushed_outputs.nominal(on, rows.at)
    last, each = len(on.h), list(enumerate(names(shown)))
    return FiniteHorizon(
        t=on.t,
        outputs=shown,
        disturbances=signals,
        limits=most,
        scale=sizes,
        l2=Gain(l2.lower * e * c, l2.upper * e * c, l2.disturbance * w),
        end={n: by_energy(i, last, float(furthest[-1, i]) if np.isfinite(upper[-1, i]) else np.inf) for i, n in each},
        peak={n: by_energy(i, int(furthest[:, i].argmax()), float(upper[:, i].max())) for i, n in each},
        bounded={n: by_bound(i) for i, n in each},
        tube={n: y[:, i, None] + bounded[:, i, None] * unit[i] * [-1.0, 1.0] for i, n in each},
        from_start={n: a * z[i] * c for (i, n), a in zip(each, pushed_outputs.from_start(on, x).T, strict=True)},
        amplification=grown,
        _on=on,
    )


def _by_name(word: str, given: Mapping[str, float] | None, known: set[str]) -> dict[str, float]:
    found = require_mapping(f"finite_horizon.{word}", {} if given is None else given, sorted(known), "signal")
    own = {n: float(require_number(f"finite_horizon.{word}[{n!r}]", v, "positive")) for n, v in found.items()}
    return {n: own.get(n, 1.0) for n in sorted(known)}


def _into(model: LTVModel, signals: Sequence[Signal]) -> Array:
    """[E, B] of the named disturbances and inputs, (nt, nx, nw)."""
    known = (*model.disturbances, *model.inputs)
    return np.concatenate([model.E, model.B], axis=-1)[..., [known.index(s) for s in signals]]


def _not_negative(owner: str, name: str, value: float) -> float:
    return float(require_number(f"{owner}[{name!r}]", value, "nonnegative"))


def _of(unit: str) -> str:
    """A unit behind a number."""
    return f" {unit}" if unit else ""
