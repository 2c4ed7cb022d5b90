"""Every name of every shipped plant: what `vary` takes works in all that a plant does, the rest it refuses in words.

    python tests/campaigns/vary_names.py --count 400

A seed is one pair of a plant and a dotted name, of all there are in chance order: all numbers that a plant is made of,
quantities or not, and names that are none. What is varied must give, at the plant's own value, what the plant itself
gives, errors included, and end in no other error beside it.
"""

from __future__ import annotations

import dataclasses
import importlib.util
import os
import time
import warnings
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import by_seed
import numpy as np

from pliant.plants import FlexibleSpacecraft, Hinge, Plant
from pliant.plants.core.errors import PliantError

TESTS = Path(__file__).parents[1]
NONE = ("", "payload.mass.real", "varied", "0", "link1", "hub", "environment.orbit.rate.0", "hub.inertia", "nothing")
OFF = 1e-9  # of the largest, between expressions in another order


@cache
def plants() -> dict[str, Plant]:
    """Those of the shared tests; a busy spacecraft; one with a single wheel and a hinge without axes."""
    found: dict[str, Plant] = {}
    for file in (TESTS / "conftest.py", TESTS / "plants" / "conftest.py"):
        spec = importlib.util.spec_from_file_location("shared", file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        found |= getattr(module, "PLANTS", {})
    found["craft busy"] = module._busy()
    wheel = found["craft busy"].hub.wheels[1]
    hub = dataclasses.replace(found["craft"].hub, wheels=(wheel,))
    for drive in ("motion", "torque", "angle"):
        part = dataclasses.replace(found["craft"].appendages[0], hinge=Hinge(drive=drive), modes=1)
        found[f"craft one {drive}"] = FlexibleSpacecraft(hub=hub, appendages=(part,))
    return found


def paths(thing: Any, prefix: str = "") -> list[str]:
    """The dotted names of all that a dataclass is made of."""
    if isinstance(thing, tuple):
        return [name for i, part in enumerate(thing) for name in paths(part, f"{prefix}{i}.")]
    if dataclasses.is_dataclass(thing):
        fields = dataclasses.fields(thing)
        return [name for f in fields for name in paths(getattr(thing, f.name), f"{prefix}{f.name}.")]
    return [prefix[:-1]]


@cache
def pairs() -> list[tuple[str, str]]:
    """(plant, name), in chance order."""
    found = [(n, path) for n, p in plants().items() for path in dict.fromkeys([*paths(p), *p.uncertain, *NONE])]
    order = np.random.default_rng(0).permutation(len(found))
    return [found[k] for k in order]


def uses(plant: Plant, p: Any) -> dict[str, Any]:
    """What a plant does with parameters, as arrays, or the kind of error in which it ends."""
    x, u, w = plant.rest_state, np.full(plant.nu, 0.01), np.zeros(plant.nw)
    one = None if p is None else np.asarray(p)
    given = dict(zip(plant.varied, p)) if p is not None else {}
    asked: dict[str, Callable[[], Any]] = {
        "dynamics": lambda: plant.dynamics(x, u, p=p),
        "measure": lambda: plant.measure(x, u, p=p),
        "A": lambda: plant.linearize(x, u, p=p).A,
        "C": lambda: plant.linearize(x, u, p=p).C,
        "feedback_model": lambda: plant.feedback_model(x, u, p=p).A,
        "stepper": lambda: plant.stepper(1e-6, check=False)(x[None], u[None], None if one is None else one[None])[0],
        "simulate": lambda: plant.simulate(x, u, [0.0, 1e-4], p=p, rtol=1e-9).x[-1],
        "casadi": lambda: plant.casadi()(0.0, x, u, w, plant.nominal_parameters if p is None else p)[0],
        "to_control": lambda: plant.to_control().linearize(x, u, params=given).A,
        "equilibrium": lambda: plant.equilibrium(p=p)[0],
    }
    for name in ("energy", "mass_matrix", "natural_frequencies"):
        if ask := getattr(plant, name, None):
            asked[name] = partial(ask, x, p=p)
    found: dict[str, Any] = {}
    for name, ask in asked.items():
        try:
            found[name] = np.asarray(ask(), dtype=float)
        except (ValueError, PliantError) as error:
            found[name] = type(error).__name__
    return found


def apart(one: dict[str, Any], other: dict[str, Any]) -> str:
    """What differs, "" where nothing does."""
    for name, a in one.items():
        b = other[name]
        if isinstance(a, str) or isinstance(b, str):
            same = isinstance(a, str) and a == b
        else:
            same = a.shape == b.shape and np.abs(a - b).max(initial=0.0) <= OFF * max(1.0, np.abs(b).max(initial=0.0))
        if not same:
            return name
    return ""


@cache
def plain(name: str) -> dict[str, Any]:
    return uses(plants()[name], None)


def tried(name: str, plant: Plant, path: str) -> tuple[str, str]:
    """(what became of it, in words what is wrong or "")."""
    try:
        varied = plant.vary(path)
    except ValueError as error:
        spoken = len(str(error)) > 20 and (repr(path) in str(error) or not path)
        return "refused", "" if spoken else f"refused without words: {error}"
    own = varied.nominal_parameters
    if differs := apart(uses(varied, own), plain(name)):
        return "works", f"{differs} at its own value is not the plant's"
    moved = own * 1.01 if own[0] else own + 1e-3
    found = uses(varied, moved)
    own = plain(name)
    if bad := [k for k, v in found.items() if k != "equilibrium" and isinstance(v, str) and v != own[k]]:
        return "works", f"{bad} at 1.01 of its value: {found[bad[0]]}"
    return "works", ""


def run(seed: int) -> dict[str, Any]:
    warnings.simplefilter("ignore")
    name, path = pairs()[seed % len(pairs())]
    began = time.perf_counter()
    try:
        became, fault = tried(name, plants()[name], path)
    except Exception as error:
        became, fault = "works", f"{type(error).__name__}: {error}"[:200]
    row = {"seed": seed, "plant": name, "path": path, "became": became, "fault": fault}
    return {**row, "seconds": round(time.perf_counter() - began, 3)}


def summary(rows: list[dict[str, Any]]) -> str:
    faults = [r for r in rows if r["fault"]]
    works = sum(r["became"] == "works" for r in rows)
    text = f"{len(rows)} of {len(pairs())} names: {works} work, {len(rows) - works} refused, {len(faults)} faults"
    return "\n  ".join([text, *(f"{r['plant']} {r['path']}: {r['fault']}" for r in faults[:20])])


if __name__ == "__main__":
    os.environ.setdefault("PLIANT_NATIVE", "0")  # compilers have nothing to do with names
    by_seed.main(__doc__, len(pairs()), run, summary, lambda row: bool(row["fault"]))
