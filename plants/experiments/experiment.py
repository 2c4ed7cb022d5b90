"""A measured motion: times, inputs, what sensors read (NaN where a sample is missing), what is known of its start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from pliant.plants.core.argument_gates import (
    LARGEST_ENTRY,
    real_array,
    require_by_name,
    require_choice,
    require_count,
    require_finite,
    require_instance,
    require_mapping,
    require_names,
    require_text,
    shown,
)
from pliant.plants.core.signals import OwnsArrays, names, read_only_times
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant

Array = np.ndarray
HOLDS = ("zero-order", "linear")
DISTURBED = 1e-3  # moves each state to see whether the states must satisfy something


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Experiment(OwnsArrays):
    """One measured motion of a plant.

    t         (nt,) [s], strictly increasing; samples need not be evenly spaced
    measured  {output or state: (nt,)}; NaN is a missing sample
    u         (nt, nu), or {input: (nt,)} with the others zero, or None: all zero. Complete: an input is never missing
    start     (nx,) the state at t[0]; None: the plant's rest state
    unknown   states whose value at t[0] is not known and is estimated with the parameters, from `start`; or "all"
    w         (nw,) constant disturbances, None: zero
    hold      what the input does between two samples: "zero-order" keeps the earlier row, "linear" joins the rows

    >>> torque, encoder = motion["hub_torque"], motion["hub_angle"]
    >>> run = Experiment(t=motion.t, u={"hub_torque": torque}, measured={"hub_angle": encoder}, unknown="all")
    >>> list(run.measured)
    ['hub_angle']
    """

    t: Any
    measured: Mapping[str, Any]
    u: Any = None
    start: Any = None
    unknown: Any = ()
    w: Any = None
    hold: str = "zero-order"
    name: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", read_only_times("Experiment.t", self.t))
        n = len(self.t)
        if n < 2:
            raise ValueError(f"Experiment.t has {n} times, must have at least 2")
        columns = require_mapping("Experiment.measured", self.measured)
        if not columns:
            raise ValueError("Experiment.measured = {} must name at least one output or state")
        read = {key: _samples(f"Experiment.measured[{key!r}]", value, n) for key, value in columns.items()}
        if all(np.isnan(column).all() for column in read.values()):
            raise ValueError(f"Experiment.measured: every sample of {', '.join(read)} is missing")
        put(self, "measured", read)
        if isinstance(self.u, Mapping):
            by_name = require_mapping("Experiment.u", self.u)
            put(self, "u", {key: require_finite(f"Experiment.u[{key!r}]", v, (n,)) for key, v in by_name.items()})
        elif self.u is not None:
            put(self, "u", require_finite("Experiment.u", self.u, (n, -1)))
        for field in ("start", "w"):
            if getattr(self, field) is not None:
                put(self, field, require_finite(f"Experiment.{field}", getattr(self, field), (-1,)))
        if self.unknown != "all":
            put(self, "unknown", require_names("Experiment.unknown", self.unknown))
        require_choice("Experiment", "hold", self.hold, HOLDS)
        require_text("Experiment.name", self.name, empty=True)

    def __repr__(self) -> str:
        about = f"{self.name!r}, " if self.name else ""
        span = f"{self.t[0]:g} to {self.t[-1]:g} s"
        return f"Experiment({about}{len(self.t)} times, {span}, {', '.join(self.measured)})"

    @classmethod
    def of(
        cls,
        motion: Trajectory,
        *,
        signals: Sequence[str] | None = None,
        noise: Mapping[str, float] | None = None,
        seed: int = 0,
        unknown: Any = (),
        name: str = "",
    ) -> Self:
        """The experiment that a motion is: its inputs, its first state, and what it measures.

        signals: outputs and states that are measured, None: all outputs. `noise` {signal: standard deviation} is
        added to them, by `seed`: what a data sheet's sensors would have read.
        Units are SI. ValueError where disturbances change.
        """
        motion = require_instance("Experiment.of.motion", motion, Trajectory)
        known = names(motion.outputs) + names(motion.states)
        chosen = names(motion.outputs) if signals is None else require_names("Experiment.of.signals", signals, known)
        levels = require_by_name("Experiment.of.noise", {} if noise is None else noise, chosen, "signal", "nonnegative")
        rng = np.random.default_rng(require_count("Experiment.of", "seed", seed, 0, 2**63))
        read = {key: motion[key] + levels.get(key, 0.0) * rng.standard_normal(len(motion)) for key in chosen}
        w = None
        if motion.w is not None and motion.w.size:
            if (motion.w != motion.w[0]).any():
                raise ValueError("Experiment.of.motion has disturbances that change, must have constant ones")
            w = motion.w[0]
        return cls(
            t=motion.t, u=motion.u, measured=read, start=motion.x[0], unknown=unknown, w=w, hold=motion.hold, name=name
        )


@dataclass(frozen=True, eq=False)
class Checked:
    """An experiment in a plant's own order: arrays that a motion is computed from, and what it is set against."""

    name: str
    signals: tuple[str, ...]
    t: Array  # (nt,)
    u: Array  # (nt, nu)
    w: Array  # (nw,)
    start: Array  # (nx,)
    unknown: tuple[int, ...]  # states
    hold: str
    y: Array  # (nt, ny), NaN where missing
    scale: Array  # (len(unknown),) sizes of the unknown states


def is_plant(owner: str, plant: Any) -> Plant:
    """`plant` itself. ValueError where it is none."""
    found: Plant = require_instance(f"{owner}.plant", plant, Plant)
    return found


def checked(plant: Plant, given: Any, name: str, k: int = 0) -> Checked:
    """A motion or experiment, the k-th, in the order of a plant's signals. ValueError where it is not one of the plant;
    `name` is the argument's.
    """
    if isinstance(given, Trajectory):
        given = Experiment.of(given)
    one = require_instance(name, given, Experiment, what="Experiment or Trajectory")
    known = names(plant.states + plant.outputs)
    signals = require_names(f"{name}.measured", tuple(one.measured), known, "output or state")
    n, u = len(one.t), np.zeros((len(one.t), plant.nu))
    if isinstance(one.u, dict):
        inputs = names(plant.inputs)
        for key, column in one.u.items():
            require_names(f"{name}.u", (key,), inputs, "input")
            u[:, inputs.index(key)] = column
    elif one.u is not None:
        u = require_finite(f"{name}.u", one.u, (n, plant.nu))
    start = plant.rest_state if one.start is None else require_finite(f"{name}.start", one.start, (plant.nx,))
    plant.check_state(start)
    states = names(plant.states)
    wanted = states if one.unknown == "all" else require_names(f"{name}.unknown", one.unknown, states, "state")
    unknown = tuple(states.index(state) for state in wanted)
    _require_free(plant, start, unknown, f"{name}.unknown")
    y = np.column_stack([one.measured[key] for key in signals])
    seen = {key: np.nanmax(np.abs(c)) for key, c in one.measured.items() if not np.isnan(c).all()}
    scale = [max(abs(start[i]), seen.get(states[i], 0.0)) or 1.0 for i in unknown]
    w = np.zeros(plant.nw) if one.w is None else require_finite(f"{name}.w", one.w, (plant.nw,))
    label = one.name or f"motion {k + 1}"
    return Checked(label, signals, one.t, u, w, start, unknown, one.hold, y, np.array(scale))


def _require_free(plant: Plant, start: Array, unknown: tuple[int, ...], name: str) -> None:
    """ValueError where an unknown state cannot be moved alone, as a part of a unit quaternion cannot."""
    for i in unknown:
        moved = start.copy()
        moved[i] += DISTURBED
        if np.abs(plant.consistent(moved) - moved).max() > 1e-6 * DISTURBED:
            raise ValueError(f"{name}: {plant.states[i].name} must be known, it cannot move without other states")


def _samples(name: str, value: Any, n: int) -> Array:
    """(n,) numbers, NaN where missing; write-protected."""
    column = np.array(real_array(name, value))
    if column.shape != (n,):
        raise ValueError(f"{name} has shape {column.shape}, must be ({n},)")
    bad = ~(np.isnan(column) | (np.abs(np.nan_to_num(column)) <= LARGEST_ENTRY))
    if bad.any() or np.isinf(column).any():
        k = int(np.argmax(bad | np.isinf(column)))
        raise ValueError(f"{name}[{k}] = {shown(float(column[k]))} must be finite, or NaN where the sample is missing")
    column.setflags(write=False)
    return column
