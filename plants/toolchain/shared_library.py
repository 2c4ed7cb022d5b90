"""Shared libraries as files: whether one is whole, and its functions.

The loader maps a file into memory and goes where its headers point: of a library that a full disk or a killed linker
cut short this ends the whole process (SIGBUS), which no handler sees. So headers are read before it is loaded.
"""

from __future__ import annotations

import ctypes
import struct
from pathlib import Path
from typing import Any

from .compiler_process import CompileError

ELF = b"\x7fELF"
OTHERS = (b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe", b"MZ")  # Mach-O of one and several processors, Windows: not read
LOADED = 1  # PT_LOAD
WORD = {1: "I", 2: "Q"}  # by EI_CLASS: 32 and 64 bit
ORDER = {1: "<", 2: ">"}  # by EI_DATA


def written(path: Path, maker: str) -> bytes:
    """The shared library that a compiler wrote; CompileError where it wrote none, or not all of it."""
    if not path.is_file():
        raise CompileError(f"{maker} says that it has compiled and linked, but wrote no shared library")
    return require_whole(path.read_bytes(), maker)


def require_whole(content: bytes, maker: str) -> bytes:
    """`content`; CompileError, which names the `maker`, unless it is a shared library with all that its headers name.

    Source  System V ABI, "Object Files": ELF header, program header
    """
    if not content.startswith((ELF, *OTHERS)):
        raise CompileError(f"{maker} wrote no shared library, but {len(content)} bytes that are none")
    if content.startswith(ELF):
        try:
            end = elf_end(content)
        except (struct.error, KeyError, IndexError, OverflowError):
            raise CompileError(f"{maker} wrote a shared library whose header is cut short or damaged") from None
        if end > len(content):
            raise CompileError(f"{maker} wrote {len(content)} bytes of a shared library of {end}")
    return content


def elf_end(content: bytes) -> int:
    """The byte after the last one that the headers of an ELF file name. Not caught: errors where there are none."""
    kind, order = WORD[content[4]], ORDER[content[5]]
    _, programs, sections, _, _, size, count, section_size, section_count = struct.unpack_from(
        f"{order}{3 * kind}I5H", content, 24
    )
    ends = [programs + size * count, sections + section_size * section_count]
    for k in range(count):
        at = programs + size * k
        if kind == "Q":
            what, _, start, _, _, length = struct.unpack_from(f"{order}IIQQQQ", content, at)
        else:
            what, start, _, _, length = struct.unpack_from(f"{order}5I", content, at)
        if what == LOADED:
            ends.append(start + length)
    return max(ends)


def functions(path: Path, *names: str) -> list[Any]:
    """Functions of a library; OSError where it cannot be loaded or has not all of them."""
    library = ctypes.CDLL(str(path))
    try:
        return [getattr(library, name) for name in names]
    except AttributeError as missing:
        raise OSError(f"{path.name} has not the functions {', '.join(names)}: {missing}") from missing
