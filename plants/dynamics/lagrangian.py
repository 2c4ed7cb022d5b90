"""Equations of motion from energies: d/dt(dT/dv) - dT/dq + dV/dq + dD/dv = Q, q the coordinates, v = dq/dt.

States   x = [q; v]
A coordinate may be driven: its acceleration is then an input and its force a reaction.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.errors import MassMatrixError
from pliant.plants.core.signals import Joint, Signal

from .plant import Array, Plant

if TYPE_CHECKING:
    from pliant.plants.core.trajectory import Trajectory

NEARLY_SINGULAR = 1e-3  # of the smallest eigenvalue of the scaled mass matrix at the start of a motion
HUGE = 1e6  # root of an inertia that only a diverged state has


def ldl(M: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
    """M = L diag(d) L^T without pivoting, which a positive definite M does not need; returns (L, d)."""
    n = M.shape[0]
    L, d = ca.SX.eye(n), [ca.SX(0)] * n
    for j in range(n):
        scaled = [L[j, k] * d[k] for k in range(j)]
        d[j] = M[j, j] - sum((L[j, k] * scaled[k] for k in range(j)), ca.SX(0))
        for i in range(j + 1, n):
            L[i, j] = (M[i, j] - sum((L[i, k] * scaled[k] for k in range(j)), ca.SX(0))) / d[j]
    return L, d


def ldl_solve(L: ca.SX, d: list[ca.SX], r: ca.SX) -> ca.SX:
    """Solve L diag(d) L^T a = r for every column of r (n, m)."""
    n = len(d)
    a = [r[i, :] for i in range(n)]
    for i in range(n):
        for k in range(i):
            a[i] = a[i] - L[i, k] * a[k]
    for i in reversed(range(n)):
        a[i] = a[i] / d[i]
        for k in range(i + 1, n):
            a[i] = a[i] - L[k, i] * a[k]
    return ca.vertcat(*a)


@dataclass(frozen=True, kw_only=True)
class LagrangianPlant(Plant):
    """M(q) dv/dt = Q + dT/dq - (d^2T/dv dq) v - dV/dq - dD/dv.

    Along a nominal the equations M a = r are linearised as they stand, at the nominal's own accelerations a = dv/dt:

        d(dv)/dt = M^-1 [(dr/dx - d(M a)/dx) dx + (dr/du) du + (dr/dw) dw] + M^-1 (r - M a)

    A rigid nominal lacks strain: the accelerations M^-1 r that an elastic plant would have on it are large however
    stiff it is, and the Jacobian of M^-1 r multiplies the change of M by those. Where the nominal is a motion of the
    plant the two agree.
    """

    @property
    @abstractmethod
    def coordinates(self) -> tuple[Signal, ...]: ...

    @abstractmethod
    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """T [J], a scalar expression quadratic in v."""

    @abstractmethod
    def potential_energy(self, q: ca.SX) -> ca.SX:
        """V [J], strain and gravity."""

    @abstractmethod
    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Rayleigh function [W]: half the power lost."""

    @abstractmethod
    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        """Q (n,): generalised forces of the inputs and disturbances."""

    @property
    def driven(self) -> dict[int, int]:
        """Coordinates whose acceleration is an input: {coordinate index: input index}."""
        return {}

    @property
    def states(self) -> tuple[Signal, ...]:
        rates = tuple(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in self.coordinates)
        return self.coordinates + rates

    @cached_property
    def rates(self) -> dict[str, str]:
        known = tuple(s.name for s in self.states)
        n = len(known) // 2
        return dict(zip(known[:n], known[n:], strict=True))

    @property
    def prescribed(self) -> tuple[str, ...]:
        return tuple(self.coordinates[i].name for i in self.driven)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """An input that is a generalised force on one coordinate alone, by a constant factor, or its acceleration."""
        at, n = {k: i for i, k in self.driven.items()}, len(self.coordinates)
        t, x, u, w, _ = self.symbols
        forces = ca.jacobian(self.symbolic.generalized_force(t, x[:n], x[n:], u, w), u)
        for k in range(self.nu):
            on = [i for i in range(n) if not forces[i, k].is_zero()]
            if k not in at and len(on) == 1 and forces[on[0], k].is_constant():
                at[k] = on[0]
        pairs = list(self.rates.items())
        return tuple(Joint(s.name, *pairs[at[k]]) for k, s in enumerate(self.inputs) if k in at)

    def statics(self) -> ca.SX:
        return self._terms[1]

    @cached_property
    def _terms(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """(M, r, T, V) with M a = r, in this plant's symbols."""
        t, x, u, w, _ = self.symbols
        return self.symbolic.equations(t, x, u, w)

    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """(M, r, T, V): mass matrix (n, n) and right-hand side (n,) of M a = r, the energies [J]."""
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        T, V, D = self.kinetic_energy(q, v), self.potential_energy(q), self.dissipation(q, v)
        momentum = ca.gradient(T, v)
        M = ca.jacobian(momentum, v)
        Q = self.generalized_force(t, q, v, u, w)
        r = Q + ca.gradient(T - V, q) - ca.jtimes(momentum, q, v) - ca.gradient(D, v)
        return M, r, T, V

    def acceleration(self, M: ca.SX, r: ca.SX, u: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        """Accelerations (n,), driven ones taken from u, and the pivots of the part of M that is solved."""
        n, driven = M.shape[0], self.driven
        free = [i for i in range(n) if i not in driven]
        a = ca.SX.zeros(n)
        for i, k in driven.items():
            a[i] = u[k]
        if not free:
            return a, []
        L, d = ldl(M[free, free])
        given = r[free]
        if driven:
            given -= M[free, list(driven)] @ ca.vertcat(*[u[k] for k in driven.values()])
        a[free] = ldl_solve(L, d, given)
        return a, d

    def ode(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        M, r, _, _ = self.equations(t, x, u, w)
        n = len(self.coordinates)
        return ca.vertcat(x[n:], self.acceleration(M, r, u)[0])

    @cached_property
    def expressions(self) -> tuple[ca.SX, ca.SX]:
        t, x, u, w, _ = self.symbols
        return self._motion[0], self.symbolic.output(t, x, u, w)

    @cached_property
    def _motion(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, smallest pivot of the mass matrix): the pivot is positive where the matrix is definite."""
        M, r, _, _ = self._terms
        a, pivots = self.acceleration(M, r, self.symbols[2])
        rate = ca.vertcat(self.symbols[1][len(self.coordinates) :], a)
        return rate, ca.mmin(ca.vertcat(*pivots)) if pivots else ca.SX(1)

    @cached_property
    def _dynamics(self) -> NumericFunction:
        return function("dynamics", list(self.symbols), list(self._motion))

    @cached_property
    def _along(self) -> NumericFunction:
        from .residual_jacobians import along

        return along(self)

    def _jacobians_along(self, nominal: Trajectory, w: Array, p: Any) -> list[Array]:
        """At the nominal's own accelerations."""
        values, batch = self._arguments(nominal.x, nominal.u, w, p, nominal.t)
        return self._along(*values, nominal.derivative()[:, len(self.coordinates) :], batch=batch)

    @cached_property
    def _mass(self) -> NumericFunction:
        return function("mass", list(self.symbols), [self._terms[0]], matrices=True)

    @cached_property
    def _powers(self) -> tuple[ca.SX, ca.SX]:
        """(power put in by inputs, disturbances and driven coordinates, power lost) [W]."""
        t, x, u, w, _ = self.symbols
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        lost = ca.jtimes(self.symbolic.dissipation(q, v), v, v)
        put_in = ca.dot(self.symbolic.generalized_force(t, q, v, u, w), v)
        if self.driven:
            M, r, _, _ = self._terms
            reaction = M @ self._motion[0][n:] - r
            put_in += sum(reaction[i] * v[i] for i in self.driven)
        return put_in, lost

    def net_power(self) -> ca.SX:
        """dE/dt [W] as an expression: power put in less power lost."""
        put_in, lost = self._powers
        return put_in - lost

    @cached_property
    def _energies(self) -> NumericFunction:
        _, _, T, V = self._terms
        return function("energies", list(self.symbols), [T, V, *self._powers])

    def mass_matrix(self, x: Any, *, p: Any = None) -> Array:
        """M (n, n), or (B, n, n) for a batch of states."""
        values, batch = self._arguments(x, p=p)
        return self._mass(*values, batch=batch)[0]

    def kinetic(self, x: Any, *, p: Any = None) -> Any:
        """T [J]."""
        values, batch = self._arguments(x, p=p)
        return self._energies(*values, batch=batch)[0][..., 0]

    def potential(self, x: Any, *, p: Any = None) -> Any:
        """V [J]; zero where all coordinates are zero."""
        values, batch = self._arguments(x, p=p)
        return self._energies(*values, batch=batch)[1][..., 0]

    def energy(self, x: Any, *, p: Any = None) -> Any:
        """T + V [J], a scalar or (B,)."""
        values, batch = self._arguments(x, p=p)
        T, V, _, _ = self._energies(*values, batch=batch)
        return (T + V)[..., 0]

    def power(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> tuple[Any, Any]:
        """(power put in by inputs and disturbances, power lost) [W]: dE/dt is their difference."""
        values, batch = self._arguments(x, u, w, p, t)
        _, _, put_in, lost = self._energies(*values, batch=batch)
        return put_in[..., 0], lost[..., 0]

    def dynamics(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> Array:
        """dx/dt: (nx,) or (B, nx). Raises MassMatrixError where the mass matrix is not positive definite."""
        values, batch = self._arguments(x, u, w, p, t)
        rate, pivot = self._dynamics(*values, batch=batch)
        self.check_definite(values[1], pivot)
        return rate

    def check_definite(self, x: Array, pivot: Array) -> None:
        """Raise MassMatrixError at the first state of x whose smallest pivot is not positive."""
        if pivot.min() > 0:
            return
        pivots = pivot.reshape(-1)
        k = int(np.argmin(pivots > 0))
        raise self._lost_definiteness(np.atleast_2d(x)[k if x.ndim == 2 else 0], float(pivots[k]))

    def check_near_singular(self, x: Array, start: Array, p: Any) -> None:
        """Raise MassMatrixError where M at x (nx,) is nearly singular and was not at `start` (nx,)."""
        smallest = []
        for M in (self.mass_matrix(x, p=p), self.mass_matrix(start, p=p)):
            scale = np.sqrt(np.abs(np.diag(M)))
            if not 0 < scale.min() <= scale.max() < HUGE:
                return
            smallest.append(float(np.linalg.eigvalsh(M / scale / scale[:, None])[0]))
        if smallest[0] < NEARLY_SINGULAR * smallest[1]:
            values, _ = self._arguments(x, p=p)
            raise self._lost_definiteness(x, float(self._dynamics(*values)[1][0]))

    def _lost_definiteness(self, x: Array, pivot: float) -> MassMatrixError:
        outputs = dict(zip((s.name for s in self.outputs), self.measure(x)))
        bent = {name: outputs[name] for name in self.deflections}
        where = ", ".join(f"{name} = {value:.4g} m" for name, value in bent.items()) or f"x = {x}"
        return MassMatrixError(
            f"the mass matrix of {self.label} is not positive definite (pivot {pivot:.3g}) at {where}; "
            "use a fidelity whose mass matrix stays definite, or smaller deflections",
            x.copy(),
            pivot,
        )

    def natural_frequencies(
        self, x0: Any = None, *, locked: tuple[str, ...] = (), rigid: bool = False, p: Any = None
    ) -> Array:
        """Undamped natural frequencies [rad/s], ascending, about a rest x0 with the `locked` coordinates held.

        From M and the stiffness d(-r)/dq; negative stiffness gives a negative "frequency" -sqrt(|w^2|).
        Frequencies below 1e-6 of the largest are rigid-body modes and are left out unless `rigid`.
        """
        import scipy.linalg

        from pliant.plants.core.signals import index

        n = len(self.coordinates)
        x = np.zeros(self.nx) if x0 is None else np.asarray(x0, dtype=float)
        held = [index(self.coordinates, name, "coordinate") for name in locked] + list(self.driven)
        free = [i for i in range(n) if i not in held]
        values, _ = self._arguments(x, p=p)
        M = self.mass_matrix(x, p=p)[np.ix_(free, free)]
        K = self._stiffness(*values)[0][np.ix_(free, free)]
        squares = scipy.linalg.eigh((K + K.T) / 2, M, eigvals_only=True)
        found = np.sign(squares) * np.sqrt(np.abs(squares))
        return found if rigid else found[np.abs(found) > 1e-6 * np.abs(found).max(initial=0.0)]

    @cached_property
    def _stiffness(self) -> NumericFunction:
        n = len(self.coordinates)
        _, x, _, _, _ = self.symbols
        return function("stiffness", list(self.symbols), [ca.jacobian(-self._terms[1], x)[:, :n]], matrices=True)
