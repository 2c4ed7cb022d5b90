"""Compilers as processes: nonsense in the environment is named, and one that hangs is ended with all it started."""

import os
import time
from pathlib import Path

import pytest

from pliant.plants.toolchain.compiler_process import (
    CompileError,
    CompilerSettingError,
    CompilerTimeout,
    program,
    run,
    words,
)


@pytest.mark.parametrize("value", ['gcc "', "gcc 'a", "gcc \\"])
def test_what_cannot_be_split_is_named(monkeypatch, value) -> None:
    monkeypatch.setenv("CC", value)
    with pytest.raises(CompilerSettingError, match=r"CC=.* cannot be split into words as a shell does"):
        words("CC")


def test_words_are_those_of_a_shell(monkeypatch) -> None:
    monkeypatch.setenv("CC", "ccache 'my gcc' -m64")
    assert words("CC") == ("ccache", "my gcc", "-m64") and words("NOT_SET_ANYWHERE") == ()


def test_what_is_missing_is_named() -> None:
    with pytest.raises(CompileError, match="no-such-compiler cannot be run"):
        run(("no-such-compiler",), limit=1.0)


@pytest.mark.skipif(os.name != "posix", reason="process groups are POSIX's")
def test_what_it_started_ends_with_it(tmp_path) -> None:
    """A shell's child would keep the output open, and go on for ten seconds."""
    slow, child = tmp_path / "slow", tmp_path / "child"
    slow.write_text(f"#!/bin/sh\nsleep 10 &\necho $! > {child}\nwait\n")
    slow.chmod(0o755)
    began = time.perf_counter()
    with pytest.raises(CompilerTimeout, match="slow took more than 2 s"):
        run((str(slow),), limit=2.0)
    assert time.perf_counter() - began < 8.0
    state = Path(f"/proc/{child.read_text().strip()}/stat")
    while _runs(state):  # killed, but not at once: the machine may be busy
        assert time.perf_counter() - began < 8.0
        time.sleep(0.01)


def _runs(state: Path) -> bool:
    try:
        return state.read_text().split()[2] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_program_is_the_same_under_all_its_names(tmp_path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_text("x")
    other.symlink_to(one)
    assert program((str(one),)) == program((str(other),))
    one.write_text("xy")
    assert program((str(one),))[2] == 2
