"""Minimum-variance filtering of a sampled linear model: gains and covariances, as functions of arrays.

    x[k+1] = A x[k] + G w[k],    y[k+1] = C x[k+1] + H w[k] + v[k+1]

w[k] is held from one sample to the next with variance W/dt, W its spectral density [unit^2 s]; v has covariance V.
What is held drives the state and is still there, through H, when the next sample is taken, so that the two are
correlated: the gain of the innovation is L = (P- C' + G W/dt H') S^-1, S the innovation's covariance.

Source   Anderson and Moore, "Optimal Filtering" (1979), Sections 3.1, 4.1 and 5.4, for correlated noises
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np

from pliant.controllers.riccati.algebraic import filter_gain
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.core.signals import Signal, index, names, rows_by_name
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

Array = np.ndarray
Model = TypeVar("Model", LinearModel, LTVModel)


class Sampled(NamedTuple):
    """One step of the filter's model, deviations from the nominal, `dt` [s] long."""

    A: Array  # (nx, nx)
    B: Array  # (nx, nu)
    G: Array  # (nx, nw), of w with covariance W
    C: Array  # (ns, nx) at the end of the step
    D: Array  # (ns, nu) of the input held over the step
    H: Array  # (ns, nw)
    W: Array  # (nw, nw) covariance of the held w
    V: Array  # (ns, ns)
    c: Array  # (nx,) push of the nominal's residual


class Filtered(NamedTuple):
    """After a sample: gain L (nx, ns), covariances P of the estimate, S of the innovation."""

    L: Array
    P: Array
    S: Array


def driven_by(model: Model, W: Mapping[str, float]) -> tuple[Model, Array]:
    """The model with what `W` names as its disturbances, and their spectral densities (nw, nw) [unit^2 s].

    A name is that of a disturbance, of an input (its actuator's error), or of a state (an error of its rate).
    """
    if not W:
        raise ValueError("process noise W must name at least one disturbance, input or state")
    A: Array = model.A
    C: Array = model.C
    columns: list[tuple[Array, Array]] = []
    signals: list[Signal] = []
    for name, density in W.items():
        if not 0 < density < np.inf:
            raise ValueError(f"process noise W[{name!r}] = {density!r} must be > 0 [unit^2 s]")
        for kind, E, F in ((model.disturbances, model.E, model.F), (model.inputs, model.B, model.D)):
            if name in names(kind):
                i = index(kind, name, "signal")
                signals.append(kind[i])
                columns.append((E[..., i], F[..., i]))
                break
        else:
            i = index(model.disturbances + model.inputs + model.states, name, "process noise W: signal")
            i -= len(model.disturbances + model.inputs)
            signals.append(Signal(f"{name} error", f"{model.states[i].unit}/s"))
            columns.append((np.broadcast_to(np.eye(A.shape[-1])[i], A.shape[:-1]), np.zeros(C.shape[:-1])))
    E, F = (np.stack([pair[k] for pair in columns], axis=-1) for k in (0, 1))
    quiet = np.zeros((*A.shape[:-2], len(signals)))
    densities = np.diag([float(v) for v in W.values()])
    if isinstance(model, LTVModel):
        return replace(model, E=E, F=F, disturbances=tuple(signals), w=quiet), densities
    return replace(model, E=E, F=F, disturbances=tuple(signals), w0=quiet), densities


def rows(model: LinearModel | LTVModel, wanted: Sequence[str]) -> tuple[Array, Array, Array]:
    """(C, D, F) (.., n, nx | nu | nw) of the named outputs or states."""
    _, C, D, F = rows_by_name(model, wanted)
    return C, D, F


def delayed(step: Sampled, samples: int) -> Sampled:
    """The step with states [x; y[k], .., y[k - samples]], y without noise, of which the last is measured."""
    if samples == 0:
        return step
    nx, ns = len(step.A), len(step.C)
    A = np.zeros((nx + (samples + 1) * ns,) * 2)
    A[:nx, :nx] = step.A
    A[nx : nx + ns, :nx] = step.C @ step.A
    A[nx + ns :, nx:-ns] = np.eye(samples * ns)
    C = np.zeros((ns, len(A)))
    C[:, -ns:] = np.eye(ns)

    def pushed(block: Array, direct: Array) -> Array:
        return np.concatenate([block, step.C @ block + direct, np.zeros((samples * ns, *block.shape[1:]))])

    B, G, c = pushed(step.B, step.D), pushed(step.G, step.H), pushed(step.c, np.zeros(ns))
    return Sampled(A, B, G, C, np.zeros_like(step.D), np.zeros_like(step.H), step.W, step.V, c)


def resting(C: Array, samples: int) -> Array:
    """T (nx + .., nx): the states of `delayed` from x of a plant that stands still; the identity without delay."""
    return np.vstack([np.eye(C.shape[1]), *([C] * (samples + 1 if samples else 0))])


def steady(step: Sampled, known: Sequence[str], dt: float) -> Filtered:
    """The limit of many samples: P of x after a sample solves the Riccati equation of y[k+1] seen from x[k].

    UncontrollableError names modes that do not decay and that the sensors do not see or the noise does not drive.
    """
    A, ns = step.A, len(step.C)
    whiten = np.diag(1 / np.sqrt(np.diag(step.V)))
    C, H, V = whiten @ step.C, whiten @ step.H, whiten @ step.V @ whiten
    known = tuple(known) + tuple(f"delayed {i + 1}" for i in range(len(A) - len(known)))
    seen, noise, W = C @ A, C @ step.G + H, step.G @ step.W @ step.G.T
    R = noise @ step.W @ noise.T + V
    N = step.G @ step.W @ noise.T
    drive = semidefinite_root(W - N @ np.linalg.solve(R, N.T))
    words = "cannot be seen by the sensors", "is not driven by the noise W"
    L, P = filter_gain(A, seen, W, R, N, drive, known, dt, words)
    S = R + seen @ P @ seen.T
    back = np.linalg.inv(whiten)
    return Filtered(L @ whiten, P, (back @ (S + S.T) @ back / 2).reshape(ns, ns))


def after(step: Sampled, P: Array) -> Filtered:
    """The next sample from the covariance P (nx, nx) after the last one; Joseph's form, which keeps P positive."""
    before = step.A @ P @ step.A.T + step.G @ step.W @ step.G.T
    return corrected(step, before, step.G @ step.W @ step.H.T)


def corrected(step: Sampled, P: Array, shared: Array | None = None) -> Filtered:
    """One sample from the covariance P before it; `shared` (nx, ns) is that of the prediction's error with H w."""
    C = step.C
    M = np.zeros((len(P), len(C))) if shared is None else shared
    noise = step.H @ step.W @ step.H.T + step.V
    S = C @ P @ C.T + C @ M + M.T @ C.T + noise
    L = np.linalg.solve(S, (P @ C.T + M).T).T
    keep = np.eye(len(P)) - L @ C
    crossed = keep @ M @ L.T
    P = keep @ P @ keep.T + L @ noise @ L.T - crossed - crossed.T
    return Filtered(L, (P + P.T) / 2, (S + S.T) / 2)
