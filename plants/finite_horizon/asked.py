"""Which outputs of a motion and which disturbances are asked about, what counts as one of each, and how it is said."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pliant.plants.core.argument_gates import require_mapping, require_names, require_number
from pliant.plants.core.signals import OwnsArrays, Signal, index, names, rows_by_name
from pliant.plants.linear.ltv import LTVModel

LENGTHS, PUSHES = ("m",), {"m": "N", "rad": "N m", "1": "N m"}  # what pushes an output of a unit, if there is any
SMALL = {"m": (0.1, 1e3, "mm"), "rad": (0.01, 1e3, "mrad"), "1": (0.0, 1.0, "")}  # below which, by what, said how


@dataclass(frozen=True, eq=False)
class Asked(OwnsArrays):
    """Outputs or states and what pushes them, of a model, with sizes that count as one and limits by name."""

    model: LTVModel = field(repr=False)
    outputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    limits: dict[str, float]
    scale: dict[str, float]
    rows: Any = field(repr=False)  # of the outputs, by `rows_by_name`


def asked(
    model: LTVModel,
    outputs: Sequence[str] | None,
    disturbances: Sequence[str] | None,
    limits: Mapping[str, float] | None,
    scale: Mapping[str, float] | None,
) -> Asked:
    """As `finite_horizon` is asked, checked."""
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
    return Asked(model, shown, signals, _by_name("limits", limits, set(pushing)), sizes, rows)


def asked_of(
    owner: str,
    model: Any,
    outputs: Sequence[str] | None,
    disturbances: Sequence[str] | None,
    limits: Mapping[str, float] | None,
    scale: Mapping[str, float] | None,
) -> Asked | None:
    """The same with what is usual where it is not said; None of another model than an LTVModel, of which ValueError
    tells where something is said.
    """
    if not isinstance(model, LTVModel):
        named = {"outputs": outputs, "disturbances": disturbances, "limits": limits, "scale": scale}
        for name, value in named.items():
            if value is not None:
                raise ValueError(f"{owner}.{name} = {value!r} of a {type(model).__name__}, must be None: no LTVModel")
        return None
    chosen = usual(model, outputs, disturbances)
    if outputs is None and disturbances is None and not (chosen[0] and chosen[1]):
        return None
    return asked(model, *chosen, limits, scale)


def usual(
    model: LTVModel, outputs: Sequence[str] | None, disturbances: Sequence[str] | None
) -> tuple[Sequence[str], Sequence[str]]:
    """What is asked about where it is not said: lengths among the outputs, else those in the unit of the first; of the
    disturbances, or of the inputs where there are none, forces for lengths and torques for angles, else all. Nothing
    where the model has none.
    """
    if outputs is None:
        unit = next((s.unit for s in model.outputs if s.unit in LENGTHS), next((s.unit for s in model.outputs), ""))
        outputs = [s.name for s in model.outputs if s.unit == unit]
    if disturbances is None:
        unit = next((s.unit for s in (*model.outputs, *model.states) if s.name in outputs), "")
        known = model.disturbances or model.inputs
        fitting = [s.name for s in known if s.unit == PUSHES.get(unit)]
        disturbances = fitting or [s.name for s in known]
    return outputs, disturbances


def said(value: float, unit: str) -> str:
    """A number with its unit, a small length in mm, a small angle in mrad."""
    below, times, small = SMALL.get(unit, (0.0, 1.0, ""))
    if abs(value) < below:
        value, unit = value * times, small
    elif unit == "1":
        unit = ""
    return f"{value:.3g}{of(unit)}"


def of(unit: str) -> str:
    """A unit behind a number."""
    return f" {unit}" if unit else ""


def energy(signals: Sequence[Signal], scale: Mapping[str, float]) -> str:
    """What disturbances of unit energy are: "tip_force_x of unit energy (1 N^2 s)"."""
    sizes = {(scale[s.name] ** 2, s.unit) for s in signals}
    who = listed([s.name for s in signals])
    if len(sizes) == 1:
        square, unit = sizes.pop()
        squared = f"{unit}^2" if unit.isalpha() else f"({unit})^2" if unit else ""
        return f"{who} of {'unit energy' if square == 1 else 'the energy'} ({square:g}{of(squared)} s)"
    alike = ", ".join(f"{scale[s.name]:g}{of(s.unit)} of {s.name}" for s in signals)
    return f"disturbances of as much energy as {alike} for one second"


def within(signals: Sequence[Signal], limits: Mapping[str, float]) -> str:
    """What disturbances within their limits are: "at most 1 N of each"."""
    sizes = {(limits[s.name], s.unit) for s in signals}
    if len(sizes) == 1:
        size, unit = sizes.pop()
        return f"at most {size:g}{of(unit)}" + (" of each" if len(signals) > 1 else "")
    return "at most " + ", ".join(f"{limits[s.name]:g}{of(s.unit)} of {s.name}" for s in signals)


def listed(words: Sequence[str]) -> str:
    """a, b and c."""
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def not_negative(owner: str, name: str, value: float) -> float:
    return float(require_number(f"{owner}[{name!r}]", value, "nonnegative"))


def _by_name(word: str, given: Mapping[str, float] | None, known: set[str]) -> dict[str, float]:
    found = require_mapping(f"finite_horizon.{word}", {} if given is None else given, sorted(known), "signal")
    own = {n: float(require_number(f"finite_horizon.{word}[{n!r}]", v, "positive")) for n, v in found.items()}
    return {n: own.get(n, 1.0) for n in sorted(known)}
