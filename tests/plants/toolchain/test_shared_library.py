"""Shared libraries that a compiler leaves: whole ones, ones cut short, other things, ones without what is asked for."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pliant.plants.toolchain import shared_library
from pliant.plants.toolchain.compiler_process import CompileError

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="ELF")


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> Path:
    """A library with one function, as the machine's own compiler makes it."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no compiler")
    folder = tmp_path_factory.mktemp("library")
    source, made = folder / "one.c", folder / "one.so"
    source.write_text("int one(void) { return 1; }\n")
    subprocess.run([compiler, "-shared", "-fPIC", str(source), "-o", str(made)], check=True)
    return made


@LINUX
def test_every_cut_through_a_library_is_seen(library):
    """That what is left cannot be loaded, or ends the process, is not tried out on it."""
    content = library.read_bytes()
    assert shared_library.require_whole(content, "cc") is content
    for length in (0, 3, 4, 20, 63, 64, 100, 1000, len(content) // 2, len(content) - 1):
        with pytest.raises(CompileError, match="cc wrote"):
            shared_library.require_whole(content[:length], "cc")


@LINUX
def test_the_naive_way_ends_the_process(library, tmp_path):
    """What loading a library without its last pages does: a signal, not an exception."""
    content = library.read_bytes()
    half = tmp_path / "half.so"
    half.write_bytes(content[:3000])
    code = f"import ctypes\ntry: ctypes.CDLL({str(half)!r})\nexcept OSError: raise SystemExit(7)"
    status = subprocess.run([sys.executable, "-c", code]).returncode
    assert status < 0 or status == 7  # by a signal; a loader that looks first says so


@pytest.mark.parametrize(
    "content", [b"", b"not a library", b"\x7fELF", b"\x7fELF" + bytes(60), b"\x7fELF\x02\x01" + b"\xff" * 90]
)
def test_what_is_no_library_is_refused(content):
    with pytest.raises(CompileError, match="gcc wrote"):
        shared_library.require_whole(content, "gcc")


def test_a_function_that_is_missing_is_an_error_of_the_file(library):
    (one,) = shared_library.functions(library, "one")
    assert one() == 1
    with pytest.raises(OSError, match="two"):
        shared_library.functions(library, "one", "two")
