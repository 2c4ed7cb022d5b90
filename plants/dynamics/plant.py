"""A plant: named signals, symbolic dynamics dx/dt = f(t, x, u, w; p) and outputs y = h(t, x, u, w; p).

A plant is its parameters (a frozen dataclass). A subclass states its signals and writes `ode` and `output` in CasADi
expressions; simulation, exact Jacobians, linear models and equilibria follow from those two.
"""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING, Any, Self

import casadi as ca
import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.signals import Signal

from .contract import PlantContract

if TYPE_CHECKING:
    import control

    from pliant.plants.core.trajectory import Trajectory
    from pliant.plants.integration.batch_stepper import Stepper
    from pliant.plants.integration.simulation import Input
    from pliant.plants.linear.lti import LinearModel
    from pliant.plants.linear.ltv import LTVModel

Array = np.ndarray


@dataclass(frozen=True, kw_only=True)
class Plant(PlantContract):
    """Base of all plants. `varied` holds the dotted names of parameters that are inputs p of every function."""

    varied: tuple[str, ...] = ()

    # --- what a plant states -------------------------------------------------------------------------------------
    @property
    @abstractmethod
    def states(self) -> tuple[Signal, ...]: ...

    @property
    @abstractmethod
    def inputs(self) -> tuple[Signal, ...]: ...

    @property
    @abstractmethod
    def disturbances(self) -> tuple[Signal, ...]: ...

    @property
    @abstractmethod
    def outputs(self) -> tuple[Signal, ...]: ...

    @property
    @abstractmethod
    def label(self) -> str:
        """The fidelity in a few words."""

    @abstractmethod
    def ode(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        """dx/dt (nx,) as an expression."""

    @abstractmethod
    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        """y (ny,) as an expression."""

    @abstractmethod
    def ladder(self) -> tuple[Self, ...]:
        """The fidelity variants of this plant, cheapest first."""

    # --- what follows --------------------------------------------------------------------------------------------
    @property
    def parameters(self) -> tuple[Signal, ...]:
        """The parameters that are inputs p, in order; see `vary`."""
        return tuple(Signal(path, parameters.unit_of(self, path)) for path in self.varied)

    @cached_property
    def nx(self) -> int:
        return len(self.states)

    @cached_property
    def nu(self) -> int:
        return len(self.inputs)

    @cached_property
    def nw(self) -> int:
        return len(self.disturbances)

    @cached_property
    def ny(self) -> int:
        return len(self.outputs)

    @property
    def nominal_parameters(self) -> Array:
        """The plant's own values of the varied parameters, shape (np,)."""
        return np.array([parameters.get(self, path) for path in self.varied], dtype=float)

    def vary(self, *paths: str) -> Self:
        """A plant whose named parameters ("payload.mass") are inputs p of every function: no rebuild per value."""
        for path in paths:
            parameters.unit_of(self, path)
            if parameters.get(self, path) is None:
                raise ValueError(f"parameter {path!r} of {type(self).__name__} is None and cannot be varied")
        if len(set(paths)) != len(paths):
            raise ValueError(f"vary{paths}: every parameter may be named once")
        return dataclasses.replace(self, varied=tuple(paths))

    @cached_property
    def nominal(self) -> Self:
        """This plant with numbers where a symbolic copy has expressions; shape functions are computed from it."""
        return self

    @cached_property
    def symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """The symbols (t, x, u, w, p)."""
        sizes = (1, self.nx, self.nu, self.nw, len(self.varied))
        return tuple(ca.SX.sym(name, size) for name, size in zip("txuwp", sizes))  # type: ignore[return-value]

    @cached_property
    def symbolic(self) -> Self:
        """A copy with the symbols p in place of the varied parameters."""
        copy = dataclasses.replace(self, varied=())
        for i, path in enumerate(self.varied):
            copy = parameters.put(copy, path, self.symbols[4][i])
        copy.__dict__["nominal"] = dataclasses.replace(self, varied=())
        return copy

    @cached_property
    def expressions(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, y) in the symbols."""
        t, x, u, w, _ = self.symbols
        return self.symbolic.ode(t, x, u, w), self.symbolic.output(t, x, u, w)

    @cached_property
    def _dynamics(self) -> NumericFunction:
        return function("dynamics", list(self.symbols), [self.expressions[0]])

    @cached_property
    def _output(self) -> NumericFunction:
        return function("output", list(self.symbols), [self.expressions[1]])

    @cached_property
    def _jacobians(self) -> NumericFunction:
        _, x, u, w, _ = self.symbols
        f, h = self.expressions
        blocks = [ca.jacobian(e, s) for e in (f, h) for s in (x, u, w)]
        return function("jacobians", list(self.symbols), blocks, matrices=True)

    @cached_property
    def _quiet(self) -> tuple[Array, Array]:
        """(w, p) where none are given."""
        return np.zeros(self.nw), self.nominal_parameters

    def _arguments(
        self, x: Any, u: Any = None, w: Any = None, p: Any = None, t: Any = 0.0
    ) -> tuple[tuple[Array, ...], int | None]:
        """Checked (t, x, u, w, p) and the batch size (None for one point)."""
        plain = w is None and p is None and type(t) is float and type(x) is type(u) is np.ndarray
        if plain and x.shape == (self.nx,) and u.shape == (self.nu,) and isfinite(x.sum() + u.sum()):
            return (t, x, u, *self._quiet), None
        default = (None, None, np.zeros(self.nu), np.zeros(self.nw), self.nominal_parameters)
        values = [np.asarray(t, dtype=float).reshape(-1, 1) if np.ndim(t) else np.asarray([t], dtype=float)]
        batch = len(values[0]) if np.ndim(t) else None
        sizes = (self.nx, self.nu, self.nw, len(self.varied))
        signals = (self.states, self.inputs, self.disturbances, self.parameters)
        for i, (name, value, size, named) in enumerate(zip("xuwp", (x, u, w, p), sizes, signals), start=1):
            array = np.asarray(default[i] if value is None else value, dtype=float)
            if array.ndim not in (1, 2) or array.shape[-1] != size:
                owner = f"{type(self).__name__}.{name}"
                raise ValueError(f"{owner} has shape {array.shape}, must be ({size},) or (B, {size})")
            if not np.isfinite(array).all():
                k = int(np.argwhere(~np.isfinite(array))[0][-1])
                bad = array[..., k][~np.isfinite(array[..., k])].flat[0]
                raise ValueError(f"{type(self).__name__}.{name}[{k}] ({named[k].name}) = {bad} must be finite")
            if array.ndim == 2:
                if batch not in (None, len(array)):
                    raise ValueError(f"{type(self).__name__}.{name} has {len(array)} rows, must have {batch}")
                batch = len(array)
            values.append(array)
        return tuple(values), batch

    def dynamics(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> Array:
        """dx/dt: (nx,) for one point; rows (B, nx) for a batch, in which any argument may be shared."""
        values, batch = self._arguments(x, u, w, p, t)
        return self._dynamics(*values, batch=batch)[0]

    def measure(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> Array:
        """Outputs y: (ny,) or (B, ny)."""
        values, batch = self._arguments(x, u, w, p, t)
        return self._output(*values, batch=batch)[0]

    def jacobians(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> list[Array]:
        """[A, B, E, C, D, F] by automatic differentiation: df/dx, df/du, df/dw, dh/dx, dh/du, dh/dw."""
        values, batch = self._arguments(x, u, w, p, t)
        return self._jacobians(*values, batch=batch)

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[Array, Array]:
        """A rest point (x0, u0) with the named states or inputs held: `equilibrium(theta1=-pi/2, theta2=0)`.

        Rates are held at zero, and so is every input unless as many states are held as there are inputs; then the
        inputs are solved for. `guess` starts the search. Raises EquilibriumError with the residual.
        """
        from .equilibrium import find

        return find(self, {**(fixed or {}), **named}, guess or {}, p)

    def linearize(self, x0: Any, u0: Any = None, *, w: Any = None, p: Any = None, t: float = 0.0) -> LinearModel:
        """The exact linear model about (x0, u0): A B E C D F by automatic differentiation, f0 the residual rate."""
        from pliant.plants.linear.lti import LinearModel

        (_, x, u, w, p), _ = self._arguments(x0, u0, w, p, t)
        if x.ndim != 1:
            raise ValueError(f"{type(self).__name__}.x has shape {x.shape}, must be ({self.nx},) to linearise")
        A, B, E, C, D, F = self.jacobians(x, u, w=w, p=p, t=t)
        return LinearModel(
            A,
            B,
            E,
            C,
            D,
            F,
            states=self.states,
            inputs=self.inputs,
            disturbances=self.disturbances,
            outputs=self.outputs,
            x0=x,
            u0=u,
            w0=w,
            y0=self.measure(x, u, w=w, p=p, t=t),
            f0=self.dynamics(x, u, w=w, p=p, t=t),
        )

    def feedback_model(self, x0: Any, u0: Any = None, *, p: Any = None) -> LinearModel:
        """The linear model about (x0, u0) in states that are the plant's signals by name, for designing feedback."""
        return self.linearize(x0, u0, p=p)

    def check_state(self, x: Array) -> None:
        """Raise ValueError where x (..., nx) is no state of the plant, at the start of a motion or on a nominal."""

    def consistent(self, x: Array) -> Array:
        """x (..., nx) with what its states must satisfy restored; free coordinates satisfy nothing."""
        return x

    def simulate(
        self,
        x0: Any,
        u: Input = None,
        t: Any = None,
        *,
        w: Any = None,
        p: Any = None,
        method: str = "dop853",
        step: float | None = None,
        rtol: float = 1e-10,
        atol: float = 1e-12,
        audit: bool = False,
        progress: Any = None,
    ) -> Trajectory:
        """The motion from x0 at the times t (nt,) [s].

        u: None (zero), (nu,) constant, (nt, nu) held over each interval, a callable u(t), or a controller with
        act(t, y). method: "dop853", "radau", "cvodes" (adaptive, to rtol and atol) or "rk4", "rk8", "midpoint",
        "rosenbrock" (fixed `step` [s]). audit=True integrates the work done too and puts the energy balance into stats.
        Raises StabilityLimitError when a fixed step is past the method's limit, IntegrationError where it must stop.
        """
        from pliant.plants.integration.simulation import simulate

        return simulate(
            self,
            x0,
            u,
            t,
            w=w,
            p=p,
            method=method,
            step=step,
            rtol=rtol,
            atol=atol,
            audit=audit,
            progress=progress,
        )

    def stepper(
        self,
        dt: float,
        *,
        method: str = "rk4",
        batch: int = 1,
        dtype: Any = np.float64,
        threads: int | None = None,
        substeps: int = 1,
    ) -> Stepper:
        """A batch step `step(x, u, p) -> x` of dt [s] in `substeps` fixed steps, the input held, on a native kernel.

        x, u, p: (batch, n), or (n,) for all lanes; a Fortran-ordered (batch, nx) array is used without a copy.
        threads None: all processors for large batches. Runs on CasADi's virtual machine where nothing compiles.
        """
        from pliant.plants.integration.batch_stepper import Stepper
        from pliant.plants.native.batch_kernels import as_dtype

        return Stepper(self, dt, method, batch, as_dtype(dtype), threads, substeps)

    def compile(self) -> Self:
        """This plant with its dynamics, outputs and Jacobians on native kernels: same calls, same results to rounding.

        Compiled once per user and machine, then loaded from the cache.
        """
        from pliant.plants.native.batch_kernels import NativeFunction, random_points

        fast = dataclasses.replace(self)
        points = random_points(self, np.random.default_rng(0))
        for name in ("_dynamics", "_output", "_jacobians"):
            slow = getattr(self, name)
            fast.__dict__[name] = NativeFunction(slow.function, points, matrices=slow.matrices)
        return fast

    def linearize_along(self, nominal: Trajectory, *, p: Any = None) -> LTVModel:
        """The linear time-varying model about any nominal motion given in this plant's states and inputs.

        The nominal need not satisfy the equations: its residual f(x, u) - dx/dt is kept as the affine term c(t).
        Mechanical plants are then linearised at the nominal's accelerations, not at those they would have there; see
        `LagrangianPlant`. Outputs are linearised at (x, u). `p`: (np,), or (nt, np) where parameters vary on the way.
        """
        from pliant.plants.linear.ltv import LTVModel

        for name, have, want in (
            ("states", nominal.states, self.states),
            ("inputs", nominal.inputs, self.inputs),
        ):
            if tuple(s.name for s in have) != tuple(s.name for s in want):
                raise ValueError(
                    f"nominal.{name} = {tuple(s.name for s in have)} must be {tuple(s.name for s in want)}"
                )
        w = nominal.w if nominal.w is not None else np.zeros((len(nominal.t), self.nw))
        A, B, E, C, D, F = self._jacobians_along(nominal, w, p)
        rate = self.dynamics(nominal.x, nominal.u, w=w, p=p, t=nominal.t)
        return LTVModel(
            nominal.t,
            A,
            B,
            E,
            C,
            D,
            F,
            c=rate - nominal.derivative(),
            x=nominal.x,
            u=nominal.u,
            w=w,
            y=self.measure(nominal.x, nominal.u, w=w, p=p, t=nominal.t),
            states=self.states,
            inputs=self.inputs,
            disturbances=self.disturbances,
            outputs=self.outputs,
        )

    def _jacobians_along(self, nominal: Trajectory, w: Array, p: Any) -> list[Array]:
        """[A, B, E, C, D, F] (nt, ..) at the nodes of a nominal that need not satisfy the equations."""
        return self.jacobians(nominal.x, nominal.u, w=w, p=p, t=nominal.t)

    def to_control(self) -> control.NonlinearIOSystem:
        """A python-control NonlinearIOSystem whose `linearize` is this plant's exact one."""
        from .python_control import to_control

        return to_control(self)

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
