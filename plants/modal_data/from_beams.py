"""Modal integrals of booms and panels made of uniform beams along x, clamped at the origin; int phi^2 dx = L."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.beams.euler_bernoulli_modes import quadrature
from pliant.plants.beams.section import Beam
from pliant.plants.beams.shape_functions import basis
from pliant.plants.core.argument_gates import require_counts, require_instance, require_number
from pliant.plants.core.parameters import is_symbolic

from .integrals import integrals
from .modal_fields import ModalNode

Array = np.ndarray


def _counts(modes: tuple[int, int], kind: str) -> tuple[int, int]:
    first, second = require_counts(f"ModalData.{kind}", "modes", modes, 0, 100, length=2)
    return first, second


def beam_stiffness(beam: Beam, moment: str) -> float:
    """E I [N m^2] for bending resisted by I_z (in x-y) or I_y (in x-z); ValueError where it is an expression."""
    require_instance("beam", beam, Beam)
    for name in ("length", "density", "area", "E", moment, "damping"):
        if is_symbolic(getattr(beam, name)):
            raise ValueError(f"Beam.{name} of an appendage cannot be varied; vary its stiffness_factor instead")
    return float(beam.E * getattr(beam, moment))


def boom(beam: Beam, modes: tuple[int, int]) -> dict[str, Any]:
    """Fields of ModalData of a uniform slender boom along x: `modes` = (how many in x-y, how many in x-z)."""
    in_plane, out = _counts(modes, "boom")
    return _along_x(
        beam,
        [(0.0, 1.0)],
        [(2, out, beam_stiffness(beam, "I_y"), (1.0,)), (1, in_plane, beam_stiffness(beam, "I_z"), (1.0,))],
    )


def panel(beam: Beam, width: float, modes: tuple[int, int]) -> dict[str, Any]:
    """Fields of ModalData of a pair of such beams at y = +-width/2 [m]: `modes` = (bending, twisting), all in z."""
    bending, twisting = _counts(modes, "panel")
    width = require_number("ModalData.panel width", width, "positive", "m")
    lines = [(width / 2, 1.0), (-width / 2, 1.0)]
    EI = beam_stiffness(beam, "I_y")
    return _along_x(beam, lines, [(2, bending, EI, (1.0, 1.0)), (2, twisting, EI, (1.0, -1.0))])


def _along_x(
    beam: Beam,
    lines: list[tuple[float, float]],
    families: list[tuple[int, int, float, tuple[float, ...]]],
) -> dict[str, Any]:
    """Parallel beams along x at (y, share of the beam's mass); families of (direction, modes, EI, sign on each line).

    Gauss's points serve as nodes: they integrate products of the shapes exactly to rounding.
    """
    L, most = float(beam.length), max(count for _, count, _, _ in families)
    xi, weight = quadrature(max(most, 1))
    n, points = sum(count for _, count, _, _ in families), len(xi)
    r = np.concatenate([np.column_stack([L * xi, np.full(points, y), np.zeros(points)]) for y, _ in lines])
    dm = np.concatenate([share * beam.mass * weight for _, share in lines])
    phi = np.zeros((n, len(r), 3))
    ends, turns, frequencies, k = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n), 0
    for direction, count, EI, signs in families:
        if not count:
            continue
        shape = basis("clamped-free", count).phi
        value, end, slope = shape(xi), shape(np.array(1.0)), shape(np.array(1.0), 1) / L
        for j in range(count):
            phi[k, :, direction] = np.concatenate([s * value[:, j] for s in signs])
            ends[k, direction] = signs[0] * end[j]
            turns[k, 3 - direction] = signs[0] * (slope[j] if direction == 1 else -slope[j])
            if len(lines) > 1:
                turns[k, 0] = (signs[0] - signs[1]) * end[j] / (lines[0][0] - lines[1][0])
            frequencies[k] = shape.roots[j] ** 2 * np.sqrt(EI / (beam.linear_density * L**4))  # type: ignore[union-attr]
            k += 1
    tip = np.array([L, lines[0][0], 0.0])
    g = np.zeros((n, n, len(r), 3))
    g[..., 0] = _shortening(families, n, L, xi)
    g_tip = np.zeros((n, n, 3))
    g_tip[..., 0] = _shortening(families, n, L, np.array([1.0]))[..., 0]
    values = integrals(r, dm, phi, g)
    stiffness = np.diag(frequencies**2 * np.einsum("kkii->k", values["overlaps"]))
    shown = slice(None, points, max(points // 12, 1))
    values |= {
        "stiffness": stiffness,
        "damping": beam.damping * stiffness,
        "tip": tip,
        "tip_shapes": ends,
        "outline": np.vstack([r[shown], tip]),
        "outline_shapes": np.concatenate([phi[:, shown], ends[:, None]], axis=1),
    }
    tidied = {name: _tidy(value) for name, value in values.items()}
    return {**tidied, "nodes": (ModalNode("tip", tip, _tidy(ends), _tidy(turns), _tidy(g_tip)),)}


def _shortening(families: list[tuple[int, int, float, tuple[float, ...]]], n: int, L: float, xi: Array) -> Array:
    """g_kl (n, n, lines * points) [1/m] along x: the integral of phi_k' . phi_l' from the root to x = L xi."""
    most = max(count for _, count, _, _ in families)
    g = np.zeros((n, n, len(families[0][3]), len(xi)))
    if not most:
        return g.reshape(n, n, len(families[0][3]) * len(xi))
    node, weight = quadrature(most)
    slope = basis("clamped-free", most).phi(xi[:, None] * node, 1) / L
    growth = np.einsum("pqi,pqj,q,p->ijp", slope, slope, weight, L * xi)
    modes = [(direction, j, np.array(signs)) for direction, count, _, signs in families for j in range(count)]
    for k, (along, i, sign) in enumerate(modes):
        for l, (other, j, turned) in enumerate(modes):
            if along == other:
                g[k, l] = (sign * turned)[:, None] * growth[i, j]
    return g.reshape(n, n, len(families[0][3]) * len(xi))


def _tidy(value: Any) -> Any:
    """Rounding in place of a zero of the theory (orthogonal modes) becomes that zero."""
    if np.ndim(value) < 1:
        return value
    return np.where(np.abs(value) > 1e-13 * np.abs(value).max(initial=0.0), value, 0.0)
