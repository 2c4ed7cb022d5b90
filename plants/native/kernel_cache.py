"""Compiled kernels on disk: one folder per user, written atomically, loaded only if nobody else could have written it.

Every file ends in the SHA-256 of what stands before, so a damaged file is noticed and built again. Nothing relies on a
lock: processes that build the same kernel at once each rename a whole file into place.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import platformdirs

from pliant.plants.core.errors import PliantError
from pliant.plants.files import leftovers
from pliant.plants.files.atomic_files import sync_folder

MAGIC = b"pliant-kernel-1\n"
TRAILER = len(MAGIC) + 32
BINARY = getattr(os, "O_BINARY", 0)
T = TypeVar("T")


class CacheError(PliantError):
    """The cache folder, or a file in it, could have been written by somebody else."""


def folder() -> Path:
    """Where compiled kernels are kept: $PLIANT_CACHE, or the user's cache folder."""
    chosen = os.environ.get("PLIANT_CACHE")
    return Path(chosen) if chosen else Path(platformdirs.user_cache_dir("pliant")) / "kernels"


def _refuse(path: Path, why: str) -> CacheError:
    return CacheError(
        f"{path} {why}: compiled code is not loaded from it. Remove it, take back its ownership and "
        "`chmod go-w` it, or set PLIANT_CACHE to a folder of your own"
    )


def check_own(path: Path) -> None:
    """Raise CacheError unless this user owns the path and nobody else may write it."""
    if not hasattr(os, "geteuid"):
        return
    info = os.lstat(path)
    if stat.S_ISLNK(info.st_mode):
        raise _refuse(path, "is a symbolic link")
    if info.st_uid != os.geteuid():
        raise _refuse(path, f"belongs to user {info.st_uid}, not to user {os.geteuid()}")
    if info.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise _refuse(path, f"may be written by others (mode {stat.S_IMODE(info.st_mode):o})")


def checked_folder(create: bool = True) -> Path:
    """The cache folder, made if missing; CacheError where it, or a folder above it, is open to other users."""
    path = folder()
    if create:
        try:
            path.mkdir(parents=True, exist_ok=True, mode=0o700)
        except OSError as failure:
            raise CacheError(
                f"the cache folder {path} cannot be made: {failure}. Set PLIANT_CACHE to a folder of your own"
            ) from failure
    if path.exists():
        check_own(path)
        for above in path.absolute().parents:
            info = os.stat(above)
            open_to_others = info.st_mode & (stat.S_IWGRP | stat.S_IWOTH) and not info.st_mode & stat.S_ISVTX
            if hasattr(os, "geteuid") and (open_to_others or info.st_uid not in (0, os.geteuid())):
                raise _refuse(above, "stands above the cache and may be changed by another user")
    return path


def seal(content: bytes) -> bytes:
    """Content followed by its mark and digest; a shared library may carry bytes after its end."""
    return content + MAGIC + hashlib.sha256(content).digest()


def unseal(data: bytes) -> bytes | None:
    """The content, or None where the file is damaged."""
    content, trailer = data[:-TRAILER], data[-TRAILER:]
    whole = trailer == MAGIC + hashlib.sha256(content).digest()
    return content if whole else None


def path_of(name: str) -> Path | None:
    """The path of a whole file in the cache, or None; a damaged file is removed."""
    path = checked_folder() / name
    try:
        check_own(path)
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    except IsADirectoryError:
        try:
            path.rmdir()
        except OSError as failure:
            raise CacheError(f"{path} is a folder, must be a file that Pliant writes: remove it") from failure
        return None
    if unseal(data) is None:
        path.unlink(missing_ok=True)
        return None
    return path


def read_text(name: str) -> str | None:
    """The text of a whole file in the cache, or None."""
    path = path_of(name)
    content = unseal(path.read_bytes()) if path else None
    return content.decode() if content is not None else None


def remove(name: str) -> None:
    """Take a file out of the cache, if it is there."""
    (folder() / name).unlink(missing_ok=True)


def write_aside(content: bytes) -> Path:
    """Write sealed content under a temporary name in the cache folder; `publish` gives it its own.

    What killed processes have left there goes.
    """
    aside = checked_folder() / leftovers.name("part.so")
    leftovers.settle(aside.parent)
    for old in aside.parent.glob("building-*.so"):  # version 0.1's name for them, which does not say whose it is
        if leftovers.is_old(old):
            old.unlink(missing_ok=True)
    try:
        with os.fdopen(os.open(aside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | BINARY, 0o700), "wb") as file:
            file.write(seal(content))
            file.flush()
            os.fsync(file.fileno())
    except BaseException:
        aside.unlink(missing_ok=True)
        raise
    return aside


def publish(aside: Path, name: str) -> Path:
    """Rename a file written aside into place: other processes see all of it or nothing."""
    path = aside.with_name(name)
    os.replace(aside, path)
    sync_folder(path.parent)
    return path


def write(name: str, content: bytes) -> Path:
    """Write a whole file atomically."""
    aside = write_aside(content)
    try:
        return publish(aside, name)
    finally:
        aside.unlink(missing_ok=True)


def kept(
    name: str, make: Callable[[], bytes], load: Callable[[Path], T], check: Callable[[Path], Any] | None = None
) -> T:
    """What `load` makes of a file of the cache; where there is none that can be loaded, `make` gives its content.

    It is published once `check` has let it pass. A whole file that cannot be loaded is another machine's.
    """
    path = path_of(name)
    if path is not None:
        try:
            return load(path)
        except OSError:
            path.unlink(missing_ok=True)
    aside = write_aside(make())
    try:
        if check is not None:
            check(aside)
        path = publish(aside, name)
    finally:
        aside.unlink(missing_ok=True)
    return load(path)


def entries() -> list[Path]:
    """All files in the cache but those that are being written."""
    path = checked_folder(create=False)
    found = path.iterdir() if path.exists() else ()
    return sorted(p for p in found if p.is_file() and not p.name.startswith(leftovers.PREFIX))


def clear() -> int:
    """Remove every file of the cache, and what killed processes have left; returns how many of the former."""
    found = entries()
    leftovers.settle(folder())
    for path in found:
        path.unlink(missing_ok=True)
    return len(found)
