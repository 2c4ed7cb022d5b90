"""Arrays and words in one .npz file with a checksum over every byte of it, and a reader that trusts nothing.

The file is what `numpy.load` reads: `about` is JSON, with the kind of file and its format; the rest are arrays of
numbers. The archive's comment is the SHA-256 of all that stands before it, so that a file that was cut off, damaged or
written again by another program is told from Pliant's own. Files of version 0.1 (format 1) have no such comment: the
archive's own CRC-32 is all that guards them. Nothing in a file is ever executed: objects, which only a pickle carries,
are refused.
"""

from __future__ import annotations

import errno
import hashlib
import io
import json
import math
import os
import stat
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from .atomic_files import replacing, require_path

SEAL = b"pliant sha256 "
DIGITS = 64  # of the checksum
ABOUT = "about"
FIRST = "motion"  # the only kind that had words in format 1, which does not say its kind
NUMBERS, TEXT = "fiub", "U"
HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
LEAST, TIMES = 2**26, 8  # what unpacks to more bytes than this, and more than so many times the file's, is refused
CHUNK = 2**20


class NotOwnError(ValueError):
    """What is wrong with a file, in words that follow its name."""


class Found(NamedTuple):
    """What stood in a file. `about` is None where it has none, `sealed` False where it has no checksum."""

    about: dict[str, Any] | None
    arrays: dict[str, np.ndarray]  # read-only
    sealed: bool


def write(file: BinaryIO, kind: str, form: int, about: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
    """Write into a file that is empty, or that cannot be read back (a pipe)."""
    text = json.dumps({"kind": kind, "format": form, **about})
    back = io.BytesIO() if not (file.readable() and file.seekable()) else file
    with zipfile.ZipFile(back, "w") as archive:
        for name, value in {ABOUT: np.array(text), **arrays}.items():
            entry = zipfile.ZipInfo(f"{name}.npy")  # dated 1980: the same content is the same file
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asanyarray(value), allow_pickle=False)
        archive.comment = SEAL + b"0" * DIGITS
    size = back.seek(0, os.SEEK_END)
    digest = _digest(back, size - DIGITS)
    back.seek(size - DIGITS)
    back.write(digest)
    if back is not file:
        file.write(back.getvalue())  # type: ignore[attr-defined]


def save(
    path: str | os.PathLike[str], kind: str, form: int, about: Mapping[str, Any], arrays: Mapping[str, Any]
) -> None:
    """The whole file, or what was there before. OSError, which names `path`."""
    with replacing(path) as file:
        write(file, kind, form, about, arrays)


def load(owner: str, path: Any, kind: str, newest: int, *, must: bool = True) -> Found:
    """What `save` wrote. ValueError, which begins with `owner` and names the file, for all that is not that.

    must: a file without `about` is refused too. FileNotFoundError where there is none, and other OSErrors of the
    system, stay what they are.
    """
    path = require_path(f"{owner}: path", path)
    with opened(owner, path) as (file, size), zipfile.ZipFile(file) as archive:
        sealed = archive.comment.startswith(SEAL)
        if sealed and archive.comment[len(SEAL) :] != _digest(file, size - DIGITS):
            raise NotOwnError("is damaged: its checksum is another")
        members = _members(archive, size)
        if ABOUT in members:
            about = _about(_array(ABOUT, archive.read(members.pop(ABOUT))))
            _check(about, kind, newest, sealed)
        elif must or sealed:
            raise NotOwnError(f"has arrays {sorted(members)}, must have {ABOUT!r}")
        else:
            about = None
        return Found(about, {name: _array(name, archive.read(entry)) for name, entry in members.items()}, sealed)


@contextmanager
def opened(owner: str, path: Path) -> Iterator[tuple[BinaryIO, int]]:
    """An ordinary file and its size; whatever is wrong with its content becomes a ValueError that names it."""
    if not stat.S_ISREG(os.stat(path).st_mode):
        raise ValueError(f"{owner}: {str(path)!r} is no ordinary file" + " but a folder" * path.is_dir())
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size == 0:
            raise ValueError(f"{owner}: {str(path)!r} is empty")
        try:
            yield file, size
        except OSError as error:
            if error.errno not in (None, errno.EINVAL):  # the disk's; a seek that a damaged archive asks for is EINVAL
                raise
            raise ValueError(f"{owner}: {str(path)!r} cannot be read: {error}") from None
        except zipfile.BadZipFile as error:
            raise ValueError(f"{owner}: {str(path)!r} cannot be read: cut off, damaged or no npz ({error})") from None
        except NotOwnError as error:
            raise ValueError(f"{owner}: {str(path)!r} {error}") from None
        except Exception as error:  # zipfile, zlib, struct and NumPy each have their own for damaged bytes
            raise ValueError(f"{owner}: {str(path)!r} cannot be read: {type(error).__name__}: {error}") from None


def _digest(file: BinaryIO, size: int) -> bytes:
    """Of the first `size` bytes."""
    found = hashlib.sha256()
    file.seek(0)
    while size > 0 and (part := file.read(min(CHUNK, size))):
        found.update(part)
        size -= len(part)
    return found.hexdigest().encode()


def _members(archive: zipfile.ZipFile, size: int) -> dict[str, zipfile.ZipInfo]:
    """The archive's arrays by name. ValueError for other files, equal names and what unpacks to far more."""
    entries = archive.infolist()
    most = max(LEAST, TIMES * size)
    if sum(entry.file_size for entry in entries) > most:
        raise NotOwnError(f"would unpack to more than {most} bytes, from {size}: not read")
    names = [entry.filename for entry in entries]
    if len(set(names)) < len(names) or not all(name.endswith(".npy") for name in names):
        raise NotOwnError(f"holds {sorted(names)[:9]}, must hold arrays with distinct names (.npy)")
    return {name.removesuffix(".npy"): entry for name, entry in zip(names, entries)}


def _array(name: str, content: bytes) -> np.ndarray:
    """An array from the bytes of a .npy file, all of which it must take."""
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    if version not in HEADERS:
        raise NotOwnError(f"holds {name!r} in version {version} of NumPy's format, which is not read")
    shape, columns_first, dtype = HEADERS[version](stream)
    if dtype.hasobject:
        raise NotOwnError(f"holds objects in {name!r}, which only a pickle carries: not opened (allow_pickle=False)")
    if dtype.kind not in (TEXT if name == ABOUT else NUMBERS) or not dtype.itemsize:
        raise NotOwnError(f"holds {dtype} in {name!r}, must be {'text' if name == ABOUT else 'numbers'}")
    start, size = stream.tell(), math.prod(shape) * dtype.itemsize
    if min(shape, default=0) < 0 or start + size != len(content):
        raise NotOwnError(f"holds {len(content) - start} bytes in {name!r}, its shape {shape} needs {size}")
    return np.ndarray(shape, dtype, buffer=content, offset=start, order="F" if columns_first else "C")


def _about(array: np.ndarray) -> dict[str, Any]:
    if array.shape != ():
        raise NotOwnError(f"holds {ABOUT!r} of shape {array.shape}, must be one text")
    about = json.loads(str(array))
    if not isinstance(about, dict):
        raise NotOwnError(f"holds {ABOUT!r} = {about!r}, must be a JSON object")
    return about


def _check(about: dict[str, Any], kind: str, newest: int, sealed: bool) -> None:
    """ValueError for another kind, a format that is not known yet, and one that should have a checksum."""
    said = about.get("kind", FIRST)
    if said != kind:
        raise NotOwnError(f"is a {said}, must be a {kind}")
    check_format(about.get("format"), newest)
    if about["format"] > 1 and not sealed:
        raise NotOwnError("has no checksum: another program has written it again, or it is damaged")


def check_format(form: Any, newest: int) -> None:
    """ValueError unless `form` is one that this version knows."""
    if isinstance(form, bool) or not isinstance(form, int) or form < 1:
        raise NotOwnError(f"says format {form!r}, must be one from 1 to {newest}")
    if form > newest:
        raise NotOwnError(f"was written by format {form}, this Pliant reads up to {newest}: a newer one reads it")
