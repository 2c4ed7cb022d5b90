"""How much must be read to follow one number? Trace which files of Pliant a call runs through, and which calls which.

    python docs/house/trace.py                 both scenarios below, for the Pliant that is installed
    python docs/house/trace.py --json --list   as JSON; with the files and edges

step        `payload.mass` through one step of a fresh environment: the plant varied, PlantEnv made, reset and stepped
scoreboard  one controller (LQR) on one scene, every case, one run, one bound: in this process

A file counts when a function of it runs, an edge when a function of one file calls a function of another (frames of
other libraries between them are passed over). What runs once when a module is imported does not count. A folder's
`__init__` that only re-exports therefore never counts, and dataclass-made methods do not either.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

FOLDERS = ("plants", "controllers", "envs", "studies")


def places() -> list[tuple[str, str]]:
    """[(folder on disk, its name in Pliant)]."""
    found = []
    for folder in FOLDERS:
        module = __import__(f"pliant.{folder}", fromlist=["__path__"])
        found += [(str(Path(path).resolve()) + "/", folder) for path in module.__path__]
    return found


class Tracer:
    """Files and edges (caller's file, called file) while it is entered."""

    def __init__(self) -> None:
        self.files: set[str] = set()
        self.edges: set[tuple[str, str]] = set()
        self._places = places()
        self._names: dict[CodeType, str | None] = {}

    def name(self, code: CodeType) -> str | None:
        """The file's name within Pliant; None for other files and for the bodies of modules and classes."""
        if code not in self._names:
            found = None
            if code.co_name != "<module>" and code.co_flags & 0x2:  # CO_NEWLOCALS: a function's code
                for path, folder in self._places:
                    if code.co_filename.startswith(path):
                        found = f"{folder}/{code.co_filename.removeprefix(path)}"
            self._names[code] = found
        return self._names[code]

    def _seen(self, frame: FrameType, event: str, _: Any) -> None:
        here = self.name(frame.f_code) if event == "call" else None
        if here is None:
            return
        self.files.add(here)
        caller = frame.f_back
        while caller is not None:
            there = self.name(caller.f_code)
            if there is not None:
                if there != here:
                    self.edges.add((there, here))
                return
            caller = caller.f_back

    def __enter__(self) -> Tracer:
        threading.setprofile(self._seen)
        sys.setprofile(self._seen)
        return self

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]


def step() -> None:
    """payload.mass, given to a fresh environment, until the first observation after it."""
    from pliant.envs import PlantEnv, scenes

    scene = scenes.get("two-link-reach")
    plant = dataclasses.replace(scene.plant, payload=dataclasses.replace(scene.plant.payload, mass=0.31415))
    env = PlantEnv(dataclasses.replace(scene, plant=plant))
    env.reset(seed=0)
    env.step(env.action_space.sample())


def board() -> None:
    """One controller on one scene."""
    from pliant.studies import scoreboard

    scoreboard(["two-link-reach"], ["LQR"], seeds=1, jobs=1, bounds=1)


SCENARIOS: dict[str, Callable[[], None]] = {"step": step, "scoreboard": board}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=[*SCENARIOS])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--list", action="store_true", help="the files and the edges too")
    given = parser.parse_args()
    said = {}
    for name, scenario in SCENARIOS.items():
        if given.only in (None, name):
            with Tracer() as tracer:
                scenario()
            said[name] = {"files": len(tracer.files), "edges": len(tracer.edges)}
            if given.list:
                said[name] |= {"which": sorted(tracer.files), "calls": sorted(" -> ".join(e) for e in tracer.edges)}
    if given.json:
        print(json.dumps(said, indent=1))
        return
    for name, found in said.items():
        print(f"{name}: {found['files']} files, {found['edges']} edges")
        print(*(f"  {line}" for key in ("which", "calls") for line in found.get(key, ())), sep="\n", end="")


if __name__ == "__main__":
    main()
