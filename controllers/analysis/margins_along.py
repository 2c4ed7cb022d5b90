"""Margins of a loop that follows a motion, two kinds told apart.

Frozen      at single times, A, B and K taken as if they stayed: margins of a constant loop. They say nothing of a
            motion that ends, nor of what A does while it varies: a loop may grow with good frozen margins at all times,
            and end well with none at some
Along       the largest change of the input, u = -f K(t) x, under which no output is pushed further than `limit` times
            what it was: by disturbances of unit energy, at its largest over the whole motion. A gain f below and above
            one, a phase f = e^(j phi), and a delay, by a Pade approximation of third order, all inputs alike

            max over t of (C W C')_ii,   dW/dt = A W + W A' + E E',   W(0) = 0

A sampled law acts as if continuous. A change is raised from none until an output is past the limit, by steps of GAINS,
PHASES and DELAYS, then halved in between: what comes after the first is not looked at.

Source   Seiler, Moore, Meissen, Arcak and Packard, "Finite horizon robustness analysis of LTV systems using integral
         quadratic constraints", Automatica 100 (2019), for gains of motions that end
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_finite, require_instance, require_names
from pliant.plants.core.argument_gates import require_number as number
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import GAUSS, OwnsArrays
from pliant.plants.linear import magnus
from pliant.plants.linear.even_units import even_expm
from pliant.plants.linear.ltv import LTVModel, splined

from .loops import loop
from .margins import margins

Array = np.ndarray
GAINS = 1 + np.geomspace(0.02, 99.0, 24)  # factors up; their reciprocals down, then none
PHASES = np.linspace(0.0, np.pi, 25)[1:]
DELAYS = np.geomspace(1e-4, 0.5, 24)  # of the motion's time
HALVINGS = 9
THIRD = np.array([120.0, 60.0, 12.0])  # 1/N(-z) N(z), N = 120 + 60 z + 12 z^2 + z^3


@dataclass(frozen=True, eq=False)
class MarginsAlong(OwnsArrays):
    """Frozen at times t (m,), zero where the frozen loop is not stable, and along the motion.

    Example
    -------
    >>> gains = np.tile(law.K, (len(motion.t), 1, 1))
    >>> found = margins_along(arm.linearize_along(motion), gains, outputs=["tip_deflection"])
    >>> round(float(found.frozen_disk.min()), 2)
    1.15
    >>> found.words[:6]
    'Frozen'
    """

    limit: float
    t: Array = field(repr=False)
    frozen_disk: Array = field(repr=False)  # (m,) of all inputs at once
    frozen_gain: Array = field(repr=False)  # (m, 2) of one input at a time, the narrowest
    frozen_phase_deg: Array = field(repr=False)  # (m,)
    frozen_delay: Array = field(repr=False)  # (m,) [s]
    gain: tuple[float, float]  # along: factors within which no output passes the limit; 0, inf: none tried did
    phase_deg: float
    delay: float  # [s]; infinite: none that was tried, to half of the motion's time

    @property
    def words(self) -> str:
        """What an engineer would write."""
        k = int(self.frozen_disk.argmin())
        bad = f"not stable at {self.t[k]:.3g} s" if self.frozen_disk[k] == 0 else f"at worst at {self.t[k]:.3g} s"
        low, high = self.frozen_gain[:, 0].max(), self.frozen_gain[:, 1].min()
        stood = f"gain {low:.3g} to {high:.3g}, phase {self.frozen_phase_deg.min():.3g} deg"
        return (
            f"Frozen, the loop is {bad}: disk {self.frozen_disk[k]:.3g}, {stood}, delay "
            f"{self.frozen_delay.min():.3g} s. Along the motion no output is pushed more than {self.limit:g} times as "
            f"far with a gain of {self.gain[0]:.3g} to {self.gain[1]:.3g}, a phase of {self.phase_deg:.3g} deg or a "
            f"delay of {self.delay:.3g} s."
        )


def margins_along(
    ltv: LTVModel,
    K: Any,
    *,
    outputs: Any = None,
    disturbances: Any = None,
    limit: float = 2.0,
    frozen: int = 21,
) -> MarginsAlong:
    """Of u = -K x, K (nt, nu, nx) at the nodes of an LTVModel.

    outputs, disturbances: by name; None takes all, and what enters with the inputs where there are no disturbances.
    limit: above one. frozen: how many times. PliantError where no disturbance pushes an output.

    Example
    -------
    >>> gains = np.tile(law.K, (len(motion.t), 1, 1))
    >>> found = margins_along(arm.linearize_along(motion), gains, outputs=["tip_deflection"])
    >>> print(found.words)
    Frozen, the loop is at worst at 0.14 s: disk 1.15, gain 0 to 9.25, phase 63.7 deg, delay 0.0338 s. Along
    the motion no output is pushed more than 2 times as far with a gain of 0.0785 to 7.41, a phase of 56 deg
    or a delay of 0.0319 s.
    """
    ltv = require_instance("margins_along.ltv", ltv, LTVModel)
    n, nu = len(ltv.states), len(ltv.inputs)
    K = require_finite("margins_along.K", K, (len(ltv.t), nu, n))
    limit = number("margins_along.limit", limit, "positive")
    if not limit > 1:
        raise ValueError(f"margins_along.limit = {limit} must be above 1")
    seen = require_names("margins_along.outputs", ltv.output_names if outputs is None else outputs, ltv.output_names)
    rows = [ltv.output_names.index(name) for name in seen]
    own = [s.name for s in ltv.disturbances]
    E = ltv.B
    if own or disturbances is not None:
        asked = require_names("margins_along.disturbances", own if disturbances is None else disturbances, own)
        E = ltv.E[:, :, [own.index(name) for name in asked]]
    count = require_count("margins_along", "frozen", frozen, 1, 10_000)
    nodes = np.unique(np.linspace(0, len(ltv.t) - 1, count).astype(int))
    pushed = _Pushed(ltv, K, E, rows)
    return MarginsAlong(limit, ltv.t[nodes], *_frozen(ltv, K, nodes), *_along(pushed, limit, float(np.ptp(ltv.t))))


def _frozen(ltv: LTVModel, K: Array, nodes: Array) -> tuple[Array, Array, Array, Array]:
    disk, gain = np.zeros(len(nodes)), np.tile([1.0, 1.0], (len(nodes), 1))
    phase, delay = np.zeros(len(nodes)), np.zeros(len(nodes))
    for i, k in enumerate(nodes):
        try:
            found = margins(loop(ltv.at(int(k)), K[k], reads=ltv.state_names))
        except PliantError:  # not stable: none
            continue
        disk[i], phase[i] = found.disk, min(c.phase_deg for c in found.channels)
        gain[i] = max(c.gain[0] for c in found.channels), min(c.gain[1] for c in found.channels)
        delay[i] = min(c.delay for c in found.channels)
    return disk, gain, phase, delay


def _along(pushed: _Pushed, limit: float, length: float) -> tuple[tuple[float, float], float, float]:
    none = pushed(1.0)
    if not (none > 0).any():
        raise PliantError("margins_along: no disturbance pushes any of these outputs")
    kept = none > 0

    def past(found: Array) -> bool:
        return not bool((found[kept] <= limit * none[kept]).all())

    up = _first(lambda f: past(pushed(f)), 1.0, GAINS)
    down = _first(lambda f: past(pushed(f)), 1.0, np.append(1 / GAINS, 0.0))
    phase = _first(lambda a: past(pushed(np.exp(1j * a))), 0.0, PHASES)
    delay = _first(lambda d: past(pushed(1.0, d)), 0.0, DELAYS * length)
    return (
        (0.0 if down is None else down, np.inf if up is None else up),
        (180.0 if phase is None else float(np.rad2deg(phase))),
        np.inf if delay is None else delay,
    )


def _first(past: Callable[[float], bool], start: float, values: Array) -> float | None:
    """The last value before the first that is past the limit; None where there is none."""
    good = start
    for bad in values:
        if past(float(bad)):
            for _ in range(HALVINGS):
                middle = (good + bad) / 2
                good, bad = (good, middle) if past(middle) else (middle, bad)
            return float(good)
        good = float(bad)
    return None


class _Pushed:
    """How far outputs are pushed over the motion (p,), squared roots of the largest (C W C')_ii, of a changed input."""

    def __init__(self, ltv: LTVModel, K: Array, E: Array, rows: list[int]) -> None:
        self.h = np.diff(ltv.t)
        at = (ltv.t[:-1, None] + self.h[:, None] * GAUSS).ravel()
        self.A, self.B, self.E, self.K = (
            splined(ltv.t, M, at).reshape(len(self.h), 2, *M.shape[1:]) for M in (ltv.A, ltv.B, E, K)
        )
        self.C, self.D, self.at_nodes = ltv.C[1:, rows], ltv.D[1:, rows], K[1:]

    def __call__(self, factor: complex, delay: float = 0.0) -> Array:
        f = complex(factor)
        A, E, C = self.A - f * self.B @ self.K, self.E + 0j, self.C - f * self.D @ self.at_nodes
        if delay > 0:
            A, E, C = self._late(f, delay)
        if f.imag:
            real: list[Array] = [np.block([[M.real, -M.imag], [M.imag, M.real]]) for M in (A, E, C)]
        else:
            real = [A.real, E.real, C.real]
        return self._largest(real[0], real[1], real[2], 2 if f.imag else 1)

    def _largest(self, A: Array, E: Array, C: Array, parts: int) -> Array:
        Phi = even_expm(magnus.exponent(A, self.h))
        step = magnus.reached(A, E @ np.swapaxes(E, -1, -2), self.h)
        W, most = np.zeros(A.shape[-2:]), np.zeros(C.shape[1])
        for k in range(len(self.h)):
            W = Phi[k] @ W @ Phi[k].T + step[k]
            most = np.maximum(most, np.einsum("ij,jk,ik->i", C[k], W, C[k]))
            if not np.isfinite(most).all():
                return np.full(len(most) // parts, np.inf)
        return np.asarray(np.sqrt(most.reshape(parts, -1).max(axis=0)))

    def _late(self, f: complex, tau: float) -> tuple[Array, Array, Array]:
        """N(-s tau)/N(s tau) = -1 + h (s tau - F)^-1 g before each input."""
        n, nu = self.B.shape[-2:]
        F, g, h = np.diag(np.ones(2), 1), np.zeros((3, 1)), np.array([[240.0, 0.0, 24.0]])
        F[-1], g[-1] = -THIRD, 1.0
        F, g, h = (np.kron(np.eye(nu), M) for M in (F, g, h))
        m = 3 * nu
        A = np.zeros((*self.A.shape[:2], n + m, n + m), dtype=complex)
        A[..., :n, :n], A[..., :n, n:] = self.A + f * self.B @ self.K, self.B @ h
        A[..., n:, :n], A[..., n:, n:] = -f * g @ self.K / tau, F / tau
        E = np.concatenate([self.E, np.zeros((*self.E.shape[:2], m, self.E.shape[-1]))], axis=2) + 0j
        C = np.concatenate([self.C + f * self.D @ self.at_nodes, self.D @ h], axis=2)
        return A, E, C
