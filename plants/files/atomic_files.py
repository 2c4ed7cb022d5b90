"""The one way in which Pliant writes a file: whole, or as it was before, whenever the process is killed.

What is written stands beside its place under another name (leftovers.py), is on the disk before it takes the place,
and takes it by one renaming. Files that belong together (`Together`) are all finished before the first takes its place,
and a list of them says so: where the process is killed between two, the next that writes into the folder lets the rest
follow.

Access rights are those of the file that stood there, or an ordinary new file's. A symbolic link stays one: its target
is written. Other names of the same file (hard links) keep the former content. A device or a pipe is written as it is.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Self

from . import leftovers

NO_SYNC = (errno.EINVAL, errno.ENOTSUP, errno.EACCES, errno.EBADF)  # a folder that the system does not synchronise


def require_path(name: str, value: Any) -> Path:
    """`value` as a path. ValueError unless it is a non-empty string or a path without a NUL."""
    if not isinstance(value, (str, os.PathLike)):
        raise ValueError(f"{name} is a {type(value).__name__}, must be a path")
    text = os.fspath(value)
    if not isinstance(text, str) or not text or "\0" in text:
        raise ValueError(f"{name} = {text!r} must be a path")
    return Path(text)


class Together:
    """Files that replace the former ones together, when the `with` block ends without an exception.

    with Together() as files:
        files.text("table.json", text)
        with files.file("table.png") as file:
            figure.savefig(file)

    All of one folder: after a kill the next writer there finishes the replacing. Of several folders: each file is
    whole, but a kill between the renamings, microseconds, leaves new beside old.
    """

    def __init__(self) -> None:
        self._made: list[tuple[Path, Path]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: BaseException | TracebackType | None) -> None:
        try:
            if kind is None:
                self._take_places()
        finally:
            for part, _place in self._made:
                part.unlink(missing_ok=True)

    @contextmanager
    def file(self, path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
        """A binary file to write, and to read back, that will stand at `path`. OSError, which names `path`."""
        place = require_path("path", path)
        with _named(place):
            target = Path(os.path.realpath(place))
            former = _former(target)
            if former is None or stat.S_ISREG(former.st_mode):
                leftovers.settle(target.parent)
                part = target.with_name(leftovers.name("part"))
                try:
                    with _opened(part, former) as file:
                        yield file
                    self._made.append((part, target))
                except BaseException:
                    part.unlink(missing_ok=True)
                    raise
                return
        with open(target, "wb") as file:  # holds nothing that could be lost
            yield file

    def text(self, path: str | os.PathLike[str], text: str) -> None:
        """Text as UTF-8."""
        with self.file(path) as file:
            file.write(text.encode())

    def _take_places(self) -> None:
        folders = sorted({target.parent for _, target in self._made})
        ready = None
        if len(self._made) > 1 and len(folders) == 1:
            with _named(self._made[0][1]):
                ready = leftovers.announce(folders[0], [(part.name, target.name) for part, target in self._made])
        try:
            for part, target in self._made:
                with _named(target):
                    os.replace(part, target)
        except KeyboardInterrupt:
            if ready is not None:
                leftovers.finish(ready)
            raise
        finally:
            if ready is not None:
                ready.unlink(missing_ok=True)
        for folder in folders:
            sync_folder(folder)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A binary file that takes the place of `path` when the block ends without an exception."""
    with Together() as files, files.file(path) as file:
        yield file


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """The whole file, or what was there before. OSError, which names `path`."""
    with replacing(path) as file:
        file.write(content)


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """The whole file as UTF-8, or what was there before. OSError, which names `path`."""
    write_bytes(path, text.encode())


def sync_folder(folder: Path) -> None:
    """Put a folder's names on the disk, where the system can."""
    if os.name != "posix":
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
    except OSError as error:
        if error.errno not in NO_SYNC:
            raise


def _former(target: Path) -> os.stat_result | None:
    """What stands there. OSError where it is a folder, may not be written, or has no folder to stand in."""
    try:
        info = os.stat(target)
    except FileNotFoundError:
        if not target.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, f"the folder {str(target.parent)!r} does not exist") from None
        return None
    if stat.S_ISDIR(info.st_mode):
        raise IsADirectoryError(errno.EISDIR, "a folder of this name is there")
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "the file there may not be written")
    return info


@contextmanager
def _opened(part: Path, former: os.stat_result | None) -> Iterator[BinaryIO]:
    """A new file with the rights of the former one, on the disk when the block ends."""
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    with os.fdopen(os.open(part, flags, 0o666 if former is None else 0o600), "w+b") as file:
        yield file
        file.flush()
        if former is not None and os.name == "posix":
            own = os.fstat(file.fileno())
            if (own.st_uid, own.st_gid) != (former.st_uid, former.st_gid):
                with suppress(PermissionError):  # only the superuser gives files away
                    os.fchown(file.fileno(), former.st_uid, former.st_gid)
            os.fchmod(file.fileno(), stat.S_IMODE(former.st_mode))
        os.fsync(file.fileno())


@contextmanager
def _named(place: Path) -> Iterator[None]:
    """An OSError inside says which file is not written."""
    try:
        yield
    except OSError as error:
        why = f"{error.strerror or error}: not written, what was there before is kept"
        if error.errno is None:
            raise OSError(f"{why}: {str(place)!r}") from error
        raise OSError(error.errno, why, str(place)) from error
