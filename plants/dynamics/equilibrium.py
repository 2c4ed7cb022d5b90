"""Rest points: states and inputs at which nothing changes, by Newton's method with minimum-norm steps."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.argument_gates import require_by_name
from pliant.plants.core.errors import EquilibriumError, UnstableRestWarning
from pliant.plants.core.signals import index

if TYPE_CHECKING:
    from .plant import Plant

TOLERANCE = 1e-10  # relative to the rates that each unknown can cause
STEP = 1e-6  # of an unknown or of SMALL: a Newton step beyond it means that very stiff terms hide the others' residual
SMALL = 1e-3


def find(
    plant: Plant, fixed: Mapping[str, float], named: Mapping[str, float], guess: Mapping[str, float], p: Any
) -> tuple[np.ndarray, np.ndarray]:
    """Solve f(x, u) = 0 with the named signals held. Unknown: every other state, and the inputs when enough is held."""
    names = tuple(s.name for s in plant.states + plant.inputs)
    signals = plant.states + plant.inputs
    z = np.zeros(len(names))
    held = np.zeros(len(names), dtype=bool)
    for kind, source in (("guess", guess), ("fixed", fixed), ("named", named)):
        for name, value in require_by_name(f"equilibrium.{kind}", source).items():
            i = index(signals, name, "state or input")
            z[i] = value
            held[i] |= kind != "guess"
    nx, fixed = plant.nx, {**fixed, **named}
    if held[:nx].sum() < plant.nu:
        held[nx:] = True  # too few states are given to determine the inputs: they stay as given, or zero

    free = np.flatnonzero(~held)
    scale, step = 1.0, 0.0
    for _ in range(100):
        at = z[:nx]
        J, residual = plant.rest_slopes(at, z[nx:], p)[:, free], plant.rest_forces(at, z[nx:], at, p)
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
            moved = plant.rest_forces(trial[:nx], trial[nx:], at, p)  # not finite where the step was too long
            if np.linalg.norm(moved / scale) < best:
                break
            length /= 2
        else:
            break
        z, residual = trial, moved
    worst = float(np.max(np.abs(residual) / scale))
    rate = plant.dynamics(z[:nx], z[nx:], p=p)  # raises where the equations have lost their meaning
    if not (worst < TOLERANCE and step < STEP):
        k = int(np.argmax(np.abs(rate)))
        raise EquilibriumError(
            f"no equilibrium of {plant.label} with {dict(fixed)} held: d({names[k]})/dt = {rate[k]:.3g} remains; "
            "hold as many coordinates as there are inputs, or give a closer guess",
            float(np.max(np.abs(rate))),
        )
    return z[:nx], z[nx:]


def tell_unstable(plant: Plant, x0: np.ndarray, u0: np.ndarray, p: Any) -> None:
    """Warn (UnstableRestWarning) where an eigenvalue at rest has a positive real part beyond its own error.

    The error is what rounding of A can do to a simple eigenvalue, n eps |A| / |y^H x| with the left and right vectors y
    and x of length one (Golub and Van Loan, "Matrix Computations", 7.2.2). Roots that are nearly multiple have large
    errors: of them nothing is said.
    """
    A = plant.at_rest(x0, u0, p)
    roots, right = np.linalg.eig(A)
    try:
        left = np.linalg.inv(right)
    except np.linalg.LinAlgError:
        return
    k = int(np.argmax(roots.real))
    with np.errstate(over="ignore"):  # a vector beside a nearly equal one
        size = np.linalg.norm(right[:, k]) * np.linalg.norm(left[k])
    error = len(A) * np.finfo(float).eps * np.linalg.norm(A) * size
    if roots[k].real > 10 * error:
        most = plant.states[int(np.argmax(np.abs(right[:, k])))]
        warnings.warn(
            f"the rest point of {plant.label} is unstable: with the inputs held, small deviations grow by "
            f"exp({roots[k].real:.3g} t), most in {most.name}; a feedback must hold it, or another guess finds another",
            UnstableRestWarning,
            stacklevel=4,
        )
