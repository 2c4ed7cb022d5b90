"""The richest models of the arms, by which their fidelities are judged, and how a simpler arm's motion is theirs.

Exact rotations, rotary inertia and shear, on polynomials, which hold any curvature that loads at the tip and inertia
bring about.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self, TypeVar, cast

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.lagrangian import LagrangianPlant
from pliant.plants.exact_rotations.projection import projection
from pliant.plants.validity.rotating_sections import AXIAL, TURN, largest_reached, longer

if TYPE_CHECKING:
    from .single_link import SingleLinkArm
    from .single_link_declaration import SingleLinkDeclaration
    from .two_link_declaration import TwoLinkDeclaration

S = TypeVar("S", bound="SingleLinkDeclaration")
T = TypeVar("T", bound="TwoLinkDeclaration")

SINGLE, TWO = 4, 3  # shapes of a link that physics has by itself
STRETCHES = 2  # of the axis of a link that stretches: under a force at its tip, and under its own weight or spin
MOST = 12  # shapes of a link: beyond, polynomials of this degree are told apart by few digits alone
UNMODELLED = ("bending out of the plane", "torsion", "extension", "joints that give way", "plasticity")


@dataclass(frozen=True, kw_only=True)
class PlanarArm(LagrangianPlant):
    """What both arms say alike of their fidelities."""

    @property
    def stretches(self) -> int:
        """Axial coordinates of a link."""
        arm: Any = self
        return STRETCHES if arm.extensible else 0

    @property
    def stretching(self) -> str:
        """Of a label."""
        return ", stretch" if self.stretches else ""

    @property
    def stiff(self) -> bool:
        """Waves run along a link's axis while it hardly bends."""
        return self.stretches > 0

    @property
    def inextensible(self) -> Self:
        """The same arm whose links keep their lengths."""
        arm: Any = self
        return cast(Self, dataclasses.replace(arm, extensible=False)) if arm.extensible else self

    def _lacking(self, effect: str) -> Self:
        arm: Any = self.inextensible
        changes: dict[str, dict[str, Any]] = {
            "bending": {"modes": 0 if isinstance(arm.modes, int) else (0, 0)},
            "extension": {},
            "shortening of the bent links": {"kinematics": "linear"},
            "exact rotations": {"kinematics": "stiffened"},
            "shear": {"theory": "euler-bernoulli"},
            "slope of the first link's tip": {"tip_slope": False},
            "inertia of the bent arm": {"reduction": "rigid-inertia"},
        }
        return cast(Self, dataclasses.replace(arm, **changes[effect]))

    def estimates(self, motion: Trajectory) -> dict[str, tuple[Self, ...]]:
        """Extension: each link `longer` for good, then links that stretch."""
        arm: Any = self
        if arm.extensible:
            return {}
        fields = ("link",) if len(arm.deflections) == 1 else ("link1", "link2")
        strains, turns = (largest_reached(arm, motion, what) for what in (AXIAL, TURN))
        links = {field: longer(getattr(arm, field), *reached) for field, *reached in zip(fields, strains, turns)}
        if not links:
            return {}
        return {"extension": (dataclasses.replace(arm, **links), dataclasses.replace(arm, extensible=True))}

    @property
    def unmodelled(self) -> tuple[str, ...]:
        return UNMODELLED


def require_stretchable(arm: Any) -> None:
    """ValueError where links shall stretch whose kinematics do not let them."""
    if arm.extensible and not (arm.kinematics == "strain" and arm.theory == "timoshenko"):
        raise ValueError(
            f"{type(arm).__name__}.extensible = True needs kinematics = 'strain' and theory = 'timoshenko', "
            f"not {arm.kinematics!r} and {arm.theory!r}"
        )


def of_single_link(arm: S, more: int) -> S:
    """Exact rotations with shear of a single link."""
    modes = min(SINGLE + more, MOST)
    return dataclasses.replace(
        arm, kinematics="strain", theory="timoshenko", frame="clamped", basis="polynomial", modes=modes
    )


def of_two_links(arm: T, more: int) -> T:
    """Exact rotations with shear of two links, whose joint turns with the first one's tip."""
    modes = (min(TWO + more, MOST),) * 2
    return dataclasses.replace(
        arm, kinematics="strain", theory="timoshenko", basis="polynomial", modes=modes, reduction="full", tip_slope=True
    )


def single_embedding(finer: SingleLinkArm, simpler: SingleLinkArm) -> np.ndarray:
    """E (nx, nx of simpler): the hub as it is, curvatures projected, each in its own frame."""
    bend = linalg.block_diag(1.0, projection(simpler.elastic.basis, finer.elastic.basis))
    E = np.linalg.solve(finer.clamped_map, bend @ simpler.clamped_map)
    return np.kron(np.eye(2), E)


def two_embedding(finer: TwoLinkDeclaration, simpler: TwoLinkDeclaration) -> np.ndarray:
    """E (nx, nx of simpler): joints as they are, curvatures of each link projected."""
    bends = [projection(a.basis, b.basis) for a, b in zip(simpler.links, finer.links)]
    return np.kron(np.eye(2), linalg.block_diag(np.eye(2), *bends))


def effects_of_link(arm: SingleLinkDeclaration) -> dict[str, bool]:
    """What physics has, and whether this variant does."""
    bends = arm.mode_count > 0
    return {
        "bending": bends,
        "shortening of the bent links": bends and arm.kinematics in ("stiffened", "strain"),
        "exact rotations": bends and arm.kinematics == "strain",
        "shear": bends and arm.theory == "timoshenko",
        **({"extension": True} if arm.extensible else {}),
    }


def effects_of_links(arm: TwoLinkDeclaration) -> dict[str, bool]:
    """The same of two links."""
    bends = any(arm.mode_counts)
    return {
        "bending": bends,
        "shortening of the bent links": bends and arm.kinematics in ("stiffened", "strain"),
        "exact rotations": bends and arm.kinematics == "strain",
        "shear": bends and arm.theory == "timoshenko",
        "slope of the first link's tip": bends and arm.tip_slope,
        "inertia of the bent arm": bends and arm.reduction == "full",
        **({"extension": True} if arm.extensible else {}),
    }
