"""How much of a box of a plant's own parameters a loop stands: lower and upper bounds, and the worst parameters.

The box: each parameter between two values. k times the box: the same about its middle, each half width times k.

stable_to     the loop is stable everywhere in this many boxes. A continuous loop: D, G scalings at all frequencies of a
              linear fractional form of its state matrix, fitted over those very boxes; what it lacks, `left`, was
              measured at some hundred points and is neglected. Where that shows too little, and for sampled loops: the
              box in parts, none of which has a zero of the loop's guardian map (`guardian_map`), or in each of which a
              norm follows the parameters (`parts_of_box`); what an interpolation of the map lacks, and what A is not
              linear in, was measured, and twice that is added: what more there may be is neglected
unstable_at   at `worst`, on the edge of this many boxes, the loop's own state matrix has an eigenvalue on its limit
mu            1/unstable_at to 1/stable_to: the structured singular value of the loop over the box
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from pliant.controllers.uncertain_blocks.fractional_form import FractionalForm, NoEffect, fitted
from pliant.controllers.uncertain_blocks.over_frequencies import bound
from pliant.plants.core.argument_gates import (
    require_count,
    require_finite,
    require_function,
    require_mapping,
    require_number,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.dynamics.plant import Plant

from .guardian_map import free_of_zeros
from .loop_over_box import LoopOverBox, loop_over_box
from .nearest_instability import first_along, growth, nearest
from .parts_of_box import Parts, shown

Array = np.ndarray
MOST = 8  # boxes that are looked at
KEPT = 0.95  # of a value, that it may fall by where boxes larger than the given one would take it past zero
QUICK = 3.0  # boxes, that a quick look tries
LOOKS_AT_MAP = 1500  # at parts of a box: by the guardian map
FIRST, LOOKS = 600, 3000  # by norms alone, then ..
BY_SCALINGS = 60.0  # .. by scalings as well: so many looks for those of 20 rows
NEUTRAL = 1e-10  # of the fastest rate: decay that is rounding
NEAR = 0.99  # of the nearest instability: the box that is shown in parts
SHARES = (0.99, 0.97, 0.94, 0.9, 0.8, 0.65, 0.5, 0.3, 0.15, 0.05)  # of the nearest instability: boxes that are tried


@dataclass(frozen=True, eq=False)
class RobustStability(OwnsArrays):
    """Of one loop over one box."""

    box: dict[str, tuple[float, float]]
    stable_to: float
    unstable_at: float | None  # None: no instability was found in `most` boxes
    most: float  # boxes beyond which nothing was looked at: a parameter would come near to zero
    worst: dict[str, float] | None  # the parameters there
    left: float  # |what the forms lack| / |state matrix|, or of the map's value, the largest that was measured
    parts: int  # of the box, each shown by itself; 1: all of it by scalings of the form
    form: FractionalForm | None
    cut_short: bool = False  # looks at parts ran out: more of the box may be stable

    @property
    def mu(self) -> tuple[float, float]:
        """Lower and upper bound. Dimensionless."""
        return (
            0.0 if self.unstable_at is None else 1 / self.unstable_at,
            1 / self.stable_to if self.stable_to else np.inf,
        )

    @property
    def words(self) -> str:
        """What an engineer would write."""
        inside = "stable for all of the box" if self.stable_to >= 1 else "not shown to be stable for all of the box"
        if self.unstable_at is not None and self.unstable_at <= 1:
            inside = "unstable within the box"
        text = f"The loop is {inside}: it stands {self.stable_to:.4g} boxes"
        if self.cut_short:
            text += " (looks at parts of it ran out)"
        if self.worst is None:
            return f"{text}, and no instability was found in {self.most:.3g}."
        at = ", ".join(f"{n} = {v:.4g}" for n, v in self.worst.items())
        return f"{text}, and is at its limit at {at}, on the edge of {self.unstable_at:.4g}."


def robust_stability(
    plant: Plant, controller: object, box: Mapping[str, tuple[float, float]], at: Mapping[str, float]
) -> RobustStability:
    """Of a plant at rest under a controller with a linear form, over intervals of its parameters by name.

    box: {"payload.mass": (lowest, highest), ..} in the parameters' units. at: what `plant.equilibrium` holds by name.
    "delay" among them is that of all inputs [s]: of a sampled law within one period and exact, of a continuous one by a
    Pade approximation of third order. The loop is linearised in the middle of the box, for all parameters: that the
    rest itself moves is neglected. A sampled law's loop is the exact one from sample to sample. PliantError where the
    loop in the middle is not stable.

    Sources: Fan, Tits and Doyle 1991; Young, Newlin and Doyle 1992.

    Example
    -------
    >>> found = robust_stability(arm, law, {"payload.mass": (0.05, 0.15)}, dict(scene.goal))
    >>> print(found.words)
    The loop is stable for all of the box: it stands 1.9 boxes, and no instability was found in 1.9.
    """
    names, middle, half = require_box("robust_stability.box", box)
    loop = loop_over_box(plant, controller, names, middle, half, at)
    return _found(names, middle, half, loop)


def over_box(
    state_matrix: Callable[[Array], Array],
    box: Mapping[str, tuple[float, float]],
    dt: float | None = None,
    mass: Callable[[Array], Array] | None = None,
) -> RobustStability:
    """The same of any closed loop by its `state_matrix` (n, n), a function of delta (k,), each in [-1, 1] in one box;
    `box` only names and scales them. dt [s]: of a sampled loop. mass: E(delta) (n, n), by which E A is a polynomial.

    Example
    -------
    >>> found = over_box(lambda delta: np.array([[-1.0 + delta[0]]]), {"gain": (0.0, 0.5)})
    >>> found.stable_to >= 1.0
    False
    """
    names, middle, half = require_box("over_box.box", box)
    state_matrix = require_function("over_box.state_matrix", state_matrix)
    dt = None if dt is None else require_number("over_box.dt", dt, "positive", unit="s")
    return _found(names, middle, half, LoopOverBox(state_matrix, mass, dt, np.inf))


def _found(names: tuple[str, ...], middle: Array, half: Array, loop: LoopOverBox) -> RobustStability:
    most, count, dt = _most(middle, half, loop), len(names), loop.dt
    middle_loop = loop.state_matrix(np.zeros(count))
    fastest = 1 / dt if dt is not None else float(np.abs(np.linalg.eigvals(middle_loop)).max())
    if (rate := growth(middle_loop, dt)) >= -NEUTRAL * fastest:
        how = f"it grows by {rate:.4g} 1/s" if rate > NEUTRAL * fastest else "a motion of it neither grows nor dies out"
        raise PliantError(f"the loop is not stable in the middle of the box: {how}")
    found = nearest(loop.state_matrix, count, dt, most)
    form, stood, parts, left, cut_short = None, 0.0, 0, np.inf, False
    edge = most if found is None else found[0]
    for share in ((1.0, *SHARES) if found is None else SHARES) if dt is None else ():
        if (form := _by_scalings(loop, count, edge * share)) is not None:
            stood, parts, left = edge * share, 1, form.left
            break
    edge *= 1.0 if found is None else NEAR
    if stood < edge:
        seen = free_of_zeros(_scaled(loop.state_matrix, edge), count, dt, LOOKS_AT_MAP)
        if seen.cut_short or (seen.stood < 1 and seen.unstable is None):
            seen = max(seen, shown(_scaled(loop.state_matrix, edge), count, dt, FIRST), key=_stood)
        if seen.cut_short and BY_SCALINGS:
            seen = max(seen, shown(_scaled(loop.state_matrix, edge), count, dt, LOOKS, BY_SCALINGS), key=_stood)
        if seen.unstable is not None:
            met = first_along(lambda delta: growth(loop.state_matrix(delta), dt), edge * seen.unstable)
            found = met if found is None or met[0] < found[0] else found
        if edge * seen.stood > stood:
            stood, parts, left, form = edge * seen.stood, seen.parts, seen.left, None
        cut_short = seen.cut_short
    return RobustStability(
        box=dict(zip(names, zip((middle - half).tolist(), (middle + half).tolist()))),
        stable_to=float(stood),
        unstable_at=None if found is None else found[0],
        most=most,
        worst=None if found is None else dict(zip(names, (middle + half * found[1]).tolist())),
        left=left,
        parts=parts,
        form=form,
        cut_short=cut_short,
    )


def _stood(seen: Parts) -> float:
    return seen.stood


def _most(middle: Array, half: Array, loop: LoopOverBox) -> float:
    with np.errstate(divide="ignore"):
        reach = np.where(middle != 0, KEPT * np.abs(middle) / half, np.inf)
    return float(min(MOST, loop.most, max(1.0, reach.min())))


def stands(
    plant: Plant,
    controller: object,
    box: Mapping[str, tuple[float, float]],
    at: Mapping[str, float],
    *,
    parts: int = 200,
) -> float:
    """How many boxes [1], at most 3, a loop was shown to stand: `stable_to`, with less patience.

    Arguments as in `robust_stability`: box and at in the parameters' and coordinates' own units; parts: of the box,
    that are looked at. ValueError for a box that is none.

    Example
    -------
    >>> stands(arm, law, {"payload.mass": (0.09, 0.11)}, dict(scene.goal))
    3.0
    """
    names, middle, half = require_box("stands.box", box)
    parts = require_count("stands", "parts", parts, 1, 100_000)
    loop = loop_over_box(plant, controller, names, middle, half, at)
    edge = min(QUICK, _most(middle, half, loop))
    if growth(loop.state_matrix(np.zeros(len(names))), loop.dt) >= 0:
        return 0.0
    return edge * shown(_scaled(loop.state_matrix, edge), len(names), loop.dt, parts).stood


def _by_scalings(loop: LoopOverBox, count: int, k: float) -> FractionalForm | None:
    """The form of k boxes over which scalings show stability."""
    mass = None if loop.mass is None else _scaled(loop.mass, k)
    try:
        form = fitted(_scaled(loop.state_matrix, k), count, loop.dt, mass)
    except NoEffect:  # parts of the box tell
        return None
    return form if bound(form, 1.0, 1.0).beta <= 1 else None


def _scaled(of: Callable[[Array], Array], k: float) -> Callable[[Array], Array]:
    return lambda delta: of(k * delta)


def require_box(owner: str, box: object) -> tuple[tuple[str, ...], Array, Array]:
    """Names, middles and half widths; ValueError for what is no box."""
    given = require_mapping(owner, box)
    if not given:
        raise ValueError(f"{owner} = {{}} must name one or more parameters")
    ends = np.array([require_finite(f"{owner}[{n!r}]", v, (2,)) for n, v in given.items()])
    for name, (low, high) in zip(given, ends):
        if not low < high:
            raise ValueError(f"{owner}[{name!r}] = ({low:g}, {high:g}) must be (lowest, highest), the first below")
    return tuple(given), ends.mean(axis=1), np.ptp(ends, axis=1) / 2
