"""What the search asks of another program: settings to try, and one motion at a setting."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .planar_machine import Machine

Motion = tuple[np.ndarray, np.ndarray]  # tip (nt, 2) [m] and the root's angle (nt,) [rad] at the control times


@dataclass(frozen=True)
class Player:
    """A model at a setting, built, assembled, compiled and warm; each call plays the motion from its start."""

    play: Callable[[], tuple[Motion, float]]  # the motion, and seconds of the integration alone, about
    seconds: Callable[[], float]  # of the integration alone, nothing watched


@dataclass(frozen=True)
class Setting:
    """Parts of each link, steps of a control period, and what else the program can be told, which says itself."""

    parts: int
    substeps: int
    solver: Any = ""


class Program(Protocol):
    """Another program with one of its models of planar beams."""

    @property
    def peer(self) -> str:
        """As in PeerRow."""

    @property
    def package(self) -> str:
        """What is imported."""

    @property
    def part(self) -> str:
        """What a link is divided into, in the plural."""

    def why_not(self, machine: Machine) -> str:
        """Why it cannot hold this machine; "" where it can."""

    def parts(self, machine: Machine) -> Sequence[int]:
        """Of each link, coarse to fine."""

    def solvers(self) -> Sequence[Hashable]:
        """Each is searched by itself."""

    def beside(self, solver: Any) -> Sequence[Hashable]:
        """What is tried instead of this one where it stands on the front."""

    def player(self, machine: Machine, setting: Setting) -> Player:
        """BrokenDownError where it does not start; where the motion runs away, of its calls."""


class BrokenDownError(Exception):
    """A motion that the program gives up, or that runs away."""


def described(program: Program, setting: Setting, dt: float) -> str:
    """The setting in words; `dt` [s] is the control period."""
    said = f", {setting.solver}" if str(setting.solver) else ""
    return f"{setting.parts} {program.part} a link, step {1e3 * dt / setting.substeps:.3g} ms{said}"
