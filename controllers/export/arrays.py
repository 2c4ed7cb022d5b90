"""Controllers, filters and linear models as named arrays: .npz for NumPy, .mat for MATLAB and Octave."""

from __future__ import annotations

import dataclasses
import io
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from pliant.controllers.analysis.linear_laws import law_of
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import names
from pliant.plants.files.atomic_files import require_path, write_bytes
from pliant.plants.linear.lti import LinearModel

LONGEST = 31  # characters of a variable's name in a .mat file


def arrays_of(what: Any) -> dict[str, Any]:
    """{name: array} of a LinearModel (A .. F, x0, u0, y0, names), or of a controller: its linear form A, B, C, D in
    u = -(C s + D y), s' = A s + B y where it has one, and its own arrays; `dt` = 0 where it is continuous.

    Example
    -------
    >>> arrays_of(LQR.for_scene(scene))["K"].shape
    (2, 12)
    """
    found: dict[str, Any] = {}
    if isinstance(what, LinearModel):
        found = {name: getattr(what, name) for name in ("A", "B", "E", "C", "D", "F", "x0", "u0", "w0", "y0", "f0")}
        for kind in ("states", "inputs", "disturbances", "outputs"):
            found[kind] = np.array(names(getattr(what, kind)), dtype=object)
    elif isinstance(what, Kalman):
        step, gain = what.steps[-1], what.gains[-1]
        found = {name: getattr(step, name) for name in ("A", "B", "C", "D")} | {"L": gain.L, "P": gain.P, "S": gain.S}
        found |= {"x0": what.x0[-1], "u0": what.u0[-1], "y0": what.y0[-1]}
    else:
        with suppress(PliantError):  # what has no linear form may have arrays
            law = law_of(what)
            found = {name: getattr(law, name) for name in ("A", "B", "C", "D")}
        if isinstance(what, LQG):
            inside = arrays_of(what.law) | {f"filter_{k}": v for k, v in arrays_of(what.filter).items()}
            found |= {k if k.startswith("filter_") else f"law_{k}": v for k, v in inside.items()}
        elif dataclasses.is_dataclass(what):
            found |= _fields(what, set(found))
        if not found:
            raise ValueError(f"arrays_of.what: {type(what).__name__} has no linear form and no arrays of its own")
        if hasattr(what, "reads"):
            found["reads"] = np.array(tuple(what.reads), dtype=object)
    dt = getattr(what, "dt", None)
    return found | {"dt": float(dt) if dt is not None else 0.0}


def export_arrays(what: Any, path: str | Path) -> Path:
    """Write `arrays_of(what)` to a .mat file (version 5) or a .npz file of arrays, names as text; the path.

    Example
    -------
    >>> export_arrays(plant.linearize(x0, u0), "craft.mat")
    """
    target = require_path("export_arrays.path", path)
    if target.suffix not in (".mat", ".npz"):
        raise ValueError(f"export_arrays.path = {str(path)!r} must end in .mat or .npz")
    found, buffer = arrays_of(what), io.BytesIO()
    if target.suffix == ".mat":
        from scipy.io import savemat

        savemat(buffer, {k[:LONGEST]: v for k, v in found.items()}, oned_as="column")
    else:
        plain = {k: v.astype(str) if getattr(v, "dtype", np.dtype(float)).kind == "O" else v for k, v in found.items()}
        np.savez(buffer, **plain)
    write_bytes(target, buffer.getvalue())
    return target


def _fields(what: Any, taken: set[str]) -> dict[str, Any]:
    """Numeric fields of a dataclass, limits as lowest and highest."""
    found: dict[str, Any] = {}
    for field in dataclasses.fields(what):
        value = getattr(what, field.name, None)
        if field.name == "limits" and isinstance(value, tuple):
            found |= {"lowest": value[0], "highest": value[1]}
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fic" and field.name not in taken:
            found[field.name] = value
    return found
