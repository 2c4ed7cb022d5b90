"""Slow variation that decides both ways: a quadratic form whose sign tells what grows from what decays.

At each time t the roots of A(t) - shift stand on two sides of the imaginary axis; P_u, P_s project onto their spaces.
H(t) solves A'H + H A = P_u'P_u + P_s'P_s with H = 0 across them, so that V = y'H y > 0 where roots grow, < 0 where they
decay. H is taken at the samples and is linear in between; with W(t) = dH/dt + A'H + H A > 0 at all t,

V' = y'W y > 0       a dichotomy, with as many growing directions as H has positive eigenvalues (Coppel 1978, Prop. 7.1)
W >= 2 mu H          V > 0 grows at least like e^(2 mu t): instability where one root or more is on the right
W >= -2 mu H         -V > 0 decays at least so fast: stability where none is

No rate of A is asked for: the difference of two H says what the motion of A eats.

Source   Coppel, "Dichotomies in Stability Theory", 1978; for stability Desoer 1969, Ilchmann, Owens and
         Praetzel-Wolters 1987, whose norm bounds are weaker than W > 0
Valid    over the record; beyond it as long as W > 0 goes on to hold with H bounded. That is the assumption
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_number
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.lti import LinearModel
from pliant.plants.transitions.state_matrix_path import Model, Path, as_pieces, kept, modal, scaling

NEAR = 1e-8  # of the fastest root: a real part this small has no side
HALVINGS = 32
SOLVED = 1e-7  # of the right-hand side: what H may miss, else its eigenvectors are no basis


@dataclass(frozen=True, eq=False)
class SlowDichotomy(OwnsArrays):
    """What is shown over the record (also as a truth value: whether anything is)."""

    verdict: str  # stable | unstable | undecided
    growing: int  # directions that grow faster than `shift`
    rate: float  # [1/s] mu: the fastest deviation grows at least so fast; below zero: all decay at least so fast
    used: float  # share of W that the motion of A eats where it eats most; the test holds below 1
    overshoot: float  # ln of what V leaves open beside e^(mu t), in the coordinates of the test
    worst_time: float  # [s]
    why: str

    def __bool__(self) -> bool:
        return self.verdict != "undecided"


def slow_dichotomy(
    model: Model, *, states: Sequence[str] | None = None, shift: float = 0.0, samples: int | None = None
) -> SlowDichotomy:
    """Whether A(t) - shift varies slowly enough for its frozen roots to tell growth from decay; shift [1/s].

    At the nodes and midway between them, or at `samples` equidistant times. ValueError for a LinearModel with `dt`.
    """
    shift = require_number("slow_dichotomy.shift", shift, unit="1/s")
    if samples is not None:
        samples = require_count("slow_dichotomy", "samples", samples, 3, 100_000)
    keep = kept(model, states)
    if isinstance(model, LinearModel):
        if model.dt is not None:
            raise ValueError(f"slow_dichotomy: model.dt = {model.dt:g} must be None (continuous time)")
        A = np.repeat(model.A[np.ix_(keep, keep)][None], 2, axis=0)
        path, t = Path(np.array([0.0, 1.0]), A, scaling(A)), np.array([0.0, 1.0])
    else:
        pieces = as_pieces(model).pieces
        if len(pieces) > 1:
            return _refused("the nominal has jumps: V does not go on across them")
        A = pieces[0].A[:, keep][:, :, keep]
        path, t = Path(pieces[0].t, A, scaling(A)), pieces[0].t
        t = np.linspace(t[0], t[-1], samples) if samples else np.sort(np.r_[t, (t[1:] + t[:-1]) / 2])
    return _along(path, t, shift)


def _along(path: Path, t: np.ndarray, shift: float) -> SlowDichotomy:
    middle = (t[1:] + t[:-1]) / 2
    X, inverse = modal(path(t))
    ends, between = (inverse @ path(s) @ X - shift * np.eye(path.n) for s in (t, middle))
    lam, V = np.linalg.eig(ends)
    right = lam.real > 0
    k = int(np.abs(lam.real).min(axis=1).argmin())
    if np.abs(lam.real).min() <= NEAR * np.abs(lam).max():
        return _refused(f"a frozen root has real part {lam[k].real[np.abs(lam[k].real).argmin()]:.3g}", t[k])
    count = right.sum(axis=1)
    if np.ptp(count):
        k = int(np.flatnonzero(np.diff(count))[0])
        return _refused("frozen roots cross the axis", t[k])
    try:
        H = form(lam, V)
    except np.linalg.LinAlgError:
        return _refused("frozen eigenvectors are parallel", t[0])
    miss = np.abs(ends.transpose(0, 2, 1) @ H + H @ ends - _gram(lam, V)).max(axis=(1, 2))
    if not (miss <= SOLVED * np.maximum(np.abs(H).max(axis=(1, 2)) * np.abs(ends).max(), 1e-300)).all():
        return _refused("frozen eigenvectors are nearly parallel", t[int(np.nanargmax(miss))])
    moved = np.diff(H, axis=0) / np.diff(t)[:, None, None]
    mean = (H[1:] + H[:-1]) / 2
    start, mid, end = (_rate(a, h) + moved for a, h in ((ends[:-1], H[:-1]), (between, mean), (ends[1:], H[1:])))
    bend = np.linalg.norm(start - 2 * mid + end, 2, axis=(1, 2)) / 8  # of a parabola from its chords
    W = np.stack([start, mid, end]) - bend[:, None, None] * np.eye(path.n)
    forms = np.stack([H[:-1], mean, H[1:]])
    quiet = np.stack([_rate(a, h) for a, h in ((ends[:-1], H[:-1]), (between, mean), (ends[1:], H[1:]))])
    least = np.linalg.eigvalsh(W).min(axis=(0, 2))
    worst = int(least.argmin())
    used = float(np.max(_eaten(quiet[:, worst], W[:, worst])))
    time = float(t[worst])
    if not least.min() > 0:
        return _refused(f"the motion of A eats {used:.3g} of what tells growth from decay", time, used)
    growing = int(count[0])
    sign = 1.0 if growing else -1.0
    hidden = float(np.linalg.norm(path.area(), axis=(1, 2)).sum()) * float(np.linalg.cond(X))
    mu = _slope(W, sign * forms, path.size)
    duration = float(t[-1] - t[0])
    size = np.linalg.eigvalsh(sign * H)
    overshoot = 0.5 * float(np.log(size[-1, -1] / size[0, -1] if growing else size[0, -1] / size[-1, 0]))
    words = (
        f"frozen roots decide, {growing} of {path.n} on the right of {shift:.4g} 1/s: the motion of A eats {used:.3g}"
    )
    words += f" (below 1 is allowed), most at {time:.6g} s; V proves {'growth' if growing else 'decay'} at {mu:.4g} 1/s"
    if not mu * duration > 4 * hidden * float(np.abs(size).max() / np.abs(size).min()):
        return _refused("what A may do between its nodes is more than V shows", time, used)
    verdict = "unstable" if growing and mu + shift > 0 else "stable" if not growing and shift - mu < 0 else "undecided"
    return SlowDichotomy(verdict, growing, shift + sign * mu, used, overshoot, time, words)


def form(lam: np.ndarray, V: np.ndarray) -> np.ndarray:
    """H (m, n, n) from the roots lam (m, n) and eigenvectors V (m, n, n) of A."""
    left = np.linalg.inv(V)
    same = (lam.real > 0)[:, :, None] == (lam.real > 0)[:, None, :]
    gram = V.conj().transpose(0, 2, 1) @ V
    M = np.where(same, gram / np.where(same, lam.conj()[:, :, None] + lam[:, None, :], 1.0), 0.0)
    H = (left.conj().transpose(0, 2, 1) @ M @ left).real
    return (H + H.transpose(0, 2, 1)) / 2


def _gram(lam: np.ndarray, V: np.ndarray) -> np.ndarray:
    left = np.linalg.inv(V)
    same = (lam.real > 0)[:, :, None] == (lam.real > 0)[:, None, :]
    gram = np.where(same, V.conj().transpose(0, 2, 1) @ V, 0.0)
    return np.asarray((left.conj().transpose(0, 2, 1) @ gram @ left).real)


def _rate(A: np.ndarray, H: np.ndarray) -> np.ndarray:
    return A.transpose(0, 2, 1) @ H + H @ A


def _eaten(quiet: np.ndarray, W: np.ndarray) -> np.ndarray:
    """Share of the quiet form that is gone in W: 1 - the least eigenvalue of W against it, 1 where that is not > 0."""
    try:
        L = np.linalg.inv(np.linalg.cholesky(quiet))
    except np.linalg.LinAlgError:
        return np.ones(1)
    return np.asarray(1 - np.linalg.eigvalsh(L @ W @ L.transpose(0, 2, 1)).min(axis=-1))


def _slope(W: np.ndarray, H: np.ndarray, most: float) -> float:
    """The largest mu [1/s] with W - 2 mu H >= 0 (indefinite H: where it grows) in all of a stack, by bisection."""
    low, high = 0.0, 4 * most
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if np.linalg.eigvalsh(W - 2 * middle * H).min() > 0 else (low, middle)
    return low


def _refused(why: str, time: float = np.nan, used: float = np.inf) -> SlowDichotomy:
    return SlowDichotomy("undecided", 0, np.nan, used, np.inf, float(time), why)
