"""The flexibility of an appendage as modal data: mass, first moment, inertia and the integrals of its clamped modes.

Axes     origin at the attachment point; a boom or panel lies along +x
Modes    displacement phi_k(r) of the body clamped at its origin (cantilever modes), so that s = r + sum phi_k eta_k
Source   "Equations of Motion of Flexible Spacecraft", Eqs (9)-(13) and (24); every integral follows
         from Pi = int z z^T dm, z = (1, r, phi_1 .. phi_n).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.signals import read_only

from .component_modes import clamped_modes
from .craig_bampton import craig_bampton
from .data_sheet import from_participation, rigid
from .from_beams import boom, panel
from .integrals import nodal
from .modal_fields import ModalFields, ModalNode, named_nodes
from .nastran import read_nastran

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class ModalData(ModalFields):
    """See `ModalFields`; from nodes, beams, panels, matrices, a NASTRAN file."""

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
        L_translation (n, 3) [kg^0.5] (None: zero), L_rotation (n, 3) [kg^0.5 m]. Its tip is its mass
        centre, which they move by L_translation / mass.
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
        nodes: Mapping[str, int] | None = None,
        turns: Any = None,
    ) -> ModalData:
        """Sums over N nodes: positions (N, 3) [m], masses (N,) [kg], shapes (n, N, 3).

        `frequencies` (n,) [rad/s] of orthogonal modes, or `stiffness` (n, n) [N/m]. `damping`: a ratio for every
        mode, or (n, n) [N s/m]. `shortening` g_kl (n, n, N, 3) [1/m]. `tip`: the node that the outputs watch.
        `nodes`: those that other bodies may hang on, by name; `turns` (n, N, 3) [rad/m] of all nodes, where known.
        """
        fields = nodal(positions, masses, shapes, frequencies, stiffness, damping, shortening, tip)
        return cls(**fields, nodes=named_nodes(nodes, positions, shapes, turns, shortening))

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
        cls,
        mass: Any,
        stiffness: Any,
        positions: Any,
        *,
        root: Sequence[int],
        modes: int,
        damping: float = 0.0,
        nodes: Mapping[str, int] | None = None,
    ) -> ModalData:
        """The slowest clamped modes of a structural model: M, K (6 N, 6 N) or (3 N, 3 N), nodes at positions (N, 3)
        [m].

        Freedoms of a node stand together: three translations, then three turns. `root`: the clamped nodes, one of
        them at the attachment point. Masses are lumped at the nodes (rows summed over translations along each
        axis), turns without mass condensed. ValueError where the lumped body has another first moment or inertia.
        `nodes`: those that other bodies may hang on, by name; they turn where nodes have six freedoms.
        """
        r = read_only("ModalData.positions", positions, (-1, 3))
        masses, shapes, omega, turns = clamped_modes(mass, stiffness, r, root, modes)
        return cls.from_nodes(r, masses, shapes, frequencies=omega, damping=damping, nodes=nodes, turns=turns)

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
        nodes: Mapping[str, int] | None = None,
    ) -> ModalData:
        """As `from_matrices`, M and K read by name from an OP4 or OP2 file. Needs pyYeti: pip install pyyeti.

        positions (k, 3) [m]; damping [-], a ratio. ValueError for a file without such matrices, ImportError without
        pyYeti.

        Example
        -------
        >>> import tempfile
        >>> from pyyeti.nastran import op4
        >>> file = tempfile.mkdtemp() + "/two_masses.op4"  # of 1 kg, 2 N/m along and 4 N/m across between them
        >>> K = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag([2.0, 4, 4, 1, 1, 1]))
        >>> op4.write(file, {"kgg": K, "mgg": np.kron(np.eye(2), np.diag([1.0, 1, 1, 1e-3, 1e-3, 1e-3]))})
        >>> body = ModalData.from_nastran(file, [[0.0, 0, 0], [1.0, 0, 0]], root=[0], modes=3)
        >>> body.mass, body.frequencies
        (2.0, array([ 1.4142,  2.    ,  2.    ]))
        """
        M, K = read_nastran(path, mass, stiffness)
        return cls.from_matrices(M, K, positions, root=root, modes=modes, damping=damping, nodes=nodes)

    @classmethod
    def from_craig_bampton(
        cls,
        mass: Any,
        stiffness: Any,
        boundary: Any,
        *,
        axes: Any = None,
        freedoms: Any = None,
        origin: Any = None,
        modes: int | None = None,
        damping: float = 0.0,
        nodes: Sequence[ModalNode] = (),
    ) -> ModalData:
        """The slowest modes (None: all) of a body handed over as boundary and modal freedoms: NASTRAN's mxx and kxx,
        or maa and kaa, of an external superelement.

        M, K (6 N + n, 6 N + n): six freedoms of each boundary node at `boundary` (N, 3) [m], in `axes` (N, 3, 3)
        (None: the body's), then n modal freedoms; fewer where `freedoms` names those of each node, as (1, 2, 3, 5):
        shifts 1 to 3 and turns 4 to 6 along and about its axes. A rigid interface holds the nodes; the attachment point
        is `origin` (3,) (None: their mean). `nodes`: named points with shapes and turns by modal freedom (rows of the
        recovery matrices), placed as the boundary is. Mass, first moment, inertia, participation factors and
        frequencies are exact; `craig_bampton` says what the matrices do not hold.

        >>> mxx, kxx = np.diag([2.0, 2.0, 2.0, 0.5, 0.5, 0.5, 1.0]), np.diag([0.0] * 6 + [400.0])
        >>> mxx[2, 6] = mxx[6, 2] = 0.9  # the mode and the boundary's z
        >>> ModalData.from_craig_bampton(mxx, kxx, boundary=[[0.0, 0.0, 0.0]], modes=1, damping=0.01).mass
        2.0
        """
        return cls(**craig_bampton(mass, stiffness, boundary, axes, freedoms, origin, modes, damping, nodes))
