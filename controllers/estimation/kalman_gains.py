"""Minimum-variance filtering of a sampled linear model: gains and covariances, as functions of arrays.

    x[k+1] = A x[k] + G w[k],    y[k+1] = C x[k+1] + H w[k] + v[k+1]

v has covariance V. A process noise of spectral density W [unit^2 s] is one of two:

held    from one sample to the next with variance W/dt. It is still there, through H, when the next sample is taken, so
        that what drives the state and what errs in the reading are correlated.
white   over the period the state gets int e^(As) E W E' e^(A's) ds (Van Loan 1978), of which a held one, of the same
        density, gives only what its mean over the period does. A reading that it enters directly takes that mean, as a
        sensor does that averages over the period; w[k] is the mean, and what it leaves of the integral comes besides.

Source   Anderson and Moore, "Optimal Filtering" (1979), Sections 3.1, 4.1 and 5.4, for correlated noises
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np

from pliant.controllers.riccati.algebraic import filter_gain
from pliant.controllers.riccati.late_inputs import late_period, periods_of
from pliant.plants.core.argument_gates import require_by_name
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.core.signals import Signal, index, names, rows_by_name
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from . import square_root

Array = np.ndarray
Model = TypeVar("Model", LinearModel, LTVModel)


class Sampled(NamedTuple):
    """One step of the filter's model, deviations from the nominal, `dt` [s] long."""

    A: Array  # (nx, nx)
    B: Array  # (nx, nu)
    G: Array  # (nx, nw), of w with covariance W; w of unit covariance besides where noise is white
    C: Array  # (ns, nx) at the end of the step
    D: Array  # (ns, nu) of the input held over the step
    H: Array  # (ns, nw)
    W: Array  # (nw, nw) covariance of w
    V: Array  # (ns, ns)
    c: Array  # (nx,) push of the nominal's residual


class Filtered(NamedTuple):
    """After a sample."""

    L: Array  # (nx, ns) gain of the innovation
    P: Array  # (nx, nx) covariance of the estimate
    S: Array  # (ns, ns) and of the innovation
    root: Array  # (nx, nx) lower triangular, P = root root'


def driven_by(model: Model, W: Mapping[str, float]) -> tuple[Model, Array]:
    """The model with what `W` names as its disturbances, and their spectral densities (nw, nw) [unit^2 s].

    A name is that of a disturbance, of an input (its actuator's error), or of a state (an error of its rate).
    """
    known = names(model.disturbances + model.inputs + model.states)
    W = require_by_name("process noise W", W, known, "disturbance, input or state", "positive")
    if not W:
        raise ValueError("process noise W must name at least one disturbance, input or state")
    A: Array = model.A
    C: Array = model.C
    columns: list[tuple[Array, Array]] = []
    signals: list[Signal] = []
    for name in W:
        for kind, E, F in ((model.disturbances, model.E, model.F), (model.inputs, model.B, model.D)):
            if name in names(kind):
                i = index(kind, name, "signal")
                signals.append(kind[i])
                columns.append((E[..., i], F[..., i]))
                break
        else:
            i = index(model.states, name, "state")
            signals.append(Signal(f"{name} error", f"{model.states[i].unit}/s"))
            columns.append((np.broadcast_to(np.eye(A.shape[-1])[i], A.shape[:-1]), np.zeros(C.shape[:-1])))
    E, F = (np.stack([pair[k] for pair in columns], axis=-1) for k in (0, 1))
    quiet = np.zeros((*A.shape[:-2], len(signals)))
    densities = np.diag(list(W.values()))
    if isinstance(model, LTVModel):
        return replace(model, E=E, F=F, disturbances=tuple(signals), w=quiet), densities
    return replace(model, E=E, F=F, disturbances=tuple(signals), w0=quiet), densities


def with_rest(G: Array, H: Array, mean: Array, rest: Array) -> tuple[Array, Array, Array]:
    """G, H, W of a step with white noise: its mean over the period, of covariance `mean` (nw, nw), moves x by G and the
    reading by H (ns, nw); what it leaves of the integral is rest e (nx, nx), e of covariance one."""
    nx, nw = G.shape
    W = np.eye(nw + nx)
    W[:nw, :nw] = mean
    return np.hstack([G, rest]), np.hstack([H, np.zeros((len(H), nx))]), W


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


def split_period(A: Array, B: Array, D: Array, dt: float, late: float) -> tuple[Array, Array]:
    """B (nx, w nu), D (ns, w nu) of the inputs that act in a period, the older first: two where `late` [periods] has a
    part of one, in which the older goes on acting. A, B of continuous time, D of what acts when the sample is taken."""
    (nx, nu), (_, part) = B.shape, periods_of(late)
    zero = np.zeros((nx, nx)), np.eye(nu), np.zeros((nx, nu))
    step = late_period(A, B, *zero, dt, part, int(part > 0)).step[:nx, nx:]
    return step, np.hstack([np.zeros((len(D), step.shape[1] - nu)), D])


def resting(C: Array, samples: int) -> Array:
    """T (nx + .., nx): the states of `delayed` from x of a plant that stands still; the identity without delay."""
    return np.vstack([np.eye(C.shape[1]), *([C] * (samples + 1 if samples else 0))])


def steady(step: Sampled, known: Sequence[str], dt: float) -> Filtered:
    """The limit of many samples: the predictor's Riccati equation, then its covariance refined by roots.

    UncontrollableError names modes that do not decay and that the sensors do not see or the noise does not drive.
    """
    whole = _remembered(step)
    ns, n = len(step.C), len(whole.A)
    whiten = 1 / np.sqrt(np.diag(step.V))
    names = tuple(known) + tuple(f"delayed {i + 1}" for i in range(n - len(known)))
    drive, words = (
        whole.G @ semidefinite_root(step.W),
        ("cannot be seen by the sensors", "is not driven by the noise W"),
    )
    C, V = whiten[:, None] * whole.C, whiten[:, None] * step.V * whiten
    _, P = filter_gain(whole.A, C, drive @ drive.T, V, np.zeros((n, ns)), drive, names, dt, words, doubted=False)
    near = _sampled(semidefinite_root(P), np.zeros((n, ns)), whole.C, semidefinite_root(step.V))
    noise, read = _noises(step)
    root = square_root.steady(step.A, step.C, noise, read, square_root.triangle(near.root[: len(step.A)]))
    return after(step, root)


def after(step: Sampled, root: Array) -> Filtered:
    """The next sample from the root (nx, nx) of the covariance after the last one."""
    noise, read = _noises(step)
    return _filtered(np.hstack([step.A @ root, noise]), np.hstack([step.C @ step.A @ root, read]))


def corrected(step: Sampled, P: Array) -> Filtered:
    """The first sample, from the covariance P (nx, nx) before it."""
    state, own = semidefinite_root(P), np.hstack([step.H @ semidefinite_root(step.W), semidefinite_root(step.V)])
    return _sampled(state, np.zeros((len(P), own.shape[1])), step.C, own)


def _sampled(state: Array, apart: Array, C: Array, own: Array) -> Filtered:
    """A reading C x of x = state @ e, with noise own @ e' of its own."""
    return _filtered(np.hstack([state, apart]), np.hstack([C @ state, own]))


def _filtered(state: Array, reading: Array) -> Filtered:
    L, root, own = square_root.update(state, reading)
    return Filtered(L, root @ root.T, own @ own.T, root)


def _noises(step: Sampled) -> tuple[Array, Array]:
    """What w and v do to the state (nx, nw + ns) and to the reading (ns, nw + ns), as noise of covariance one."""
    w, v = semidefinite_root(step.W), semidefinite_root(step.V)
    noise = np.hstack([step.G @ w, np.zeros((len(step.G), len(v)))])
    return noise, np.hstack([(step.C @ step.G + step.H) @ w, v])


def _remembered(step: Sampled) -> Sampled:
    """The step with those of w that reach the reading as states: then nothing is common to x+ and the reading."""
    direct = np.asarray(step.H.any(axis=0))
    if not direct.any():
        return step
    k, nx = int(direct.sum()), len(step.A)
    A = np.zeros((nx + k, nx + k))
    A[:nx, :nx] = step.A
    G = np.vstack([step.G, np.eye(len(direct))[direct]])
    C = np.hstack([step.C, step.H[:, direct]])
    return step._replace(A=A, G=G, C=C, H=np.zeros_like(step.H))
