"""Inputs that take a plant from rest to rest, by inverse dynamics at each time.

M q'' = f + B u has one u for each q'' wanted where one input drives each moved coordinate. Coordinates without an input
follow where forces tie them to the moved ones. Many times are evaluated at once: an integrator asks for all stages of
a step together, and the plant's functions cost little more for twelve points than for one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from pliant.plants.core.argument_gates import require_finite, require_seconds
from pliant.plants.core.signals import OwnsArrays, names

from .minimum_jerk import profile_of

Array = np.ndarray
NODES = 25  # of the rests along the way, interpolated at Chebyshev's points
UNTIED = 1e-10  # of the largest stiffness over mass: below it nothing ties a coordinate
NEWTON, CLOSE, SMALL = 30, 1e-9, 1e-2  # steps; the last one, of the unknowns' size or of SMALL


def rest_to_rest_ends(plant: Any, begin: Any, end: Any, time: Any) -> tuple[Array, Array, float]:
    """The states (nx,), copies, and the time [s] between which a plant is to move; ValueError names what is none."""
    first, last = (
        np.array(require_finite(f"rest_to_rest.{name}", x, (plant.nx,))) for name, x in (("begin", begin), ("end", end))
    )
    return first, last, require_seconds("rest_to_rest.time", time)


class InverseDynamics(OwnsArrays):
    """u(t) (nu,) along x(t) (nx,) whose moved coordinates go from `begin` to `end` (nx,) in `time` [s].

    Moved are all coordinates where there are as many inputs, else those of the joints, or, where no input drives one
    coordinate alone, as many coordinates as there are inputs that differ at the end. What else forces tie to those
    (a link behind a spring, a load that hangs, a beam's shapes) follows: it is accelerated as the rests along the way
    are, and bent as far as that acceleration takes. Its vibration about this is left out. Coordinates that nothing
    ties stay at `begin`, free to be accelerated. ValueError where the inputs and the moved do not match, or where what
    follows has no rest along the way.

    >>> arm = TwoLinkArm.textbook().ladder()[0]
    >>> u = arm.rest_to_rest(np.zeros(4), np.array([1.0, 0.5, 0.0, 0.0]), time=1.0)
    >>> u(0.25), u.at_times(np.linspace(0, 1, 5))  # (2,), (5, 2)
    """

    def __init__(self, plant: Any, begin: Array, end: Array, time: float, profile: str = "minimum-jerk") -> None:
        known = names(plant.states)
        self.plant, self.profile = plant, profile
        self._motion = profile_of("rest_to_rest", profile)
        self._start, last, self.time = rest_to_rest_ends(plant, begin, end, time)
        moved = self._moved(last)
        self._q = [known.index(name) for name in moved]
        self._v = [known.index(plant.rates[name]) for name in moved]
        self._way = last[self._q] - self._start[self._q]
        others = [name for name in plant.rates if name not in moved]
        self._others = [known.index(name) for name in others], [known.index(plant.rates[name]) for name in others]
        self._require_reach()
        self._tied = self._ties()
        self._rests = self._along_the_way() if self._tied.size else np.zeros((1, 0))
        self._held: Array | None = None  # the input at the end, once it is known

    def _moved(self, last: Array) -> tuple[str, ...]:
        """One coordinate for each input; ValueError where there are none."""
        plant, known = self.plant, names(self.plant.states)
        moved = tuple(plant.rates) if len(plant.rates) == plant.nu else tuple(j.position for j in plant.joints)
        alone = ", ".join(moved) or "none"
        if len(moved) != plant.nu or not set(moved) <= set(plant.rates):
            moved = tuple(n for n in plant.rates if last[known.index(n)] != self._start[known.index(n)])
        if len(moved) != plant.nu:
            raise ValueError(
                f"inputs that drive one coordinate each: the {plant.nu} of {type(plant).__name__} ({plant.label}) "
                f"drive {alone}; move {plant.nu} coordinates instead of {len(moved)}, name those driven in `joints`, "
                "or give the inputs as functions of time instead, in a file as [motion] of type samples"
            )
        return moved

    def _require_reach(self) -> None:
        """ValueError where along the way the inputs do not accelerate the moved coordinates each as it is wanted."""
        at = np.linspace(0.0, 1.0, NODES)
        x = np.tile(self._start, (NODES, 1))
        x[:, self._q] += np.multiply.outer(at, self._way)
        B = self.plant.jacobians(self._carried(x), np.zeros((NODES, self.plant.nu)))[1][:, self._v]
        rows = np.maximum(np.abs(B).max(axis=2, keepdims=True), np.finfo(float).tiny)  # of their own units
        sign = np.linalg.slogdet(B)[0]
        lost = (np.linalg.matrix_rank(B / rows) < len(self._v)) | (sign != sign[0])
        if lost.any():
            moved = ", ".join(names(self.plant.states)[k] for k in self._q)
            raise ValueError(
                f"inputs that accelerate {moved}, each as is wanted, all along the way: those of "
                f"{type(self.plant).__name__} ({self.plant.label}) do not at {at[np.argmax(lost)]:.2g} of it; give the "
                "inputs as functions of time instead"
            )

    def __call__(self, t: float) -> Array:
        """The inputs (nu,) at one time; those of the end from then on."""
        if t < self.time:
            return self._inputs(np.array([t]))[0]
        if self._held is None:
            self._held = self._inputs(np.array([self.time]))[0]
        return self._held.copy()

    def at_times(self, times: Array) -> Array:
        """The inputs (n, nu) at times (n,)."""
        if np.min(times, initial=np.inf) >= self.time:
            return np.tile(self(self.time), (len(times), 1))
        return self._inputs(times)

    def _carried(self, x: Array) -> Array:
        """States (n, nx) with what moves along where the moved coordinates do: nothing."""
        return x

    def _ties(self) -> Array:
        """(others, ties), orthonormal: the directions in which forces hold the others at rest, the moved ones held."""
        q, v = self._others
        if not q:
            return np.zeros((0, 0))
        u = np.zeros(self.plant.nu)
        B = self.plant.jacobians(self._start, u)[1]
        u -= np.linalg.solve(B[self._v], self.plant.dynamics(self._start, u)[self._v])  # what holds the moved ones
        A, B = self.plant.jacobians(self._start, u)[:2]
        held = np.linalg.solve(B[self._v], A[np.ix_(self._v, q)])
        _, sizes, directions = np.linalg.svd(A[np.ix_(v, q)] - B[v] @ held)
        tied: Array = directions[: int(np.sum(sizes > UNTIED * sizes[0]))].T
        return tied

    def _along_the_way(self) -> Array:
        """Coefficients (NODES, ties) of the rests over the way from 0 to 1, found one after another."""
        at = (1 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)) / 2
        y, found = np.zeros((1, self._tied.shape[1])), []
        u, still = np.zeros((1, self.plant.nu)), np.zeros((1, 1))
        for s in at:
            place = s * self._way[None], still * self._way, still * self._way
            y, u, sound = self._balanced(*place, y, 0 * y, 0 * y, u)
            if not sound.all():
                others = ", ".join(names(self.plant.states)[k] for k in self._others[0])
                raise ValueError(
                    f"a rest at every place along the way: {others} of {type(self.plant).__name__} "
                    f"({self.plant.label}), which no input drives, has none at {s:.2g} of it; give the inputs as "
                    "functions of time instead"
                )
            found.append(y[0])
        coefficients: Array = chebyshev.chebfit(2 * at - 1, np.array(found), NODES - 1)
        return coefficients

    def _balanced(
        self, way: Array, rate: Array, wanted: Array, y: Array, dy: Array, ddy: Array, u: Array
    ) -> tuple[Array, Array, Array]:
        """(y, u, which are found) at which the moved coordinates have the accelerations `wanted`, the tied ones ddy,
        by Newton's method from y and u; where that finds none, its first step.
        """
        (q, v), Y, nu = self._others, self._tied, self.plant.nu
        first: Array | None = None
        sound = np.zeros(len(way), dtype=bool)
        for _ in range(NEWTON):
            x = np.tile(self._start, (len(way), 1))
            x[:, self._q], x[:, self._v] = self._start[self._q] + way, rate
            x[:, q], x[:, v] = self._start[q] + y @ Y.T, dy @ Y.T
            x = self._carried(x)
            A, B = self.plant.jacobians(x, u)[:2]
            a = self.plant.dynamics(x, u)
            lacking = np.hstack([a[:, self._v] - wanted, a[:, v] @ Y - ddy])
            rows = np.concatenate([A[:, self._v][:, :, q], Y.T @ A[:, v][:, :, q]], axis=1) @ Y
            slopes = np.concatenate([rows, np.concatenate([B[:, self._v], Y.T @ B[:, v]], axis=1)], axis=2)
            try:
                step = np.linalg.solve(slopes, -lacking[:, :, None])[:, :, 0]
            except np.linalg.LinAlgError:
                break
            z = np.where(sound[:, None], 0.0, step) + np.hstack([y, u])
            first = z if first is None else first
            y, u = z[:, : Y.shape[1]], z[:, -nu:]
            sound |= np.abs(step).max(axis=1) <= CLOSE * (SMALL + np.abs(z).max(axis=1))
            if sound.all() or not np.isfinite(z).all():
                break
        if first is not None and not sound.all():
            z = np.where(sound[:, None], np.hstack([y, u]), first)
            y, u = z[:, : Y.shape[1]], z[:, -nu:]
        return y, u, sound

    def _inputs(self, times: Array) -> Array:
        way, rate, wanted = (np.multiply.outer(part, self._way) for part in self._motion(times / self.time))
        rate, wanted = rate / self.time, wanted / self.time**2
        still = np.zeros((len(times), self.plant.nu))
        if self._tied.size and len(times):
            return self._following(times, way, rate, wanted, still)
        x = np.tile(self._start, (len(times), 1))
        x[:, self._q], x[:, self._v] = self._start[self._q] + way, rate
        x = self._carried(x)
        free = self.plant.dynamics(x, still)[:, self._v]
        B = self.plant.jacobians(x, still)[1][:, self._v]
        return np.linalg.solve(B, (wanted - free)[:, :, None])[:, :, 0]

    def _following(self, times: Array, way: Array, rate: Array, wanted: Array, still: Array) -> Array:
        """With the tied coordinates near their rests y(s) over the way, at y' ds/dt and y'' (ds/dt)^2 + y' d2s/dt2."""
        s, ds, dds = (np.asarray(part)[:, None] for part in self._motion(times / self.time))
        ds, dds = ds / self.time, dds / self.time**2
        slope = 2 * chebyshev.chebder(self._rests)
        y, by, curve = (
            np.atleast_2d(chebyshev.chebval(2 * s[:, 0] - 1, c).T)
            for c in (self._rests, slope, 2 * chebyshev.chebder(slope))
        )
        return self._balanced(way, rate, wanted, y, by * ds, curve * ds**2 + by * dds, still)[1]
