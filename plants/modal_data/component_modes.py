"""Clamped modes of a structural program's mass and stiffness matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import LEAST, require_counts
from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_count, require_finite
from pliant.plants.core.quaternions import skew

Array = np.ndarray
RANK = 1e-9  # of lengths: what rounding and the text of a file leave of a zero
LOST = 0.05  # of the rigid body's first moment and inertia that lumping may change


def clamped_modes(
    mass: Any, stiffness: Any, positions: Array, root: Sequence[int], modes: int
) -> tuple[Array, Array, Array, Array | None]:
    """(masses (N,), shapes (n, N, 3), frequencies (n,) [rad/s], turns (n, N, 3) where nodes have them); shapes of unit
    modal mass. Nodes at positions (N, 3).

    Guyan's condensation, exact for turns without mass. ValueError where a lumped mass differs between axes, where the
    lumped body is another one (offset masses, rotary inertia, a coarse mesh) or modes lack.
    """
    nodes = len(positions)
    K = require_finite("from_matrices.stiffness", stiffness, (-1, -1))
    M = require_finite("from_matrices.mass", mass, K.shape)
    per_node = len(K) // max(nodes, 1)
    if per_node * nodes != len(K) or per_node not in (3, 6):
        raise ValueError(
            f"from_matrices.stiffness is {K.shape}, must be {3 * nodes} or {6 * nodes} square for {nodes} nodes"
        )
    root = require_counts("from_matrices", "root", root, 0, nodes - 1)
    if not len(root):
        raise ValueError("from_matrices.root = () must name the clamped nodes")
    places = np.arange(len(K)).reshape(nodes, per_node)
    moved, turned = places[:, :3], places[:, 3:].ravel()
    lumped = np.column_stack([M[np.ix_(moved[:, c], moved[:, c])].sum(axis=1) for c in range(3)])
    spread = np.abs(lumped - lumped.mean(axis=1, keepdims=True)).max()
    if spread > 1e-6 * np.abs(lumped).max() or lumped.min() < 0:
        raise ValueError(f"from_matrices.mass: nodal masses {lumped.tolist()} must be equal along the axes and >= 0")
    masses = lumped.mean(axis=1)
    _check_lumped(M, masses, positions)
    _check_held(K, positions, places[list(root)].ravel())
    free_nodes = np.setdiff1d(np.arange(nodes), list(root))
    free = moved[free_nodes].ravel()
    inner = np.setdiff1d(turned, places[list(root)].ravel())
    inner = inner[np.diag(K)[inner] > 0]
    Kff = K[np.ix_(free, free)]
    if inner.size:
        Kfi = K[np.ix_(free, inner)]
        Kff = Kff - Kfi @ np.linalg.solve(K[np.ix_(inner, inner)], Kfi.T)
    carried = np.repeat(masses[free_nodes], 3) >= LEAST
    if not carried.all():
        where = free_nodes[~carried[::3]].tolist()
        raise ValueError(f"from_matrices.mass: nodes {where} must carry mass, at least {LEAST:g} kg")
    modes = require_count("from_matrices", "modes", modes, 0, len(free))
    if not modes:
        return masses, np.zeros((0, nodes, 3)), np.zeros(0), None
    squares, vectors = linalg.eigh(
        (Kff + Kff.T) / 2, np.diag(np.repeat(masses[free_nodes], 3)), subset_by_index=[0, modes - 1]
    )
    noise = len(Kff) * np.finfo(float).eps * np.abs(np.diag(Kff) / np.repeat(masses[free_nodes], 3)).max()
    if squares[0] <= noise:
        raise ValueError(
            f"from_matrices.stiffness lets a mechanism move, or nearly: omega^2 = {squares[0]:.3g} is within its "
            f"rounding of {noise:.3g} 1/s^2"
        )
    shapes = np.zeros((modes, nodes, 3))
    shapes[:, free_nodes] = vectors.T.reshape(modes, len(free_nodes), 3)
    if not turned.size:
        return masses, shapes, np.sqrt(squares), None
    turns = np.zeros((len(K), modes))
    if inner.size:
        turns[inner] = -np.linalg.solve(K[np.ix_(inner, inner)], Kfi.T @ vectors)
    return masses, shapes, np.sqrt(squares), turns[places[:, 3:]].transpose(2, 0, 1)


def _check_held(K: Array, positions: Array, clamped: Array) -> None:
    """ValueError where a rigid motion that leaves `clamped` freedoms in place meets no force beyond rounding."""
    rigid = _rigid_motions(positions, len(K) // len(positions))
    _, sizes, axes = np.linalg.svd(rigid[clamped])
    motions = rigid @ axes[np.count_nonzero(sizes > RANK * sizes.max(initial=0.0)) :].T  # root in place
    left, sizes, _ = np.linalg.svd(motions, full_matrices=False)
    motions = left[:, sizes > RANK * np.abs(rigid).max()]  # those that move something
    rounding = len(K) * np.finfo(float).eps * np.abs(K).sum(axis=1)
    felt = np.delete(K @ motions, clamped, axis=0) / np.maximum(np.delete(rounding, clamped), 1e-300)[:, None]
    if felt.shape[1] and np.linalg.svd(felt, compute_uv=False).min() < 1.0:
        raise ValueError(f"from_matrices.root clamps {len(clamped)} freedoms, which leaves a rigid motion free")


def _rigid_motions(positions: Array, per_node: int) -> Array:
    """Of each freedom in the six rigid motions, (N * per_node, 6): translations, then turns about the origin."""
    moved = np.zeros((len(positions), per_node, 6))
    moved[:, :3, :3] = np.eye(3)
    moved[:, :3, 3:] = -skew(positions)
    if per_node == 6:
        moved[:, 3:, 3:] = np.eye(3)
    return moved.reshape(-1, 6)


def _check_lumped(M: Array, masses: Array, positions: Array) -> None:
    """ValueError where the lumped masses (N,) have another first moment or inertia about the origin than M."""
    rigid = _rigid_motions(positions, len(M) // len(positions))
    moved = rigid.reshape(len(positions), -1, 6)
    whole, points = rigid.T @ M @ rigid, np.einsum("p,pia,pib->ab", masses, moved[:, :3], moved[:, :3])
    reach = np.abs(positions).max(initial=0.0)
    for name, part, size in (
        ("first moment", np.s_[:3, 3:], masses.sum() * reach),
        ("inertia", np.s_[3:, 3:], np.abs(whole[3:, 3:]).max()),
    ):
        lost = np.abs(whole[part] - points[part]).max() / max(size, 1e-300)
        if lost > LOST:
            raise ValueError(
                f"from_matrices.mass: lumping at the nodes changes the {name} by {lost:.2g} of itself (<= {LOST}): "
                "refine the mesh, or put offset masses and rotary inertia on nodes of their own"
            )
