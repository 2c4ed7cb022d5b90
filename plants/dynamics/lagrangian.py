"""Equations of motion from energies: d/dt(dT/dv) - dT/dq + dV/dq + dD/dv = Q, q the coordinates, v = dq/dt.

States   x = [q; v]
A coordinate may be driven: its acceleration is then an input and its force a reaction.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_names, shown
from pliant.plants.core.casadi_functions import NumericFunction, built_once, function, last_call
from pliant.plants.core.signals import Joint, Signal, index
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.linear.second_order import natural_squares

from . import arguments
from .declaration import Array
from .equilibrium import ForcesAtRest, RestConditions, forces_at_rest
from .mechanical import BalancedPlant
from .residual_jacobians import Differentiated, from_energies
from .symbolic_ldl import ldl, ldl_solve


@dataclass(frozen=True, kw_only=True)
class LagrangianPlant(BalancedPlant):
    """M(q) dv/dt = Q + dT/dq - (d^2T/dv dq) v - dV/dq - dD/dv."""

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
    def states(self) -> tuple[Signal, ...]:
        rates = tuple(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in self.coordinates)
        return self.coordinates + rates

    @cached_property
    def rates(self) -> dict[str, str]:
        """{name of a coordinate: name of its rate}."""
        known, n = tuple(s.name for s in self.states), len(self.coordinates)
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

    @built_once
    def _terms(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """(M, r, T, V) with M a = r, in this plant's symbols."""
        t, x, u, w, _ = self.symbols
        return self.symbolic.equations(t, x, u, w)

    @last_call
    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """(M, r, T, V): mass matrix (n, n) and right-hand side (n,) of M a = r, the energies [J]."""
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        T, V, D = self.kinetic_energy(q, v), self.potential_energy(q), self.dissipation(q, v)
        momentum = ca.gradient(T, v)
        M = ca.jacobian(momentum, v)
        r = self.generalized_force(t, q, v, u, w) + ca.gradient(T - V, q) - ca.gradient(D, v)
        return M, r - ca.jtimes(momentum, q, v), T, V

    def balance(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        """r - M a (n,) at accelerations a (n,); from the energies M is never written out."""
        if not self._written_out:
            return from_energies(self, t, x, u, w, a)
        M, r, _, _ = self.equations(t, x, u, w)
        return r - M @ a

    def _written_mass(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX | None:
        return self.equations(t, x, u, w)[0] if self._written_out else None

    def elimination(self, n: int) -> Sequence[int]:
        """Rows of M (n, n) in the order in which they are eliminated; of a sparse M those with few entries first."""
        return range(n)

    def acceleration(self, M: ca.SX, r: ca.SX, u: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        """Accelerations (n,), driven ones taken from u, and the pivots of the part of M that is solved."""
        n, driven = M.shape[0], self.driven
        free = [i for i in self.elimination(n) if i not in driven]
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
        return ca.vertcat(self.coordinate_rates(x), self.solved(t, x, u, w)[0])

    @last_call
    def solved(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        """Accelerations (n,), and pivots of the mass matrix in the coordinates that it is solved in."""
        return self.acceleration(*self.equations(t, x, u, w)[:2], u)

    @built_once
    def _motion(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, smallest pivot of the mass matrix): the pivot is positive where the matrix is definite."""
        t, x, u, w, _ = self.symbols
        a, pivots = self.symbolic.solved(t, x, u, w)
        return ca.vertcat(self.coordinate_rates(x), a), ca.mmin(ca.vertcat(*pivots)) if pivots else ca.SX(1)

    def _differentiated(self) -> Differentiated:
        return _differentiated(self)

    def _accelerations(self, nominal: Trajectory, p: Any) -> Array:
        return nominal.derivative()[:, len(self.coordinates) :]

    _forces_at_rest = built_once(forces_at_rest)

    def rest_conditions(self, p: Any = None) -> RestConditions:
        return ForcesAtRest(self, p)

    def _lost_at(self, x: Array) -> str:
        values, _ = self._arguments(x)
        outputs = dict(zip((s.name for s in self.outputs), self._output(*values)[0]))
        bent = {name: outputs[name] for name in self.deflections}
        where = ", ".join(f"{name} = {value:.4g} m" for name, value in bent.items()) or f"x = {x}"
        return f" at {where}; use a fidelity whose mass matrix stays definite, or smaller deflections"

    @built_once
    def _mass(self) -> NumericFunction:
        return function("mass", list(self.symbols), [self._terms[0]], matrices=True)

    @built_once
    def _powers(self) -> tuple[ca.SX, ca.SX]:
        """(power put in by inputs, disturbances and driven coordinates, power lost) [W]."""
        t, x, u, w, _ = self.symbols
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        put_in = ca.dot(self.symbolic.generalized_force(t, q, v, u, w), v)
        if self.driven:
            reaction = self._terms[0] @ self._motion[0][n:] - self._terms[1]
            put_in += sum(reaction[i] * v[i] for i in self.driven)
        return put_in, ca.jtimes(self.symbolic.dissipation(q, v), v, v)

    @built_once
    def _energies(self) -> NumericFunction:
        _, _, T, V = self._terms
        return function("energies", list(self.symbols), [T, V])

    def mass_matrix(self, x: Any, *, p: Any = None) -> Array:
        """M (n, n), or (B, n, n) for a batch of states."""
        values, batch = self._arguments(x, p=p)
        return arguments.told(self, "mass_matrix", self._mass(*values, batch=batch), values[1])[0]

    def kinetic(self, x: Any, *, p: Any = None) -> Any:
        """T [J]."""
        return self._energy(x, p, "kinetic")[0]

    def potential(self, x: Any, *, p: Any = None) -> Any:
        """V [J]; zero where all coordinates are zero."""
        return self._energy(x, p, "potential")[1]

    def energy(self, x: Any, *, p: Any = None) -> Any:
        """T + V [J], a scalar or (B,)."""
        return sum(self._energy(x, p, "energy"))

    def _energy(self, x: Any, p: Any, name: str) -> list[Any]:
        """[T, V] [J]."""
        values, batch = self._arguments(x, p=p)
        return arguments.told(self, name, [e[..., 0] for e in self._energies(*values, batch=batch)], values[1])

    def natural_frequencies(
        self, x0: Any = None, *, locked: tuple[str, ...] = (), rigid: bool = False, p: Any = None
    ) -> Array:
        """Undamped natural frequencies [rad/s], ascending, about a rest x0; `locked` coordinates are held.

        From M and the stiffness d(-r)/dq; negative stiffness gives a negative "frequency" -sqrt(|w^2|).
        Below 1e-6 of the largest they are rigid-body modes, left out unless `rigid`. ValueError: not finite at x0.
        """
        x = self.rest_state if x0 is None else arguments.one_state(self, x0)
        rigid, locked = require_flag("rigid", rigid), require_names("natural_frequencies.locked", locked)
        known, moved = tuple(s for s in self.coordinates if s.name in self.rates), self.states[len(self.coordinates) :]
        held = [self.rates[known[index(known, name, "coordinate")].name] for name in locked]
        free = [i for i, s in enumerate(moved) if s.name not in held and i not in self.driven]
        M, K = self.mass_matrix(x, p=p), self._stiffness(*self._arguments(x, p=p)[0])[0]
        M, K = M[np.ix_(free, free)], K[np.ix_(free, free)]
        if not (np.isfinite(K).all() and np.isfinite(M).all()):
            raise ValueError(f"natural_frequencies.x0 = {shown(x0)}: the equations linearised there are not finite")
        squares = natural_squares(K, M)
        found = np.sign(squares) * np.sqrt(np.abs(squares))
        return found if rigid else found[np.abs(found) > 1e-6 * np.abs(found).max(initial=0.0)]

    @built_once
    def _stiffness(self) -> NumericFunction:
        q = self.symbols[1][: len(self.coordinates)]
        return function("stiffness", list(self.symbols), [ca.jacobian(-self._terms[1], q)], matrices=True)


def _differentiated(plant: LagrangianPlant) -> Differentiated:
    """Driven accelerations are the inputs."""
    _, x, u, w, _ = plant.symbols
    M, r, _, _ = plant._terms
    n, m, nx = len(plant.coordinates), M.shape[0], plant.nx
    a, z = ca.SX.sym("a", m), ca.vertcat(x, u, w)
    moving, change = ca.SX(a), ca.SX(m, z.shape[0])
    for i, k in plant.driven.items():
        moving[i], change[i, nx + k] = u[k], 1
    free = [i for i in plant.elimination(m) if i not in plant.driven]
    if free:
        lacking = (r - M @ moving)[free]
        change[free, :] = ldl_solve(*ldl(M[free, free]), ca.jacobian(lacking, z))
    return Differentiated(a, ca.vertcat(plant.coordinate_rates(x), a), change, plant._motion[0][n:])
