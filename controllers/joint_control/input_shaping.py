"""Command shaping for lightly damped modes: a command convolved with a few impulses leaves no vibration behind.

Impulses A_i at t_i, sum A_i = 1. A mode (natural frequency w, damping ratio z) keeps, of the vibration that one unit
impulse would leave, the share (Singer and Seering 1990, "Preshaping command inputs to reduce system vibration", Eq 8)

    V(w, z) = e^(-z w t_n) | sum A_i e^((z w + j w sqrt(1 - z^2)) t_i) |

zv    V = 0 at the model, 2 impulses, half a period long
zvd   and dV/dw = 0, 3 impulses, one period
zvdd  and the second derivative, 4 impulses, one and a half
ei    V = `tolerance` at the model and 0 at one frequency on either side, 3 impulses, about one period
      (Singhose, Seering and Singer 1994, "Residual vibration reduction using vector diagrams")

Several modes: the shapers one after the other, which is the convolution of their impulses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from math import comb, exp, pi, sqrt
from typing import TYPE_CHECKING, Any, final

import numpy as np
from scipy.optimize import least_squares

from pliant.controllers.base.controller import share
from pliant.plants.core.argument_gates import (
    finite_array,
    in_order,
    real_array,
    require_choice,
    require_count,
    require_function,
    require_instance,
    require_number,
    shown,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, read_only
from pliant.plants.linear import modal_analysis

if TYPE_CHECKING:
    from pliant.plants.linear.lti import LinearModel
    from pliant.plants.linear.modal_analysis import Mode

KINDS = ("zv", "zvd", "zvdd", "ei")
Command = Callable[[float], Any]
LIGHT = 0.2  # damping ratio below which a mode is shaped for
NYQUIST = np.pi * (1 - 1e-9)  # angle a period: at pi, z < 0, nothing tells a frequency
EI_STEPS = 0.02  # of the damping ratio, from the undamped shaper on


@final
@dataclass(frozen=True, eq=False)
class Shaper(OwnsArrays):
    """Impulses; `shaper(command)` is the shaped command, a function of time."""

    times: np.ndarray  # (n,) [s], ascending from 0
    amplitudes: np.ndarray  # (n,), sum 1

    def __post_init__(self) -> None:
        times = read_only("Shaper.times", self.times, (-1,))
        amplitudes = read_only("Shaper.amplitudes", self.amplitudes, (len(times),))
        if not len(times) or times[0] != 0 or (np.diff(times) <= 0).any():
            raise ValueError(f"Shaper.times = {times} must start at 0 and increase")
        if not abs(amplitudes.sum() - 1) < 1e-9:
            raise ValueError(f"Shaper.amplitudes = {amplitudes} sum to {amplitudes.sum():g}, must sum to 1")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "amplitudes", amplitudes)

    @property
    def duration(self) -> float:
        """How much later a shaped command ends [s]."""
        return float(self.times[-1])

    def __call__(self, command: Command) -> Command:
        """sum A_i command(t - t_i); `command` holds its first value before 0 and its last after its end."""
        require_function("Shaper.command", command)
        impulses = list(zip(self.times.tolist(), self.amplitudes.tolist()))
        return lambda t: sum(a * finite_array("Shaper.command(t)", command(t - s)) for s, a in impulses)

    def __mul__(self, other: Shaper) -> Shaper:
        """One after the other; impulses at the same time become one."""
        times = (self.times[:, None] + other.times).ravel()
        amplitudes = np.outer(self.amplitudes, other.amplitudes).ravel()
        order = np.argsort(times, kind="stable")
        times, amplitudes = times[order], amplitudes[order]
        fresh = np.append(True, np.diff(times) > 1e-12 * max(1.0, times[-1]))
        return Shaper(times[fresh], np.bincount(np.cumsum(fresh) - 1, weights=amplitudes))

    def residual(self, frequency: Any, damping: float = 0.0) -> Any:
        """V [-] at natural frequencies [rad/s], a number or (m,), of a damping ratio [-]: the sensitivity curve.

        ValueError where a frequency is negative or not finite.
        """
        w, damping = real_array("Shaper.residual: frequency", frequency), share("shaper.damping", damping)
        if not np.isfinite(w).all() or (w < 0).any():
            raise ValueError(f"Shaper.residual: frequency = {shown(frequency)} must be finite and >= 0 [rad/s]")
        rate = damping * (self.times - self.times[-1]) + 1j * sqrt(1 - damping**2) * self.times
        found = np.abs((self.amplitudes * np.exp(w[..., None] * rate)).sum(axis=-1))
        return found if w.ndim else float(found)


def shaper(frequency: float, damping: float = 0.0, kind: str = "zvd", *, tolerance: float = 0.05) -> Shaper:
    """For one mode: natural frequency [rad/s], damping ratio in [0, 1); `tolerance` is V at the model of "ei"."""
    require_choice("shaper", "kind", kind, KINDS)
    frequency = require_number("shaper.frequency", frequency, "positive", "rad/s")
    damping, tolerance = share("shaper.damping", damping), _allowed(tolerance)
    half = pi / (frequency * sqrt(1 - damping**2))
    if kind == "ei":
        times, amplitudes = _extra_insensitive(damping, tolerance)
        return Shaper(times / frequency, amplitudes)
    n = KINDS.index(kind) + 1
    fade = exp(-damping * pi / sqrt(1 - damping**2))
    amplitudes = np.array([comb(n, i) * fade**i for i in range(n + 1)]) / (1 + fade) ** n
    return Shaper(half * np.arange(n + 1), amplitudes)


def shape(
    command: Command, modes: LinearModel | Iterable[Mode | float], kind: str = "zvd", *, tolerance: float = 0.05
) -> Command:
    """The command (a function of t [s]) that leaves none of the modes vibrating; see `shaper_for`.
    tolerance: what "ei" may leave, as a share of what an unshaped command leaves [-].

    Example
    -------
    >>> quiet = shape(lambda t: np.array([1.0]), [10.0])
    >>> quiet(0.0)
    array([1.])
    """
    require_function("shape.command", command)
    return shaper_for(modes, kind, tolerance=tolerance)(command)


def shaper_for(
    modes: LinearModel | Iterable[Mode | float],
    kind: str = "zvd",
    *,
    tolerance: float = 0.05,
    most: int | None = None,
) -> Shaper:
    """One shaper for several modes: frequencies [rad/s], a model's Modes, or the lightly damped ones of a model.

    Of a model, sampled or not, those count that oscillate with a damping ratio below 0.2; the `most` slowest where
    given. A sampled model shows what oscillates faster than half its sampling rate at a lower frequency: take the
    continuous model where it has such modes. ValueError where none is damped so lightly. tolerance [-]: what "ei" may
    leave.

    Example
    -------
    >>> round(shaper_for([10.0], "zv").duration, 4)
    0.3142
    """
    if most is not None:
        most = require_count("shaper_for", "most", most, 1, 1000)
    require_choice("shaper_for", "kind", kind, KINDS)
    tolerance = _allowed(tolerance)
    if hasattr(modes, "eigenvalues") and hasattr(modes, "modes") and hasattr(modes, "dt"):
        values = modal_analysis.rates(modes.eigenvalues, modes.dt)
        values = values[values.imag * (modes.dt or 0.0) < NYQUIST]
        modes = light(values, most)
        if not modes:
            raise ValueError(f"shaper_for.modes must hold at least one mode that oscillates{_too_damped(values)}")
    else:
        modes = in_order("shaper_for.modes", modes, "a linear model, or a sequence of modes or frequencies")
    found = [_read(mode) for mode in modes]
    if not found:
        raise ValueError("shaper_for.modes must hold at least one mode that oscillates")
    return reduce(Shaper.__mul__, (shaper(w, z, kind, tolerance=tolerance) for w, z in found))


def light(eigenvalues: Any, most: int | None = None) -> list[Any]:
    """The lightly damped of a model's eigenvalues [1/s], slowest first; each stands for its pair."""
    values = np.asarray(eigenvalues, dtype=complex)
    size = np.abs(values).max(initial=0.0)
    shaking = values[(values.imag > 1e-6 * size) & (-values.real < LIGHT * np.abs(values))]
    return sorted(shaking, key=abs)[:most]


def _too_damped(values: np.ndarray) -> str:
    """Why no eigenvalue [1/s] of a model is shaped for: the least damping ratio of those that oscillate, or no word."""
    swinging = values[values.imag > 1e-6 * np.abs(values)]
    if not swinging.size:
        return ""
    least = float((-swinging.real / np.abs(swinging)).min())
    return f" with a damping ratio below {LIGHT}; the least of this model is {least:.3g}: give its modes to shape them"


def _read(mode: Any) -> tuple[float, float]:
    """(natural frequency, damping ratio) of a Mode, an eigenvalue or a frequency [rad/s]."""
    value = getattr(mode, "eigenvalue", mode)
    if isinstance(value, (complex, np.complexfloating)):
        if not np.isfinite(value):
            raise ValueError(f"shaper_for.modes: {shown(mode)} must be finite")
        value = complex(value)
        size = abs(value)
        if value.real > 1e-9 * size:
            raise ValueError(f"shaper_for.modes: a mode grows at {value.real:.3g} 1/s; no command can calm it")
        return float(size), max(0.0, float(-value.real / size))
    return require_number("shaper_for.modes: frequency", value, "positive", "rad/s"), 0.0


def _allowed(tolerance: Any) -> float:
    found = require_number("shaper.tolerance", tolerance)
    if not 0 < found < 1:
        raise ValueError(f"shaper.tolerance = {found!r} must be > 0 and < 1")
    return found


def _extra_insensitive(damping: float, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Times [rad of the natural frequency] and amplitudes, from the undamped closed form on by continuation.

    Unknowns A_1, A_2, t_2, t_3 and the two frequencies w_lo, w_hi where V = 0 (A_3 = 1 - A_1 - A_2); equations:
    V = 0 there (complex, 4), V = tolerance and dV/dw = 0 at the model.
    """
    hump = float(np.arccos((1 - tolerance) / (1 + tolerance))) / pi  # cos(pi w) = -(1 - V) / (1 + V) at the zeros
    z = np.array([(1 + tolerance) / 4, (1 - tolerance) / 2, pi, 2 * pi, 1 - hump, 1 + hump])
    steps = np.linspace(0.0, damping, 1 + int(np.ceil(damping / EI_STEPS)))
    for start, ratio in zip([0.0, *steps], steps):
        found = least_squares(_conditions, z, args=(float(ratio), tolerance), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        if not np.abs(found.fun).max() < 1e-9:
            raise PliantError(
                f'no "ei" shaper found for damping ratio {ratio:.3g} (from {start:.3g}) and tolerance {tolerance:g}: '
                'use "zvd"'
            )
        z = found.x
    return np.array([0.0, z[2], z[3]]), np.array([z[0], z[1], 1 - z[0] - z[1]])


def _conditions(z: np.ndarray, damping: float, tolerance: float) -> list[float]:
    a = np.array([z[0], z[1], 1 - z[0] - z[1]])
    t = np.array([0.0, z[2], z[3]])
    rate = damping * (t - t[-1]) + 1j * sqrt(1 - damping**2) * t

    def sums(w: float) -> tuple[complex, complex]:
        """The sum in V, before its modulus, and its derivative over w."""
        terms = a * np.exp(w * rate)
        return terms.sum(), (terms * rate).sum()

    (low, _), (high, _), (mid, change) = sums(z[4]), sums(z[5]), sums(1.0)
    stationary = (mid.conjugate() * change).real
    return [low.real, low.imag, high.real, high.imag, abs(mid) - tolerance, stationary]


def switches(command: Sequence[tuple[float, Any]], by: Shaper) -> list[tuple[float, np.ndarray]]:
    """A command of steps [(time, value from then on), ..] shaped: again steps, the times in order.

    The first value holds before its time too. Held exactly, such a command needs no small steps.
    """
    require_instance("switches.by", by, Shaper)
    command = _steps(command)
    jumps = [command[0]]
    jumps += [(t, v - u) for (_, u), (t, v) in pairwise(command)]
    spread = sorted(
        ((t + s, a * jump) for t, jump in jumps[1:] for s, a in zip(by.times, by.amplitudes)), key=lambda pair: pair[0]
    )
    value, found = jumps[0][1], [jumps[0]]
    for t, jump in spread:
        value = value + jump
        found.append((float(t), value))
    return found


def _steps(command: Any) -> list[tuple[float, np.ndarray]]:
    """Pairs (time, value), the times in order, the values of one shape."""
    if not isinstance(command, (tuple, list)) or not command:
        raise ValueError(f"switches.command = {shown(command)} must be pairs (time [s], value)")
    found: list[tuple[float, np.ndarray]] = []
    for i, pair in enumerate(command):
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise ValueError(f"switches.command[{i}] = {shown(pair)} must be a pair (time [s], value)")
        t, value = (
            require_number(f"switches.command[{i}] time", pair[0], unit="s"),
            real_array("switches.command", pair[1]),
        )
        if not np.isfinite(value).all() or (found and (value.shape != found[0][1].shape or t < found[-1][0])):
            raise ValueError(
                f"switches.command[{i}] = {shown(pair)} must be finite, of the first's shape, and not before"
            )
        found.append((t, value))
    return found
