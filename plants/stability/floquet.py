"""Floquet's answer for a periodic model: multipliers, exponents and modes from the monodromy matrix.

Phi(t0 + T, t0) v = lambda v; exponents sigma = ln(lambda) / T; every motion is a sum of e^(sigma t) p(t), p periodic.

What A(t) does between its nodes is known within bounds only (`interpolation`), and so are the matrix
(`transition_error`) and its multipliers (`eigenvalue_bounds`): `error` is a bound for every matrix that the data allow,
and the verdict holds for all of them. Multipliers that cannot be told apart are judged as a group: mean and radius.
Undamped models have multipliers in pairs lambda, 1/lambda. That is a finding here (`undamped`) and takes nothing from
the error: data that are known to 1e-3 do not put a multiplier onto the circle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_number
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.transitions.eigenvalue_bounds import EPS, Bounds, bounds
from pliant.plants.transitions.interpolation import FEW
from pliant.plants.transitions.state_matrix_path import CLEAR, Model, Path, as_pieces, kept, modal, scaling
from pliant.plants.transitions.transition_error import TooManySteps, Transition, monodromy, transition

from . import periodicity as periods

FLOOR = 1e-9  # a multiplier this near the unit circle is on it
MOST_POINTS = 2**11  # of a mode's shape


__all__ = ["Floquet", "floquet", "monodromy", "periodic_path", "periodic_paths"]


@dataclass(frozen=True, eq=False)
class Floquet(OwnsArrays):
    """Multipliers lambda (nx,), largest first, exponents sigma = ln(lambda)/T (nx,) [1/s] with |Im| <= pi/T."""

    period: float  # [s]
    multipliers: np.ndarray = field(repr=False)  # eigenvalues of `monodromy`
    exponents: np.ndarray = field(repr=False)
    modes: np.ndarray = field(repr=False)  # (nx, nx): column k belongs to multiplier k, at the start of the period
    monodromy: np.ndarray = field(repr=False)  # (nx, nx)
    error: np.ndarray = field(repr=False)  # (nx,) bound on what each multiplier may be off
    uncertainty: np.ndarray = field(repr=False)  # (nx, nx) bound on what each entry of `monodromy` may be off
    groups: tuple[np.ndarray, ...] = field(repr=False)  # positions of multipliers that cannot be told apart
    least: float  # the largest |lambda| is this at least ..
    most: float  # .. and this at most
    undamped: bool  # trace A = 0, and multipliers in pairs lambda, 1/lambda within their errors
    steps: int  # in a period
    states: tuple[str, ...]
    source: str  # where the period comes from
    paths: tuple[Path, ...] = field(repr=False)  # A(t) over the period, piece by piece
    jumps: tuple[np.ndarray, ...] = field(repr=False)  # between the pieces, in scaled coordinates
    times: np.ndarray = field(repr=False)  # (m + 1,) [s] over the period, and ..
    transitions: np.ndarray = field(repr=False)  # (m, nx, nx) .. between them, in scaled coordinates

    @property
    def path(self) -> Path:
        """A(t) over the period, its first piece where it jumps."""
        return self.paths[0]

    @property
    def growth(self) -> float:
        """Growth rate [1/s] of the fastest growing mode, below zero where all decay: an estimate."""
        return float(self.exponents.real.max(initial=-np.inf))

    @property
    def growth_bound(self) -> float:
        """No mode grows faster [1/s], whatever A(t) does between its nodes; infinite where nothing is known."""
        return float(np.log(self.most) / self.period) if self.most > 0 else -np.inf

    @property
    def outside(self) -> np.ndarray:
        """Which multipliers (nx,) are outside the unit circle by more than their error; the largest where its bound
        says so."""
        sizes = np.abs(self.multipliers)
        shown = (sizes == sizes.max(initial=0.0)) & (sizes >= self.least) & (self.least > 1.0 + FLOOR)
        return (sizes - 1.0 > np.maximum(self.error, FLOOR)) | shown

    @property
    def on_circle(self) -> np.ndarray:
        """Which multipliers (nx,) cannot be told from ones on the unit circle."""
        sizes = np.abs(self.multipliers)
        inside = sizes.max(initial=0.0) <= self.most < 1.0 - FLOOR
        return (np.abs(sizes - 1.0) <= np.maximum(self.error, FLOOR)) & ~self.outside & (not inside)

    @property
    def verdict(self) -> str:
        """stable, unstable, marginal (nothing tells it from the unit circle, and the error is small), undecided."""
        if self.outside.any():
            return "unstable"
        if not self.on_circle.any() and not np.isnan(self.multipliers).any():
            return "stable"
        return "marginal" if self.error[self.on_circle].max(initial=0.0) <= CLEAR else "undecided"

    def mode(self, k: int) -> np.ndarray:
        """The periodic shape p(t) (m + 1, nx), complex, of mode k over the period, at m + 1 equidistant times.

        ValueError for a period of several pieces: its nodes are not equidistant.
        """
        if len(self.paths) > 1:
            raise ValueError(f"Floquet.mode: the period has {len(self.paths)} pieces, must be one")
        few = min(1 << (self.steps - 1).bit_length(), MOST_POINTS)
        edges = np.linspace(self.path.t[0], self.path.t[0] + self.period, few + 1)
        found = [self.modes[:, k] / self.path.scale]
        for Phi in self.path.between(edges, max(1, -(-self.steps // few))):
            found.append(Phi @ found[-1])
        decay = np.exp(-self.exponents[k] * (edges - edges[0]))
        return np.array(found) * self.path.scale * decay[:, None]


def floquet(
    model: Model,
    period: float | None = None,
    *,
    states: Sequence[str] | None = None,
    undamped: bool | None = None,
    tolerance: float = 1e-11,
) -> Floquet:
    """Multipliers and modes of a model whose A(t) has the `period` [s]; ValueError where it has not.

    None: the period is found: `periodicity.find`. Pieces are one period of it, or several that agree. `states` keeps
    only those, a part that does not feel the others: ValueError else. `undamped` True: ValueError where the
    multipliers do not come in pairs; False: not asked. `tolerance` of the monodromy matrix, relative, on top of what
    the data leave open.
    """
    tolerance = require_number("floquet.tolerance", tolerance, "positive")
    undamped = None if undamped is None else require_flag("floquet.undamped", undamped)
    paths, jumps, length, source = periodic_paths(model, period, states)
    try:
        found = transition(paths, jumps, tolerance)
    except TooManySteps as refusal:
        raise TooManySteps(f"floquet: {refusal}") from None
    b = bounds(found.M, found.D, volume=(found.rate, found.rate_error), trace=found.trace)
    named, keep = _names(model), kept(model, states)
    names = tuple(named[i] for i in keep)
    about = (length, source, names, tuple(paths), tuple(jumps), undamped, found)
    cycle = _found(about, found.M, found.D, b)
    if cycle.verdict == "undecided" and len(names) > 2 and all(p.constant or len(p.t) > FEW for p in paths):
        cycle = _sharper(model, about, tolerance, cycle)
    if undamped and not cycle.undamped:
        raise ValueError("floquet.undamped = True: the multipliers do not come in pairs lambda, 1/lambda")
    return cycle


About = tuple[float, str, tuple[str, ...], tuple[Path, ...], tuple[np.ndarray, ...], bool | None, Transition]


def _found(about: About, M: np.ndarray, D: np.ndarray, b: Bounds) -> Floquet:
    """From M and D (n, n) in the paths' scaled coordinates and the bounds on the eigenvalues."""
    length, source, names, paths, jumps, undamped, found = about
    scale = paths[0].scale
    order = np.argsort(-np.abs(b.values), kind="stable")
    place = np.argsort(order)
    lam, error = b.values[order], b.errors[order]
    vectors = b.vectors[:, order] * scale[:, None]
    with np.errstate(divide="ignore"):
        exponents = np.log(lam) / length
    ratio = scale[:, None] / scale
    return Floquet(
        length,
        lam,
        exponents,
        vectors / np.maximum(np.linalg.norm(vectors, axis=0), 1e-300),
        M * ratio,
        error,
        D * ratio,
        tuple(np.sort(place[g]) for g in b.groups),
        b.least,
        b.most,
        undamped is not False and _traceless(paths, jumps) and _paired(lam, error),
        found.steps,
        names,
        source,
        paths,
        jumps,
        found.times,
        found.Phi,
    )


def _sharper(model: Model, about: About, tolerance: float, cycle: Floquet) -> Floquet:
    """The same judged in the modes' coordinates: those of the mean of A for A(t), those of the matrix for its bound.

    A fast mode's oscillation is no growth in them, as it is where |Phi| is taken entry by entry in other coordinates,
    and a part that the states hide stands alone. Kept where it decides, or knows the largest multiplier better.
    """
    length, _, names, paths, jumps, _, first = about
    X, inverse = np.eye(len(names)), np.eye(len(names))
    if len(paths) == 1 and not paths[0].constant:
        piece, keep = as_pieces(model).pieces[0], [_names(model).index(name) for name in names]
        scale = paths[0].scale
        A = piece.A[:, keep][:, :, keep] * scale / scale[:, None]
        X, inverse = modal(A)
        size, n = np.abs(A).max(axis=0), len(names)
        A, around = inverse @ A @ X, 4 * n * EPS * np.abs(inverse)
        apart = np.abs(inverse @ X - np.eye(n)) + around @ np.abs(X)  # the inverse is one to rounding
        rounding = around @ size @ np.abs(X) + 2 * apart @ np.abs(A).max(axis=0)
        if apart.sum(axis=1).max() > 0.1:
            return cycle
        path, reason = periods.one_period(piece.t, A, length, names, rounding=rounding)
        if reason:
            return cycle
        X, inverse, paths = X * path.scale, inverse / path.scale[:, None], (path,)
    try:
        found = transition(paths, jumps, tolerance, modal=True)
    except TooManySteps:
        return cycle
    if found.V is None or found.M_V is None or found.D_V is None:
        return cycle
    b = bounds(found.M_V, found.D_V)
    M = X @ found.M @ inverse
    D = np.minimum(np.abs(X) @ found.D @ np.abs(inverse), first.D + np.abs(first.M - M))
    other = _found(about, M, D, replace(b, vectors=X @ found.V @ b.vectors))
    better = other.verdict != "undecided" or other.error[0] < cycle.error[0]
    return other if better else cycle


def _names(model: Model) -> tuple[str, ...]:
    return model.state_names if isinstance(model, LinearModel) else as_pieces(model).pieces[0].state_names


def periodic_paths(
    model: Model, period: float | None, states: Sequence[str] | None
) -> tuple[list[Path], list[np.ndarray], float, str]:
    """A(t) over one period in pieces, the jumps between, the period [s] and where it comes from."""
    if isinstance(model, LinearModel):
        path, length, source = periodic_path(model, period, states)
        return [path], [], length, source
    joined = as_pieces(model)
    if len(joined.pieces) == 1:
        path, length, source = periodic_path(joined.pieces[0], period, states)
        return [path], [], length, source
    if period is None:
        raise ValueError("floquet.period = None: pieces have no smooth period to be found, it must be given")
    return periods.pieced(joined, periods.require_period(period), kept(model, states))


def periodic_path(
    model: LTVModel | LinearModel, period: float | None, states: Sequence[str] | None
) -> tuple[Path, float, str]:
    """A(t) over one period, the period [s], and where it comes from. ValueError where A(t) is not periodic."""
    keep = kept(model, states)
    if isinstance(model, LinearModel):
        if model.dt is not None or period is None or not 0 < period < np.inf:
            raise ValueError(f"floquet.period = {period!r} must be > 0 for a LinearModel, and its dt None")
        A = model.A[np.ix_(keep, keep)][None]
        return Path(np.array([0.0, period]), A.repeat(2, axis=0), scaling(A)), float(period), "A is constant"
    span = float(model.t[-1] - model.t[0])
    if period is None:
        found, source, known = periods.find(model)
        if found is None:
            raise ValueError(f"floquet: the model is not periodic: {source}")
        if known is not None and len(keep) == model.A.shape[-1]:
            return known, found, source
        length = found
    else:
        length, source = periods.require_period(period), "given"
    if length > span * (1 + 1e-9):
        covers = f"the model covers {span:.6g} s, less than the period {length:.6g} s"
        raise ValueError(f"floquet.period = {length:.6g} s: the model is not periodic: {covers}")
    names = tuple(model.state_names[k] for k in keep)
    path, reason = periods.one_period(model.t, model.A[:, keep][:, :, keep], length, names)
    if reason:
        raise ValueError(f"floquet.period = {length:.6g} s: the model is not periodic: {reason}")
    return path, length, source


def _traceless(paths: Sequence[Path], jumps: Sequence[np.ndarray]) -> bool:
    """Whether tr A(t) = 0 at all times, as it is where nothing damps or drives."""
    small = [abs(np.trace(path(path.t), axis1=1, axis2=2)).max() <= 1e-11 * path.size * path.n for path in paths]
    return bool(all(small)) and not len(jumps)


def _paired(lam: np.ndarray, error: np.ndarray) -> bool:
    """Whether the multipliers come in pairs lambda, 1/lambda, within their errors."""
    if len(lam) % 2 or not (np.abs(lam) > 0).all():
        return False
    rest = list(range(len(lam)))
    while rest:
        i = rest.pop(0)
        j = min(rest, key=lambda k: abs(lam[k] * lam[i] - 1))
        rest.remove(j)
        slack = error[i] * abs(lam[j]) + error[j] * abs(lam[i]) + 1e-9
        if abs(lam[i] * lam[j] - 1) > 2 * slack:
            return False
    return True
