"""Rest points: states and inputs at which nothing changes, by Newton's method with minimum-norm steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.errors import EquilibriumError
from pliant.plants.core.signals import index

if TYPE_CHECKING:
    from .plant import Plant

TOLERANCE = 1e-10  # relative to the rates that each unknown can cause
STEP = 1e-6  # of an unknown or of SMALL: a Newton step beyond it means that very stiff terms hide the others' residual
SMALL = 1e-3


def find(plant: Plant, fixed: Mapping[str, float], guess: Mapping[str, float], p: Any) -> tuple[np.ndarray, np.ndarray]:
    """Solve f(x, u) = 0 with the named signals held. Unknown: every other state, and the inputs when enough is held."""
    names = tuple(s.name for s in plant.states + plant.inputs)
    signals = plant.states + plant.inputs
    z = np.zeros(len(names))
    held = np.zeros(len(names), dtype=bool)
    for source, hold in ((guess, False), (fixed, True)):
        for name, value in source.items():
            i = index(signals, name, "state or input")
            if not np.isfinite(value):
                raise ValueError(f"equilibrium {name} = {value} must be finite")
            z[i] = value
            held[i] |= hold
    nx = plant.nx
    if held[:nx].sum() < plant.nu:
        held[nx:] = True  # too few states are given to determine the inputs: they stay as given, or zero

    free = np.flatnonzero(~held)
    scale, step = 1.0, 0.0
    residual = plant.dynamics(z[:nx], z[nx:], p=p)
    for _ in range(100):
        A, B = plant.jacobians(z[:nx], z[nx:], p=p)[:2]
        at = z[:nx]
        J = plant.rest_residual(at, np.hstack([A, B])[:, free], p)
        residual = plant.rest_residual(at, residual, p)
        size = np.maximum(np.abs(z[free]), SMALL)
        scale = np.maximum(np.abs(J) @ size, 1e-3)
        change = np.linalg.lstsq(J / scale[:, None], -residual / scale, rcond=1e-12)[0]
        step = float(np.max(np.abs(change) / size, initial=0.0))
        if np.max(np.abs(residual) / scale) < TOLERANCE * 1e-2 and step < STEP:
            break
        length, best = 1.0, float(np.linalg.norm(residual / scale))
        while length > 1e-6:
            trial = z.copy()
            trial[free] += length * change
            moved = plant.dynamics(trial[:nx], trial[nx:], p=p)
            if np.linalg.norm(plant.rest_residual(at, moved, p) / scale) < best:
                break
            length /= 2
        else:
            break
        z, residual = trial, moved
    worst = float(np.max(np.abs(residual) / scale))
    if not (worst < TOLERANCE and step < STEP):
        rate = plant.dynamics(z[:nx], z[nx:], p=p)
        k = int(np.argmax(np.abs(rate)))
        raise EquilibriumError(
            f"no equilibrium of {plant.label} with {dict(fixed)} held: d({names[k]})/dt = {rate[k]:.3g} remains; "
            "hold as many coordinates as there are inputs, or give a closer guess",
            float(np.max(np.abs(rate))),
        )
    return z[:nx], z[nx:]
