"""A verdict on the stability of a linear model, from every method that applies, with the reasons of those that do not.

Constant A        its eigenvalues decide
Periodic A(t)     Floquet's multipliers decide
Any other         over the time that the nominal covers, and no longer: slow variation of A (then the frozen-time roots
                  may be believed), a Lyapunov certificate, the growth of the transition matrix, in this order
Frozen-time eigenvalues alone never decide.

stable      every deviation decays; on a nominal that is not periodic: ends smaller than it began, or falls in the
            measure V of slow variation
unstable    some deviation grows; on a nominal that is not periodic: by GROWN, and so that growth builds on growth,
            which drift (a power of time, however late it starts) does not
marginal    the slowest cannot be told from one that neither decays nor grows, to within a small error that is said:
            undamped, or free to drift. `Verdict.growth` tells drift (polynomial) from what stays bounded
drift       on a nominal that is not periodic: states that none feels run off, and without them it is bounded
bounded     on a nominal that is not periodic: every deviation ends at most GROWN times as large as it began, where
            states are weighed alike: in scaled coordinates
undecided   none of these is shown; a motion that ends has its numbers all the same: `Verdict.horizon`

Stable and unstable hold for every A(t) that its nodes allow (`interpolation`, `transition_error`, `eigenvalue_bounds`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import LEAST, require_flag, require_seconds, require_text
from pliant.plants.core.imports import Late
from pliant.plants.finite_horizon.asked import asked_of
from pliant.plants.linear import magnus
from pliant.plants.linear.lti import LinearModel
from pliant.plants.transitions.state_matrix_path import Model, as_pieces
from pliant.plants.transitions.transition_error import TooManySteps

from .floquet import Floquet, floquet
from .frozen_time import (
    frozen_along,
    frozen_time,
    said_coordinates,
    slow_along,
)
from .lyapunov_certificate import certified
from .open_motion import judged_once
from .periodicity import varying
from .proven import proven
from .transition_growth import grown, growth
from .verdict import Verdict, made, of_constant, of_periodic

LONG_RUN = Late("pliant.plants.exponents.beyond_the_record")  # which imports this room
MOST_POINTS = 500  # times of a period at which growth is taken, at most
SOME, LARGE = 64, 40  # times of a period at which frozen roots are, an eighth of them beyond so many states
FEW_STEPS = 256  # a certificate beside Floquet's answer is only sought with so many steps ..


def assess(
    model: Model | LinearModel,
    *,
    period: float | None = None,
    periodic: bool | None = None,
    states: Sequence[str] | None = None,
    coordinates: str | None = None,
    window: float | None = None,
    thorough: bool = True,
    beyond: str | None = None,
    limit: Any = None,
    within: float = 0.0,
    outputs: Sequence[str] | None = None,
    disturbances: Sequence[str] | None = None,
    limits: Mapping[str, float] | None = None,
    scale: Mapping[str, float] | None = None,
    rigorous: bool = False,
) -> Verdict:
    """The verdict on a LinearModel, an LTVModel, or pieces joined by jumps.

    `period` [s] of A(t), None: found where there is one; of pieces: all of them, or some that are repeated.
    `periodic=False`: the nominal is what it is and not repeated; True: ValueError where no period is found, and pieces
    are taken as one period. `states` keeps only those, a part that does not feel the others (ValueError else).
    `coordinates` says in words what the states are measured in. `window` [s] of the growth. thorough=False stops at
    the method that decides. ValueError for what cannot have an effect: a window or a period of a constant model's
    growth, a period of a nominal that is not repeated.

    beyond: what is taken for granted after a nominal that ends, so that the answer is about all times: "constant" (A
    stays what it is at the end), "tends" (A comes to stay within `within` [1/s] of `limit` (nx, nx), of A at the end
    where it is None), "periodic", or "persists" (what was seen goes on, by averages: an estimate), as in
    `exponents.spectrum`. The assumption stands in the sentence. None: the answer is about the nominal alone.

    outputs, disturbances, limits, scale: of `Verdict.horizon` as in `finite_horizon`, for an LTVModel. Where they are
    not given it tells of lengths and of the forces on them, else of what is in the unit of the first output.

    rigorous: "stable" and "unstable" only where they are theorems of the model given, of 12 states at most, with the
    numbers that show it enclosed: `Verdict.proof`. ImportError without python-flint; ValueError with `beyond`.

    >>> told = assess(plant.linearize_along(motion), outputs=["tip_y"], disturbances=["tip_force_y"])
    >>> print(told.verdict, told.sentence)
    """
    rigorous = require_flag("assess.rigorous", rigorous)
    if rigorous and beyond is not None:
        raise ValueError(f"assess.rigorous = True with beyond = {beyond!r}, must be None: what is assumed is not shown")
    about = asked_of("assess", model, outputs, disturbances, limits, scale)
    if beyond is None and (limit is not None or within):
        raise ValueError("assess.limit, within belong to beyond = 'tends', must be None and 0")
    if beyond is not None:
        periodic = LONG_RUN.repeated("assess", model, beyond, periodic, limit, within)
    found = _judged(model, period, periodic, states, coordinates, window, thorough)
    if beyond is not None and found.method not in ("eigenvalues", "floquet"):
        found = LONG_RUN.in_the_long_run(found, model, beyond, states, limit, within)
    if rigorous:
        found = proven(found, model, states)
    return found if about is None else replace(found, asked=about)


def _judged(
    model: Model | LinearModel,
    period: float | None,
    periodic: bool | None,
    states: Sequence[str] | None,
    coordinates: str | None,
    window: float | None,
    thorough: bool,
) -> Verdict:
    thorough = require_flag("assess.thorough", thorough)
    periodic = None if periodic is None else require_flag("assess.periodic", periodic)
    period = None if period is None else require_seconds("assess.period", period, LEAST)
    window = None if window is None else require_seconds("assess.window", window, LEAST)
    coordinates = None if coordinates is None else require_text("assess.coordinates", coordinates)
    if periodic is False and period is not None:
        raise ValueError(f"assess.period = {period:g} s of a nominal that is not repeated (periodic=False)")
    if isinstance(model, LinearModel):
        if window is not None:
            raise ValueError(f"assess.window = {window:g} s: a LinearModel has no nominal to take windows of")
        if period is not None and model.dt is not None:
            raise ValueError(f"assess.period = {period!r} s: a sampled model has none")
        return of_constant(model, states, coordinates)
    joined = as_pieces(model)
    if len(joined.pieces) == 1 and not varying(joined.pieces[0])[0].shape[1]:
        span = float(joined.pieces[0].t[-1] - joined.pieces[0].t[0])
        for name, time in (("floquet.period", period), ("growth.window", window)):
            if time is not None and time > span * (1 + 1e-9):
                raise ValueError(f"{name} = {time:.6g} must be > 0 and at most {span:.6g} s")
        spread = np.ptp(joined.pieces[0].A, axis=0)  # rounding, or what units make small
        still = of_constant(joined.pieces[0].at(0), states, coordinates, spread)
        if still.verdict != "undecided" or not spread.any():
            return still
    said: dict[str, str] = {"eigenvalues": "A varies"}
    evidence: dict[str, Any] = {}
    cycle = None
    if periodic is False:
        said["floquet"] = "told that the nominal is not repeated"
    elif len(joined.pieces) > 1 and period is None and not periodic:
        said["floquet"] = "the nominal has jumps"
    else:
        if len(joined.pieces) > 1 and period is None:
            period = float(joined.pieces[-1].t[-1] - joined.pieces[0].t[0])
        try:
            cycle = floquet(joined, period, states=states)
        except ValueError as refusal:
            said["floquet"] = str(refusal).removeprefix("floquet: ")
            if periodic or period is not None:
                if isinstance(refusal, TooManySteps):  # periodic it is
                    return made("undecided", "", np.nan, said["floquet"], evidence, said)
                raise
    if cycle is not None:
        evidence["floquet"] = cycle
        if thorough:
            _beside(joined, states, coordinates, window, cycle, evidence, said)
        return of_periodic(joined, states, cycle, evidence, said)
    return judged_once(joined, states, coordinates, window, thorough, evidence, said)


def _beside(
    joined: Any,
    states: Sequence[str] | None,
    coordinates: str | None,
    window: float | None,
    cycle: Floquet,
    evidence: dict[str, Any],
    said: dict[str, str],
) -> None:
    """What the other methods say of a periodic model; they do not decide."""
    if len(cycle.paths) > 1:
        evidence["frozen_time"] = frozen_time(joined, states=states, coordinates=coordinates)
        said["slow_variation"] = said["lyapunov"] = "the nominal has jumps"
        evidence["growth"] = growth(joined, window, states=states)
        return
    path, t0 = cycle.path, cycle.path.t[0]
    few = t0 + np.linspace(0.0, cycle.period, (SOME if path.n <= LARGE else SOME // 8) + 1)
    said_in = coordinates or said_coordinates(joined, states)
    evidence["frozen_time"] = frozen_along(path, few, said_in)
    if evidence["frozen_time"].suggests == "stable":
        evidence["slow_variation"] = slow_along(path, few)
    else:
        said["slow_variation"] = "frozen roots are not all in the left half-plane"
    m = len(cycle.transitions)
    edges = np.unique(np.linspace(0, m, min(m, MOST_POINTS) + 1).astype(int))
    try:
        Phi = magnus.grouped(cycle.transitions, edges)
        evidence["growth"] = grown(cycle.times[edges], Phi, path.scale, window)
    except ValueError as failure:
        if window is not None:
            raise
        said["growth"] = str(failure)
    if cycle.verdict != "stable":
        said["lyapunov"] = f"no certificate where Floquet says {cycle.verdict}"
        return
    if path.n > LARGE:
        said["lyapunov"] = f"not needed: Floquet decides, and it costs much with {path.n} states"
        return
    found = certified(path, cycle.period, most=FEW_STEPS)
    if found:
        evidence["lyapunov"] = found
    else:
        said["lyapunov"] = f"not needed; {found.why}"
