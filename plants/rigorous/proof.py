"""What is a theorem of a model given by its doubles, and its numbers, each enclosed.

constant  eigenvalues of A counted against the axis (of a sampled A against the circle) in exact arithmetic
periodic  A(t): the cubic spline through the nodes from t_0 to t_0 + T, as `LTVModel` defines it, for ever repeated;
          jumps are the matrices given. Multipliers of the enclosed transition matrix
motion    the same spline over the nominal and no longer: how large deviations end, and are at the nodes, at most, in
          scaled coordinates (powers of two, so that scaling is exact)

Of what the doubles stand for, and what A(t) does between its nodes beside the spline, a theorem says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.transitions.state_matrix_path import parts_of, scaling

from . import exact_roots
from .balls import ends, flint, matrix, midpoint, part, radii, spectral_bounds
from .enclosed_growth import compounds
from .enclosed_multipliers import multipliers
from .enclosed_transition import Frames, Piece, TooLong, transitions

MOST_STATES = 12
BITS = (96, 224)  # that are tried
NARROW = 1e-14  # width of what is known of the largest multiplier, where more bits would tell doubles no more
GROWN = 10.0  # growth over a motion up to which it is bounded, beyond which unstable if it compounds
SPLINE = "A(t) the cubic spline through the doubles at its nodes"


@dataclass(frozen=True, eq=False)
class Proof(OwnsArrays):
    """Intervals hold the true number of the model given; doubles, rounded outwards."""

    verdict: str  # stable | unstable | marginal | drift | bounded: a theorem; undecided: none
    kind: str  # constant | sampled | periodic | motion
    words: str
    rate: tuple[float, float]  # [1/s] of the fastest growth, below zero: decay; of a motion ln(end)/duration
    bits: int  # of the balls' midpoints
    roots: np.ndarray = field(repr=False, default_factory=lambda: np.zeros(0, complex))  # eigenvalues or multipliers ..
    radii: np.ndarray = field(repr=False, default_factory=lambda: np.zeros(0))  # .. and what each may be off
    growth: str = ""  # how the deviation that lasts longest behaves, where it is shown
    largest: tuple[float, float] = (0.0, np.inf)  # periodic: size of the largest multiplier
    end: tuple[float, float] = (0.0, np.inf)  # motion: largest |Phi(end, start)|, and ..
    peak: tuple[float, float] = (1.0, np.inf)  # .. at any node, before and after a jump there
    peak_time: float = np.nan  # [s]
    transition: np.ndarray | None = field(
        repr=False, default=None
    )  # (nx, nx) in the model's units, start to end, and ..
    transition_error: np.ndarray | None = field(repr=False, default=None)  # .. what each entry may be off

    @property
    def said(self) -> str:
        """The words, and whether they are a theorem."""
        what = "no theorem" if self.verdict == "undecided" else f"{self.verdict}, a theorem of the model given"
        return f"{what}: {self.words}"

    def __str__(self) -> str:
        return self.said

    def to_json(self) -> dict[str, Any]:
        found: dict[str, Any] = {"verdict": self.verdict, "kind": self.kind, "words": self.words, "bits": self.bits}
        for name, asked in (("rate", True), ("largest", "periodic"), ("end", "motion"), ("peak", "motion")):
            if asked in (True, self.kind):
                found[name] = [x if np.isfinite(x) else None for x in getattr(self, name)]
        return found


def of_constant(A: np.ndarray, dt: float | None = None) -> Proof:
    """Of A (n, n) [1/s], or of one step of dt [s]. ValueError beyond MOST_STATES."""
    _few(len(A))
    kind = "constant" if dt is None else "sampled"
    edge = "the imaginary axis" if dt is None else "the unit circle"
    found = exact_roots.counted(A, circle=dt is not None)
    if found is None:
        words = f"{exact_roots.MOST_BITS:,} bits do not tell the eigenvalues from {edge}"
        return Proof("undecided", kind, words, (-np.inf, np.inf), exact_roots.MOST_BITS)
    where = f"{found.outside} of {len(A)} eigenvalues beyond {edge}, {found.on} on it, {found.inside} within"
    what = "the rightmost real part is" if dt is None else "the largest size is"
    words = f"for the matrix as its doubles are, counted exactly: {where}; {what} {_told(found.largest)}"
    verdict, growth = ("stable", "decays") if not found.on else ("marginal", "bounded")
    if found.power:
        growth = "polynomial"
        words += f"; those on it share directions, so that deviations grow like t^{found.power}"
    if found.outside:
        verdict, growth = "unstable", "exponential"
    rate = found.largest if dt is None else _logs(found.largest, dt)
    return Proof(verdict, kind, words, rate, found.bits, np.array(found.values), np.array(found.radii), growth)


def of_cycle(pieces: Sequence[Piece], jumps: Sequence[np.ndarray], period: float, scale: np.ndarray) -> Proof:
    """Over one period [s], that ends where the last piece does; A and jumps (n, n) in coordinates x / scale."""
    n = len(scale)
    _few(n)
    groups = parts_of(_pattern(pieces, jumps))
    neutral = [g for g in groups if len(g) == 1 and _neutral(int(g[0]), pieces, jumps)]
    rest = [g for g in groups if not any(g is other for other in neutral)]
    verdict = "undecided"
    words = ""
    for bits in BITS:
        with flint().ctx.workprec(bits):
            try:
                frames = Frames(n)
                for _, jump, steps in transitions(pieces, jumps):
                    for P in jump + steps:
                        frames.times(P)
                M = frames.whole
                found = multipliers(M, rest, neutral)
                Phi, error = _unscaled(M, scale)
            except TooLong as refusal:
                return Proof("undecided", "periodic", str(refusal), (-np.inf, np.inf), bits)
        if found.least > 1:
            verdict = "unstable"
        elif found.most < 1:
            verdict = "marginal" if neutral else "stable"
        if verdict != "undecided" or found.most - found.least < NARROW:
            break
    largest = (max(found.least, 1.0), max(found.most, 1.0)) if neutral else (found.least, found.most)
    words = f"for {SPLINE}, repeated every {period!r} s, the largest multiplier is of size {_told(largest)}"
    if neutral and verdict == "marginal":
        words += f": {len(neutral)} of {n} are 1, since nothing moves these states by themselves, the others below 1"
    elif verdict == "undecided":
        words += ": not to be told from 1"
    kinds = {"stable": "decays", "unstable": "exponential", "marginal": "bounded" if len(neutral) == 1 else ""}
    return Proof(
        verdict,
        "periodic",
        words,
        _logs(largest, period),
        bits,
        np.array(found.values),
        np.array(found.radii),
        kinds.get(verdict, ""),
        largest,
        transition=Phi,
        transition_error=error,
    )


def of_motion(
    pieces: Sequence[Piece], jumps: Sequence[np.ndarray], scale: np.ndarray, drifting: Sequence[int] = ()
) -> Proof:
    """From the first node to the last; `drifting`: positions of states that may run off, asked about where needed."""
    n, begin = len(scale), float(pieces[0].t[0])
    _few(n)
    duration = float(pieces[-1].t[-1]) - begin
    for bits in BITS:
        with flint().ctx.workprec(bits):
            frames, own, path = Frames(n), [], [(begin, (1.0, 1.0))]
            try:
                for t, jump, steps in transitions(pieces, jumps):
                    for J in jump:  # a node has a deviation before it and one after
                        frames.times(J)
                        path.append((path[-1][0], _interval(frames.whole)))
                    for P in steps:
                        frames.times(P)
                    own.append((t, jump + steps))
                    path.append((t, _interval(frames.whole)))
            except TooLong as refusal:
                return Proof("undecided", "motion", str(refusal), (-np.inf, np.inf), bits)
            M, end = frames.whole, path[-1][1]
            verdict, words = _of_end(M, end, pieces, jumps, drifting, begin, own)
            Phi, error = _unscaled(M, scale)
        if end[1] - end[0] <= 1e-9 * end[1] and verdict != "undecided":
            break
    peak = max(low for _, (low, _) in path), max(high for _, (_, high) in path)
    at = max(path, key=lambda one: one[1][0])[0]
    words = (
        f"for {SPLINE}, states weighed alike: the largest deviation ends {_told(end)} times as large as it began, and "
        f"is {_told(peak)} times as large at a node, at {at:.6g} s{words}"
    )
    growth = {"stable": "decays", "unstable": "exponential", "bounded": "bounded", "drift": "polynomial"}
    return Proof(
        verdict,
        "motion",
        words,
        _logs(end, duration),
        bits,
        growth=growth.get(verdict, ""),
        end=end,
        peak=peak,
        peak_time=at,
        transition=Phi,
        transition_error=error,
    )


def _of_end(
    M: Any,
    end: tuple[float, float],
    pieces: Sequence[Piece],
    jumps: Sequence[np.ndarray],
    drifting: Sequence[int],
    begin: float,
    own: list[tuple[float, list[Any]]],
) -> tuple[str, str]:
    """The verdict from how large deviations end, and what is to be said of it."""
    if end[1] < 1:
        return "stable", ""
    if end[1] <= GROWN:
        return "bounded", ""
    centre = np.abs(midpoint(M))
    keep = [k for k in range(len(centre)) if k not in drifting]
    if len(keep) < len(centre) and keep and not any(_felt(k, pieces, jumps) for k in drifting):
        own_even = scaling((centre * (1 - np.eye(len(centre))))[np.ix_(keep, keep)][None])
        rest = part(M, keep)
        most = min(_interval(rest)[1], _interval(_scaled(rest, own_even))[1])
        if most <= GROWN:
            return "drift", f"; apart from states that nothing feels {most:.6g} times at most"
    even = scaling((centre * (1 - np.eye(len(centre))))[None])
    most = np.inf if drifting else _interval(_scaled(M, even))[1]
    if most <= GROWN:
        return "bounded", f"; {most:.6g} times at most in units in which the motion couples its states evenly"
    if end[0] > GROWN and compounds(begin, own):
        return "unstable", "; the growth builds on itself"
    return "undecided", ""


def _few(n: int) -> None:
    if n > MOST_STATES:
        raise ValueError(
            f"assess.rigorous = True of {n} states, must be of at most {MOST_STATES}: name some by `states`"
        )


def _pattern(pieces: Sequence[Piece], jumps: Sequence[np.ndarray]) -> np.ndarray:
    found = np.any([(piece.A != 0).any(axis=0) for piece in pieces], axis=0)
    for J in jumps:
        found |= J != 0
    return np.asarray(found | np.eye(len(found), dtype=bool))


def _neutral(k: int, pieces: Sequence[Piece], jumps: Sequence[np.ndarray]) -> bool:
    """Whether a state that stands alone keeps its size, by itself."""
    return not any(piece.A[:, k, k].any() for piece in pieces) and all(J[k, k] == 1 for J in jumps)


def _felt(k: int, pieces: Sequence[Piece], jumps: Sequence[np.ndarray]) -> bool:
    moved = any(piece.A[:, :, k].any() for piece in pieces)
    return moved or any((J[:, k] != np.eye(len(J))[:, k]).any() for J in jumps)


def _interval(M: Any) -> tuple[float, float]:
    low, high = spectral_bounds(M)
    return max(ends(low)[0], 0.0), ends(high)[1]


def _scaled(M: Any, s: np.ndarray) -> Any:
    return matrix(np.diag(1 / s)) * M * matrix(np.diag(s))


def _unscaled(M: Any, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    own = _scaled(M, 1 / scale)
    centre = midpoint(own)
    return centre, radii(own, centre)


def _logs(size: tuple[float, float], time: float) -> tuple[float, float]:
    """ln(size)/time of an interval, outwards."""
    arb = flint().arb
    low = ends(arb(size[0]).log() / arb(time))[0] if size[0] > 0 else -np.inf
    return low, ends(arb(size[1]).log() / arb(time))[1] if size[1] < np.inf else np.inf


def _told(interval: tuple[float, float]) -> str:
    """Both ends, with all their digits: none may be rounded inwards."""
    low, high = interval
    return f"{low!r}" if low == high else f"{low!r} to {high!r}"
