"""Equations of motion M a = r as they stand and their Jacobians, at any accelerations, not those alone that solve them.

With accelerations a held, dM a + M da = dr gives da = M^-1 (dr - dM a); the plant gives da, its rate dx/dt as a
function of a, and the accelerations that solve the equations. At those the Jacobians are the plant's own, with fewer
operations than the derivative of M^-1 r takes. Where they are asked for at some points only, writing them out costs
more than it saves: `ForceBalance` has them from derivatives along one direction at a time, and M from the same.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, cast

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.native.batch_kernels import NativeFunction, random_points
from pliant.plants.native.kernel_loader import wanted

Array = np.ndarray

UNIT = 2.0**40  # [m/s^2, rad/s^2] at which M is read off: beside M a all other forces are rounding then
MOVE, LEAST = 1e-6, 1e-2  # of a state's largest value, or this share of the largest of its kind, or of one


class Differentiated(NamedTuple):
    """The equations M a = r of a plant with m accelerations, differentiated at accelerations `a` held."""

    a: ca.SX  # (m,) symbols
    rate: ca.SX  # (nx,) dx/dt at a
    change: ca.SX  # (m, nx + nu + nw) da by (x, u, w)
    solved: ca.SX  # (m,) the accelerations that solve the equations


class ResidualJacobians:
    """[A, B, E, C, D, F] at the accelerations that solve the equations and at others."""

    def __init__(self, plant: PlantLike, output: Callable[[], ca.SX], equations: Differentiated) -> None:
        _, x, u, w, _ = plant.symbols
        self._z = ca.vertcat(x, u, w)
        self.plant, self.accelerations, self._output = plant, equations.solved, output
        self._symbols = [*plant.symbols, equations.a]
        rate = ca.jacobian(equations.rate, self._z)
        self._rates = self._parted(rate + ca.jacobian(equations.rate, equations.a) @ equations.change)
        self._moved = ca.Function("moved", self._symbols, self._rates)

    def _parted(self, J: ca.SX) -> list[ca.SX]:
        plant = self.plant
        ends = [0, plant.nx, plant.nx + plant.nu, plant.nx + plant.nu + plant.nw]
        return [J[:, s:e] for s, e in pairwise(ends)]

    @cached_property
    def blocks(self) -> ca.Function:
        """[A, B, E, C, D, F] at accelerations."""
        outputs = self._parted(ca.jacobian(self._output(), self._z))
        return ca.Function("blocks", self._symbols, [*self._rates, *outputs])

    def slopes(self) -> ca.SX:
        """[A, B] (nx, nx + nu) at the plant's own accelerations, sparse."""
        return cast(ca.SX, ca.horzcat(*self._moved(*self.plant.symbols, self.accelerations)[:2]))

    @cached_property
    def states(self) -> NumericFunction:
        """(t, x, u, w, p) -> [A, B] at the plant's own accelerations: without outputs, at a fraction of the cost."""
        symbols = list(self.plant.symbols)
        return function("states", symbols, list(self._moved(*symbols, self.accelerations))[:2], matrices=True)

    @cached_property
    def states_along(self) -> NumericFunction:
        """(t, x, u, w, p, a) -> [A] at accelerations a (m,)."""
        return function("states_along", self._symbols, self._rates[:1], matrices=True)

    @cached_property
    def solved(self) -> NumericFunction:
        """(t, x, u, w, p) at the plant's own accelerations."""
        symbols = list(self.plant.symbols)
        return function("jacobians", symbols, list(self.blocks(*symbols, self.accelerations)), matrices=True)

    @cached_property
    def along(self) -> NumericFunction:
        """(t, x, u, w, p, a) at accelerations a (m,); native where the plant's own Jacobians are."""
        a = ca.SX.sym("a", self.accelerations.shape[0])
        symbols = [*self.plant.symbols, a]
        found = function("along", symbols, list(self.blocks(*symbols)), matrices=True)
        if not isinstance(self.plant.__dict__.get("_jacobians"), NativeFunction):
            return found
        rng = np.random.default_rng(0)
        points = random_points(self.plant, rng)
        moving = rng.uniform(-1.0, 1.0, (a.shape[0], points[0].shape[1]))
        return NativeFunction(found.function, [*points, moving], matrices=True)


def from_energies(plant: Any, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
    """r - M a = Q - d/dt(dT/dv) + d(T - V)/dq - dD/dv (n,) at accelerations a (n,)."""
    q, v = x[: a.shape[0]], x[a.shape[0] :]
    T, V, D = plant.kinetic_energy(q, v), plant.potential_energy(q), plant.dissipation(q, v)
    moved = ca.jtimes(ca.gradient(T, v), x, ca.vertcat(v, a))
    return plant.generalized_force(t, q, v, u, w) + ca.gradient(T - V, q) - ca.gradient(D, v) - moved


class ForceBalance:
    """M a = r of the `free` ones of n speeds, the others `driven` by inputs.

    At rows (B, ..) of t, x, u and accelerations a (B, n), undisturbed where w is None, with the plant's own parameters
    where p is.
    """

    def __init__(
        self,
        plant: PlantLike,
        lacking: ca.SX,
        a: ca.SX,
        driven: dict[int, int],
        rates: ca.SX,
        mass: ca.SX | None = None,
    ) -> None:
        """lacking: r - M a of the free speeds at their accelerations a; driven: {speed: input}; rates: dq/dt of x;
        mass: their M where it is written out.
        """
        _, x, u, _, _ = plant.symbols
        self.plant, self.driven, self.first = plant, driven, rates.shape[0]  # speeds follow the coordinates
        self.n = plant.nx - self.first
        self._rates = _numeric("rates", [x], rates)
        self._turning = NumericFunction(ca.Function("turning", [x], [ca.densify(ca.jacobian(rates, x))]), matrices=True)
        self.free = [i for i in range(self.n) if i not in driven]
        at = [*plant.symbols, a]
        if not wanted():  # of what is read once, and done for rows, finding them takes longer than they do
            lacking = ca.cse(lacking)
        self._lacking = _numeric("lacking", at, lacking)
        self._mass = (
            None
            if mass is None
            else NumericFunction(ca.Function("mass", list(plant.symbols), [ca.densify(mass)]), matrices=True)
        )
        self._expressions = at, lacking, x, u

    @cached_property
    def _pushed(self) -> NumericFunction:
        at, lacking, _, u = self._expressions
        return _numeric("pushed", at, ca.jacobian(lacking, u))

    @cached_property
    def _changed(self) -> NumericFunction:
        at, lacking, x, _ = self._expressions
        along = ca.SX.sym("dx", x.shape[0])
        return _numeric("changed", [*at, along], ca.jtimes(lacking, x, along))

    def _values(self, t: Array, x: Array, u: Array, w: Any, p: Any) -> tuple[Array, ...]:
        quiet_w, quiet_p = self.plant.quiet
        return t[:, None], x, u, quiet_w if w is None else w, quiet_p if p is None else p

    def lacking(self, t: Array, x: Array, u: Array, a: Array, *, w: Any = None, p: Any = None) -> Array:
        """r - M a of the free speeds (B, m)."""
        if not self.free:
            return np.zeros((len(x), 0))
        return self._lacking(*self._values(t, x, u, w, p), a[:, self.free], batch=len(x))[0]

    def mass(self, t: Array, x: Array, u: Array, *, w: Any = None, p: Any = None) -> Array:
        """M of the free speeds (B, m, m)."""
        m = len(self.free)
        if not m:
            return np.zeros((len(x), 0, 0))
        if self._mass is not None:
            return self._mass(*self._values(t, x, u, w, p), batch=len(x))[0]
        values, still = self._values(t, x, u, w, p), np.zeros((len(x), m))
        M = -self._differences(values, still, np.full((len(x), m), UNIT), 5) / UNIT
        return (M + np.swapaxes(M, 1, 2)) / 2

    def _differences(self, values: tuple[Array, ...], a: Array, moves: Array, k: int) -> Array:
        """(B, m, c): what moves (B, c) of the entries of the k-th argument, each alone, change r - M a by."""
        rows, count = moves.shape
        given = [*(np.broadcast_to(v, (rows, np.shape(v)[-1])) for v in values), a]
        several = [np.repeat(v, count + 1, axis=0) for v in given]
        at = several[k].reshape(rows, count + 1, count)
        at[:, np.arange(count), np.arange(count)] += moves
        found = self._lacking(*several, batch=rows * (count + 1))[0].reshape(rows, count + 1, -1)
        return np.swapaxes(found[:, :-1] - found[:, -1:], 1, 2)

    def at_rest(self, t: Array, x: Array, u: Array, *, w: Any = None, p: Any = None) -> list[Array]:
        """[r (n, 1), dr/dq, dr/dv, dr/du, M] at one row, where nothing moves and no speed is driven."""
        values, still = self._values(t, x, u, w, p), np.zeros((1, self.n))
        slopes = _columns(self._changed, (*values, still), self.plant.nx)[0]
        forces, pushed = self._lacking(*values, still, batch=1)[0], self._pushed(*values, still, batch=1)[0]
        pushed = pushed.reshape(self.n, -1)
        return [forces.T, slopes[:, : self.first], slopes[:, self.first :], pushed, self.mass(t, x, u, w=w, p=p)[0]]

    def rates(self, x: Array) -> Array:
        """dq/dt (B, nx - n) of states."""
        return self._rates(x, batch=len(x))[0]

    def accelerations(self, t: Array, x: Array, u: Array, M: Array) -> Array:
        """a (B, n) that solve the equations with M of `mass`."""
        a = np.zeros((len(x), self.n))
        for i, k in self.driven.items():
            a[:, i] = u[:, k]
        if self.free:
            a[:, self.free] = np.linalg.solve(M, self.lacking(t, x, u, a)[..., None])[..., 0]
        return a

    def state_jacobians(self, t: Array, x: Array, u: Array, a: Array, *, w: Any = None, p: Any = None) -> Array:
        """A (B, nx, nx) of dx/dt, the equations differentiated at accelerations a."""
        nx, first = self.plant.nx, self.first
        A = np.zeros((len(x), nx, nx))
        A[:, :first] = self._turning(x, batch=len(x))[0]
        if self.free:
            slopes = _columns(self._changed, (*self._values(t, x, u, w, p), a[:, self.free]), nx)
            A[:, [first + i for i in self.free]] = np.linalg.solve(self.mass(t, x, u, w=w, p=p), slopes)
        return A

    def near_jacobians(self, t: Array, x: Array, u: Array, a: Array, M: Array) -> Array:
        """The same by differences of the equations themselves, with M of `mass`: to some parts in a million."""
        nx, first = self.plant.nx, self.first
        A = np.zeros((len(x), nx, nx))
        A[:, :first] = self._turning(x, batch=len(x))[0]
        if self.free:
            size, kind = np.abs(x).max(axis=0), np.arange(nx) < first
            least = np.where(kind, size[kind].max(initial=0.0), size[~kind].max(initial=0.0))
            h = MOVE * np.maximum(np.maximum(size, LEAST * least), LEAST)
            slopes = self._differences(self._values(t, x, u, None, None), a[:, self.free], np.tile(h, (len(x), 1)), 1)
            A[:, [first + i for i in self.free]] = np.linalg.solve(M, slopes / h)
        return A


def _numeric(name: str, symbols: list[ca.SX], found: ca.SX) -> NumericFunction:
    return NumericFunction(ca.Function(name, symbols, [ca.densify(found)]))


def _columns(along: NumericFunction, values: tuple[Array, ...], count: int) -> Array:
    """Derivatives along each of `count` unit vectors at each of the rows of values (B, ..): (B, m, count)."""
    batch = len(values[1])
    at = [v if np.ndim(v) < 2 else np.repeat(v, count, axis=0) for v in values]
    found = along(*at, np.tile(np.eye(count), (batch, 1)), batch=batch * count)[0]
    return found.reshape(batch, count, -1).transpose(0, 2, 1)
