"""A verdict that is a theorem for the model given, or says that it is none: `assess(.., rigorous=True)`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pliant.plants.linear.lti import LinearModel
from pliant.plants.rigorous.enclosed_transition import Piece
from pliant.plants.rigorous.proof import Proof, of_constant, of_cycle, of_motion
from pliant.plants.transitions.state_matrix_path import Model, as_pieces, kept, scaling

from .verdict import Verdict

SURE = ("stable", "unstable")


def proven(found: Verdict, model: Model | LinearModel, states: Sequence[str] | None) -> Verdict:
    """The verdict with its proof; "stable" and "unstable" only where that shows them. ValueError beyond 12 states."""
    shown = _proof(found, model, states)
    if shown.verdict == "undecided":
        if found.verdict not in SURE:
            return replace(found, proof=shown)
        why = f"{found.verdict} as computed ({found.why}), but no theorem: {shown.words}"
        return replace(
            found, verdict="undecided", method="", why=why, margin_bound=np.nan, growth="unknown", proof=shown
        )
    low, high = shown.rate
    why = found.why
    if shown.verdict != found.verdict:
        why = f"{shown.words}; as computed, with what rounding and the nodes leave open, {found.verdict}: {found.why}"
    inside = low <= -found.margin <= high or not np.isfinite(found.margin)
    margin = found.margin if inside or shown.verdict == found.verdict else -(low + high) / 2
    return replace(
        found,
        verdict=shown.verdict,
        why=why,
        margin=margin,
        margin_bound=0.0 - high,
        growth=shown.growth or found.growth,
        drifting=found.drifting if shown.verdict in ("drift", "marginal") else (),
        proof=shown,
    )


def _proof(found: Verdict, model: Model | LinearModel, states: Sequence[str] | None) -> Proof:
    keep = kept(model, states)
    if isinstance(model, LinearModel):
        return of_constant(model.A[np.ix_(keep, keep)], model.dt)
    joined = as_pieces(model)
    A = [piece.A[:, keep][:, :, keep] for piece in joined.pieces]
    if len(A) == 1 and not np.ptp(A[0], axis=0).any():
        return of_constant(A[0][0])
    scale = scaling(np.concatenate(A))
    ratio = scale / scale[:, None]
    pieces = [Piece(piece.t, a * ratio) for piece, a in zip(joined.pieces, A)]
    jumps = [J[np.ix_(keep, keep)] * ratio for J, _ in joined.jumps]
    cycle = found.evidence.get("floquet")
    if cycle is None:
        names = [joined.pieces[0].state_names[k] for k in keep]
        return of_motion(pieces, jumps, scale, [names.index(name) for name in found.drifting])
    end = pieces[0].t[0] + cycle.period
    count = max(1, sum(bool(piece.t[-1] <= end + 1e-9 * cycle.period) for piece in pieces))
    if count == 1:
        pieces = [Piece(pieces[0].t, pieces[0].A, cycle.period)]
    return of_cycle(pieces[:count], jumps[: len(cycle.jumps)], cycle.period, scale)
