"""Linear models about a nominal with jumps: an LTVModel on each smooth piece, and the jump of the deviations between.

An impulse P [input units times s] at a jump moves the state by f(x, P) - f(x, 0), exactly where the inputs enter
linearly and act on rates (forces and torques do). The nominal moves as its own program said; the difference is
carried as a jump of the deviations:

    dx+ = J dx- + j,   j = f(x-, P) - f(x-, 0) - (x+ - x-),   J = 1 + d/dx [f(x, P) - f(x, 0)] at x-
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from pliant.plants.core.parameters import require_finite
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.core.trajectory import Trajectory

from .ltv import LTVModel

Array = np.ndarray


class Linearised(Protocol):
    """What pieces ask of a plant."""

    @property
    def nu(self) -> int: ...

    def linearize_along(self, nominal: Trajectory, *, p: Any = None) -> LTVModel: ...

    def jump_map(self, x: Array, P: Array, *, after: Array, p: Any = None, t: float = 0.0) -> tuple[Array, Array]: ...


@dataclass(frozen=True, eq=False)
class PiecewiseLTV(OwnsArrays):
    """Pieces in order, each starting where the last ended, with one jump (J (nx, nx), j (nx,)) between each two."""

    pieces: tuple[LTVModel, ...]
    jumps: tuple[tuple[Array, Array], ...] = field(repr=False, default=())

    def __post_init__(self) -> None:
        if len(self.jumps) != len(self.pieces) - 1:
            raise ValueError(f"PiecewiseLTV.jumps has {len(self.jumps)} entries, must have {len(self.pieces) - 1}")
        for k, (a, b) in enumerate(zip(self.pieces[:-1], self.pieces[1:])):
            if abs(a.t[-1] - b.t[0]) > 1e-9 * max(abs(a.t[-1]), 1.0) or a.states != b.states:
                raise ValueError(
                    f"PiecewiseLTV.pieces[{k + 1}].t[0] = {b.t[0]:.9g} must be {a.t[-1]:.9g}, with the same states"
                )

    @property
    def t(self) -> Array:
        """All nodes; a jump's time is there twice."""
        return np.concatenate([piece.t for piece in self.pieces])

    @property
    def jump_times(self) -> Array:
        """Times of the jumps [s]."""
        return np.array([piece.t[0] for piece in self.pieces[1:]])

    def simulate(self, dx0: Any, du: Sequence[Any] | None = None) -> tuple[Array, Array]:
        """Deviations (dx, dy) at the nodes `t` from dx0 (nx,); `du`: one input, as of LTVModel.simulate, for each
        piece.
        """
        dx = require_finite("simulate.dx0", dx0, (len(self.pieces[0].states),))
        found = []
        for k, piece in enumerate(self.pieces):
            if k:
                J, j = self.jumps[k - 1]
                dx = J @ dx + j
            found.append(piece.simulate(dx, None if du is None else du[k]))
            dx = found[-1][0][-1]
        return np.concatenate([x for x, _ in found]), np.concatenate([y for _, y in found])

    def transition(self) -> Array:
        """The map (nx, nx) of deviations from start to end, jumps included."""
        total = np.eye(len(self.pieces[0].states))
        for k, piece in enumerate(self.pieces):
            if k:
                total = self.jumps[k - 1][0] @ total
            for Phi in piece.transition()[0]:
                total = Phi @ total
        return total


def linearize_pieces(
    plant: Linearised, nominals: Sequence[Trajectory], impulses: Sequence[Any] | None = None, *, p: Any = None
) -> PiecewiseLTV:
    """The models along each smooth piece of a nominal; `impulses` (nu,) at each jump, zero where None.

    Positions must not jump. The deviations are those of the plant's `linearize_along`.
    """
    if not nominals:
        raise ValueError("linearize_pieces: nominals = () must be one or more pieces")
    given = [np.zeros(plant.nu)] * (len(nominals) - 1) if impulses is None else list(impulses)
    if len(given) != len(nominals) - 1:
        raise ValueError(f"linearize_pieces: {len(given)} impulses, must be {len(nominals) - 1} (one for each jump)")
    pieces = tuple(plant.linearize_along(nominal, p=p) for nominal in nominals)
    jumps = []
    for before, after, P in zip(nominals[:-1], nominals[1:], given):
        P = require_finite("linearize_pieces.impulse", P, (plant.nu,))
        jumps.append(plant.jump_map(before.x[-1], P, after=after.x[0], p=p, t=float(before.t[-1])))
    return PiecewiseLTV(pieces, tuple(jumps))
