"""A program's own best settings: parts of a link by steps by solvers, from coarse to fine, then what stands on its
front of error against time.

A solver's steps are made shorter until they no longer change the error, or the error no longer matters. Settings go by
what they should cost; where the time is spent, those that are left are not tried.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from .planar_machine import Machine
from .programs import BrokenDownError, Player, Program, Setting

SUBSTEPS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48, 64, 96, 128, 256, 512, 1024, 2048, 4096)  # of a control period
ENOUGH = 0.1  # shorter steps are not tried where twice as short ones change less of the error ..
FLOOR = 2e-3  # .. or it is below this share of the tolerance
FAR = 30.0  # times the tolerance: steps are halved at least while the error is larger
COMPILED = 2.0  # [s] of building a model: more is compiling, which does not count
QUICK = 0.03  # [s] a shorter run is easily disturbed: the quickest of three is taken
SLOW = 3.0  # [s] a run expected to take longer is not made
SHARES = 0.55, 0.8  # of the time: when the first search ends, and the one beside its front
WORTH = 0.8  # a slower row has at most this share of the faster one's error
REPEATS = 5  # runs of a row, after the one that warmed it


@dataclass(frozen=True)
class Found:
    """One setting, played."""

    setting: Setting
    seconds: float  # per simulated second
    error: float
    runs: int = 1


class Search:
    """One program on one machine, against the compared outputs (nt, n) of the reference."""

    def __init__(
        self, program: Program, machine: Machine, outputs: np.ndarray, tolerance: float, seconds: float
    ) -> None:
        self.program, self.machine, self.outputs, self.tolerance = program, machine, outputs, tolerance
        self.began, self.seconds, self.tried = time.perf_counter(), seconds, 0
        self.found: list[Found] = []
        self.still = float(np.abs(outputs - outputs[0]).max())  # error of what does not move

    def front(self) -> list[Found]:
        """What no other setting beats, each timed several times; empty where no setting gives a motion."""
        self._grid()
        for at in best(self.found):
            for solver in self.program.beside(at.setting.solver):
                if self._left(SHARES[1]) > 0:
                    self._try(dataclasses.replace(at.setting, solver=solver))
        return best([self._timed(at) for at in best(self.found)])

    def _left(self, share: float) -> float:
        """Seconds to this share of the time."""
        return self.began + share * self.seconds - time.perf_counter()

    def _grid(self) -> None:
        settings = [
            Setting(n, k, solver)
            for n in self.program.parts(self.machine)
            for k in SUBSTEPS
            for solver in self.program.solvers()
        ]
        settings.sort(key=lambda s: (s.parts * s.substeps, s.parts))
        last: dict[tuple[Any, int], Found] = {}
        enough: set[tuple[Any, int]] = set()
        for setting in settings:
            key = setting.solver, setting.parts
            before = last.get(key)
            least = 2 * before.setting.substeps if before and before.error > FAR * self.tolerance else 0
            if key in enough or setting.substeps < least:
                continue
            if self._left(SHARES[0]) < self._expected(setting) or self._expected(setting) > SLOW:
                continue
            found = self._try(setting)
            if found is None:
                continue
            if found.error < FLOOR * self.tolerance or (before is not None and settled(before, found)):
                enough.add(key)
            last[key] = found

    def _expected(self, setting: Setting) -> float:
        """Seconds that a run should take, by the nearest that was made with this solver; 0 where none was."""
        size = setting.parts * setting.substeps
        near = [f for f in self.found if f.setting.solver == setting.solver]
        if not near:
            return 0.0
        closest = min(near, key=lambda f: abs(np.log(f.setting.parts * f.setting.substeps / size)))
        return closest.seconds * self.machine.duration * size / (closest.setting.parts * closest.setting.substeps)

    def _try(self, setting: Setting) -> Found | None:
        self.tried += 1
        try:
            player = self._player(setting)
            motion, seconds = player.play()
            for _ in range(2 if seconds < QUICK else 0):
                seconds = min(seconds, player.play()[1])
        except BrokenDownError:
            return None
        error = float(np.abs(self.machine.outputs(*motion) - self.outputs).max())
        if not error < self.still:
            return None
        found = Found(setting, seconds / self.machine.duration, error)
        self.found.append(found)
        return found

    def _player(self, setting: Setting) -> Player:
        begin = time.perf_counter()
        player = self.program.player(self.machine, setting)
        if (spent := time.perf_counter() - begin) > COMPILED:
            self.began += spent
        return player

    def _timed(self, at: Found) -> Found:
        """With the median of several more runs; fewer where the time is spent."""
        times: list[float] = []
        player = self._player(at.setting)
        player.seconds()
        while len(times) < (REPEATS if self._left(1.0) > 0 else 1):
            times.append(player.seconds() / self.machine.duration)
        return dataclasses.replace(at, seconds=median(times), runs=len(times))


def settled(before: Found, after: Found) -> bool:
    """Whether shorter steps no longer change the error."""
    ratio = after.setting.substeps / before.setting.substeps
    return abs(before.error - after.error) < ENOUGH * after.error * min(ratio - 1.0, 1.0)


def best(found: Iterable[Found]) -> list[Found]:
    """Those whose error is clearly below that of all that are faster, the fastest first."""
    kept: list[Found] = []
    for at in sorted(found, key=lambda f: (f.seconds, f.error)):
        if not kept or at.error < WORTH * kept[-1].error:
            kept.append(at)
    return kept
