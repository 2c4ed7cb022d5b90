"""Figures of merit of a linear law on the two carts, and the score that is made of them.

    score = clip((PM - 30)/5) + clip((GM - 6)/2) + clip((15 - ts)/3) + clip((r - 0.3)/0.05) + min(-20 log10(u)/3, 2)
            + clip((20 log10(k_max/k_min) - 12)/3) + 2 where no bracket is negative,   clip to +-2

PM [deg] and GM [dB] at the input, ts [s] of x2 after a blow on either cart, u [N] the largest input after one on the
second, k stable between, r: both masses and the stiffness off by any signs of r, stable.

Source   an example of the package cdmtb 0.2.4, after Manabe and Kim 2021, Section 4.3. Its settling times are of
         1/P and (s^2 + 1)/P with P = PLANT A + B and A(0) = 1, so that A(s) is left out: `of_the_program`
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import expm
from scipy.signal import impulse

from pliant.controllers import loop, margins
from pliant.controllers.analysis.linear_laws import LinearLaw, closed_matrix, readings_under_way
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.signals import rows_by_name

from .machine import AWAY, SETTLED, STIFFNESS, blown, model
from .published import PLANT, Published

Array = np.ndarray
LASTS = 60.0  # [s] that is looked at after a blow
FINE = 0.01  # [s] between the points of a law that acts at every time; also the steps of k and r
MOST = 4.0  # [N/m] stiffness that is tried
WIDE = 1.0  # r that is tried, at most
Models = Callable[[float], tuple[tuple[float, ...], ...]]


@dataclass(frozen=True)
class Merit:
    """Of one law. Where the nominal loop is unstable there are no figures: see `merit`."""

    decay: float  # [1/s] of the slowest pole
    settling: tuple[float, float]  # [s] from which on |x2| < 0.1 m, after a blow on the first cart, on the second
    peak: float  # [N] largest input after a blow on the second
    gain_margin: float  # [dB]
    phase_margin: float  # [deg]
    stiffness: tuple[float, float]  # [N/m] stable between, in steps of 0.01; 4 is as far as it was tried
    spread: float  # r, in steps of 0.01

    @property
    def meets(self) -> bool:
        """The first problem: at rest after 15 s, stable from 0.5 to 2 N/m, as far as steps of 0.01 tell."""
        low, high = self.stiffness
        return self.settling[1] <= SETTLED and low <= STIFFNESS[0] and high >= STIFFNESS[1]


def merit(law: LinearLaw) -> Merit:
    """PliantError where the nominal loop is not stable.

    Example
    -------
    >>> round(merit(PUBLISHED[-1].law).decay, 2)
    0.77
    """
    require_instance("merit.law", law, LinearLaw)
    input_ = margins(loop(model(), law)).channels[0]
    poles = np.linalg.eigvals(closed_matrix(plant(law), law))
    decay = -poles.real.max() if law.dt is None else -np.log(np.abs(poles).max()) / law.dt
    (_, first, _), (t, second, u) = played(law, 1), played(law, 2)
    return Merit(
        float(decay),
        (_settled(t, first), _settled(t, second)),
        float(np.abs(u).max()),
        float(20 * np.log10(min(max(g, 1 / g) for g in input_.gain if 0 < g < np.inf))),
        float(input_.phase_deg),
        (
            _last(law, -FINE, lambda k: ((1.0, 1.0, k),), 1.0, 0.0),
            _last(law, FINE, lambda k: ((1.0, 1.0, k),), 1.0, MOST),
        ),
        _last(law, FINE, _corners, 0.0, WIDE),
    )


def score(found: Merit, settling: tuple[float, float] | None = None) -> float:
    """The score, with other settling times [s] where they are given."""
    ts = max(found.settling if settling is None else settling)
    low, high = found.stiffness
    over = [
        (found.phase_margin - 30) / 5,
        (found.gain_margin - 6) / 2,
        (15 - ts) / 3,
        (found.spread - 0.3) / 0.05,
        (20 * np.log10(high / low) - 12) / 3,
    ]
    little = -20 * np.log10(found.peak) / 3
    bonus = 2.0 if min(*over, little) >= 0 else 0.0
    return float(np.clip(over, -2, 2).sum() + min(little, 2.0) + bonus)


def plant(law: LinearLaw, *parameters: float) -> tuple[Array, Array, Array, Array]:
    """(A, B, C, D) from the force to what the law reads, sampled where the law is. parameters: of `model`."""
    A, B, C, D = _matrices(law.reads, law.dt, parameters)
    A, B, C = readings_under_way(A, B, C, law.delay)
    return A, B, C, D


@lru_cache(maxsize=4096)
def _matrices(reads: tuple[str, ...], dt: float | None, parameters: tuple[float, ...]) -> tuple[Array, ...]:
    found = model(*parameters) if dt is None else model(*parameters).discretize(dt)
    return found.A, found.B, rows_by_name(found, reads).C, np.zeros((len(reads), 1))


def played(law: LinearLaw, cart: int) -> tuple[Array, Array, Array]:
    """t (n,) [s], x2 (n,) [m] and u (n,) [N] after a blow, without noise and limits."""
    A, _, C, _ = plant(law)
    step = closed_matrix(plant(law), law)
    dt = FINE if law.dt is None else law.dt
    if law.dt is None:
        step = expm(step * dt)
    z, seen, given = np.concatenate([blown(cart), np.zeros(len(step) - 4)]), [], []
    t = dt * np.arange(round(LASTS / dt))
    for _ in t:
        y = C @ z[: len(A)]
        given.append(-(law.C @ z[len(A) :] + law.D @ y)[0])
        seen.append(z[0] + z[1])
        z = step @ z
    return t, np.array(seen), np.array(given)


def of_the_program(law: Published) -> tuple[float, float]:
    """Settling times [s] as that program takes them; see the source."""
    P = np.convolve(PLANT, law.denominator) + np.concatenate([np.zeros(4), law.numerator])
    t = FINE * np.arange(round(LASTS / FINE))
    above = (1.0, 0.0, 1.0)
    first, second = (_settled(t, impulse((np.array(n) * law.denominator[-1], P), T=t)[1]) for n in ((1.0,), above))
    return first, second


def _settled(t: Array, x: Array) -> float:
    away = np.flatnonzero(np.abs(x) >= AWAY)
    return 0.0 if not len(away) else (float(t[away[-1] + 1]) if away[-1] + 1 < len(t) else np.inf)


def _corners(r: float) -> tuple[tuple[float, ...], ...]:
    return tuple(itertools.product((1 - r, 1 + r), repeat=3))


def _last(law: LinearLaw, step: float, models: Models, first: float, end: float) -> float:
    """The last value, from `first` on in steps, at which all models are stable."""
    count = round(abs(end - first) / FINE)
    for i in range(1, count):
        value = round(first + i * step, 6)
        if not all(_stable(law, *p) for p in models(value)):
            return round(value - step, 6)
    return end


def _stable(law: LinearLaw, mass1: float, mass2: float, stiffness: float) -> bool:
    poles = np.linalg.eigvals(closed_matrix(plant(law, mass1, mass2, stiffness), law))
    return bool((poles.real < 0).all() if law.dt is None else (np.abs(poles) < 1).all())
