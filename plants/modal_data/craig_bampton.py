"""A body as structural programs hand it over: freedoms of its boundary and modal freedoms (Craig-Bampton).

M = [M_bb M_bq; M_qb M_qq], K = [K_bb 0; 0 K_qq], modes q with the boundary held (cantilever modes). The boundary's
nodes are held together by a rigid interface: u_b = T (d, turn) of the attachment point, K_bb T = 0. Then T' M_bb T
holds mass, first moment and inertia, and M_qb T the participation factors int phi dm and int r x phi dm, both exactly.

How modes change the inertia needs more than these matrices hold, int r phi^T dm and int phi phi^T dm: they are taken as
of the rigid motion nearest to each mode, with what is left of its modal mass spread over the axes alike. So the linear
model is exact; terms of second order in the amplitudes are what the participation factors tell.

Source   R. R. Craig and M. C. C. Bampton, "Coupling of substructures for dynamic analyses", AIAA J. 6 (1968)
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_all, require_number
from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_count, require_finite
from pliant.plants.core.quaternions import skew
from pliant.plants.core.signals import read_only

from .data_sheet import fields_of_factors
from .modal_fields import ModalNode

Array = np.ndarray
RIGID = 1e-4  # of K_bb: forces that a rigid motion of the boundary may meet, as text files round them
COUPLED = 1e-6  # of the mean of both: stiffness between the boundary and the modes


def craig_bampton(
    mass: Any, stiffness: Any, boundary: Any, axes: Any, origin: Any, modes: int | None, damping: float, nodes: Any
) -> dict[str, Any]:
    """Fields of ModalData; the arguments are those of `ModalData.from_craig_bampton`, checked here."""
    r = read_only("from_craig_bampton.boundary", boundary, (-1, 3))
    K = require_finite("from_craig_bampton.stiffness", stiffness, (-1, -1))
    M = require_finite("from_craig_bampton.mass", mass, K.shape)
    b, n = 6 * len(r), len(K) - 6 * len(r)
    if K.shape[0] != K.shape[1] or n < 0:
        raise ValueError(
            f"from_craig_bampton.stiffness is {K.shape}, must be square with at least {b} rows, six a boundary node"
        )
    at = r.mean(axis=0) if origin is None else read_only("from_craig_bampton.origin", origin, (3,))
    R = (
        np.tile(np.eye(3), (len(r), 1, 1))
        if axes is None
        else read_only("from_craig_bampton.axes", axes, (len(r), 3, 3))
    )
    T = _rigid(r - at, R)
    _check(K, T, b)
    whole, driven = T.T @ M[:b, :b] @ T, M[b:, :b] @ T
    modes = n if modes is None else require_count("from_craig_bampton", "modes", modes, 0, n)
    squares, Q = linalg.eigh(_even(K[b:, b:]), _even(M[b:, b:])) if n else (np.zeros(0), np.zeros((0, 0)))
    if n and squares[0] <= 0:
        raise ValueError(f"from_craig_bampton.stiffness: mode 1 has omega^2 = {squares[0]:.3g} 1/s^2, must be > 0")
    Q, squares = Q[:, :modes], squares[:modes]
    damping = require_number("from_craig_bampton.damping", damping, "nonnegative")
    driven = Q.T @ driven
    nearest = driven @ np.linalg.pinv(whole, rcond=1e-12, hermitian=True)
    mass = float(np.trace(whole[:3, :3]) / 3)
    first = np.array([whole[1, 5] - whole[2, 4], whole[2, 3] - whole[0, 5], whole[0, 4] - whole[1, 3]]) / 2
    owner, J, omega = "from_craig_bampton.mass", _even(whole[3:, 3:]), np.sqrt(squares)
    found = fields_of_factors(owner, mass, first, J, driven, nearest, omega, damping)
    named = [_mixed(node, Q, n, at) for node in require_all("from_craig_bampton.nodes", nodes, ModalNode)]
    places, shapes = [node.position for node in named], [node.shapes for node in named]
    return found | {
        "outline": np.array([*found["outline"], *places]),
        "outline_shapes": np.concatenate([found["outline_shapes"], *(s[:, None] for s in shapes)], axis=1),
        "nodes": tuple(named),
    }


def _rigid(r: Array, R: Array) -> Array:
    """T (6 N, 6): freedoms of the boundary's nodes, in each one's axes R, by those of the origin."""
    blocks = [
        np.block([[turn.T, -turn.T @ skew(at)], [np.zeros((3, 3)), turn.T]]) for at, turn in zip(r, R, strict=True)
    ]
    return np.concatenate(blocks)


def _even(A: Array) -> Array:
    return (A + A.T) / 2


def _check(K: Array, T: Array, b: int) -> None:
    """ValueError where the boundary is not where it is said to be, or the modes are not those of a held boundary."""
    sizes = np.sqrt(np.abs(np.diag(T.T @ np.diag(np.diag(np.abs(K[:b, :b]))) @ T)))
    felt = np.sqrt(np.abs(np.diag(T.T @ K[:b, :b] @ T)))
    worst = float((felt / np.maximum(sizes, 1e-300)).max(initial=0.0)) ** 2
    if worst > RIGID:
        raise ValueError(
            f"from_craig_bampton.boundary: a rigid motion meets {worst:.2g} of the boundary's own stiffness (<= "
            f"{RIGID}): positions, axes or the order of the freedoms are others"
        )
    between = np.abs(K[:b, b:]) / np.sqrt(np.maximum(np.outer(np.diag(K)[:b], np.diag(K)[b:]), 1e-300))
    if between.size and between.max() > COUPLED:
        raise ValueError(
            f"from_craig_bampton.stiffness couples boundary and modes by {between.max():.2g} (<= {COUPLED}): "
            "the modes must be those of a held boundary"
        )


def _mixed(node: ModalNode, Q: Array, n: int, origin: Array) -> ModalNode:
    """A node's shapes by the modes kept, its position from the attachment point."""
    if len(node.shapes) != n:
        raise ValueError(
            f"from_craig_bampton.nodes: {node.name!r} has {len(node.shapes)} shapes, must have one for each "
            f"of {n} modal freedoms"
        )
    turns = None if node.turns is None else Q.T @ node.turns
    return ModalNode(node.name, node.position - origin, Q.T @ node.shapes, turns)
