"""What a plant states: named signals, symbolic dynamics dx/dt = f(t, x, u, w; p), outputs y = h(t, x, u, w; p).

A plant is its parameters (a frozen dataclass). What is done with the statements is in `Plant`.
"""

from __future__ import annotations

import dataclasses
import numbers
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_names
from pliant.plants.core.casadi_functions import built_once
from pliant.plants.core.signals import Signal, owned, sealed
from pliant.plants.files.html_tables import PlantTable
from pliant.plants.native.batch_kernels import compiled

Array = np.ndarray
COMPILED, NATIVE = ("_dynamics", "_output", "_jacobians"), "_native"  # functions, and where their names are kept


@dataclass(frozen=True, kw_only=True)
class Declaration(PlantTable, ABC):
    """Signals, equations, parameters; `varied`: dotted names of parameters that are inputs p of every function."""

    varied: tuple[str, ...] = dataclasses.field(default=(), metadata={"gate": require_names})

    @property
    @abstractmethod
    def states(self) -> tuple[Signal, ...]:
        """Names and units of x (nx,)."""

    @property
    @abstractmethod
    def inputs(self) -> tuple[Signal, ...]:
        """Names and units of u (nu,)."""

    @property
    @abstractmethod
    def disturbances(self) -> tuple[Signal, ...]:
        """Names and units of w (nw,)."""

    @property
    @abstractmethod
    def outputs(self) -> tuple[Signal, ...]:
        """Names and units of y (ny,)."""

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

    def ladder(self) -> tuple[Self, ...]:
        """The fidelity variants of this plant, cheapest first, all of the same inputs and outputs. Default: itself."""
        return (self,)

    @property
    def coordinates_slice(self) -> slice:
        """Where the positions stand in x; their rates follow. None where a plant states no more than dx/dt."""
        return slice(0, 0)

    def check_state(self, x: Array) -> None:
        """Raise ValueError where x (..., nx) is no state of the plant, at the start of a motion or on a nominal."""

    def consistent(self, x: Array) -> Array:
        """x (..., nx) with what its states must satisfy restored; free coordinates satisfy nothing."""
        return x

    @property
    def rest_state(self) -> Array:
        """x (nx,) where none is given: all states zero, and what they must satisfy restored."""
        return self.consistent(np.zeros(self.nx))

    @property
    def parameters(self) -> tuple[Signal, ...]:
        """The parameters that are inputs p, in order; see `vary`."""
        return tuple(Signal(path, parameters.unit_of(self, path)) for path in self.varied)

    @cached_property
    def signals(self) -> dict[str, tuple[Signal, ...]]:
        """{kind: the plant's signals of it}, made once."""
        return {kind: getattr(self, kind) for kind in ("states", "inputs", "outputs", "disturbances")}

    @cached_property
    def nx(self) -> int:
        """How many states: x is (nx,)."""
        return len(self.states)

    @cached_property
    def nu(self) -> int:
        """How many inputs: u is (nu,)."""
        return len(self.inputs)

    @cached_property
    def nw(self) -> int:
        """How many disturbances: w is (nw,)."""
        return len(self.disturbances)

    @cached_property
    def ny(self) -> int:
        """How many outputs: y is (ny,)."""
        return len(self.outputs)

    @property
    def nominal_parameters(self) -> Array:
        """The plant's own values of the varied parameters, shape (np,)."""
        return np.array([parameters.get(self, path) for path in self.varied], dtype=float)

    @cached_property
    def quiet(self) -> tuple[Array, Array]:
        """(w, p) where none are given: no disturbance, the plant's own parameters."""
        w, p = np.zeros(self.nw), self.nominal_parameters
        for shared in (w, p):
            shared.setflags(write=False)
        return w, p

    def vary(self, *paths: str) -> Self:
        """A plant whose named parameters ("payload.mass") are inputs p of every function: no rebuild per value.

        ValueError for a name that is no number, or of which the plant must know the value when it is built.
        """
        paths = require_names(f"{type(self).__name__}.vary", paths)
        for path in paths:
            parameters.unit_of(self, path)
            value = parameters.get(self, path)
            if value is None:
                raise ValueError(f"parameter {path!r} of {type(self).__name__} is None and cannot be varied")
            if isinstance(value, bool) or not isinstance(value, numbers.Real):
                raise ValueError(f"parameter {path!r} = {value!r} must be one number; name one of them, as '{path}.0'")
        made = dataclasses.replace(self, varied=tuple(paths))
        made._take_symbols()
        return made

    def _take_symbols(self) -> None:
        """ValueError where one of the varied parameters cannot be a symbol."""
        for path in self.varied:
            try:
                parameters.put(dataclasses.replace(self, varied=()), path, ca.SX.sym("p"))
            except (TypeError, RuntimeError) as compared:  # CasADi's, of an expression that must be true or false
                raise ValueError(
                    f"parameter {path!r} of {type(self).__name__} cannot be varied: its value decides how the plant is "
                    "built"
                ) from compared

    @cached_property
    def nominal(self) -> Self:
        """This plant with numbers where a symbolic copy has expressions; shape functions are computed from it."""
        return self

    @built_once
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

    @built_once
    def expressions(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, y) in the symbols."""
        t, x, u, w, _ = self.symbols
        return self.symbolic.ode(t, x, u, w), self.symbolic.output(t, x, u, w)

    @built_once
    def _function(self) -> ca.Function:
        """Without a value p is not a number: zero would be a plant without mass."""
        options = {"default_in": [0.0, 0.0, 0.0, 0.0, float("nan") if self.varied else 0.0]}
        results = [ca.densify(e) for e in self.expressions]
        return ca.Function("plant", list(self.symbols), results, list("txuwp"), ["dx", "y"], options)

    def casadi(self) -> ca.Function:
        """A casadi.Function (t, x, u, w, p) -> (dx, y) for a user's own expressions and programs; takes SX, MX and DM.

        t [s] is a number, x (nx,), u (nu,), w (nw,), p (np,) columns in the order of `states`, `inputs`,
        `disturbances` and `parameters`; dx (nx,) is dx/dt, y (ny,) the outputs. It has all its derivatives. By name,
        t, u and w may be left out, and are zero; a parameter that is varied must be given, or all is NaN. Of a
        spacecraft x holds a unit quaternion: dx keeps its length, and y holds twice its vector part.

        >>> f = arm.casadi()
        >>> f(x=scene.initial[0], u=0.0)["dx"].shape
        (6, 1)
        """
        return self._function

    def compile(self) -> Self:
        """This plant with its dynamics, outputs and Jacobians on native kernels: same calls, same results to rounding.

        Compiled once per user and machine, then loaded from the cache; a copy that travels compiles where it arrives.
        """
        own: Any = self  # its functions are those of `Plant`
        fast: Self = compiled(own, COMPILED)
        fast.__dict__[NATIVE] = COMPILED
        return fast

    def _taken(self, name: str, built: Any) -> Any:
        """What a property that is built once gives this instance: a kernel of its own where it was compiled."""
        if name not in self.__dict__.get(NATIVE, ()):
            return built
        own: Any = dataclasses.replace(self)
        return compiled(own, (name,)).__dict__[name]

    def __getstate__(self) -> dict[str, Any]:
        kept = {NATIVE: self.__dict__[NATIVE]} if NATIVE in self.__dict__ else {}
        return {f.name: sealed(getattr(self, f.name)) for f in dataclasses.fields(self)} | kept

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(owned(state))
