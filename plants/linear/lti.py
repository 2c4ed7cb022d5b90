"""The linear model of a plant about a point, continuous or sampled.

dx/dt = f0 + A dx + B du + E dw,   dy = C dx + D du + F dw,   dx = x - x0 and so on

Sampled (dt not None): dx[k+1] = f0 + A dx[k] + B du[k] + E dw[k]. The time-varying model is `LTVModel`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pliant.plants.core.argument_gates import LEAST, require_seconds, shown
from pliant.plants.core.parameters import require_finite
from pliant.plants.core.signals import InputLike, Signal, as_signals, read_only, read_only_times, sample
from pliant.plants.files.html_tables import ModelTable

from . import modal_analysis
from .even_units import even_expm
from .model_signals import ModelSignals, state_space

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, eq=False)
class LinearModel(ModelSignals, ModelTable):
    """A, B, E, C, D, F about (x0, u0, w0). Arrays are write-protected copies, sized as the signals."""

    A: np.ndarray = field(repr=False)  # (nx, nx)
    B: np.ndarray = field(repr=False)  # (nx, nu)
    E: np.ndarray = field(repr=False)  # (nx, nw)
    C: np.ndarray = field(repr=False)  # (ny, nx)
    D: np.ndarray = field(repr=False)  # (ny, nu)
    F: np.ndarray = field(repr=False)  # (ny, nw)
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    x0: np.ndarray = field(repr=False)  # (nx,)
    u0: np.ndarray = field(repr=False)  # (nu,)
    w0: np.ndarray = field(repr=False)  # (nw,)
    y0: np.ndarray = field(repr=False)  # (ny,)
    f0: np.ndarray = field(repr=False)  # (nx,) dx/dt at the point; of a sampled model its effect over one step
    dt: float | None = None  # [s] sampling time
    error_bound: float | None = None  # of a reduced model: largest error of its gain at any frequency

    def __post_init__(self) -> None:
        n, m, k, p = (len(s) for s in (self.states, self.inputs, self.disturbances, self.outputs))
        shapes: dict[str, tuple[int, ...]] = {"x0": (n,), "u0": (m,), "w0": (k,), "y0": (p,), "f0": (n,)}
        shapes |= self._matrix_shapes()
        for name, shape in shapes.items():
            object.__setattr__(self, name, read_only(f"LinearModel.{name}", getattr(self, name), shape))
        self._check_signals()
        if self.dt is not None:
            object.__setattr__(self, "dt", require_seconds("LinearModel.dt", self.dt, LEAST))

    @classmethod
    def from_matrices(
        cls,
        A: Any,
        B: Any,
        C: Any = None,
        D: Any = None,
        *,
        E: Any = None,
        F: Any = None,
        states: Sequence[str | Signal] | None = None,
        inputs: Sequence[str | Signal] | None = None,
        disturbances: Sequence[str | Signal] | None = None,
        outputs: Sequence[str | Signal] | None = None,
        dt: float | None = None,
    ) -> LinearModel:
        """A model about the origin. C = None gives the states as outputs; D, E, F = None are zero.

        Names default to x1.., u1.., w1.., y1...
        A (nx, nx), B (nx, nu), C (ny, nx), D (ny, nu), E (nx, nw), F (ny, nw); dt [s], None: continuous.
        """
        A = require_finite("LinearModel.A", A, (-1, -1))
        B = require_finite("LinearModel.B", B, (-1, -1))
        n, m = len(A), B.shape[1]
        E = np.zeros((n, 0)) if E is None else require_finite("LinearModel.E", E, (n, -1))
        named = as_signals("LinearModel.states", states, n, "x")
        if C is None:
            C, outputs = np.eye(n), outputs or named
        C = require_finite("LinearModel.C", C, (-1, n))
        p, k = len(C), E.shape[1]
        return cls(
            A,
            B,
            E,
            C,
            np.zeros((p, m)) if D is None else D,
            np.zeros((p, k)) if F is None else F,
            states=named,
            inputs=as_signals("LinearModel.inputs", inputs, m, "u"),
            disturbances=as_signals("LinearModel.disturbances", disturbances, k, "w"),
            outputs=as_signals("LinearModel.outputs", outputs, p, "y"),
            x0=np.zeros(n),
            u0=np.zeros(m),
            w0=np.zeros(k),
            y0=np.zeros(p),
            f0=np.zeros(n),
            dt=dt,
        )

    @cached_property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """Eigenvalues of A (nx,), complex: [1/s], or in the z plane where the model is sampled."""
        return np.linalg.eigvals(self.A).astype(complex)

    def modes(self) -> tuple[modal_analysis.Mode, ...]:
        """The modes, slowest first: frequency [Hz], damping ratio, dominant state; see `modal_analysis.Mode`."""
        return modal_analysis.modes(self.A, self.state_names, self.dt)

    def discretize(self, dt: float) -> LinearModel:
        """The sampled model, exact for inputs and disturbances held over each step dt [s]; f0 included."""
        self._require_continuous("discretize")
        dt = require_seconds("discretize.dt", dt, LEAST)
        Phi, held, _ = held_response(self.A, self._drives, np.array([dt]))
        nu, nw = len(self.inputs), len(self.disturbances)
        B, E, f0 = np.split(held[0], [nu, nu + nw], axis=1)
        return replace(self, A=Phi[0], B=B, E=E, f0=f0[:, 0], dt=float(dt))

    def simulate(self, dx0: Any, du: InputLike, t: Any, dw: InputLike = None) -> tuple[np.ndarray, np.ndarray]:
        """Deviations (x (nt, nx), y (nt, ny)) from dx0 (nx,) at the times t (nt,) [s].

        `du`, `dw`: None, a constant, (nt, n) held from each time to the next, or a function of time. Exact
        for the first three. A function is taken as the line through its values at two Gauss points of each
        interval: exact for lines, else of fourth order in the interval. A sampled model takes inputs only at
        its times, dt apart. ValueError where the times do not fit dt.
        """
        times = read_only_times("simulate.t", t)
        x0 = require_finite("simulate.dx0", dx0, (len(self.states),))
        (u, ug), (w, wg) = (
            sample(f"simulate.{name}", value, times, len(signals))
            for name, value, signals in (("du", du, self.inputs), ("dw", dw, self.disturbances))
        )
        h = np.diff(times)
        v = np.concatenate([ug, wg, np.ones((len(h), 2, 1))], axis=2)
        if self.dt is not None:
            if np.abs(h - self.dt).max() > 1e-6 * self.dt:
                raise ValueError(f"simulate.t has steps up to {h.max():.9g}, must be {self.dt:.9g} (the model's dt)")
            Phi = np.broadcast_to(self.A, (len(h), *self.A.shape))
            push = np.concatenate([u[:-1], w[:-1], np.ones((len(h), 1))], axis=1) @ self._drives.T
        else:
            uniform = np.ptp(h) <= 1e-9 * h.mean()
            step, which = np.unique([h.mean()] if uniform else h, return_inverse=True)
            which = np.zeros(len(h), dtype=int) if uniform else which
            Phi, held, ramp = (m[which] for m in held_response(self.A, self._drives, step))
            slope = np.sqrt(3.0) * (v[:, 1] - v[:, 0])
            start = (v[:, 0] + v[:, 1] - slope) / 2
            push = np.einsum("kij,kj->ki", held, start) + np.einsum("kij,kj->ki", ramp, slope)
        x = np.empty((len(times), len(x0)))
        x[0] = x0
        for k in range(len(h)):
            x[k + 1] = Phi[k] @ x[k] + push[k]
        return x, x @ self.C.T + u @ self.D.T + w @ self.F.T

    def reduce(self, order: int, method: str = "balanced") -> LinearModel:
        """A model of `order` states; its `error_bound` is the largest error of the gain from (u, w) to y.

        "balanced" needs modes that all decay. "modal" keeps the modes that grow, then the slowest; its
        bound is infinite where it drops an undamped one. New states are combinations L x of the old ones; see
        `modal_analysis.truncation`. ValueError where `order` cannot be had.
        """
        L, R, bound = modal_analysis.truncation(self.A, self._drives[:, :-1], self.C, order, method, self.dt)
        return replace(
            self,
            A=L @ self.A @ R,
            B=L @ self.B,
            E=L @ self.E,
            C=self.C @ R,
            states=as_signals("LinearModel.states", None, len(L), method),
            x0=L @ self.x0,
            f0=L @ self.f0,
            error_bound=bound,
        )

    def to_control(
        self, *, disturbances: bool = False, outputs: Any = None, name: str | None = None
    ) -> control.StateSpace:
        """python-control's StateSpace of the deviations, names kept; f0 is left out.

        disturbances=True appends the disturbances to the inputs. outputs: None (the model's), "states", or names of
        outputs and states.
        """
        return state_space(self, disturbances, outputs, name)

    @classmethod
    def from_control(cls, system: control.StateSpace) -> LinearModel:
        """The model of a python-control StateSpace about the origin, names taken from it, units unknown.

        Its timebase must be stated: 0 or None is continuous, a number is the sampling time.
        ValueError where it is True.
        """
        system = _as_state_space(system)
        if system.dt is True:
            raise ValueError("from_control: system.dt = True must be 0, None or a sampling time in seconds")
        return cls.from_matrices(
            system.A,
            system.B,
            system.C,
            system.D,
            states=system.state_labels,
            inputs=system.input_labels,
            outputs=system.output_labels,
            dt=system.dt or None,
        )

    @property
    def _drives(self) -> np.ndarray:
        """[B, E, f0], (nx, nu + nw + 1)."""
        return np.hstack([self.B, self.E, self.f0[:, None]])

    def _require_continuous(self, task: str) -> None:
        if self.dt is not None:
            raise ValueError(f"{task}: LinearModel.dt = {self.dt} must be None (a continuous-time model)")


def _as_state_space(system: Any) -> Any:
    if not all(hasattr(system, name) for name in (*"ABCD", "dt", "state_labels", "input_labels", "output_labels")):
        raise ValueError(f"from_control.system = {shown(system)} must be a python-control StateSpace")
    if isinstance(system, type):
        raise ValueError(f"from_control.system = {shown(system)} must be a StateSpace, not its class")
    return system


def held_response(A: np.ndarray, G: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Over the steps h (m,) of dx/dt = A x + G v: e^(A h) (m, nx, nx), response to v = 1 and v = s/h (m, nx,
    nv).

    One exponential of an augmented matrix (Van Loan 1978).
    """
    n, k = G.shape
    M = np.zeros((len(h), n + 2 * k, n + 2 * k))
    M[:, :n, :n] = A * h[:, None, None]
    M[:, :n, n : n + k] = G * h[:, None, None]
    M[:, n : n + k, n + k :] = np.eye(k)
    P = even_expm(M)
    return P[:, :n, :n], P[:, :n, n : n + k], P[:, :n, n + k :]
