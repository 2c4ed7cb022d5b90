"""Where states and inputs of a spacecraft stand in x and u."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Layout:
    """Slices of x and u; `hinges`, `modes` and so on one for each appendage."""

    position: slice
    quaternion: slice
    hinges: tuple[slice, ...]
    modes: tuple[slice, ...]
    velocity: slice
    omega: slice
    hinge_rates: tuple[slice, ...]
    mode_rates: tuple[slice, ...]
    wheels: slice
    hub_inputs: slice
    hinge_inputs: tuple[slice, ...]

    @classmethod
    def of(
        cls,
        angles: Sequence[int],
        modes: Sequence[int],
        moved: Sequence[int],
        *,
        wheels: int,
        hub_inputs: int,
        translation: bool,
    ) -> Layout:
        """angles, modes, moved: hinge axes, elastic coordinates and hinge inputs of each appendage."""
        place = 3 if translation else 0
        sizes = [place, 4, *angles, *modes, place, 3, *angles, *modes, wheels]
        ends = np.cumsum([0, *sizes])
        parts = [slice(int(a), int(b)) for a, b in itertools.pairwise(ends)]
        m = len(angles)
        starts = hub_inputs + np.cumsum([0, *moved])
        return cls(
            parts[0],
            parts[1],
            tuple(parts[2 : 2 + m]),
            tuple(parts[2 + m : 2 + 2 * m]),
            parts[2 + 2 * m],
            parts[3 + 2 * m],
            tuple(parts[4 + 2 * m : 4 + 3 * m]),
            tuple(parts[4 + 3 * m : 4 + 4 * m]),
            parts[-1],
            slice(0, hub_inputs),
            tuple(slice(int(a), int(b)) for a, b in itertools.pairwise(starts)),
        )

    def unknowns(self, i: int) -> list[int]:
        """Where appendage i's unknowns (hinges, modes) stand among all."""
        first = self.quaternion.stop - 6
        return [k - first for s in (self.hinges[i], self.modes[i]) for k in range(s.start, s.stop)]

    @property
    def rates(self) -> int:
        """Where the velocities of the unknowns after the hub's begin in x."""
        return self.omega.stop
