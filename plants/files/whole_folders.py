"""Folders that are written whole or not at all: built beside, then put in place by one step of the file system.

Where the system can exchange two folders in one step (Linux, on its own file systems), a reader finds the former or the
new one at every moment. Elsewhere the former makes room first: for microseconds there is none, and where the process is
killed then, the next that writes beside puts it back.
"""

from __future__ import annotations

import ctypes
import errno
import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from . import leftovers
from .atomic_files import Together, sync_folder

HERE, EXCHANGE = -100, 2  # AT_FDCWD and RENAME_EXCHANGE of Linux
CANNOT = (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EXDEV, errno.EBUSY, errno.EPERM, errno.EACCES)


def check_target(folder: Path, mark: str) -> None:
    """ValueError unless the folder is absent, empty or a former one: one that holds the file `mark`."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise ValueError(f"out = {str(folder)!r} must be a folder, or not exist yet")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / mark).is_file():
        raise ValueError(
            f"out = {str(folder)!r} holds other files: it must be absent, empty or a former report ({mark})"
        )


@contextmanager
def whole_folder(folder: Path, mark: str) -> Iterator[Path]:
    """A new folder beside `folder` to write into; it takes the folder's place when the block ends without an exception.

    A former one, which holds `mark`, is replaced with all that is in it. ValueError as `check_target`.
    """
    place = Path(os.path.abspath(folder))
    leftovers.settle(place.parent)
    check_target(folder, mark)
    place.parent.mkdir(parents=True, exist_ok=True)
    made = place.with_name(leftovers.name("part"))
    try:
        made.mkdir()
        yield made
        _sync(made)
        check_target(folder, mark)
        _put(made, place)
        sync_folder(place.parent)
    finally:
        if os.path.lexists(made):  # half of a new one, or the former
            leftovers.remove(made)


def _put(made: Path, place: Path) -> None:
    if not place.exists():
        os.rename(made, place)
        return
    made.chmod(stat.S_IMODE(place.stat().st_mode))
    if exchange(made, place):
        return
    former = place.with_name(leftovers.name(f"former.{place.name}"))
    try:
        os.rename(place, former)
        os.rename(made, place)
    except BaseException:
        if former.exists() and not place.exists():
            os.rename(former, place)
        raise
    shutil.rmtree(former, ignore_errors=True)


@contextmanager
def renewed(folder: Path) -> Iterator[Path]:
    """A folder to write files into that belong together; they take their places in `folder`, made if missing, at once.

    What else is in `folder` stays. Where it holds plain files alone, a reader finds all former files or all new ones at
    every moment. Where it cannot be exchanged (it holds folders or links, somebody here works in it, its file system
    or the rights do not allow it), the files take their places one after the other: after a kill between two of them,
    the next writer there lets the rest follow.
    """
    place = Path(os.path.realpath(folder))
    place.mkdir(parents=True, exist_ok=True)
    leftovers.settle(place.parent)
    leftovers.settle(place)
    made, beside = place.with_name(leftovers.name("part")), True
    try:
        try:
            made.mkdir()
        except OSError:  # the folder above belongs to somebody else
            made, beside = place / leftovers.name("part"), False
            made.mkdir()
        yield made
        _sync(made)
        if not (beside and _exchanged(made, place)):
            with Together() as files:
                for path in sorted(made.iterdir()):
                    with files.file(place / path.name) as file, path.open("rb") as source:
                        shutil.copyfileobj(source, file)
    finally:
        if os.path.lexists(made):
            leftovers.remove(made)


def _exchanged(made: Path, place: Path) -> bool:
    """Put a folder of new files in the place of the former, with what else that holds; False where that cannot be."""
    new, former = {path.name for path in made.iterdir()}, list(place.iterdir())
    here = Path(os.path.realpath(os.getcwd()))
    if place == here or place in here.parents or not all(_plain(path) for path in former):
        return False
    try:
        for path in former:
            if path.name in new:
                (made / path.name).chmod(stat.S_IMODE(path.stat().st_mode))
            else:
                os.link(path, made / path.name)
    except OSError:  # a file system without links
        return False
    made.chmod(stat.S_IMODE(place.stat().st_mode))
    sync_folder(made)
    if not exchange(made, place):
        return False
    sync_folder(place.parent)
    known = new | {path.name for path in former}
    for path in made.iterdir():
        if path.name not in known:  # somebody's, written while this went on
            os.rename(path, place / path.name)
    return True


def _plain(path: Path) -> bool:
    return path.is_file() and not path.is_symlink() and os.access(path, os.W_OK)


def exchange(one: Path, other: Path) -> bool:
    """Exchange two paths in one step; False where the system cannot."""
    rename = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None) if os.name == "posix" else None
    if rename is None:
        return False
    if rename(HERE, os.fsencode(one), HERE, os.fsencode(other), EXCHANGE) == 0:
        return True
    number = ctypes.get_errno()
    if number in CANNOT:
        return False
    raise OSError(number, os.strerror(number), str(other))


def _sync(folder: Path) -> None:
    """Put all that is in a folder on the disk; elsewhere than on POSIX each file's own writer has done it."""
    if os.name != "posix":
        return
    for where, _, files in os.walk(folder):
        for name in files:
            with open(os.path.join(where, name), "rb") as file:
                os.fsync(file.fileno())
        sync_folder(Path(where))
