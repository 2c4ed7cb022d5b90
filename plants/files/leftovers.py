"""Names of unfinished files, and what becomes of those whose process no longer runs.

What is being written stands beside its place as `.pliant-HOST-PROCESS-START-SERIAL.ROLE`:

part         a file or folder that is not finished: removed
ready        a list of finished files that take their places together: they take them
former.NAME  a folder that made room for its successor: put back where NAME is missing, else removed

A process that runs keeps what is its own. Whether one of another machine, another container or before the last start of
this one still runs is not known here: what it left goes when it is a day old.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import shutil
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path

PREFIX = ".pliant-"
AGE = 86400.0  # [s] since the last change, where nobody here can say whether the writer runs
PATTERN = r"(?s)\.pliant-([0-9a-f]{12})-(\d+)-(\d+)-[0-9a-f]{12}\.(part|ready|former)(?:\.(.+))?"


def name(role: str) -> str:
    """A name for what this process is about to write; `role` as above, "part.so" for a part that must end so."""
    process = os.getpid()
    _, start = _state(process)
    return f"{PREFIX}{_machine()}-{process}-{start}-{os.urandom(6).hex()}.{role}"


@cache
def _machine() -> str:
    """Tells machines, their starts and their containers apart: only within one does a process number mean anything."""
    told = [platform.node()]
    with suppress(OSError):
        told.append(Path("/proc/sys/kernel/random/boot_id").read_text(encoding="utf-8"))
    with suppress(OSError):
        told.append(os.readlink("/proc/self/ns/pid"))
    return hashlib.sha256("\n".join(told).encode()).hexdigest()[:12]


def _state(process: int) -> tuple[str, str]:
    """A process's state (Z: ended, not yet asked for) and start [clock ticks]; "" and "0" where Linux does not say."""
    try:
        told = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return "", "0"
    fields = told[told.rindex(")") + 2 :].split()
    return fields[0], fields[19]


def _runs(process: int, start: str) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # another user's
        return True
    state, began = _state(process)
    return state != "Z" and (start == began or "0" in (start, began))  # else its number was given again


def is_left(path: Path) -> bool:
    """Whether a file of this module's names was left by a process that no longer runs."""
    parts = re.fullmatch(PATTERN, path.name)
    if parts is None:
        return False
    if parts[1] == _machine() and os.name == "posix":
        return not _runs(int(parts[2]), parts[3])
    return is_old(path)


def is_old(path: Path) -> bool:
    """Whether nobody has changed a file for so long that no writer can still be at it."""
    try:
        return time.time() - path.lstat().st_mtime > AGE
    except OSError:  # gone meanwhile
        return False


def _listed(folder: Path) -> list[Path]:
    """Nothing where the folder is missing or may not be listed: whoever writes there is told what is wrong."""
    try:
        with os.scandir(folder) as entries:
            return [folder / entry.name for entry in entries if entry.name.startswith(PREFIX)]
    except OSError:
        return []


def settle(folder: Path) -> None:
    """Finish or remove what ended processes have left in a folder. What this user may not remove stays."""
    left = [path for path in _listed(folder) if is_left(path)]
    if not left:
        return
    kept: set[str] = set()
    # Listed anew: a process that had no list when its parts were seen may have written one before it ended.
    for path in _listed(folder):
        if _role(path) == "ready" and is_left(path):
            try:
                finish(path)
            except (OSError, ValueError):  # tried again by the next writer; until then its parts are all there is
                kept |= {part for part, _ in _pairs(path)}
    for path in left:
        with suppress(OSError):
            if _role(path) == "former":
                _put_back(path)
            elif _role(path) == "part" and path.name not in kept:
                remove(path)


def _role(path: Path) -> str:
    parts = re.fullmatch(PATTERN, path.name)
    return parts[4] if parts else ""


def _put_back(path: Path) -> None:
    parts = re.fullmatch(PATTERN, path.name)
    assert parts is not None
    place = path.with_name(parts[5])
    if os.path.lexists(place):
        remove(path)
    else:
        os.rename(path, place)


def remove(path: Path) -> None:
    """Remove a file or a folder with all that is in it."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def announce(folder: Path, pairs: Sequence[tuple[str, str]]) -> Path:
    """Write the list of finished parts and the names that they take: from here on they all do, whoever is killed."""
    ready = folder / name("ready")
    part = ready.with_suffix(".part")
    try:
        with part.open("x", encoding="utf-8") as file:
            json.dump([list(pair) for pair in pairs], file)
            file.flush()
            os.fsync(file.fileno())
        os.rename(part, ready)
    finally:
        part.unlink(missing_ok=True)
    return ready


def finish(ready: Path) -> None:
    """Let all parts of a list take their places, and remove the list. May be done twice, also at once."""
    for part, place in _pairs(ready):
        with suppress(FileNotFoundError):  # it has taken it
            os.replace(ready.with_name(part), ready.with_name(place))
    ready.unlink(missing_ok=True)


def _pairs(ready: Path) -> Iterable[tuple[str, str]]:
    """What a list says. ValueError unless it names own parts and plain names beside it."""
    try:
        pairs = json.loads(ready.read_text(encoding="utf-8"))
    except FileNotFoundError:  # another process was faster
        return []
    for part, place in pairs:
        if not re.fullmatch(PATTERN, part) or os.path.basename(place) != place or place in ("", ".", ".."):
            raise ValueError(f"{ready}: {part!r} and {place!r} must be names of this folder")
    return [(part, place) for part, place in pairs]
