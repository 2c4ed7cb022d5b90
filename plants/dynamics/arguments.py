"""The arguments (t, x, u, w, p) of a plant's functions: defaults, shapes, finiteness, batch size."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from math import isfinite
from typing import Any, TypeVar

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_count, require_finite
from pliant.plants.core.errors import NotFiniteWarning
from pliant.plants.core.parameters import require_allowed
from pliant.plants.core.plant_protocol import Arguments

from .declaration import Declaration

R = TypeVar("R", bound=Sequence[Any])
FLOAT = np.dtype(float)
MOST_POINTS = 100_000


def checked(plant: Declaration, x: Any, u: Any, w: Any, p: Any, t: Any) -> Arguments:
    """(t, x, u, w, p) and the batch size B, None for one point; each (n,) or (B, n).

    u and w are zero and p the plant's own values where None. ValueError names the argument, its index and its signal.
    """
    plain = w is None and p is None and type(t) is float and type(x) is type(u) is np.ndarray
    plain = plain and x.dtype == FLOAT and u.dtype == FLOAT and x.shape == (plant.nx,) and u.shape == (plant.nu,)
    if plain and isfinite(t + x.sum() + u.sum()):
        return (t, x, u, *plant.quiet), None
    default = (None, None, np.zeros(plant.nu), np.zeros(plant.nw), plant.nominal_parameters)
    time = require_times(plant, t)
    values, batch = [time.reshape(-1, 1) if time.ndim else time[None]], len(time) if time.ndim else None
    sizes = (plant.nx, plant.nu, plant.nw, len(plant.varied))
    for i, (name, value, size) in enumerate(zip("xuwp", (x, u, w, p), sizes), start=1):
        array = real_array(f"{type(plant).__name__}.{name}", default[i] if value is None else value)
        if array.ndim not in (1, 2) or array.shape[-1] != size:
            owner = f"{type(plant).__name__}.{name}"
            raise ValueError(f"{owner} has shape {array.shape}, must be ({size},) or (B, {size})")
        if not np.isfinite(array).all():
            k = int(np.argwhere(~np.isfinite(array))[0][-1])
            bad = array[..., k][~np.isfinite(array[..., k])].flat[0]
            named = (plant.states, plant.inputs, plant.disturbances, plant.parameters)[i - 1]
            raise ValueError(f"{type(plant).__name__}.{name}[{k}] ({named[k].name}) = {bad} must be finite")
        if name == "p" and value is not None:
            require_allowed(f"{type(plant).__name__}.p", array, plant)
        if array.ndim == 2:
            if batch not in (None, len(array)):
                raise ValueError(f"{type(plant).__name__}.{name} has {len(array)} rows, must have {batch}")
            batch = len(array)
        values.append(array)
    return tuple(values), batch


def require_times(plant: Declaration, t: Any) -> np.ndarray:
    """t [s], () or (B,), finite."""
    time = real_array(f"{type(plant).__name__}.t", t)
    if time.ndim > 1 or not time.size:
        raise ValueError(f"{type(plant).__name__}.t has shape {time.shape}, must be a number or (B,) [s]")
    return require_finite(f"{type(plant).__name__}.t", time, time.shape)


def one_state(plant: Declaration, x: Any) -> np.ndarray:
    """x (nx,) of one point."""
    return require_finite(f"{type(plant).__name__}.x", x, (plant.nx,))


def line_points(plant: Declaration, points: Any) -> int:
    """How many points a body is drawn by."""
    return require_count(f"{type(plant).__name__}.outline", "points", points, 2, MOST_POINTS)


def told(plant: Declaration, name: str, results: R, x: Any) -> R:
    """The results; warns (NotFiniteWarning) where those at states x hold NaN or infinity, and at which row."""
    for k, result in enumerate(results):
        if isfinite(np.add.reduce(result, axis=None)):
            continue  # a sum is one pass; that of finite numbers may still overflow, so that the entries decide
        bad = np.argwhere(~np.isfinite(np.atleast_1d(result)))
        if len(bad):
            where, rows = tuple(int(i) for i in bad[0]), np.asarray(x)
            at = rows[where[0]] if rows.ndim == 2 else rows
            value = np.atleast_1d(result)[where]
            count = f"{len(bad)} of {np.size(result)} entries are not finite"
            first = f"result {k}, " if len(results) > 1 else ""
            warnings.warn(
                f"{type(plant).__name__}.{name}: {count}, first {first}{list(where)} = {value}, at x = {at}",
                NotFiniteWarning,
                stacklevel=3,
            )
            break
    return results
