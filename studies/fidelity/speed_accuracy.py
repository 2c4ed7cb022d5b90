"""Speed against accuracy, as data: what one setting gave, and the chart of all of them.

A setting is a variant by a path, a method and a step or tolerance, in so many lanes, in double or single precision:

    simulate  one motion by `Plant.simulate`
    stepper   `Plant.stepper`, called once a control period: one lane or 1,024 alike, in one thread; it gives states,
              and no outputs
    linear    `simulate` of a linear model at hand: along a motion ("ltv"), about the start ("linear"), and that one
              with half the states ("reduced"); what making it took is told beside

Error  the largest difference of the scene's compared outputs from the reference, over the scene's open-loop motion
       [the outputs' unit]; the reference is physics, see `physics_motion`, with its own uncertainty
Time   wall time per simulated second and lane, the median of several runs after a warm-up
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pliant.plants import Trajectory
from pliant.plants.core.argument_gates import (
    require_choice,
    require_instance,
    require_number,
    require_path,
    require_text,
)
from pliant.plants.files.atomic_files import Together, write_text
from pliant.studies.common.formatting import duration
from pliant.studies.peers.peer_rows import PeerRow

SUBSTEPS = (1, 2, 5, 10, 20, 50)  # fixed steps a control period
TOLERANCES = {"dop853": (1e-3, 1e-5, 1e-7, 1e-9), "rodas5p": (1e-3, 1e-5, 1e-7), "cvodes": (1e-4, 1e-6, 1e-8)}
METHODS = ("dop853", "rk4", "rk8", "rodas5p", "rosenbrock", "midpoint", "cvodes")
ROOTS = {"rodas5p": 5}  # the root of a tolerance by which steps become shorter; else the eighth
LINEAR = {"ltv": "LTV along a motion", "linear": "linear about the start", "reduced": "linear, half the states"}
PATHS, LANES, PRECISIONS = ("simulate", "stepper", "linear"), (1, 1024), ("double", "single")
TOLD_FROM = 10.0  # times what the reference is known to: errors below are not told apart from it
RUNS_AWAY = 1e5  # times the tolerance: a variant that goes so far from the reference is not timed
SPENT = "not run: the time budget was spent"
REASONS = {  # how a failure begins, and what it is in a few words
    "StabilityLimitError": "past the stability limit",
    "MassMatrixError": "mass matrix lost",
    "IntegrationError": "the integration stopped",
    "no compiled code": "no compiled code",
    "no linear model": "no linear model",
    "too slow": "too slow",
    "not run: runs away": "the model runs away",
    "not run: dominated": "dominated, not run",
    SPENT: "no time left, not run",
}


def comparable_seconds(runs: Sequence[Trajectory]) -> list[float]:
    """Seconds of the runs made as the last was: the virtual machine's, before it paid to compile, do not count."""
    native = runs[-1].stats.get("native")
    return [run.stats["seconds"] for run in runs if run.stats.get("native") == native]


@dataclass(frozen=True)
class Row:
    """One variant at one setting. `failure` says why there are no numbers."""

    variant: str
    states: int
    method: str
    step: float | None  # [s], of fixed-step methods, and between the nodes of a model along a motion
    rtol: float | None  # adaptive methods
    seconds: float | None = None  # wall time per simulated second and lane
    error: float | None = None  # against the reference
    step_error: float | None = None  # against the same variant, converged: what the integrator alone does
    runs: int = 0  # timed runs
    failure: str | None = None
    pareto: bool = False  # no other of its number of lanes is as good and faster, or better and as fast
    path: str = "simulate"
    lanes: int = 1
    precision: str = "double"
    native: bool | None = None  # whether compiled code ran
    made: float | None = None  # what making a linear model took, per simulated second, its nominal motion included
    rms_bound: float | None = None  # of a reduced linear model, a priori, from the linear model with all states

    @property
    def setting(self) -> str:
        """Like "rk4, 2 ms", "dop853, rtol 1e-05" or "stepper, rk4, 2 ms, 1,024 lanes, single"."""
        if self.path == "linear":
            nodes = "" if self.step is None else f", nodes {duration(self.step)} apart"
            return LINEAR.get(self.method, self.method) + nodes
        at = duration(self.step) if self.step is not None else f"rtol {self.rtol:.0e}"
        if self.path == "simulate":
            return f"{self.method}, {at}"
        lanes = f"{self.lanes:,} lanes" if self.lanes > 1 else "1 lane"
        return f"stepper, {self.method}, {at}, {lanes}, {self.precision}"

    @property
    def reason(self) -> str:
        """The failure in a few words; "" where there is none."""
        text = self.failure or ""
        return next((words for begins, words in REASONS.items() if text.startswith(begins)), text.partition(":")[0])

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells it from every other row of a chart."""
        return self.variant, self.path, self.method, self.step, self.rtol, self.lanes, self.precision


@dataclass(frozen=True)
class Reference:
    """What errors are measured against, and what is shown of its own error."""

    variant: str  # physics
    how: str  # it was found
    uncertainty: float  # [unit of the compared outputs]


@dataclass(frozen=True)
class Chart:
    """The measured rows; `reference` and `machine` say against what and on what."""

    scene: str
    compare: tuple[str, ...]
    tolerance: float
    duration: float  # [s] simulated
    rows: tuple[Row, ...]
    reference: Reference
    machine: dict[str, str]
    budget: float  # [s]
    unit: str = "m"  # of the compared outputs, errors and tolerance
    outside: tuple[tuple[str, str], ...] = ()  # variants whose own motion leaves their range, and which
    peers: tuple[PeerRow, ...] = ()  # other programs on the same motion
    needed: float | None = None  # [s] about the budget that buys each variant a row, where this one did not

    @property
    def told_from(self) -> float:
        """The least error that is told as a number: ten times what the reference is known to."""
        return TOLD_FROM * self.reference.uncertainty

    @property
    def measured(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.failure is None)

    @property
    def failed(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.failure is not None)

    @property
    def variants(self) -> tuple[str, ...]:
        """In the order of the ladder."""
        return tuple(dict.fromkeys(row.variant for row in self.rows))

    @property
    def lacking(self) -> tuple[str, ...]:
        """Variants that the budget bought no row of."""
        had = {row.variant for row in self.measured}
        return tuple(dict.fromkeys(r.variant for r in self.rows if r.failure == SPENT and r.variant not in had))

    @property
    def front(self) -> tuple[Row, ...]:
        """The Pareto fronts, of one lane before those of many, the most exact first."""
        return tuple(sorted((r for r in self.measured if r.pareto), key=lambda r: (r.lanes, r.error or 0.0)))

    def fastest(self, tolerance: float | None = None, variant: str | None = None, lanes: int = 1) -> Row | None:
        """The fastest nonlinear row that keeps the tolerance (None: the scene's) with what the reference is known to,
        of one variant if named, of one lane or of 1,024.
        """
        bound = self.tolerance if tolerance is None else require_number("fastest.tolerance", tolerance, "nonnegative")
        if variant is not None:
            require_text("fastest.variant", variant)
        require_choice("Chart.fastest", "lanes", lanes, LANES)
        found = [
            r
            for r in self.measured
            if r.path != "linear"
            and r.lanes == lanes
            and variant in (None, r.variant)
            and (r.error or 0.0) + self.reference.uncertainty <= bound
        ]
        return min(found, key=lambda r: r.seconds or 0.0, default=None)

    def ahead(self, peer: PeerRow, lanes: int = 1) -> float | None:
        """How many times faster than another program's row the fastest of one lane, or of 1,024, is that errs no more;
        None where none is as good, or the other has no result.
        """
        require_instance("ahead.peer", peer, PeerRow)
        require_choice("Chart.ahead", "lanes", lanes, LANES)
        if peer.failure is not None or peer.seconds is None or peer.error is None:
            return None
        good = [r for r in self.measured if r.path != "linear" and r.lanes == lanes and (r.error or 0.0) <= peer.error]
        return peer.seconds / min((r.seconds or 0.0) for r in good) if good else None

    def holding(self, row: Row | None) -> Chart:
        """The same with a row that was measured elsewhere, where none of its setting has numbers here."""
        if row is None or any(own.key == row.key for own in self.measured):
            return self
        rows = [own for own in self.rows if own.key != row.key]
        last = max((i for i, own in enumerate(rows) if own.variant == row.variant), default=len(rows) - 1)
        return dataclasses.replace(self, rows=with_fronts([*rows[: last + 1], row, *rows[last + 1 :]], self.told_from))

    def to_json(self) -> dict[str, Any]:
        """With "not_told", where in rows the errors are that are not told apart from the reference."""
        errors = [row.error for row in self.rows]
        return asdict(self) | {"not_told": [i for i, e in enumerate(errors) if e is not None and e < self.told_from]}

    @classmethod
    def from_json(cls, content: dict[str, Any]) -> Chart:
        """What `to_json` gave."""
        made = {
            "compare": tuple(content["compare"]),
            "rows": tuple(Row(**row) for row in content["rows"]),
            "reference": Reference(**content["reference"]),
            "outside": tuple((variant, words) for variant, words in content["outside"]),
            "peers": tuple(PeerRow(**row) for row in content["peers"]),
        }
        return cls(**({k: v for k, v in content.items() if k != "not_told"} | made))

    @property
    def not_run(self) -> int:
        """Settings that the budget left no time for."""
        return sum(row.failure == SPENT for row in self.rows)

    def save(self, table: str | Path, together: Together | None = None) -> None:
        """Write the table as json; the picture is drawn by `figures.speed_accuracy.save`, in one with the table
        where both are told the same `together`. OSError, which names the file."""
        table, text = require_path("Chart.save: table", table), json.dumps(self.to_json(), indent=1) + "\n"
        if together is None:
            write_text(table, text)
        else:
            together.text(table, text)


def pareto(points: Sequence[tuple[float, float]]) -> list[bool]:
    """Which of the points (error, time) no other point beats in one and equals or beats in the other."""

    def beaten(e: float, s: float) -> bool:
        return any(a <= e and b <= s and (a, b) != (e, s) for a, b in points)

    return [not beaten(e, s) for e, s in points]


def with_fronts(rows: Sequence[Row], told_from: float = 0.0) -> tuple[Row, ...]:
    """The rows with `pareto` told among the measured ones of as many lanes; linear models stand apart. Errors below
    `told_from` are as good as one another.
    """
    found = list(rows)
    for lanes in LANES:
        own = [i for i, r in enumerate(found) if r.failure is None and r.path != "linear" and r.lanes == lanes]
        kept = pareto([(max(found[i].error or 0.0, told_from), found[i].seconds or 0.0) for i in own])
        for i, keep in zip(own, kept, strict=True):
            found[i] = dataclasses.replace(found[i], pareto=keep)
    return tuple(found)
