"""The linear time-varying model of a plant about a nominal motion x(t), u(t), w(t).

d(dx)/dt = A(t) dx + B(t) du + E(t) dw + c(t),   dy = C(t) dx + D(t) du + F(t) dw

c = f(x, u, w) - dx/dt is what the nominal lacks of being a motion of the plant; it is zero where the plant
made it.

Between the nodes A, B, E, c are cubic splines. Each interval h is one step of the fourth-order Magnus method
exp(h/2 (N1 + N2) - sqrt(3)/12 h^2 (N1 N2 - N2 N1)), N = [[A, B, c], [0, 0, 0]] at two Gauss points
(Iserles and Norsett 1999). Where A, B or c jump, as with a held nominal input that enters them, splines do
not follow and the order falls to one: put nodes closer there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_count, require_finite
from pliant.plants.core.signals import GAUSS, InputLike, Signal, read_only, read_only_times, sample
from pliant.plants.splines.cubic_spline import CubicSpline

from .even_units import even_expm
from .lti import LinearModel
from .magnus import exponent
from .model_signals import ModelSignals
from .second_order import SecondOrderModel, from_ltv


class DiscreteLTV(NamedTuple):
    """dx[k+1] = A[k] dx[k] + B[k] du[k] + E[k] dw[k] + c[k], dy[k] = C[k] dx[k] + D[k] du[k] + F[k] dw[k]."""

    A: np.ndarray  # (nt-1, nx, nx)
    B: np.ndarray  # (nt-1, nx, nu)
    E: np.ndarray  # (nt-1, nx, nw)
    c: np.ndarray  # (nt-1, nx)
    C: np.ndarray  # (nt, ny, nx)
    D: np.ndarray  # (nt, ny, nu)
    F: np.ndarray  # (nt, ny, nw)


@dataclass(frozen=True, eq=False)
class LTVModel(ModelSignals):
    """Matrices at the nodes t of a nominal motion; the arrays are write-protected copies."""

    t: np.ndarray = field(repr=False)  # (nt,) [s], strictly increasing
    A: np.ndarray = field(repr=False)  # (nt, nx, nx)
    B: np.ndarray = field(repr=False)  # (nt, nx, nu)
    E: np.ndarray = field(repr=False)  # (nt, nx, nw)
    C: np.ndarray = field(repr=False)  # (nt, ny, nx)
    D: np.ndarray = field(repr=False)  # (nt, ny, nu)
    F: np.ndarray = field(repr=False)  # (nt, ny, nw)
    c: np.ndarray = field(repr=False)  # (nt, nx) residual of the nominal
    x: np.ndarray = field(repr=False)  # (nt, nx) nominal
    u: np.ndarray = field(repr=False)  # (nt, nu)
    y: np.ndarray = field(repr=False)  # (nt, ny)
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    w: np.ndarray | None = field(default=None, repr=False)  # (nt, nw), zero where None
    between: Callable[[LTVModel], LTVModel | None] | None = field(default=None, repr=False)  # finds `finer`
    missed: Callable[..., tuple[np.ndarray, np.ndarray] | None] | None = field(
        default=None, repr=False
    )  # missed(model,
    # dx, du, dw): of dx/dt and of y at deviations, what the plant that the model was made from has beyond it

    def __post_init__(self) -> None:
        n, m, k, p = (len(s) for s in (self.states, self.inputs, self.disturbances, self.outputs))
        object.__setattr__(self, "t", read_only_times("LTVModel.t", self.t))
        shapes: dict[str, tuple[int, ...]] = {"c": (n,), "x": (n,), "u": (m,), "y": (p,), "w": (k,)}
        shapes |= self._matrix_shapes()
        for name, shape in shapes.items():
            given = np.zeros((len(self.t), k)) if name == "w" and self.w is None else getattr(self, name)
            object.__setattr__(self, name, read_only(f"LTVModel.{name}", given, (len(self.t), *shape)))
        self._check_signals()

    @cached_property
    def finer(self) -> LTVModel | None:
        """The same model with nodes between these, where these cannot show what A does; None where they can, or where
        nothing is known between them. Found when it is first asked for: stability is judged on it.
        """
        found = self.between(self) if self.between is not None else None
        if found is None:
            return None
        at = np.isin(found.t, self.t)
        if found.A.shape[1:] != self.A.shape[1:] or at.sum() != len(self.t):
            return None
        size = np.abs(self.A).max(axis=0)
        balanced, (scale, _) = linalg.matrix_balance(size, permute=False, separate=True)
        rounding = 1e-12 * balanced.max() * scale[:, None] / scale
        changed = np.abs(found.A[at] - self.A).max(axis=0) > 1e-9 * size + rounding
        return None if changed.any() else found  # A is no longer what it was made from

    def at(self, k: int) -> LinearModel:
        """The model frozen at node k; its f0 is c[k], the rate of a deviation from the moving nominal."""
        k = require_count("LTVModel.at", "k", k, -len(self.t), len(self.t) - 1)
        assert self.w is not None
        return LinearModel(
            *(self.A[k], self.B[k], self.E[k], self.C[k], self.D[k], self.F[k]),
            states=self.states,
            inputs=self.inputs,
            disturbances=self.disturbances,
            outputs=self.outputs,
            x0=self.x[k],
            u0=self.u[k],
            w0=self.w[k],
            y0=self.y[k],
            f0=self.c[k],
        )

    def transition(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Phi (nt-1, nx, nx), Gamma (nt-1, nx, nu), gamma (nt-1, nx): dx[k+1] = Phi dx + Gamma du + gamma."""
        return self._steps.A, self._steps.B, self._steps.c

    def discretize(self) -> DiscreteLTV:
        """The model from node to node with du and dw held in between."""
        return self._steps

    def simulate(self, dx0: Any, du: InputLike = None, dw: InputLike = None) -> tuple[np.ndarray, np.ndarray]:
        """Deviations (dx (nt, nx), dy (nt, ny)) from dx0 (nx,), the effect of c included.

        `du`, `dw`: None, a constant, (nt, n) held from each node to the next, or a function of time, which
        enters at the Gauss points so that the order stays four.
        """
        x0 = require_finite("simulate.dx0", dx0, (len(self.states),))
        (u, ug), (w, wg) = (
            sample(f"simulate.{name}", value, self.t, len(signals))
            for name, value, signals in (("du", du, self.inputs), ("dw", dw, self.disturbances))
        )
        if callable(du) or callable(dw):
            A, B, E, c = self._gauss
            c = c + np.einsum("kgij,kgj->kgi", B, ug) + np.einsum("kgij,kgj->kgi", E, wg)
            Phi, held = held_steps(A, c[..., None], np.diff(self.t))
            push = held[..., 0]
        else:
            Phi, B, E, c = self._steps[:4]
            push = c + np.einsum("kij,kj->ki", B, u[:-1]) + np.einsum("kij,kj->ki", E, w[:-1])
        dx = np.empty((len(self.t), len(x0)))
        dx[0] = x0
        for k in range(len(push)):
            dx[k + 1] = Phi[k] @ dx[k] + push[k]
        dy = np.einsum("kij,kj->ki", self.C, dx)
        dy += np.einsum("kij,kj->ki", self.D, u) + np.einsum("kij,kj->ki", self.F, w)
        return dx, dy

    def second_order(self, mass: Any = None) -> SecondOrderModel:
        """[A] y'' + [B] y' + [C] y = Q where the states are [y; dy/dt]; `mass` (nt, n, n) multiplies all."""
        return from_ltv(self, mass)

    @cached_property
    def _gauss(self) -> tuple[np.ndarray, ...]:
        """A, B, E, c at the Gauss points of each interval, (nt-1, 2, ...), by cubic splines."""
        at = (self.t[:-1, None] + np.diff(self.t)[:, None] * GAUSS).ravel()
        found = (splined(self.t, values, at) for values in (self.A, self.B, self.E, self.c))
        return tuple(a.reshape(len(self.t) - 1, 2, *a.shape[1:]) for a in found)

    @cached_property
    def _steps(self) -> DiscreteLTV:
        A, B, E, c = self._gauss
        m, k = B.shape[-1], E.shape[-1]
        Phi, held = held_steps(A, np.concatenate([B, E, c[..., None]], axis=-1), np.diff(self.t))
        parts = (Phi, held[..., :m], held[..., m : m + k], held[..., -1])
        for part in (Phi, held, *parts):
            part.setflags(write=False)
        return DiscreteLTV(*parts, self.C, self.D, self.F)


def held_steps(A: np.ndarray, G: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """e^Omega over each step h (m,) of dx/dt = A x + G v, v constant; A (m, 2, nx, nx), G (m, 2, nx, nv).

    Returns Phi (m, nx, nx) and the response to v, (m, nx, nv).
    """
    n = A.shape[-1]
    N = np.concatenate([A, G], axis=-1)
    Omega = np.zeros((len(A), N.shape[-1], N.shape[-1]))
    Omega[:, :n] = exponent(N, h)
    P = even_expm(Omega)
    return P[:, :n, :n], P[:, :n, n:]


def splined(t: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Cubic splines through values (nt, ..) at the times `at` (m,): (m, ..); what does not vary stays as it is."""

    flat = values.reshape(len(t), -1)
    vary = np.ptp(flat, axis=0) > 0
    found = np.repeat(flat[:1], len(at), axis=0)
    if vary.any():
        found[:, vary] = CubicSpline(t, flat[:, vary])(at)
    return found.reshape(len(at), *values.shape[1:])
