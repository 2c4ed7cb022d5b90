"""Floquet modes in what is measured: y_k(t) = C(t) p_k(t), periodic, of the motion e^(sigma t) p_k(t).

A mode of a periodic machine is no shape but a periodic one; its harmonics say at which frequencies it is seen:
Im sigma + m W, W = 2 pi/period.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_instance
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.ltv import LTVModel, splined
from pliant.plants.stability.floquet import Floquet

Array = np.ndarray
LEAST_POINTS, MOST_POINTS = 128, 4096  # of a shape


@dataclass(frozen=True, eq=False)
class OutputMode(OwnsArrays):
    """Of one multiplier, the largest component of the largest output 1 at its time."""

    exponent: complex  # [1/s]
    t: Array = field(repr=False)  # (m + 1,) [s] over a period
    y: Array = field(repr=False)  # (m + 1, ny) complex: periodic shape of each output
    outputs: tuple[str, ...]
    frequencies: Array = field(repr=False)  # (m,) [rad/s] |Im sigma + m W|, and ..
    shares: Array = field(repr=False)  # .. (m, ny) sizes of the harmonics there

    def __getitem__(self, name: str) -> Array:
        """The shape (m + 1,) of an output."""
        return np.asarray(self.y[:, self.outputs.index(name)])

    @property
    def strongest(self) -> float:
        """Frequency [rad/s] at which the mode is seen most."""
        return float(self.frequencies[int(self.shares.sum(axis=1).argmax())])


def output_mode(model: LTVModel, cycle: Floquet, k: int) -> OutputMode:
    """Mode k of `stability.floquet(model)` in the model's outputs; largest multiplier first.

    ValueError where the outputs see states that `cycle` has left out.
    """
    require_instance("output_mode.model", model, LTVModel)
    require_instance("output_mode.cycle", cycle, Floquet)
    k = require_count("output_mode", "k", k, 0, len(cycle.multipliers) - 1)
    kept = [model.state_names.index(name) for name in cycle.states]
    seen = np.abs(model.C).max(axis=0, initial=0.0)
    rows = [i for i in range(seen.shape[0]) if not np.delete(seen[i], kept).any()]
    if not rows:
        raise ValueError("output_mode.cycle has left out states that every output sees")
    p = _shape(cycle, k, len(model.t))
    t = np.linspace(cycle.path.t[0], cycle.path.t[0] + cycle.period, len(p))
    C = splined(model.t, model.C[:, rows][:, :, kept], np.minimum(t, model.t[-1]))
    y = np.einsum("tij,tj->ti", C, p)
    size = y.ravel()[np.abs(y).argmax()]
    y = y / size if size else y
    harmonics = np.fft.fft(y[:-1], axis=0) / (len(y) - 1)
    turns = np.fft.fftfreq(len(y) - 1, 1 / (len(y) - 1))
    sigma = complex(cycle.exponents[k])
    names = tuple(model.outputs[i].name for i in rows)
    return OutputMode(sigma, t, y, names, np.abs(sigma.imag + turns * 2 * np.pi / cycle.period), np.abs(harmonics))


def _shape(cycle: Floquet, k: int, nodes: int) -> Array:
    """p_k (m + 1, nx) at equidistant times, enough for what C does between the nodes too."""
    if len(cycle.paths) > 1:
        raise ValueError(f"output_mode.cycle: the period has {len(cycle.paths)} pieces, must be one")
    few = min(max(LEAST_POINTS, 1 << (2 * max(cycle.steps, nodes) - 1).bit_length()), MOST_POINTS)
    edges = np.linspace(cycle.path.t[0], cycle.path.t[0] + cycle.period, few + 1)
    found = [cycle.modes[:, k] / cycle.path.scale]
    for Phi in cycle.path.between(edges, max(1, -(-cycle.steps // few))):
        found.append(Phi @ found[-1])
    return np.array(found) * cycle.path.scale * np.exp(-cycle.exponents[k] * (edges - edges[0]))[:, None]
