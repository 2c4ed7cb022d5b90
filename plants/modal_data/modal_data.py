"""The flexibility of an appendage as modal data: mass, first moment, inertia and the integrals of its clamped modes.

Axes     origin at the attachment point; a boom or panel lies along +x
Modes    displacement phi_k(r) of the body clamped at its origin (cantilever modes), so that s = r + sum phi_k eta_k
Source   "Equations of Motion of Flexible Spacecraft", Eqs (9)-(13) and (24); every integral follows
         from Pi = int z z^T dm, z = (1, r, phi_1 .. phi_n).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import require_counts, require_finite, require_number
from pliant.plants.core.parameters import require_count
from pliant.plants.core.signals import OwnsArrays, read_only
from pliant.plants.linear.second_order import natural_squares

from .component_modes import clamped_modes
from .data_sheet import from_participation, rigid
from .from_beams import boom, panel
from .integrals import nodal
from .nastran import read_nastran

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class ModalData(OwnsArrays):
    """A body of n clamped modes. Integrals run over its mass; arrays are write-protected copies.

    The shortening that n modes cause is s2(r) = -(1/2) sum g_kl(r) eta_k eta_l (zero where it is not known).
    """

    mass: float  # [kg]
    first: Array = field(repr=False)  # int r dm (3,) [kg m]
    second: Array = field(repr=False)  # int r r^T dm (3, 3) [kg m^2]
    R: Array = field(repr=False)  # int phi_k dm (n, 3) [kg], Eq (9)
    moments: Array = field(repr=False)  # int r phi_k^T dm (n, 3, 3) [kg m]
    overlaps: Array = field(repr=False)  # int phi_k phi_l^T dm (n, n, 3, 3) [kg]
    stiffness: Array = field(repr=False)  # (n, n) [N/m]
    damping: Array = field(repr=False)  # (n, n) [N s/m]
    shortening: Array = field(repr=False)  # int g_kl dm (n, n, 3) [kg/m]
    shortening_moments: Array = field(repr=False)  # int r g_kl^T dm (n, n, 3, 3) [kg]
    shortening_overlaps: Array = field(repr=False)  # int phi_j g_kl^T dm (n, n, n, 3, 3) [kg/m]
    shortening_squares: Array = field(repr=False)  # int g_kl g_mn^T dm (n, n, n, n, 3, 3) [kg/m^2]
    tip: Array = field(repr=False)  # the point that outputs watch (3,) [m]
    tip_shapes: Array = field(repr=False)  # phi_k there (n, 3)
    outline: Array = field(repr=False)  # points for drawing (m, 3) [m]
    outline_shapes: Array = field(repr=False)  # phi_k there (n, m, 3)

    def __post_init__(self) -> None:
        n = len(require_finite("ModalData.R", self.R, (-1, 3)))
        object.__setattr__(self, "mass", require_number("ModalData.mass", self.mass, "positive", "kg"))
        shapes: dict[str, tuple[int, ...]] = {"first": (3,), "second": (3, 3), "R": (n, 3), "moments": (n, 3, 3)}
        shapes |= {"overlaps": (n, n, 3, 3), "stiffness": (n, n), "damping": (n, n), "shortening": (n, n, 3)}
        shapes |= {"shortening_moments": (n, n, 3, 3), "tip": (3,), "tip_shapes": (n, 3)}
        shapes |= {"shortening_overlaps": (n, n, n, 3, 3), "shortening_squares": (n, n, n, n, 3, 3)}
        shapes |= {"outline": (-1, 3), "outline_shapes": (n, -1, 3)}
        for name, shape in shapes.items():
            object.__setattr__(self, name, read_only(f"ModalData.{name}", getattr(self, name), shape))
        for name in ("second", "stiffness", "damping"):
            value = getattr(self, name)
            if np.abs(value - value.T).max(initial=0.0) > 1e-9 * np.abs(value).max(initial=0.0):
                raise ValueError(f"ModalData.{name} = {value.tolist()} must be symmetric")
        for name, value in (("int z z^T dm", self.pi), ("stiffness", self.stiffness), ("damping", self.damping)):
            least = np.linalg.eigvalsh((value + value.T) / 2)[0] if len(value) else 0.0
            if least < -1e-9 * np.abs(value).max(initial=0.0):
                raise ValueError(f"ModalData: {name} has the eigenvalue {least:.3g}, must be >= 0")
        if n and np.linalg.eigvalsh(self.modal_mass)[0] <= 1e-12 * np.abs(self.modal_mass).max():
            raise ValueError(f"ModalData.R: the {n} modes must be independent")

    def __eq__(self, other: object) -> bool:
        names = self.__dataclass_fields__
        return isinstance(other, ModalData) and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in names
        )

    def __hash__(self) -> int:
        return hash((self.mass, *(getattr(self, name).tobytes() for name in ("first", "R", "stiffness", "damping"))))

    @property
    def n(self) -> int:
        """How many modes."""
        return len(self.R)

    @property
    def centre(self) -> Array:
        """d, the mass centre (3,) [m]."""
        return self.first / self.mass

    @property
    def inertia(self) -> Array:
        """Inertia about the attachment point (3, 3) [kg m^2]."""
        return np.trace(self.second) * np.eye(3) - self.second

    @property
    def modal_mass(self) -> Array:
        """m_kl = int phi_k . phi_l dm (n, n) [kg]."""
        return np.einsum("klii->kl", self.overlaps)

    @cached_property
    def frequencies(self) -> Array:
        """Natural frequencies clamped (n,) [rad/s], ascending."""
        if not self.n:
            return np.zeros(0)
        return np.sqrt(np.maximum(natural_squares(self.stiffness, self.modal_mass), 0.0))

    @cached_property
    def pi(self) -> Array:
        """Pi = int z z^T dm (4 + 3 n, 4 + 3 n), z = (1, r, phi_1 .. phi_n)."""
        n = self.n
        Pi = np.zeros((4 + 3 * n, 4 + 3 * n))
        Pi[0, 0] = self.mass
        Pi[0, 1:4] = self.first
        Pi[1:4, 1:4] = self.second
        Pi[0, 4:] = self.R.ravel()
        Pi[1:4, 4:] = self.moments.transpose(1, 0, 2).reshape(3, 3 * n)
        Pi[4:, 4:] = self.overlaps.transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
        return np.triu(Pi) + np.triu(Pi, 1).T

    def keep(self, modes: Sequence[int]) -> ModalData:
        """The same body with these modes only, counted from 0."""
        chosen = list(require_counts("ModalData.keep", "modes", modes, 0, self.n - 1))
        pair = np.ix_(chosen, chosen)
        pairs = ("overlaps", "stiffness", "damping", "shortening", "shortening_moments")
        rows = ("R", "moments", "tip_shapes", "outline_shapes")
        values: dict[str, Any] = {name: getattr(self, name) for name in self.__dataclass_fields__}
        values["shortening_overlaps"] = values["shortening_overlaps"][np.ix_(chosen, chosen, chosen)]
        values["shortening_squares"] = values["shortening_squares"][np.ix_(chosen, chosen, chosen, chosen)]
        values |= {name: values[name][pair] for name in pairs} | {name: values[name][chosen] for name in rows}
        return ModalData(**values)

    def slowest(self, count: int) -> ModalData:
        """The same body with the `count` slowest of its modes, in their order here."""
        count = require_count("ModalData.slowest", "count", count, 0, self.n)
        squares = np.diag(self.stiffness) / np.diag(self.modal_mass)
        return self.keep(sorted(int(k) for k in np.argsort(squares, kind="stable")[:count]))

    @classmethod
    def rigid(cls, mass: float, first: Any, inertia: Any) -> ModalData:
        """A rigid body: first moment (3,) [kg m] and inertia (3, 3) [kg m^2] about the attachment point."""
        return cls(**rigid(mass, first, inertia))

    @classmethod
    def from_participation(
        cls,
        mass: float,
        centre: Any,
        inertia: Any,
        frequencies: Any,
        damping: Any,
        L_translation: Any,
        L_rotation: Any,
    ) -> ModalData:
        """From a data sheet: modes of unit mass, their factors about the attachment point (`data_sheet`).

        centre (3,) [m], inertia (3, 3) [kg m^2] there, frequencies (n,) [rad/s], damping a ratio or (n,),
        L_translation (n, 3) [kg^0.5] (None: zero), L_rotation (n, 3) [kg^0.5 m]. Its tip moves rigidly: no shapes.
        """
        return cls(**from_participation(mass, centre, inertia, frequencies, damping, L_translation, L_rotation))

    @classmethod
    def from_nodes(
        cls,
        positions: Any,
        masses: Any,
        shapes: Any,
        *,
        frequencies: Any = None,
        stiffness: Any = None,
        damping: Any = 0.0,
        shortening: Any = None,
        tip: int = -1,
    ) -> ModalData:
        """Sums over N nodes: positions (N, 3) [m], masses (N,) [kg], shapes (n, N, 3).

        `frequencies` (n,) [rad/s] of orthogonal modes, or `stiffness` (n, n) [N/m]. `damping`: a ratio for every
        mode, or (n, n) [N s/m]. `shortening` g_kl (n, n, N, 3) [1/m]. `tip`: the node that the outputs watch.
        """
        return cls(**nodal(positions, masses, shapes, frequencies, stiffness, damping, shortening, tip))

    @classmethod
    def boom(cls, beam: Beam, modes: tuple[int, int] = (1, 1)) -> ModalData:
        """A uniform slender boom along x: `modes` = (how many in x-y, how many in x-z), int phi^2 dx = L.

        Bending in x-z first; no torsion, no inertia about x.
        """
        return cls(**boom(beam, modes))

    @classmethod
    def panel(cls, beam: Beam, width: float, modes: tuple[int, int] = (1, 1)) -> ModalData:
        """A plate-like panel as a pair of such beams at y = +-width/2 [m]: `modes` = (bending, twisting), all in z.

        In bending the beams move together, in twisting against each other; in its plane the panel is stiff.
        """
        return cls(**panel(beam, width, modes))

    @classmethod
    def from_matrices(
        cls, mass: Any, stiffness: Any, positions: Any, *, root: Sequence[int], modes: int, damping: float = 0.0
    ) -> ModalData:
        """The slowest clamped modes of a structural model: M, K (6 N, 6 N) or (3 N, 3 N), nodes at positions (N, 3)
        [m].

        Freedoms of a node stand together: three translations, then three turns. `root`: the clamped nodes, one of
        them at the attachment point. Masses are lumped at the nodes (rows summed over translations along each
        axis), turns without mass condensed. ValueError where the lumped body has another first moment or inertia.
        """
        r = read_only("ModalData.positions", positions, (-1, 3))
        masses, shapes, omega = clamped_modes(mass, stiffness, r, root, modes)
        return cls.from_nodes(r, masses, shapes, frequencies=omega, damping=damping)

    @classmethod
    def from_nastran(
        cls,
        path: str | Path,
        positions: Any,
        *,
        root: Sequence[int],
        modes: int,
        mass: str = "mgg",
        stiffness: str = "kgg",
        damping: float = 0.0,
    ) -> ModalData:
        """As `from_matrices`, M and K read by name from an OP4 or OP2 file. Needs pyYeti: pip install pyyeti."""
        M, K = read_nastran(path, mass, stiffness)
        return cls.from_matrices(M, K, positions, root=root, modes=modes, damping=damping)
