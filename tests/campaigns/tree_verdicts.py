"""Verdicts on machines that are trees, at rest in gravity: a seeded campaign.

    python tests/campaigns/tree_verdicts.py

Every coordinate is damped, so that the theorem of Kelvin, Tait and Chetaev counts what grows: as many roots as the
potential energy has directions in which it falls (Merkin, Introduction to the Theory of Stability, 1997, chapter 6).
The potential's second derivatives are central differences of the energy, which the equations of motion do not use.
Counted are wrong verdicts, wrong numbers of growing roots, and the share that stays undecided.
"""

from __future__ import annotations

import time
import warnings
from typing import Any

import by_seed
import numpy as np
from random_trees import random_tree

from pliant.plants import FlexibleTree, PliantError
from pliant.plants.stability import assess

STEP = 1e-4  # of a coordinate, in its own scale
ROUNDED = 1e3  # units of rounding of the energy, with what follows: below, a curvature's sign is not known


def curvatures(tree: FlexibleTree, x0: np.ndarray) -> tuple[np.ndarray, float]:
    """Eigenvalues of the potential's second derivatives at rest, in coordinates of like size, and their error."""
    n = len(tree.coordinates)
    moving = len(tree.moving)
    scale = np.where(np.arange(n) < moving, 1.0, 0.05)  # radians, metres of a slider; deflections

    def potential(dq: np.ndarray) -> np.ndarray:
        x = np.tile(x0, (len(dq), 1))
        x[:, :n] += dq * scale
        return np.asarray(tree.energy(x))

    unit = STEP * np.eye(n)
    i, k = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n)))
    found = [potential(a * unit[i] + b * unit[k]) for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
    H = ((found[0] - found[1] - found[2] + found[3]) / (4 * STEP**2)).reshape(n, n)
    curved = np.linalg.eigvalsh((H + H.T) / 2)
    rounding = ROUNDED * np.finfo(float).eps * max(np.abs(f).max() for f in found) / STEP**2
    return curved, float(rounding + 10 * STEP**2 * np.abs(curved).max())


def run(seed: int) -> dict[str, Any]:
    began = time.perf_counter()
    tree = random_tree(seed)
    row: dict[str, Any] = {"seed": seed, "tree": tree.label, "states": tree.nx}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            x0, u0 = tree.equilibrium()
        except PliantError as failure:
            return {**row, "rest": False, "why": str(failure)[:200], "wrong": False}
        verdict = assess(tree.linearize(x0, u0))
        curved, error = curvatures(tree, x0)
    clear = bool(np.abs(curved).min() > error)
    falls = int((curved < 0).sum())
    grows = int((verdict.evidence["eigenvalues"].real > 0).sum())
    told = {"verdict": verdict.verdict, "falls": falls, "grows": grows, "clear": clear}
    opposite = verdict.verdict == ("stable" if falls else "unstable")
    decided = verdict.verdict in ("stable", "unstable")
    wrong = clear and (opposite or (decided and falls != grows))
    seconds = round(time.perf_counter() - began, 3)
    return {**row, "rest": True, **told, "decided": decided, "wrong": bool(wrong), "seconds": seconds}


def summary(rows: list[dict[str, Any]]) -> str:
    clear = [r for r in rows if r["rest"] and r["clear"]]
    unstable = [r for r in clear if r["falls"]]
    left = [r for r in clear if not r["decided"]]
    return (
        f"{len(rows)} trees, {len(rows) - sum(r['rest'] for r in rows)} without a rest that was found; "
        f"{len(clear)} of known sign, {len(unstable)} of them unstable: {sum(r['wrong'] for r in rows)} wrong, "
        f"{len(left)} undecided"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 400, run, summary, lambda row: row["wrong"])
