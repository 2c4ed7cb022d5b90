"""What a scoreboard holds: what each scene was played with, rows, bounds, and motions for the figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.signals import OwnsArrays
from pliant.studies.closed_loop.scores import Row

from .raw_runs import RawRuns


@dataclass(frozen=True)
class Entry:
    """A scene, and what it was played with."""

    scene: str
    about: str
    design: str
    design_states: int
    plant: str  # of all cases but "exact"
    plant_states: int
    limits: tuple[float, ...]
    substeps: int
    step_error: float  # of the compared outputs, by the step
    varied: tuple[tuple[str, float, float], ...]
    noise: Mapping[str, float]  # standard deviation of each reading
    remark: str = ""
    model_error: float | None = None  # of that plant against physics, in the compared outputs, on what its LQR plays
    model_known: float | None = None  # to what physics is known there
    model_remark: str = ""  # why there is none, or that the open loop stands for the LQR


@dataclass(frozen=True, eq=False)
class Line(OwnsArrays):
    """A motion as the figures show it: t (n,), goal signals, deflections and inputs by name (n,)."""

    t: np.ndarray
    signals: Mapping[str, np.ndarray]
    u: np.ndarray  # (n - 1, nu)


@dataclass(frozen=True, eq=False)
class Results:
    """The rows, the bounds by (scene, case), one a run, and the motions of the "finer" case for the figures."""

    seeds: int
    seed: int
    entries: tuple[Entry, ...]
    rows: tuple[Row, ...]
    bounds: Mapping[tuple[str, str], tuple[float | None, ...]]
    remarks: Mapping[tuple[str, str], str]  # why a bound is missing
    scenes: Mapping[str, Scene] = field(repr=False, default_factory=dict)
    lines: Mapping[tuple[str, str], Line] = field(repr=False, default_factory=dict)  # by (scene, controller or "bound")
    raw: RawRuns | None = field(repr=False, default=None)  # every run

    def row(self, scene: str, case: str, controller: str) -> Row:
        """One row. ValueError where there is none."""
        for row in self.rows:
            if (row.scene, row.case, row.controller) == (scene, case, controller):
                return row
        raise ValueError(f"scoreboard has no row of {controller!r} on {scene!r}, {case!r}")
