"""What integrators and kernels ask of a plant, so that they need not know the class `Plant`, which calls them."""

from __future__ import annotations

from typing import Any, Protocol

import casadi as ca
import numpy as np

from .casadi_functions import NumericFunction
from .signals import Signal

Arguments = tuple[tuple[Any, ...], int | None]  # (t, x, u, w, p) checked, and the batch size


class PlantLike(Protocol):
    """dx/dt = f(t, x, u, w; p), y = h(t, x, u, w; p), as expressions and as functions of arrays.

    Hashable: kernels and step maps are kept by plant.
    """

    def __hash__(self) -> int: ...

    @property
    def states(self) -> tuple[Signal, ...]: ...

    @property
    def inputs(self) -> tuple[Signal, ...]: ...

    @property
    def disturbances(self) -> tuple[Signal, ...]: ...

    @property
    def outputs(self) -> tuple[Signal, ...]: ...

    @property
    def signals(self) -> dict[str, tuple[Signal, ...]]: ...

    @property
    def label(self) -> str: ...

    @property
    def small_states(self) -> tuple[str, ...]: ...

    @property
    def attitude_states(self) -> tuple[str, ...]: ...

    @property
    def nx(self) -> int: ...

    @property
    def nu(self) -> int: ...

    @property
    def nw(self) -> int: ...

    @property
    def rest_state(self) -> np.ndarray: ...

    @property
    def quiet(self) -> tuple[np.ndarray, np.ndarray]: ...

    @property
    def varied(self) -> tuple[str, ...]: ...

    @property
    def nominal_parameters(self) -> np.ndarray: ...

    @property
    def symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]: ...

    @property
    def expressions(self) -> tuple[ca.SX, ca.SX]: ...

    @property
    def _dynamics(self) -> NumericFunction: ...

    @property
    def _output(self) -> NumericFunction: ...

    @property
    def _jacobians(self) -> NumericFunction: ...

    @property
    def validity(self) -> tuple[Any, ...]: ...

    @property
    def _measured_ranges(self) -> bool: ...

    @property
    def _reached(self) -> NumericFunction: ...

    def _arguments(self, x: Any, u: Any = None, w: Any = None, p: Any = None, t: Any = 0.0) -> Arguments: ...

    def dynamics(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> np.ndarray: ...

    def measure(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> np.ndarray: ...

    def jacobians(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> list[np.ndarray]: ...

    def _told_rates(self, values: tuple[Any, ...], results: list[np.ndarray]) -> np.ndarray: ...

    def slopes(self) -> ca.SX: ...

    def check_state(self, x: np.ndarray) -> None: ...

    def explain_stop(self, passed: np.ndarray, last: np.ndarray, w: Any, p: Any) -> None: ...
