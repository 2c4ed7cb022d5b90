"""A(t) of a linear model as a function of time, in coordinates scaled once for all times.

Between the nodes A is a cubic spline, as in `LTVModel`; over a period of equidistant nodes a trigonometric polynomial
where its harmonics die out, else a periodic cubic spline. A nominal with jumps is a list of models, `Pieces`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as sla

from . import magnus
from .linear import LinearModel
from .ltv import LTVModel
from .parameters import require_finite
from .signals import index

DROPPED = 1e-11  # of the largest |A|: harmonics that are left out, root of the sum of squares
MOST_HARMONICS = 256
CHUNK = 4096  # steps whose matrices are held at a time


@dataclass(frozen=True, eq=False)
class Pieces:
    """Models of consecutive time spans; after piece k a deviation jumps from dx to jumps[k] dx.

    `models` LTVModels with the same states, each beginning when the one before ends. `jumps` (np-1, nx, nx), None: the
    state is continuous and only the matrices jump. A constant impulse moves the nominal, not the deviation.
    """

    models: tuple[LTVModel, ...]
    jumps: tuple[np.ndarray, ...] | None = None

    def __post_init__(self) -> None:
        models = tuple(self.models)
        if not models or not all(isinstance(m, LTVModel) for m in models):
            raise ValueError(f"Pieces.models = {[type(m).__name__ for m in models]} must be one or more LTVModel")
        n = len(models[0].states)
        for k, (a, b) in enumerate(zip(models, models[1:])):
            if a.state_names != b.state_names:
                raise ValueError(f"Pieces.models[{k + 1}] has states {b.state_names}, must be {a.state_names}")
            if abs(b.t[0] - a.t[-1]) > 1e-9 * max(1.0, abs(a.t[-1]), a.t[-1] - a.t[0]):
                raise ValueError(f"Pieces.models[{k + 1}] begins at {b.t[0]:.9g} s, must be {a.t[-1]:.9g}: the end before")
        jumps = (np.eye(n),) * (len(models) - 1) if self.jumps is None else tuple(self.jumps)
        if len(jumps) != len(models) - 1:
            raise ValueError(f"Pieces.jumps has {len(jumps)} matrices, must have {len(models) - 1}: one between two pieces")
        jumps = tuple(require_finite(f"Pieces.jumps[{k}]", J, (n, n)) for k, J in enumerate(jumps))
        object.__setattr__(self, "models", models)
        object.__setattr__(self, "jumps", jumps)

    @property
    def state_names(self) -> tuple[str, ...]:
        return self.models[0].state_names


Model = LinearModel | LTVModel | Pieces | Sequence[LTVModel]


def as_pieces(model: Model) -> Pieces:
    """The model as pieces: one where it has no jump. ValueError for a LinearModel, which has no times."""
    if isinstance(model, Pieces):
        return model
    if isinstance(model, LTVModel):
        return Pieces((model,))
    if isinstance(model, Sequence):
        return Pieces(tuple(model))
    raise ValueError(f"model is a {type(model).__name__}, must be an LTVModel, Pieces or a list of LTVModel")


def kept(model: Any, states: Sequence[str] | None) -> list[int]:
    """Positions of the named states (None: all)."""
    signals = as_pieces(model).models[0].states if not isinstance(model, LinearModel) else model.states
    if states is None:
        return list(range(len(signals)))
    return [index(signals, name, "state") for name in states]


def scaling(A: np.ndarray) -> np.ndarray:
    """Powers of two (n,), largest 1: in z = x / scale the rows and columns of A (nt, n, n) are of like size."""
    mean = np.abs(A).mean(axis=0)
    if not len(mean) or not mean.any():
        return np.ones(len(mean))
    _, (scale, _) = sla.matrix_balance(mean, permute=False, separate=True)
    return scale / scale.max()


class Path:
    """A(t) = base + what varies, from values A (nt, n, n) at times t; `period`: t[-1] is a period after t[0]."""

    def __init__(self, t: np.ndarray, A: np.ndarray, scale: np.ndarray, *, periodic: bool = False) -> None:
        A = A * scale / scale[:, None]
        self.t, self.n, self.scale = t, A.shape[-1], scale
        self.size = float(np.abs(A).max(initial=0.0))  # [1/s]
        self.rows, self.columns = np.nonzero(np.ptp(A, axis=0) > 1e-14 * self.size)
        self.base, flat = A.mean(axis=0), A[:, self.rows, self.columns]
        self.harmonics, self.error = 0, 0.0  # error [1/s]: of A between the nodes
        self._values: Any = None
        if not len(self.rows):
            return
        self.base[self.rows, self.columns] = 0.0
        if periodic:
            flat = flat.copy()
            flat[0] = flat[-1] = (flat[0] + flat[-1]) / 2
            if np.ptp(np.diff(t)) <= 1e-7 * np.diff(t).mean() and len(t) >= 5 and self._trigonometric(flat):
                return
        self._spline(flat, periodic)

    def _trigonometric(self, flat: np.ndarray) -> bool:
        c = np.fft.rfft(flat[:-1], axis=0) / (len(flat) - 1)
        c[1:] *= 2.0
        if len(flat) % 2:
            c[-1] /= 2.0
        size = np.abs(c).max(axis=1)
        tail = np.sqrt(np.cumsum(size[::-1] ** 2)[::-1])
        K = int(np.sum(tail > DROPPED * self.size))  # harmonics 0 .. K-1 are kept
        if K > MOST_HARMONICS or (len(c) == K and tail[3 * len(c) // 4] > 1e-4 * self.size):
            return False
        K = max(K, 1)
        self.harmonics = K - 1
        self.error = float(tail[K] if len(c) > K else tail[-1])
        omega, start = 2 * np.pi / (self.t[-1] - self.t[0]) * np.arange(K), self.t[0]
        weights = np.concatenate([c[:K].real, -c[:K].imag])

        def values(t: np.ndarray) -> np.ndarray:
            angle = np.outer(t - start, omega)
            return np.hstack([np.cos(angle), np.sin(angle)]) @ weights

        self._values = values
        return True

    def _spline(self, flat: np.ndarray, periodic: bool) -> None:
        from scipy.interpolate import CubicSpline

        self.spline = CubicSpline(self.t, flat, bc_type="periodic" if periodic else "not-a-knot")
        self._values = self.spline
        if len(self.t) >= 9:
            half = np.unique(np.r_[np.arange(0, len(self.t), 2), len(self.t) - 1])
            coarse = CubicSpline(self.t[half], flat[half], bc_type="periodic" if periodic else "not-a-knot")
            self.error = float(np.sqrt(np.mean((coarse(self.t) - flat) ** 2, axis=0)).max() / 15.0)
        self.harmonics = min(len(self.t) - 1, 64) if periodic else 0

    @property
    def constant(self) -> bool:
        return not len(self.rows)

    def __call__(self, t: Any) -> np.ndarray:
        """A (.., n, n) in scaled coordinates at the times t."""
        t = np.asarray(t, dtype=float)
        found = np.broadcast_to(self.base, (t.size, self.n, self.n))
        if not self.constant:
            found = found.copy()
            found[:, self.rows, self.columns] = self._values(t.ravel())
        return found.reshape(*t.shape, self.n, self.n)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """dA/dt (nt, n, n) [1/s^2] at the times t by central differences of the interpolant, one-sided at the ends."""
        span = self.t[-1] - self.t[0]
        step = 1e-4 * span / max(len(self.t) - 1, 1)
        low, high = np.maximum(t - step, self.t[0]), np.minimum(t + step, self.t[-1])
        return (self(high) - self(low)) / (high - low)[:, None, None]

    def transitions(self, edges: np.ndarray) -> np.ndarray:
        """Phi (m, n, n) between consecutive times edges (m+1,), in scaled coordinates."""
        h = np.diff(edges)
        if self.constant and np.ptp(h) <= 1e-12 * h.mean():
            return np.broadcast_to(magnus.expm(self.base[None] * h.mean()), (len(h), self.n, self.n))
        found = np.empty((len(h), self.n, self.n))
        for k in range(0, len(h), CHUNK):
            part = slice(k, k + CHUNK)
            found[part] = magnus.steps(self(edges[:-1][part, None] + h[part, None] * magnus.GAUSS3), h[part])
        return found

    def fastest(self) -> float:
        """Largest |eigenvalue| [1/s] at a few times."""
        at = self.t[:: max(1, len(self.t) // 8)] if not self.constant else self.t[:1]
        return float(np.abs(np.linalg.eigvals(self(at))).max(initial=0.0))
