"""The verdict over the span of a nominal that is not repeated, and no longer: slow variation, a certificate, growth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.plants.finite_horizon.asked import listed
from pliant.plants.rigorous.proof import GROWN
from pliant.plants.transitions.state_matrix_path import Path, paths_of, scaling, unfelt
from pliant.plants.transitions.transition_error import Transition, transition

from .frozen_time import (
    LARGE,
    FrozenTime,
    SlowVariation,
    frozen_along,
    frozen_time,
    said_coordinates,
    slow_along,
    slow_variation,
    thinned,
)
from .lyapunov_certificate import Certificate, backward
from .transition_growth import MOST_NODES, Growth, growth_between
from .verdict import Verdict, made

POINTS = 200  # times at which frozen roots are taken where the first method that decides is enough
OPEN_STEPS = 2048  # a certificate is only sought with so many steps
SEEN = 1e-9  # of the largest entry of a transition: what moves another
ALIKE = "every deviation ends at most {:.3g} times as large as it began, states weighed alike"


def judged_once(
    joined: Any,
    states: Sequence[str] | None,
    coordinates: str | None,
    window: float | None,
    thorough: bool,
    evidence: dict[str, Any],
    said: dict[str, str],
) -> Verdict:
    """The verdict on pieces `joined`, of a nominal that ends; what was found so far goes along."""
    (paths, jumps), moved = paths_of(joined, states), None
    evidence["frozen_time"], evidence["slow_variation"] = _frozen(joined, paths, states, coordinates, thorough)
    if thorough or not _proves(evidence["slow_variation"], paths):
        try:
            moved = transition(paths, jumps, 1e-6)
        except (ValueError, np.linalg.LinAlgError):
            moved = None
        try:
            evidence["growth"] = found = growth_between(joined, moved, window, states)
        except ValueError as refusal:
            if window is not None:
                raise
            found, said["growth"] = None, str(refusal).removeprefix("growth: ")
        if len(paths) > 1:
            said["lyapunov"] = "V is not continued across jumps"
        elif found is not None and not found.total < 1:
            said["lyapunov"] = "not needed: some deviation ends as large as it began"
        elif moved is not None:
            try:
                evidence["lyapunov"] = backward(paths[0], None, OPEN_STEPS, lambda: moved.M)
            except np.linalg.LinAlgError as failure:
                said["lyapunov"] = f"failed: {failure}"
    return _open(joined, paths, states, moved, evidence, said)


def _frozen(
    joined: Any, paths: Sequence[Path], states: Sequence[str] | None, coordinates: str | None, thorough: bool
) -> tuple[FrozenTime, SlowVariation]:
    points = MOST_NODES if thorough and paths[0].n <= LARGE else POINTS
    span = float(joined.pieces[-1].t[-1] - joined.pieces[0].t[0])
    if len(paths) > 1:
        roots = frozen_time(joined, states=states, coordinates=coordinates, points=points)
        return replace(roots, span=span), slow_variation(joined, states=states)
    t, said_in = joined.pieces[0].t, coordinates or said_coordinates(joined, states)
    return replace(frozen_along(paths[0], thinned(t, points), said_in), span=span), slow_along(paths[0], t)


def _hidden(paths: Sequence[Path]) -> float:
    """The integral of |what A misses between its nodes|."""
    return sum(float(np.linalg.norm(path.area(), axis=(1, 2)).sum()) for path in paths)


def _proves(slow: SlowVariation, paths: Sequence[Path]) -> bool:
    """Whether slow variation decides, also beside what A misses between its nodes."""
    duration = float(sum(path.t[-1] - path.t[0] for path in paths))
    return bool(slow) and slow.decay * duration > 4 * _hidden(paths)


def _open(
    joined: Any,
    paths: Sequence[Path],
    states: Sequence[str] | None,
    moved: Transition | None,
    evidence: dict[str, Any],
    said: dict[str, str],
) -> Verdict:
    """The verdict over the span of a nominal that is not periodic."""
    slow: SlowVariation = evidence["slow_variation"]
    shown: Certificate | None = evidence.get("lyapunov")
    grown: Growth | None = evidence.get("growth")
    duration = float(joined.pieces[-1].t[-1] - joined.pieces[0].t[0])
    known = joined.pieces[0].state_names if states is None else tuple(states)
    hidden, why = _hidden(paths), ""
    if _proves(slow, paths):
        why = f"A varies slowly enough for its frozen roots to decide: {slow.why}; V proves {slow.decay:.4g} 1/s"
        return made("stable", "slow_variation", slow.decay, why, evidence, said, slow.decay, "decays")
    if shown is not None and shown and shown.contraction < 1:
        left = shown.contraction * float(np.exp(min(shown.overshoot * hidden, 700.0)))
        if left < 1:
            margin, bound = (-float(np.log(x)) / duration for x in (shown.contraction, left))
            why = f"{shown.why}; over {duration:.4g} s every deviation shrinks to {left:.3g} of itself or less"
            return made("stable", "lyapunov", margin, why, evidence, said, bound, "decays")
    if grown is None:
        return made("undecided", "", np.nan, f"no method could be used: {said['growth']}", evidence, said)
    why = f"over {duration:.4g} s deviations change by a factor of up to {grown.total:.4g}, as computed"
    error = spectral(moved.D) if moved is not None else np.inf
    beyond = not np.isfinite(error) and grown.logs[-1] > 600  # the range of numbers
    bound = -float(np.log(grown.total + error)) / duration if np.isfinite(grown.total + error) else np.nan
    if grown.total + error < 1:
        return made("stable", "growth", -grown.rate, why, evidence, said, bound, "decays")
    if (grown.total - error > GROWN or beyond) and grown.compounds:
        return made("unstable", "growth", -grown.rate, f"{why}, and it compounds", evidence, said, bound, "exponential")
    near, free = grown.total + error <= GROWN, unfelt(joined, states)
    most = grown.total + error if near or free else ends_within(moved)
    if most <= GROWN:
        why = f"over {duration:.4g} s {ALIKE.format(most)}"
        return made("bounded", "growth", -grown.rate, why, evidence, said, bound, "bounded")
    if grown.total - error > GROWN:
        return _drift(known, free, moved, grown, bound, evidence, said)
    if error > 0.1 * abs(np.log(max(grown.total, 1e-300))):
        why += f", known to {error:.2g} only: more nodes would help"
    else:
        why += f": neither below 1 nor above {GROWN:g}; the nominal is too short or has no one answer"
    return made("undecided", "", -grown.rate, why, evidence, said, bound)


def _drift(
    known: Sequence[str],
    free: tuple[str, ...],
    moved: Transition | None,
    grown: Growth,
    bound: float,
    evidence: dict[str, Any],
    said: dict[str, str],
) -> Verdict:
    """Growth that does not build on itself: drift where states that none feels are all that grows.

    The others' transition is a block of the whole, and so is what it may be off.
    """
    rest = [k for k, name in enumerate(known) if name not in free]
    if free and rest:
        most = ends_within(moved, rest)
        if most <= GROWN:
            why = f"drift of {listed(free)}, which nothing else feels; apart from it {ALIKE.format(most)}"
            return made("drift", "growth", -grown.rate, why, evidence, said, bound, "polynomial", free)
    why = (
        f"over {grown.t[-1] - grown.t[0]:.4g} s deviations change by a factor of up to {grown.total:.4g}, as computed, "
    )
    why += "but it does not build on itself, as free drift does not: no exponential growth is shown; `states` can "
    why += "leave out what drifts"
    return made("undecided", "", -grown.rate, why, evidence, said, bound, "polynomial")


def ends_within(moved: Transition | None, at: Sequence[int] | None = None) -> float:
    """How large any deviation ends at most beside its start, of the states `at` (None: all), which feel no other.

    In scaled coordinates, or in those in which the whole motion couples its states evenly. Infinite: nothing is known.
    """
    if moved is None:
        return np.inf
    own = np.ix_(*2 * [range(len(moved.M)) if at is None else at])
    M, D = moved.M[own], moved.D[own]
    if not np.isfinite(M).all() or not np.isfinite(D).all():
        return np.inf
    moves = np.abs(M - np.diag(np.diagonal(M)))
    even = scaling(np.where(moves > SEEN * moves.max(initial=0.0), moves + D, 0.0)[None])  # else it keeps its unit
    return min(spectral(M * s / s[:, None]) + spectral(D * s / s[:, None]) for s in (np.ones(len(M)), even))


def spectral(M: np.ndarray) -> float:
    """2-norm, infinite where it is not known."""
    return float(np.linalg.norm(M, 2)) if np.isfinite(M).all() else np.inf
