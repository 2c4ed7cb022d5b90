"""Everything travels: a campaign over every class of the four packages and every way there is to send it.

    python tests/campaigns/travel.py

A seed is one object of tests/cases/travellers.py. It is sent in the middle of what it does by pickle (all protocols),
cloudpickle, copy and deepcopy, protocol 5 with read-only buffers beside the stream (as Ray has them), joblib's memory
maps, a spawned process, joblib's loky and a Dask cluster. Each copy must go on as the original, bit for bit, whatever
was done with another copy before; its arrays may be written to where the original's may and nowhere else, and none that
may be shares memory with the original.

By hand, for Ray: pip install ray into another environment, and `python tests/campaigns/travel.py --ray`.
"""

from __future__ import annotations

import copy
import importlib
import inspect
import multiprocessing
import pickle
import pkgutil
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import by_seed
import casadi as ca
import cloudpickle
import gymnasium
import numpy as np
from travellers import MAKERS, NOT_MADE, go_on

from pliant.plants.core.casadi_functions import NumericFunction  # its buffers are filled anew by every call

PACKAGES = ("plants", "controllers", "envs", "studies")
OPAQUE = (
    str,
    bytes,
    int,
    float,
    complex,
    bool,
    type(None),
    np.generic,
    np.dtype,
    type,
    ca.SX,
    ca.MX,
    ca.Function,
    NumericFunction,
    gymnasium.Space,
)


def by_buffers(thing: Any) -> Any:
    """Protocol 5: the arrays lie beside the stream, in memory that may not be written to."""
    beside: list[pickle.PickleBuffer] = []
    stream = pickle.dumps(thing, protocol=5, buffer_callback=beside.append)
    return pickle.loads(stream, buffers=[bytes(b) for b in beside])


def by_memory_map(thing: Any) -> Any:
    import joblib

    with tempfile.TemporaryDirectory() as folder:
        joblib.dump(thing, Path(folder) / "it")
        return joblib.load(Path(folder) / "it", mmap_mode="r")


ROUTES: dict[str, Callable[[Any], Any]] = {
    **{f"pickle {k}": lambda thing, k=k: pickle.loads(pickle.dumps(thing, protocol=k)) for k in range(2, 6)},
    "cloudpickle": lambda thing: cloudpickle.loads(cloudpickle.dumps(thing)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "read-only buffers": by_buffers,
    "memory map": by_memory_map,
}


def parts(thing: Any, path: str = "", seen: dict[int, Any] | None = None) -> Iterator[tuple[str, Any]]:
    """(path, object) of all that an object is made of."""
    seen = {} if seen is None else seen
    if isinstance(thing, OPAQUE) or id(thing) in seen or inspect.isroutine(thing) or inspect.ismodule(thing):
        return
    seen[id(thing)] = thing
    yield path, thing
    if isinstance(thing, dict):
        inner = [(f"{path}[{k!r}]", v) for k, v in thing.items()]
    elif isinstance(thing, (tuple, list)):
        inner = [(f"{path}[{k}]", v) for k, v in enumerate(thing)]
    else:
        inner = [(f"{path}.{k}", v) for k, v in getattr(thing, "__dict__", {}).items() if k != "_shared"]
        for kind in type(thing).__mro__:
            slots = kind.__dict__.get("__slots__", ())
            inner += [(f"{path}.{k}", getattr(thing, k, None)) for k in ([slots] if isinstance(slots, str) else slots)]
    for name, value in inner:
        yield from parts(value, name, seen)


def arrays(thing: Any) -> dict[str, np.ndarray]:
    return {path: a for path, a in parts(thing) if isinstance(a, np.ndarray) and a.size and a.dtype != object}


def unlike(thing: Any, twin: Any) -> str:
    """What of a copy is not as in the original, "" where all is. A bare tuple of arrays travels as NumPy has it."""
    if isinstance(thing, tuple):
        return ""
    ours, theirs = arrays(thing), arrays(twin)
    for name in ours.keys() & theirs.keys():
        a, b = ours[name], theirs[name]
        if a.flags.writeable != b.flags.writeable:
            return f"{name} may{' not' * a.flags.writeable} be written to in a copy"
        if b.flags.writeable and np.may_share_memory(a, b) and np.shares_memory(a, b):
            return f"{name} is shared with the original"
    return ""


def same(found: list[np.ndarray], wanted: list[np.ndarray]) -> bool:
    return len(found) == len(wanted) and all(
        a.shape == b.shape and a.dtype == b.dtype and a.tobytes() == b.tobytes() for a, b in zip(found, wanted)
    )


def sent(name: str, routes: dict[str, Callable[[Any], Any]]) -> dict[str, str]:
    """{route: what is wrong}."""
    thing, faults, twins = MAKERS[name](), {}, {}
    for route, send in routes.items():
        try:
            twins[route] = send(thing)
            if wrong := unlike(thing, twins[route]):
                faults[route] = wrong
            go_on(name, send(thing))  # one that is driven elsewhere
        except Exception as error:
            faults[route] = f"{type(error).__name__}: {error}"[:200]
    wanted = go_on(name, thing)
    if not wanted:
        faults["every"] = "there is nothing to compare"
    for route, twin in twins.items():
        try:
            if not same(go_on(name, twin), wanted):
                faults.setdefault(route, "goes on in another way")
        except Exception as error:
            faults[route] = f"{type(error).__name__}: {error}"[:200]
    return faults


@cache
def known() -> dict[str, type]:
    """{module.Class: class} of all classes that are not private."""
    found = {}
    for package in PACKAGES:
        top = importlib.import_module(f"pliant.{package}")
        for module in pkgutil.walk_packages(top.__path__, f"pliant.{package}."):
            here = importlib.import_module(module.name)
            for name, kind in vars(here).items():
                if inspect.isclass(kind) and kind.__module__ == module.name and not name.startswith("_"):
                    found[f"{module.name[7:]}.{name}"] = kind
    return found


def left() -> list[str]:
    """Classes that neither a traveller is made of nor a reason keeps at home."""
    met = {type(part) for make in MAKERS.values() for _, part in parts(make())}
    kinds = {n: k for n, k in known().items() if not (inspect.isabstract(k) or getattr(k, "_is_protocol", False))}
    return [n for n, k in kinds.items() if k not in met and not any(f"{n}.".startswith(f"{at}.") for at in NOT_MADE)]


def far(name: str, thing: Any) -> list[np.ndarray]:
    """What it does next, in the process that runs this."""
    warnings.simplefilter("ignore")
    return go_on(name, thing)


def by_spawn(things: dict[str, Any]) -> dict[str, Any]:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return told({name: pool.apply_async(far, (name, thing)).get for name, thing in things.items()})


def by_loky(things: dict[str, Any]) -> dict[str, Any]:
    import joblib

    with joblib.Parallel(n_jobs=2, backend="loky", max_nbytes=1) as pool:  # every array as a read-only memory map
        return told({n: lambda n=n, t=t: pool([joblib.delayed(far)(n, t)] * 2)[1] for n, t in things.items()})


def by_dask(things: dict[str, Any]) -> dict[str, Any]:
    import distributed

    options: dict[str, Any] = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(processes=True, **options) as cluster, distributed.Client(cluster) as client:
        return told({n: client.submit(far, n, t, pure=False).result for n, t in things.items()})


def by_ray(things: dict[str, Any]) -> dict[str, Any]:
    import ray

    paths = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "cases")]
    ray.init(num_cpus=1, include_dashboard=False, runtime_env={"env_vars": {"PYTHONPATH": ":".join(paths)}})
    send = ray.remote(far)
    return told({name: lambda n=name, t=thing: ray.get(send.remote(n, t)) for name, thing in things.items()})


def told(asked: dict[str, Callable[[], Any]]) -> dict[str, Any]:
    """{name: the arrays, or in words why there are none}."""
    found: dict[str, Any] = {}
    for name, ask in asked.items():
        try:
            found[name] = ask()
        except Exception as error:
            found[name] = f"{type(error).__name__}: {error}"[:200]
    return found


AWAY: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {"spawn": by_spawn, "loky": by_loky, "Dask": by_dask}


def sent_away(send: Callable[[dict[str, Any]], dict[str, Any]], names: list[str]) -> dict[str, str]:
    """{object: what is wrong} after all went to another process at once."""
    things = {name: MAKERS[name]() for name in names}
    found, faults = send(things), {}
    for name, thing in things.items():
        if isinstance(found[name], str):
            faults[name] = found[name]
        elif not same(found[name], go_on(name, thing)):
            faults[name] = "goes on in another way"
    return faults


def run(seed: int) -> dict[str, Any]:
    warnings.simplefilter("ignore")
    began = time.perf_counter()
    if seed < len(MAKERS):
        name = list(MAKERS)[seed]
        faults = sent(name, ROUTES)
    elif seed < len(MAKERS) + len(AWAY):
        name = list(AWAY)[seed - len(MAKERS)]
        faults = sent_away(AWAY[name], list(MAKERS))
    else:
        name, faults = "classes", dict.fromkeys(left(), "neither tried nor named with a reason")
    return {"seed": seed, "name": name, "faults": faults, "seconds": round(time.perf_counter() - began, 3)}


def summary(rows: list[dict[str, Any]]) -> str:
    faulty = [f"{r['name']} and {other}: {fault}" for r in rows for other, fault in r["faults"].items()]
    text = f"{len(MAKERS)} objects, {len(known())} classes, {len(ROUTES)} ways within the process and {len(AWAY)} out"
    return "\n  ".join([f"{text}: {len(faulty)} faults", *faulty])


if __name__ == "__main__":
    if "--ray" in sys.argv:
        wrong = sent_away(by_ray, list(MAKERS))
        print(f"{len(MAKERS)} objects by Ray: {len(wrong)} faults", *wrong.items(), sep="\n  ")
        sys.exit(bool(wrong))
    by_seed.main(__doc__, len(MAKERS) + len(AWAY) + 1, run, summary, lambda row: bool(row["faults"]))
