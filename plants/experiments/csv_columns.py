"""Measured motions in CSV files: a column "t [s]", and one for each signal, "tip_x [m]", in the plant's own units.

A cell that is empty or "nan" is a missing sample; inputs and times have none. Columns that the plant does not know are
an error: what stands in them was meant for something.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_path, shown
from pliant.plants.core.signals import Signal, names
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant
from pliant.plants.files.atomic_files import write_text

from .experiment import Experiment, checked, is_plant

Array = np.ndarray
LARGEST = 500_000_000  # bytes of a file
MISSING = ("", "nan", "NaN", "NAN")


def read_experiment(
    plant: Plant, path: str | Path, *, start: Any = None, unknown: Any = (), hold: str = "zero-order", name: str = ""
) -> Experiment:
    """The experiment that a CSV file holds. ValueError, which names file, line and column, where it is none.

    Inputs that have no column are zero. start, unknown, hold and name are those of `Experiment`.

    >>> write_experiment(arm, Experiment.of(motion, noise={"hub_angle": 2.4e-5}), "run1.csv")
    >>> read = read_experiment(arm, "run1.csv", unknown="all")
    >>> read.t.shape == motion.t.shape
    True
    """
    plant = is_plant("read_experiment", plant)
    place = require_path("read_experiment.path", path)
    if place.stat().st_size > LARGEST:
        raise ValueError(f"{str(place)!r} has {place.stat().st_size} bytes, must be at most {LARGEST}")
    try:
        with place.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{str(place)!r} is no CSV file of text: {error}") from None
    if len(rows) < 3:
        raise ValueError(
            f"{str(place)!r} has {len(rows)} lines that are not blank, must have a head and at least two samples"
        )
    columns = [_column(place, cell, plant) for cell in rows[0][1]]
    if len(set(columns)) != len(columns):
        twice = next(c for c in columns if columns.count(c) > 1)
        raise ValueError(f"{str(place)!r} has the column {twice!r} twice")
    if "t" not in columns:
        raise ValueError(f"{str(place)!r} has no column 't [s]'")
    values = np.array([_numbers(place, line, row, columns) for line, row in rows[1:]])
    by_name = dict(zip(columns, values.T))
    inputs = {n: by_name[n] for n in names(plant.inputs) if n in by_name}
    for key in ("t", *inputs):
        if np.isnan(by_name[key]).any():
            line, _ = rows[1 + int(np.argmax(np.isnan(by_name[key])))]
            raise ValueError(f"{str(place)!r} line {line}: {key} is missing, only what is measured may be")
    read = {n: column for n, column in by_name.items() if n != "t" and n not in inputs}
    options = {"start": start, "unknown": unknown, "hold": hold, "name": name or place.stem}
    found = Experiment(t=by_name["t"], u=inputs, measured=read, **options)
    checked(plant, found, f"{str(place)!r}")
    return found


def write_experiment(plant: Plant, motion: Experiment | Trajectory, path: str | Path) -> None:
    """Write a motion of a plant as such a file; missing samples become empty cells.

    >>> write_experiment(arm, Experiment.of(motion, noise={"hub_angle": 2.4e-5}), "run1.csv")
    """
    one = checked(is_plant("write_experiment", plant), motion, "write_experiment.motion")
    known = {s.name: s for s in plant.states + plant.outputs}
    signals = [Signal("t", "s"), *plant.inputs, *(known[name] for name in one.signals)]
    table = np.column_stack([one.t, one.u, one.y])
    lines = [",".join(f"{s.name} [{s.unit or '1'}]" for s in signals)]
    lines += [",".join("" if math.isnan(v) else repr(v) for v in row) for row in table.tolist()]
    write_text(require_path("write_experiment.path", path), "\n".join([*lines, ""]))


def _column(place: Path, cell: str, plant: Plant) -> str:
    """The name of a column whose head is "name [unit]"."""
    name, bracket, rest = cell.strip().partition("[")
    name, unit = name.strip(), rest.rstrip().removesuffix("]").strip()
    units = {s.name: s.unit for s in plant.inputs + plant.states + plant.outputs} | {"t": "s"}
    if name not in units:
        raise ValueError(f"{str(place)!r} has the column {shown(cell)}; the plant has {', '.join(units)}")
    if not bracket or unit != (units[name] or "1"):
        raise ValueError(f"{str(place)!r} has the column {shown(cell)}, must be '{name} [{units[name] or '1'}]'")
    return name


def _numbers(place: Path, line: int, row: list[str], columns: list[str]) -> list[float]:
    if len(row) != len(columns):
        raise ValueError(f"{str(place)!r} line {line} has {len(row)} cells, must have {len(columns)}")
    found = []
    for name, cell in zip(columns, row):
        text = cell.strip()
        try:
            found.append(math.nan if text in MISSING else float(text))
        except ValueError:
            raise ValueError(f"{str(place)!r} line {line}: {name} = {shown(cell)} must be a number") from None
    return found
