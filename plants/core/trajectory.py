"""A motion: times, states, inputs and outputs with their names. Simulated, or from another program."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.files import sealed_arrays
from pliant.plants.files.html_tables import TrajectoryTable
from pliant.plants.splines.cubic_spline import CubicHermite, CubicSpline

from .argument_gates import shown
from .parameters import require_choice, require_finite
from .signals import OwnsArrays, Signal, as_signals, names, read_only, read_only_times

if TYPE_CHECKING:
    import pandas

KINDS = ("states", "outputs", "inputs", "disturbances")
ARRAYS = ("t", "x", "u", "y", "dx", "w")
FILE, FORMAT = "motion", 2  # what a file says of itself; format 1, of version 0.1, has no checksum


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(OwnsArrays, TrajectoryTable):
    """Rows belong to the times t; `traj["tip_x"]` is a column by name. The arrays are write-protected copies.

    `hold` says what the input does between two times: "zero-order" keeps the earlier row, "linear" joins the
    rows.
    """

    t: np.ndarray  # (nt,) [s], strictly increasing
    x: np.ndarray  # (nt, nx)
    u: np.ndarray  # (nt, nu)
    y: np.ndarray  # (nt, ny)
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    dx: np.ndarray | None = None  # (nt, nx) exact dx/dt, where known
    w: np.ndarray | None = None  # (nt, nw)
    disturbances: tuple[Signal, ...] = ()
    stats: Mapping[str, Any] = field(default_factory=dict)  # of the run that made it; plain numbers and words
    hold: str = "linear"

    def __post_init__(self) -> None:
        require_choice("Trajectory", "hold", self.hold, ("zero-order", "linear"))
        if not isinstance(self.stats, Mapping):
            raise ValueError(f"Trajectory.stats = {shown(self.stats)} must be values by name")
        object.__setattr__(self, "t", read_only_times("Trajectory.t", self.t))
        for kind in KINDS:
            signals = getattr(self, kind)
            object.__setattr__(self, kind, as_signals(f"Trajectory.{kind}", signals, None, ""))
        sizes = {"x": self.states, "dx": self.states, "u": self.inputs, "y": self.outputs}
        sizes["w"] = self.disturbances
        for name, signals in sizes.items():
            value = getattr(self, name)
            if value is not None:
                shape = (len(self.t), len(signals))
                object.__setattr__(self, name, read_only(f"Trajectory.{name}", value, shape))

    @classmethod
    def from_arrays(
        cls,
        t: Any,
        x: Any,
        u: Any = None,
        *,
        plant: Any = None,
        states: Sequence[str | Signal] | None = None,
        inputs: Sequence[str | Signal] | None = None,
        outputs: Sequence[str | Signal] = (),
        disturbances: Sequence[str | Signal] = (),
        y: Any = None,
        w: Any = None,
        dx: Any = None,
        hold: str = "linear",
    ) -> Trajectory:
        """A motion that another program made: t (nt,) [s], x (nt, nx), u (nt, nu) (None: zero), dx: dx/dt (nt, nx).

        With `plant` the signals are the plant's and y, where None, is what the plant measures. Without it
        the names are given; states and inputs default to x1.., u1...
        ValueError names the array whose shape does not fit.
        """
        t = read_only_times("Trajectory.t", t)
        x = require_finite("Trajectory.x", x, (len(t), -1))
        if plant is not None and not all(hasattr(plant, kind) for kind in (*KINDS, "measure")):
            raise ValueError(f"Trajectory.from_arrays: plant = {shown(plant)} must be a Plant")
        if plant is not None:
            states, inputs, outputs, disturbances = (
                getattr(plant, kind) for kind in ("states", "inputs", "outputs", "disturbances")
            )
            x = require_finite("Trajectory.x", x, (len(t), len(states or ())))
        if u is None:
            u = np.zeros((len(t), len(inputs or ())))
        u = require_finite("Trajectory.u", u, (len(t), -1))
        if plant is not None and y is None:
            u = require_finite("Trajectory.u", u, (len(t), len(inputs or ())))
            y = plant.measure(x, u, w=w, t=t)
        return cls(
            t,
            x,
            u,
            np.zeros((len(t), 0)) if y is None else y,
            states=as_signals("Trajectory.states", states, x.shape[1], "x"),
            inputs=as_signals("Trajectory.inputs", inputs, u.shape[1], "u"),
            outputs=as_signals("Trajectory.outputs", outputs, None, ""),
            dx=dx,
            w=w,
            disturbances=as_signals("Trajectory.disturbances", disturbances, None, ""),
            hold=hold,
        )

    def _columns(self) -> dict[str, np.ndarray]:
        """Every column (nt,) by name; of equal names the state's, then the output's, the input's."""
        found: dict[str, np.ndarray] = {}
        for kind, rows in zip(KINDS, (self.x, self.y, self.u, self.w)):
            if rows is not None:
                for name, column in zip(names(getattr(self, kind)), rows.T):
                    found.setdefault(name, column)
        return found

    def __getitem__(self, name: str) -> np.ndarray:
        """The column (nt,) of a state, output, input or disturbance; ValueError that lists the names."""
        columns = self._columns()
        if not isinstance(name, str) or name not in columns:
            raise ValueError(f"Trajectory[{shown(name)}] must be one of {', '.join(columns)}")
        return columns[name]

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        sizes = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"Trajectory({len(self.t)} times, {self.t[0]:g} to {self.t[-1]:g} s, {sizes})"

    def derivative(self) -> np.ndarray:
        """dx/dt (nt, nx): exact where known, else of a cubic spline through x."""
        if self.dx is not None:
            return self.dx
        return CubicSpline(self.t, self.x)(self.t, 1)

    def resample(self, t: Any) -> Trajectory:
        """The motion at other times within [t[0], t[-1]].

        x by cubic Hermite polynomials where dx is known (the new dx is theirs), else by a spline; y by a
        spline; u and w as `hold` says. Under "zero-order" the rate jumps at the old times and y with it: x
        is then of third order. ValueError for times beyond them.
        """
        new = read_only_times("resample.t", t)
        outside = (new < self.t[0]) | (new > self.t[-1])
        if outside.any():
            worst = new[outside][0]
            raise ValueError(f"resample.t = {worst:.9g} must be within [{self.t[0]:.9g}, {self.t[-1]:.9g}]")
        known = self.dx is not None
        path = CubicHermite(self.t, self.x, self.dx) if known else CubicSpline(self.t, self.x)
        return Trajectory(
            new,
            path(new),
            self._held(self.u, new),
            CubicSpline(self.t, self.y)(new) if self.y.size else np.zeros((len(new), 0)),
            states=self.states,
            inputs=self.inputs,
            outputs=self.outputs,
            dx=path(new, 1) if known else None,
            w=None if self.w is None else self._held(self.w, new),
            disturbances=self.disturbances,
            hold=self.hold,
        )

    def _held(self, rows: np.ndarray, new: np.ndarray) -> np.ndarray:
        if self.hold == "zero-order":
            return rows[np.searchsorted(self.t, new, side="right") - 1]
        return np.array([np.interp(new, self.t, column) for column in rows.T]).reshape(-1, len(new)).T

    def save(self, path: str | Path) -> None:
        """Write one .npz file: the arrays, and names, units and stats as JSON text, with a checksum.

        The whole file, or what was there before, also where the process is killed. OSError, which names the file.
        """
        arrays = {k: getattr(self, k) for k in ARRAYS if getattr(self, k) is not None}
        about: dict[str, Any] = {kind: [[s.name, s.unit] for s in getattr(self, kind)] for kind in KINDS}
        stats = json.dumps(dict(self.stats), default=lambda v: v.tolist() if hasattr(v, "tolist") else str(v))
        sealed_arrays.save(path, FILE, FORMAT, {**about, "stats": json.loads(stats), "hold": self.hold}, arrays)

    @classmethod
    def load(cls, path: str | Path) -> Trajectory:
        """Read what `save` wrote. ValueError, which names the file, where it is damaged or something else.

        Files of version 0.1 have no checksum: of those only the archive's own CRC-32 is checked.
        """
        found = sealed_arrays.load("Trajectory.load", path, FILE, FORMAT)
        about: dict[str, Any] = found.about or {}
        odd = set(found.arrays) - set(ARRAYS)
        if odd:
            raise ValueError(f"Trajectory.load: {str(path)!r} has arrays {sorted(odd)}, which no motion has")
        try:
            fields: dict[str, Any] = dict(found.arrays)
            fields |= {kind: tuple(_signal(pair) for pair in about[kind]) for kind in KINDS}
            return cls(**fields, stats=about["stats"], hold=about["hold"])
        except KeyError as error:
            raise ValueError(f"Trajectory.load: {str(path)!r} lacks {error}") from None
        except (TypeError, ValueError) as error:
            raise ValueError(f"Trajectory.load: {str(path)!r} holds no motion: {error}") from None

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame indexed by time [s], one column per name. pandas is not installed with Pliant: ImportError
        without it.

        Example
        -------
        >>> table = motion.to_pandas()
        >>> table.index.name, len(table) == len(motion.t), bool((table["tip_x"] == motion["tip_x"]).all())
        ('t', True, True)
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError("Trajectory.to_pandas needs pandas: pip install pandas") from error
        return pandas.DataFrame(self._columns(), index=pandas.Index(self.t, name="t"))


def _signal(pair: Any) -> Signal:
    """From [name, unit]. ValueError unless both are text."""
    if not (isinstance(pair, list) and len(pair) == 2 and all(isinstance(word, str) for word in pair)):
        raise ValueError(f"{pair!r} must be a name and a unit")
    return Signal(*pair)


def of_run(**fields: Any) -> Trajectory:
    """From arrays that a simulation has just made, which become its own, write-protected, and a plant's signals.

    Nothing is checked again where all numbers are finite.
    """
    arrays = [fields[name] for name in ARRAYS if fields.get(name) is not None]
    if not all(isfinite(np.vdot(array, array)) for array in arrays):
        return Trajectory(**fields)
    made = object.__new__(Trajectory)
    for array in arrays:
        array.setflags(write=False)
    made.__dict__.update(fields)
    return made
