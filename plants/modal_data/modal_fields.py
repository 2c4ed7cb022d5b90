"""The integrals of a body's clamped modes, checked; see `modal_data`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np

from pliant.plants.core.argument_gates import (
    require_all,
    require_counts,
    require_finite,
    require_mapping,
    require_number,
    require_text,
)
from pliant.plants.core.parameters import require_count
from pliant.plants.core.signals import OwnsArrays, read_only
from pliant.plants.linear.second_order import natural_squares

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class ModalNode(OwnsArrays):
    """A named point of a body of n modes: where it stands, how each mode moves and turns it.

    `turns` None: nothing is known of them, and what hangs there does not turn with it. `shortening` g_kl there, None
    where it is not known.

    >>> ModalNode("tip", position=(5.0, 0.0, 0.0), shapes=[[0.0, 0.0, 2.0]], turns=[[0.0, -0.55, 0.0]]).name
    'tip'
    """

    name: str
    position: Array  # (3,) [m]
    shapes: Array  # phi_k (n, 3)
    turns: Array | None = None  # psi_k (n, 3) [rad/m]
    shortening: Array | None = None  # g_kl (n, n, 3) [1/m]

    def __post_init__(self) -> None:
        require_text("ModalNode.name", self.name)
        object.__setattr__(self, "position", read_only("ModalNode.position", self.position, (3,)))
        object.__setattr__(self, "shapes", read_only("ModalNode.shapes", self.shapes, (-1, 3)))
        n = len(self.shapes)
        for name, shape in (("turns", (n, 3)), ("shortening", (n, n, 3))):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, read_only(f"ModalNode.{name}", getattr(self, name), shape))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ModalNode) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def _key(self) -> tuple[Any, ...]:
        arrays = (self.position, self.shapes, self.turns, self.shortening)
        return (self.name, *(None if a is None else (a.shape, a.tobytes()) for a in arrays))

    def keep(self, chosen: list[int]) -> ModalNode:
        """With these modes only."""
        turns = None if self.turns is None else self.turns[chosen]
        g = None if self.shortening is None else self.shortening[np.ix_(chosen, chosen)]
        return ModalNode(self.name, self.position, self.shapes[chosen], turns, g)


def named_nodes(
    nodes: Mapping[str, int] | None, positions: Any, shapes: Any, turns: Any, shortening: Any
) -> tuple[ModalNode, ...]:
    """Nodes by name from what is known of all nodes, as `ModalData.from_nodes` has it."""
    found = require_mapping("ModalData.nodes", nodes, None, "node") if nodes is not None else {}
    r, phi = np.asarray(positions, dtype=float), np.asarray(shapes, dtype=float)
    psi = None if turns is None else read_only("ModalData.turns", turns, phi.shape)
    g = None if shortening is None else np.asarray(shortening, dtype=float)
    named = []
    for name, k in found.items():
        k = require_count("ModalData.nodes", repr(name), k, -len(r), len(r) - 1)
        own, pulled = None if psi is None else psi[:, k], None if g is None else g[:, :, k]
        named.append(ModalNode(name, r[k], phi[:, k], own, pulled))
    return tuple(named)


@dataclass(frozen=True, eq=False)
class ModalFields(OwnsArrays):
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
    nodes: tuple[ModalNode, ...] = field(default=(), repr=False)  # where other bodies may hang

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

        object.__setattr__(self, "nodes", require_all("ModalData.nodes", self.nodes, ModalNode))
        for k, node in enumerate(self.nodes):
            if len(node.shapes) != n or node.name in [other.name for other in self.nodes[:k]]:
                raise ValueError(
                    f"ModalData.nodes[{k}] = {node.name!r} has {len(node.shapes)} shapes, must have {n} and a name of "
                    "its own"
                )

    def __eq__(self, other: object) -> bool:
        names = [name for name in self.__dataclass_fields__ if name != "nodes"]
        return (
            isinstance(other, ModalFields)
            and self.nodes == other.nodes
            and all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)
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

    def keep(self, modes: Sequence[int]) -> Self:
        """The same body with these modes only, counted from 0."""
        chosen = list(require_counts("ModalData.keep", "modes", modes, 0, self.n - 1))
        pair = np.ix_(chosen, chosen)
        pairs = ("overlaps", "stiffness", "damping", "shortening", "shortening_moments")
        rows = ("R", "moments", "tip_shapes", "outline_shapes")
        values: dict[str, Any] = {name: getattr(self, name) for name in self.__dataclass_fields__}
        values["shortening_overlaps"] = values["shortening_overlaps"][np.ix_(chosen, chosen, chosen)]
        values["shortening_squares"] = values["shortening_squares"][np.ix_(chosen, chosen, chosen, chosen)]
        values["nodes"] = tuple(node.keep(chosen) for node in self.nodes)
        values |= {name: values[name][pair] for name in pairs} | {name: values[name][chosen] for name in rows}
        return type(self)(**values)

    def slowest(self, count: int) -> Self:
        """The same body with the `count` slowest of its modes, in their order here."""
        count = require_count("ModalData.slowest", "count", count, 0, self.n)
        squares = np.diag(self.stiffness) / np.diag(self.modal_mass)
        return self.keep(sorted(int(k) for k in np.argsort(squares, kind="stable")[:count]))

    def node(self, name: str) -> ModalNode:
        """A named node; "": the point that outputs watch, of which no turn is known.

        ValueError for a name that the data lack.
        """
        for node in self.nodes:
            if node.name == name:
                return node
        if name:
            known = ", ".join(repr(node.name) for node in self.nodes)
            raise ValueError(f"ModalData.node = {name!r} must be one of {known or 'none: the data name no nodes'}")
        return ModalNode("tip", self.tip, self.tip_shapes)
