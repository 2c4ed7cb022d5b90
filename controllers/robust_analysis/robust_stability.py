"""How much of a box of a plant's own parameters a loop stands: lower and upper bounds, and the worst parameters.

The box: each parameter between two values. k times the box: the same about its middle, each half width times k.

stable_to     the loop is stable everywhere in this many boxes: D, G scalings at all frequencies of a linear fractional
              form of the loop's state matrix, fitted over those very boxes. What the form lacks of the loop, `left`,
              was measured at some hundred points and is neglected
unstable_at   at `worst`, on the edge of this many boxes, the loop's own state matrix has an eigenvalue on its limit
mu            1/unstable_at to 1/stable_to: the structured singular value of the loop over the box
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from pliant.controllers.analysis.linear_laws import closed_matrix, law_of
from pliant.controllers.analysis.loops import plant_of
from pliant.plants.core.argument_gates import (
    require_finite,
    require_function,
    require_instance,
    require_mapping,
    require_number,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, rows_by_name
from pliant.plants.dynamics.plant import Plant

from .fractional_form import FractionalForm, fitted
from .nearest_instability import growth, nearest
from .over_frequencies import bound

Array = np.ndarray
MOST = 8  # boxes that are looked at
KEPT = 0.95  # of a value, that it may fall by where boxes larger than the given one would take it past zero
SHARES = (0.99, 0.97, 0.94, 0.9, 0.8, 0.65, 0.5, 0.3, 0.15, 0.05)  # of the nearest instability: boxes that are tried


@dataclass(frozen=True, eq=False)
class RobustStability(OwnsArrays):
    """Of one loop over one box."""

    box: dict[str, tuple[float, float]]
    stable_to: float
    unstable_at: float | None  # None: no instability was found in `most` boxes
    most: float  # boxes beyond which nothing was looked at: a parameter would come near to zero
    worst: dict[str, float] | None  # the parameters there
    left: float  # |what the form lacks| / |state matrix|, the largest that was measured
    form: FractionalForm

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
        if self.worst is None:
            return f"{text}, and no instability was found in {self.most:.3g}."
        at = ", ".join(f"{n} = {v:.4g}" for n, v in self.worst.items())
        return f"{text}, and is at its limit at {at}, on the edge of {self.unstable_at:.4g}."


def robust_stability(
    plant: Plant, controller: object, box: Mapping[str, tuple[float, float]], at: Mapping[str, float]
) -> RobustStability:
    """Of a plant at rest under a controller with a linear form, over intervals of its parameters by name.

    box: {"payload.mass": (lowest, highest), ..} in the parameters' units. at: what `plant.equilibrium` holds by name.
    The loop is linearised there in the middle of the box, for all parameters: that the rest itself moves is neglected.
    A controller without states acts as if continuous. PliantError where the loop in the middle is not stable.

    Sources: Fan, Tits and Doyle 1991; Young, Newlin and Doyle 1992.

    Example
    -------
    >>> found = robust_stability(arm, LQR.for_scene(scene), {"payload.mass": (0.05, 0.15)}, dict(scene.goal))
    >>> print(found.words, found.mu)
    """
    names, middle, half = require_box("robust_stability.box", box)
    varied = require_instance("robust_stability.plant", plant, Plant).vary(*names)
    law = law_of(controller)
    if law.dt is not None:
        if len(law.A) or law.delay:
            raise PliantError("robust_stability: a sampled law with states or delays must be given as a continuous one")
        law = replace(law, dt=None)
    x0, u0 = varied.equilibrium(at, p=middle)
    n = len(x0)

    middle_model = varied.linearize(x0, u0, p=middle)
    rows = rows_by_name(middle_model, law.reads).at
    whole = len(plant_of(middle_model, law)[0]) == n  # nothing conserved leaves the loop

    def state_matrix(delta: Array) -> Array:
        p = middle + half * delta
        if not whole:
            return closed_matrix(plant_of(varied.linearize(x0, u0, p=p), law), law)
        A, B, _, C, D, _ = varied.jacobians(x0, u0, p=p)
        seen, direct = np.vstack([np.eye(n), C])[rows], np.vstack([np.zeros_like(B), D])[rows]
        return closed_matrix((A, B, seen, direct), law)

    def mass(delta: Array) -> Array:
        M = np.asarray(varied.mass_matrix(x0, p=middle + half * delta))  # type: ignore[attr-defined]
        wide = np.eye(n + len(law.A))
        wide[n - len(M) : n, n - len(M) : n] = M
        return wide

    known = whole and hasattr(varied, "mass_matrix") and 2 * len(varied.mass_matrix(x0, p=middle)) == n
    return over_box(state_matrix, dict(zip(names, zip(middle - half, middle + half))), mass=mass if known else None)


def over_box(
    state_matrix: Callable[[Array], Array],
    box: Mapping[str, tuple[float, float]],
    dt: float | None = None,
    mass: Callable[[Array], Array] | None = None,
) -> RobustStability:
    """The same of any closed loop by its state matrix (n, n), a function of delta (k,), each in [-1, 1] in one box;
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
    size = np.abs(middle)
    with np.errstate(divide="ignore"):
        reach = np.where(size > 0, KEPT * size / half, np.inf)
    most = float(min(MOST, max(1.0, reach.min())))
    if (rate := growth(state_matrix(np.zeros(len(names))), dt)) >= 0:
        raise PliantError(f"the loop is not stable in the middle of the box: it grows by {rate:.4g} 1/s")
    found = nearest(state_matrix, len(names), dt, most)
    edge, k = most if found is None else found[0], 0.0
    for share in (1.0, *SHARES) if found is None else SHARES:
        k = edge * share
        form = fitted(_scaled(state_matrix, k), len(names), dt, None if mass is None else _scaled(mass, k))
        if bound(form, 1.0, 1.0).beta <= 1:
            break
    else:
        k = 0.0
    return RobustStability(
        box=dict(zip(names, zip((middle - half).tolist(), (middle + half).tolist()))),
        stable_to=float(k),
        unstable_at=None if found is None else found[0],
        most=most,
        worst=None if found is None else dict(zip(names, (middle + half * found[1]).tolist())),
        left=form.left,
        form=form,
    )


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
