"""What every Riccati design checks first: shapes, definite weights, and modes that are out of reach."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import LARGEST, require_finite, require_names, shown
from pliant.plants.core.errors import UncontrollableError
from pliant.plants.linear.modal_analysis import dominant, eigen, stays

ROUNDING = 1e-13  # of the largest entry of a weight
UNREACHED = 1e-10  # least singular value of [A - s I, B] over |A - s I| of a mode that is not reached


def sized(name: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """require_finite, with entries up to LARGEST: products of larger ones are no numbers."""
    found: np.ndarray = require_finite(name, value, shape)
    if np.abs(found).max(initial=0.0) > LARGEST:
        raise ValueError(f"{name} = {shown(value)} must be at most {LARGEST:g} in size")
    return found


def require_reached(
    A: np.ndarray, B: np.ndarray, names: tuple[str, ...], dt: float | None, what: str, dual: bool = False
) -> None:
    """UncontrollableError that names every mode of A that neither decays nor is reached through B, both in even units.

    With `dual`, A and B are the transposes of the dynamics and of what sees them. Balancing A again would push what
    only drives (the plant of an integrator) ever further from what it drives, and B with it.
    """
    lam, _, vectors, rounding = eigen(A, balance=False)
    found: dict[str, None] = {}
    for s in lam[stays(lam, rounding, dt) & (lam.imag >= 0)]:
        shifted = A - s * np.eye(len(A))
        size = np.linalg.norm(shifted) or 1.0
        gain = np.linalg.norm(B)
        left, sigma, _ = np.linalg.svd(np.hstack([shifted, B * (size / gain if gain else 0.0)]))
        if sigma[-1] > UNREACHED * size:
            continue
        rate = s if dt is None else np.log(complex(s)) / dt
        missed = left[:, sigma <= UNREACHED * size]
        pivots = sla.qr(missed.conj().T, mode="r", pivoting=True)[1][: missed.shape[1]]
        for z in (missed @ np.linalg.inv(missed[pivots])).T:
            state = names[_state_of(z, z if dual else shifted @ z, vectors[:, np.abs(lam - s) <= 1e-6 * size])]
            found[f"mode {abs(rate) / (2 * np.pi):.2f} Hz ({state})"] = None
    if found:
        raise UncontrollableError(f"{', '.join(found)} {what}", tuple(found))


def columns_even(B: np.ndarray) -> np.ndarray:
    """B (nx, nu) with columns of length one: what an input reaches does not depend on its unit."""
    length = np.linalg.norm(B, axis=0)
    return np.asarray(B / np.where(length > 0, length, 1.0))


def _state_of(z: np.ndarray, position: np.ndarray, right: np.ndarray) -> int:
    """The state that takes part most in the mode with left eigenvector z; `right` (nx, k) are its right ones.

    A double root without a second eigenvector is a free body: then z is not its own, and `position` is named.
    """
    spread = np.linalg.norm(right, axis=1)
    if (np.abs(z) * spread).sum() < 1e-6 * np.linalg.norm(z):
        return int(np.argmax(np.abs(position) * (spread if np.any(np.abs(position) * spread > 0) else 1.0)))
    return dominant(z, spread)


def system(A: Any, B: Any, name: str = "B") -> tuple[np.ndarray, np.ndarray]:
    A = require_finite("A", A, (-1, -1))
    A = sized("A", A, (len(A), len(A)))
    return A, sized(name, B, (len(A), -1))


def known_names(names: Sequence[str] | None, n: int) -> tuple[str, ...]:
    known = tuple(f"x{i + 1}" for i in range(n)) if names is None else require_names("names", names)
    if len(known) != n:
        raise ValueError(f"names = {known} must be {n} names")
    return known


def weight_matrix(name: str, value: Any, n: int, *, definite: bool) -> np.ndarray:
    """A symmetric weight (n, n), positive (semi)definite in any units; see `indefinite`."""
    weight = sized(name, value, (n, n))
    unit, off = _own_units(weight), np.abs(weight - weight.T)
    rounding = ROUNDING * np.abs(weight).max(initial=0.0)
    skew = off > np.maximum(1e-9 * unit[:, None] * unit, rounding)
    if skew.any():
        i, j = np.unravel_index(np.argmax(np.where(skew, off, 0.0)), weight.shape)
        raise ValueError(f"{name}[{i}, {j}] = {weight[i, j]:g} must equal {name}[{j}, {i}], {weight[j, i]:g}")
    weight = (weight + weight.T) / 2
    least = np.linalg.eigvalsh(weight / unit[:, None] / unit).min(initial=np.inf)
    lowest = np.linalg.eigvalsh(weight).min(initial=np.inf)
    said = f"{lowest:.4g}" if np.sign(lowest) == np.sign(least) else f"{least:.4g} with a diagonal of ones"
    if definite and not (least > 0 and (np.diagonal(weight) > 0).all()):
        raise ValueError(f"{name} has eigenvalue {said}, must be > 0 (positive definite)")
    alone = np.abs(weight).sum(axis=0) == -np.diagonal(weight)  # no difference of larger ones: meant
    if indefinite(weight, 1e-10) or (alone & (np.diagonal(weight) < 0)).any():
        raise ValueError(f"{name} has eigenvalue {said}, must be >= 0 (positive semidefinite)")
    return weight


def indefinite(weight: np.ndarray, tolerance: float) -> np.ndarray:
    """Whether a symmetric weight (.., n, n) has an eigenvalue below -tolerance once its diagonal is ones.

    What is rounding of its largest entry is none: so small an entry may be the rest of a difference.
    """
    unit = _own_units(weight)
    least = np.linalg.eigvalsh(weight / unit[..., :, None] / unit[..., None, :]).min(axis=-1, initial=np.inf)
    lowest = np.linalg.eigvalsh(weight).min(axis=-1, initial=np.inf)
    size = np.abs(weight).max(axis=(-1, -2), initial=0.0)
    return np.asarray((least < -tolerance) & (lowest < -ROUNDING * size))


def _own_units(weight: np.ndarray) -> np.ndarray:
    """Roots (.., n) of the diagonal; of the largest entry where that is not positive."""
    own = np.diagonal(weight, axis1=-2, axis2=-1)
    size = np.abs(weight).max(axis=(-1, -2), initial=0.0)[..., None]
    return np.asarray(np.sqrt(np.where(own > 0, own, np.where(size > 0, size, 1.0))))
