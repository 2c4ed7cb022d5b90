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
from pliant.controllers.learning.policy import Policy
from pliant.controllers.learning.policy_files import parts_of
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.mpc.mpc import MPC
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import names
from pliant.plants.files.atomic_files import require_path, write_bytes
from pliant.plants.linear.lti import LinearModel

LONGEST = 31  # characters of a variable's name in a .mat file


def arrays_of(what: Any) -> dict[str, Any]:
    """{name: array} of `what`: a LinearModel (A .. F, x0, u0, y0, names), or a controller: its linear form A, B, C, D
    in u = -(C s + D y), s' = A s + B y where it has one, and its own numbers and arrays, of a policy W1, b1 .., of an
    MPC its programs; `dt` = 0 where it is continuous. ValueError for anything else.

    Example
    -------
    >>> arrays_of(law)["K"].shape
    (1, 6)
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
        elif isinstance(what, MPC):
            found |= _programs(what)
        elif isinstance(what, Policy):
            found |= parts_of(what)[1] | {"goal": what.goal, "limits": what.limits, "clip": float(what.clip)}
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

    ValueError for another ending.

    Example
    -------
    >>> print(export_arrays(arm.linearize(*scene.target), "arm.mat"))
    arm.mat
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


def _fields(what: Any, taken: set[str], prefix: str = "") -> dict[str, Any]:
    """Numbers and numeric arrays of a dataclass, limits as lowest and highest, those of a reference after its name."""
    found: dict[str, Any] = {}
    for field in dataclasses.fields(what):
        name, value = prefix + field.name, getattr(what, field.name, None)
        if field.name == "limits" and isinstance(value, tuple):
            found |= {"lowest": value[0], "highest": value[1]}
        elif field.name in ("reference", "shaper") and dataclasses.is_dataclass(value):
            found |= _fields(value, taken, f"{name}_")
        elif field.name[0] == "_" or name in taken or name == "dt":
            continue
        elif isinstance(value, float) or (isinstance(value, np.ndarray) and value.dtype.kind in "fic"):
            found[name] = value
    return found


def _programs(law: MPC) -> dict[str, Any]:
    """u = u0 + G p + first z, z of least |z|^2 with low <= rows p + M z <= high, of each node in turn."""
    m = len(law._steps[0].low)
    each = {
        "u0": lambda s: s.u,
        "G": lambda s: s.G[m:],
        "rows": lambda s: s.G[:m],
        "low": lambda s: s.low,
        "high": lambda s: s.high,
        "M": lambda s: s.solver.M,
        "first": lambda s: s.first,
    }
    found: dict[str, Any] = {name: np.array([part(s) for s in law._steps]) for name, part in each.items()}
    found |= {"lowest": law.limits.low, "highest": law.limits.high, "change": law.limits.change}
    return found | {"soft": law._steps[0].solver.soft.astype(float), "penalty": float(law.penalty)}
