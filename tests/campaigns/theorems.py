"""Verdicts that are theorems, of random models with a closed form: a seeded campaign.

    python tests/campaigns/theorems.py

A(t) = p(t) G + c 1 with G (n, n), 2 to 12 states, and p a cubic with p(0) = p(T), both of few bits, so that the doubles
at the nodes and the spline through them are exactly this; Phi = e^(c T) exp(G integral of p). A third of them are moved
to within 1e-9 of the edge, a third of G have one direction for several equal eigenvalues. mpmath (50 digits) is the
other program. Wrong: a theorem that is not true, or a number outside its interval. Told: how many are decided.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import mpmath
import numpy as np
from known_systems import ltv

from pliant.plants.stability import assess

DIGITS = 50
SLACK = mpmath.mpf(10) ** -30  # of the other program; ill-conditioned eigenvalues keep no more


def model(rng: np.random.Generator) -> tuple[Any, np.ndarray, list[float], float, float]:
    """(model, G, p lowest power first, c, T)."""
    n, nodes = int(rng.integers(2, 13)), int(rng.integers(4, 25))
    G = rng.integers(-16, 17, (n, n)) / 16.0
    if rng.random() < 1 / 3:  # triangular, two values on the diagonal
        G = np.triu(G, 1) + np.diag(rng.choice(rng.integers(-16, 17, 2) / 16.0, n))
    t = np.arange(nodes) / 8.0
    T = float(t[-1])
    a, b, d = rng.integers(-8, 9, 3) / 8.0
    p = [a, -b * T, b * (1 - d * T), b * d]  # a + b t (t - T) (1 + d t): it closes
    whole = sum(x * T ** (k + 1) / (k + 1) for k, x in enumerate(p))
    fastest = float((np.linalg.eigvals(G) * whole).real.max())
    off = rng.choice([1.0, 1e-3, 1e-9]) * rng.uniform(-1, 1)
    c = float(np.round((off - fastest) / T * 2**36) / 2**36)
    shape = sum(x * t**k for k, x in enumerate(p))
    return ltv(t, shape[:, None, None] * G + c * np.eye(n)), G, p, c, T


def run(seed: int) -> dict[str, Any]:
    began, rng = time.process_time(), np.random.default_rng(seed)
    told, G, p, c, T = model(rng)
    periodic = bool(rng.random() < 0.6)
    row: dict[str, Any] = {"seed": seed, "states": len(G), "periodic": periodic}
    found = assess(told, period=T, rigorous=True) if periodic else assess(told, periodic=False, rigorous=True)
    with mpmath.workdps(DIGITS):
        whole = sum(mpmath.mpf(x) * mpmath.mpf(T) ** (k + 1) / (k + 1) for k, x in enumerate(p))
        M = mpmath.expm(mpmath.matrix(G.tolist()) * whole) * mpmath.exp(mpmath.mpf(c) * T)
        wrong = _outside(found.proof, M)
        if found.proof.kind == "periodic":
            sizes = [abs(mpmath.exp(z * whole + mpmath.mpf(c) * T)) for z in _eigenvalues(G)]
            low, high = found.proof.largest
            wrong |= not low - SLACK <= max(sizes) <= high + SLACK
            wrong |= found.verdict == "stable" and max(sizes) >= 1 + SLACK
            wrong |= found.verdict == "unstable" and max(sizes) <= 1 - SLACK
        elif found.proof.kind == "motion":
            size = mpmath.svd_r(_weighed(M, told), compute_uv=False)[0]
            wrong |= not found.proof.end[0] * (1 - SLACK) <= size <= found.proof.end[1] * (1 + SLACK)
    seconds = round(time.process_time() - began, 2)
    return {**row, "verdict": found.verdict, "proof": found.proof.verdict, "wrong": bool(wrong), "seconds": seconds}


def _eigenvalues(G: np.ndarray) -> list[Any]:
    if not np.tril(G, -1).any():
        return [mpmath.mpf(float(x)) for x in np.diag(G)]
    return list(mpmath.eig(mpmath.matrix(G.tolist()), left=False, right=False))


def _outside(proof: Any, M: Any) -> bool:
    """Whether an entry of the transition matrix is outside its interval."""
    if proof.transition is None:
        return False
    n = len(proof.transition)
    rows = ((proof.transition[i, j], proof.transition_error[i, j], M[i, j]) for i in range(n) for j in range(n))
    return any(abs(truth - about) > error * (1 + SLACK) for about, error, truth in rows)


def _weighed(M: Any, told: Any) -> Any:
    from pliant.plants.transitions.state_matrix_path import scaling

    s = scaling(told.A)
    return mpmath.matrix([[M[i, j] * s[j] / s[i] for j in range(len(s))] for i in range(len(s))])


def summary(rows: list[dict[str, Any]]) -> str:
    decided = sum(r["proof"] != "undecided" for r in rows)
    return f"{len(rows)} models: {sum(r['wrong'] for r in rows)} wrong, {decided} with a theorem"


if __name__ == "__main__":
    by_seed.main(__doc__, 300, run, summary, lambda row: row["wrong"])
