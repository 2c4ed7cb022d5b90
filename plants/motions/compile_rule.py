"""When a plant's motions are compiled: once the virtual machine has cost, or is about to cost, as much as compiling.

A library in memory is always used; one on disk as soon as the motion is longer than looking for it takes. Nothing is
compiled before the seconds that the virtual machine has spent on this plant's motions, in this process, and those
that the motion at hand would take, exceed the estimated time to compile: whoever waits as long loses at most as much
again (the ski-rental bound). Both estimates go by the number of operations, measured on two cores of 2.1 to 3 GHz:
the virtual machine over plants of 100 to 17,000 operations, compiling over libraries of 500 to 160,000 with gcc 12
and of 500 to 70,000 with clang 14. It takes 50 to 250 us an operation beside a third of a second, most where they are
few. A library that was refused is not asked for again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Generic, TypeVar

import casadi as ca

from pliant.plants.core.errors import PliantError
from pliant.plants.native import kernel_loader
from pliant.plants.rounding.agreement import Trial

from . import motion_library
from .time_limit import time_left

L = TypeVar("L")

COMPILING = (0.6, 2e-4)  # [s] to write, compile and check a library, and for each operation
LOOKING = (4e-3, 4e-6)  # [s] to look for one on disk and load it, and for each operation
STEPPING = (2e-5, 6e-9)  # [s] of a step on the virtual machine, and for each of its operations


class OnDemand(Generic[L]):
    """A library of one plant, of its motions by one kind of method or of what is seen on them, where it is had or pays.

    equations() is what its C is written from, by source(), and `kind` tells libraries of the same equations apart;
    count() gives the operations of the function that it holds, trials() say how it is compared.
    """

    def __init__(
        self,
        equations: Callable[[], ca.Function],
        count: Callable[[], int],
        kind: str,
        load: Callable[[Path], L],
        source: Callable[[], str],
        trials: Callable[[], Sequence[Trial]],
        name: str,
        lanes: int = 1,
    ) -> None:
        self._equations, self._count, self.kind, self._load = equations, count, kind, load
        self._source, self._trials, self.name = source, trials, name
        self.lanes = lanes
        self.spent = 0.0  # [s] by the virtual machine on this plant's motions
        self.compiled = False  # whether this process has asked a compiler for it
        self._library: L | None = None
        self._looked = False

    @cached_property
    def operations(self) -> int:
        """Of the function that the library holds."""
        return max(1, int(self._count()))

    @cached_property
    def key(self) -> str:
        """Its name in the cache."""
        return motion_library.key(self._equations(), self.kind)

    @property
    def price(self) -> float:
        """What compiling is expected to take [s]."""
        return COMPILING[0] + COMPILING[1] * self.operations

    @property
    def settled(self) -> bool:
        """Whether the virtual machine will stay: native code is not wanted, or was refused."""
        return not kernel_loader.wanted() or (self.compiled and self._library is None)

    def seconds(self, steps: float, evaluations: int) -> float:
        """What the virtual machine takes for as many steps of as many evaluations, as the operations let expect."""
        start, each = STEPPING
        return steps * (start + each * evaluations * self.operations)

    def seconds_of_rows(self, rows: int) -> float:
        """What it takes for one evaluation at each of many rows, called once."""
        return rows * STEPPING[1] * self.operations

    @property
    def loaded(self) -> L | None:
        """The library, where it is in memory."""
        return self._library

    @property
    def at_hand(self) -> bool:
        """Whether it is there without a compiler, in memory or on disk."""
        if self._library is None and not self._looked and kernel_loader.wanted():
            self._looked, self._library = True, self._at_hand()
        return self._library is not None

    def library(self, coming: float) -> L | None:
        """The library, where it is at hand, or worth its price to save `coming` seconds; None: the virtual machine."""
        if not kernel_loader.wanted():
            return None
        if self._library is None and not self.compiled:
            owed = self.spent + coming
            if (self._looked or owed > LOOKING[0] + LOOKING[1] * self.operations) and self.at_hand:
                return self._library
            if time_left() > self.price < owed:
                self.compiled = True
                self._library = motion_library.build(
                    lambda: self.key, self._load, self._source, self._trials, self.name, self.lanes
                )
        return self._library

    def _at_hand(self) -> L | None:
        """From memory or disk; why a library cannot be had is told where it is worth compiling."""
        try:
            return motion_library.cached(self.key, self._load) if motion_library.compiler_known() else None
        except (PliantError, OSError):
            return None
