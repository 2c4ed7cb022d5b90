"""Writers that are killed while they replace a file: a seeded campaign.

    python tests/campaigns/kills.py

Each kind of file is written in version 1; a child process that writes version 2 over it is killed: by SIGKILL at a
moment drawn at random (the first 200 seeds, where the child goes on with versions 1 and 2 in turn), before its k-th
call of the system for every k there is (`steps`), and by the system itself in the middle of a write, after so many
bytes (`bytes`). What stands there then must be one version as a whole; after version 3 is written nothing else may be
left in the folder.

`between` counts kills between a table and its chart, which are two files of the user's naming, and, where the system
cannot exchange folders (`without exchange`), between the files of one folder: a reader finds new beside old until the
next writer there, or `leftovers.settle`, lets the rest follow. All must be of one version then.
"""

from __future__ import annotations

import dataclasses
import os
import resource
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import by_seed
import numpy as np
from file_kinds import KINDS, Kind

from pliant.plants.files import leftovers, whole_folders

RANDOM = 200
CALLS = ("open", "fsync", "replace", "rename", "link", "unlink", "rmdir", "mkdir", "chmod", "fchmod", "fchown")
FOLDERS = ("report", "scoreboard", "paper's figures")
SIZES = (0, 1, 100, 1000, 4096, 9000)  # bytes after which the system kills


def child(write: Callable[[], object], before: Callable[[], object] = lambda: None) -> int:
    """Fork, do it, and end without cleaning anything up; the process's number."""
    number = os.fork()
    if number == 0:
        try:
            before()
            write()
        except BaseException:
            os._exit(3)
        os._exit(0)
    return number


def at_call(k: int) -> None:
    """In this process: SIGKILL before the k-th call of the system that changes files."""
    seen = 0

    def counted(real: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            nonlocal seen
            seen += 1
            if seen == k:
                os.kill(os.getpid(), signal.SIGKILL)
            return real(*given, **named)

        return call

    for name in CALLS:
        setattr(os, name, counted(getattr(os, name)))
    whole_folders.exchange = counted(whole_folders.exchange)


def at_byte(n: int) -> None:
    """In this process: the system kills it when a file grows past n bytes."""
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n, n))


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


class Case:
    """A folder with version 1, over which a child writes version 2 until it is killed."""

    def __init__(self, kind: Kind, folder: Path) -> None:
        self.kind, self.folder = kind, folder
        kind.write(folder, 1)
        self.wanted = files(folder)
        self.faults: dict[str, Any] = {"kills": 0, "lost": 0, "mixed": 0, "left": 0}
        self.faults |= {"between": 0, "absent": 0, "new": 0}

    def killed(self, number: int) -> bool:
        """What is found after a child has ended; False where it had come to its end."""
        _, status = os.waitpid(number, 0)
        if os.WIFEXITED(status):
            assert os.WEXITSTATUS(status) == 0, "the writer failed"
            return False
        self.faults["kills"] += 1
        found = self.found()
        if self.kind.settles and len(found) != 1:
            self.faults["between" if found else "absent"] += 1
            for path in (self.folder, *(path for path in self.folder.iterdir() if path.is_dir())):
                leftovers.settle(path)
            found = self.found()
        self.faults["lost"] += not found
        self.faults["mixed"] += len(found) > 1 or not found <= {1, 2}
        self.faults["new"] += found == {2}
        self.kind.write(self.folder, 3)
        self.faults["left"] += files(self.folder) != self.wanted or self.kind.read(self.folder) != {3}
        self.kind.write(self.folder, 1)
        return True

    def found(self) -> set[int]:
        try:
            return self.kind.read(self.folder)
        except (ValueError, OSError, StopIteration):
            return set()


def run(seed: int, names: tuple[str, ...] = tuple(KINDS), every: int = 1) -> dict[str, Any]:
    """One kind killed in one way; `every`: of the steps, for a sample."""
    kind = KINDS[names[seed % len(names)]]
    how = "moment" if seed < RANDOM else ("steps", "bytes", "without exchange")[(seed - RANDOM) // len(names) % 3]
    with tempfile.TemporaryDirectory() as there:
        case = Case(kind, Path(there))

        def write() -> object:
            return kind.write(case.folder, 2)

        if how == "moment":
            began = time.perf_counter()
            write()
            took = time.perf_counter() - began
            kind.write(case.folder, 1)
            number = child(lambda: [kind.write(case.folder, v) for _ in range(10**6) for v in (2, 1)])
            time.sleep(np.random.default_rng(seed).uniform(0, 3) * took)
            os.kill(number, signal.SIGKILL)
            case.killed(number)
        elif how == "bytes":
            for n in SIZES:
                case.killed(child(write, lambda n=n: at_byte(n)))
        elif how == "steps":
            k = 1
            while case.killed(child(write, lambda k=k: at_call(k))):
                k += every
        elif kind.name in FOLDERS:  # no system without exchange does this in one step: the next writer mends it
            case.kind = dataclasses.replace(kind, settles=True)
            with patch.object(whole_folders, "exchange", lambda *_: False):
                k = 1
                while case.killed(child(write, lambda k=k: at_call(k))):
                    k += every
    return {"seed": seed, "kind": kind.name, "how": how, **case.faults}


def summary(rows: list[dict[str, Any]]) -> str:
    def line(own: list[dict[str, Any]]) -> str:
        total = {
            name: sum(r[name] for r in own) for name in ("kills", "new", "lost", "mixed", "left", "between", "absent")
        }
        text = f"{total['kills']} kills, {total['new']} of them after the new file stood: {total['lost']} lost, "
        text += f"{total['mixed']} mixed, {total['left']} with leftovers after the next write"
        text += f"; {total['between']} between two files until the next writer" * bool(total["between"])
        return text + f"; {total['absent']} times absent until the next writer put it back" * bool(total["absent"])

    text = "all: " + line(rows)
    for name in KINDS:
        text += f"\n  {name}: " + line([r for r in rows if r["kind"] == name])
    for how in dict.fromkeys(r["how"] for r in rows):
        text += f"\n  by {how}: " + line([r for r in rows if r["how"] == how])
    return text


def faulty(row: dict[str, Any]) -> bool:
    return bool(row["lost"] or row["mixed"] or row["left"])


if __name__ == "__main__":
    by_seed.main(__doc__, RANDOM + 3 * len(KINDS), run, summary, faulty)
