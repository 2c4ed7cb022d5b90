"""Plants whose equations of motion are M a = r: their linearisation at accelerations, their power, and how they end."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, built_once, function
from pliant.plants.core.errors import MassMatrixError
from pliant.plants.core.signals import Signal
from pliant.plants.core.trajectory import Trajectory

from . import arguments
from .declaration import Array
from .linear_models import check_signals
from .plant import Plant
from .residual_jacobians import Differentiated, ForceBalance, ResidualJacobians

NEARLY_SINGULAR = 1e-3  # of the smallest eigenvalue of the scaled mass matrix at the start of a motion
HUGE = 1e6  # root of an inertia that only a diverged state has


@dataclass(frozen=True, kw_only=True)
class MechanicalPlant(Plant):
    """M(q) a = r(t, x, u, w).

    Along a nominal the equations M a = r are linearised as they stand, at the nominal's own accelerations a = dv/dt:

        d(dv)/dt = M^-1 [(dr/dx - d(M a)/dx) dx + (dr/du) du + (dr/dw) dw] + M^-1 (r - M a)

    A rigid nominal lacks strain: the accelerations M^-1 r that an elastic plant would have on it are large however
    stiff it is, and the Jacobian of M^-1 r multiplies the change of M by those. Where the nominal is a motion of the
    plant the two agree.
    """

    @property
    @abstractmethod
    def coordinates(self) -> tuple[Signal, ...]:
        """Names and units of q (nq,)."""

    @property
    @abstractmethod
    def _motion(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, smallest pivot of the mass matrix): the pivot is positive where the matrix is definite."""

    @property
    @abstractmethod
    def _powers(self) -> tuple[ca.SX, ca.SX]:
        """(power put in, power lost) [W] as expressions."""

    @abstractmethod
    def _differentiated(self) -> Differentiated:
        """The equations M a = r at accelerations held."""

    @abstractmethod
    def _accelerations(self, nominal: Trajectory, p: Any) -> Array:
        """The accelerations a (nt, m) with which a nominal moves."""

    @abstractmethod
    def mass_matrix(self, x: Any, *, p: Any = None) -> Array:
        """M (m, m), or (B, m, m) for a batch of states."""

    @abstractmethod
    def energy(self, x: Any, *, p: Any = None) -> Any:
        """Kinetic and potential energy [J], a scalar or (B,)."""

    @property
    def coordinates_slice(self) -> slice:
        return slice(0, len(self.coordinates))

    def coordinate_rates(self, x: ca.SX) -> ca.SX:
        """dq/dt (n,) as an expression: what follows the coordinates in x, but of quaternions."""
        return x[len(self.coordinates) :]

    @built_once
    def expressions(self) -> tuple[ca.SX, ca.SX]:
        """Symbols of dx (nx,) and of y (ny,)."""
        t, x, u, w, _ = self.symbols
        return self._motion[0], self.symbolic.output(t, x, u, w)

    @built_once
    def _dynamics(self) -> NumericFunction:
        return function("dynamics", list(self.symbols), list(self._motion))

    def _sound_rate(self, x: Array, results: list[Array]) -> Array:
        """dx/dt: (nx,) or (B, nx). Raises MassMatrixError where the mass matrix is not positive definite."""
        rate, pivot = results
        self.check_definite(x, pivot)
        return rate

    def check_definite(self, x: Array, pivot: Array) -> None:
        """Raise MassMatrixError at the first state of x whose smallest pivot is not positive."""
        if pivot.min() > 0:
            return
        pivots = pivot.reshape(-1)
        k = int(np.argmin(pivots > 0))
        raise self._lost_definiteness(np.atleast_2d(x)[k if x.ndim == 2 else 0], float(pivots[k]))

    def _lost_definiteness(self, x: Array, pivot: float) -> MassMatrixError:
        return MassMatrixError(
            f"the mass matrix of {self.label} is not positive definite (pivot {pivot:.3g}){self._lost_at(x)}",
            x.copy(),
            pivot,
        )

    def _lost_at(self, x: Array) -> str:
        """Where and why the mass matrix has lost definiteness, and a remedy."""
        return f" at x = {x}"

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

    def explain_stop(self, passed: Array, last: Array, w: Any, p: Any) -> None:
        """Raise MassMatrixError where the mass matrix has lost definiteness, or nearly.

        passed (k, nx), last (nx,), w (nw,).
        """
        self.dynamics(passed, w=w, p=p)
        if np.isfinite(last).all():
            self.check_near_singular(last, passed[0], p)

    @cached_property
    def _linear(self) -> ResidualJacobians:
        t, x, u, w, _ = self.symbols
        return ResidualJacobians(self, lambda: self.symbolic.output(t, x, u, w), self._differentiated())

    @built_once
    def _jacobians(self) -> NumericFunction:
        return self._linear.solved

    def slopes(self) -> ca.SX:
        return self._linear.slopes()

    def _jacobians_along(self, nominal: Trajectory, w: Array, p: Any) -> list[Array]:
        """At the nominal's own accelerations."""
        values, batch = self._arguments(nominal.x, nominal.u, w, p, nominal.t)
        return self._linear.along(*values, self._accelerations(nominal, p), batch=batch)

    def _state_jacobians(self, x: Array, u: Array, p: Any) -> list[Array]:
        values, batch = self._arguments(x, u, p=p)
        return self._linear.states(*values, batch=batch)

    def state_jacobians_along(self, nominal: Trajectory, *, p: Any = None) -> Array:
        check_signals(self, nominal)
        values, batch = self._arguments(nominal.x, nominal.u, nominal.w, p, nominal.t)
        return self._linear.states_along(*values, self._accelerations(nominal, p), batch=batch)[0]

    def net_power(self) -> ca.SX:
        """dE/dt [W] as an expression: power put in less power lost."""
        put_in, lost = self._powers
        return put_in - lost

    @built_once
    def _power(self) -> NumericFunction:
        return function("power", list(self.symbols), list(self._powers))

    def power(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> tuple[Any, Any]:
        """(power put in by inputs and disturbances, power lost) [W]: dE/dt is their difference."""
        values, batch = self._arguments(x, u, w, p, t)
        put_in, lost = self._power(*values, batch=batch)
        arguments.told(self, "power", [put_in, lost], values[1])
        return put_in[..., 0], lost[..., 0]


@dataclass(frozen=True, kw_only=True)
class BalancedPlant(MechanicalPlant):
    """A mechanical plant x = [q; v] whose forces are also known at accelerations that are given: see `ForceBalance`.

    Where quaternions are among q there are fewer speeds v than coordinates, n of them; momenta of wheels count as
    speeds.
    """

    @abstractmethod
    def balance(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        """r - M a (n,) at accelerations a (n,)."""

    @property
    def driven(self) -> dict[int, int]:
        """Speeds whose rate is an input: {index among the speeds: input index}."""
        return {}

    @property
    def speed_count(self) -> int:
        """How many speeds v there are, and accelerations."""
        return self.nx - len(self.coordinates)

    @property
    def _written_out(self) -> bool:
        """Whether equations are written out in fewer operations than the energies give."""
        return False

    def _written_mass(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX | None:
        """M (n, n) where it is written out; None: it is had from `balance`."""
        return None

    def output_at(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        """y (ny,) at accelerations a (n,), where outputs tell these. Default: `output`, whose accelerations are its
        own.
        """
        return self.output(t, x, u, w)

    @built_once
    def force_balance(self) -> ForceBalance:
        """Of the speeds that are not driven; the others' accelerations are inputs."""
        t, x, u, w, _ = self.symbols
        n, driven = self.speed_count, self.driven
        free = [i for i in range(n) if i not in driven]
        a, moving = ca.SX.sym("a", len(free)), ca.SX(n, 1)
        moving[free] = a
        for i, k in driven.items():
            moving[i] = u[k]
        lacking = self.symbolic.balance(t, x, u, w, moving)[free]
        M = self.symbolic._written_mass(t, x, u, w)
        return ForceBalance(self, lacking, a, driven, self.coordinate_rates(x), None if M is None else M[free, free])

    def measure_at(self, t: Array, x: Array, u: Array, a: Array) -> Array:
        """y (B, ny) at rows of t (B,) [s], states (B, nx), inputs (B, nu) and accelerations (B, nv); see `output_at`.

        Example
        -------
        >>> rows = np.zeros((2, arm.nx))
        >>> arm.measure_at(np.zeros(2), rows, np.zeros((2, arm.nu)), np.zeros((2, arm.nx // 2))).shape == (2, arm.ny)
        True
        """
        w, p = self.quiet
        return self._output_at[0](t[:, None], x, u, w, p, a, batch=len(x))[0]

    @property
    def feels_accelerations(self) -> list[bool]:
        """Which outputs depend on accelerations."""
        return self._output_at[1]

    @built_once
    def _output_at(self) -> tuple[NumericFunction, list[bool]]:
        """(t, x, u, w, p, a) -> y, and which of y depend on a."""
        t, x, u, w, p = self.symbols
        a = ca.SX.sym("a", self.speed_count)
        y = ca.SX(self.symbolic.output_at(t, x, u, w, a))
        return function("output_at", [t, x, u, w, p, a], [y]), ca.which_depends(y, a, 1, True)

    def state_jacobians_along(self, nominal: Trajectory, *, p: Any = None) -> Array:
        check_signals(self, nominal)
        t, x, u, w, p = self._arguments(nominal.x, nominal.u, nominal.w, p, nominal.t)[0]
        a = nominal.derivative()[:, self.nx - self.speed_count :]
        return self.force_balance.state_jacobians(t[:, 0], x, u, a, w=w, p=p)
