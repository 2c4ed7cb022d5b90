"""A compiler as a process: what the environment says of it, how it is run, and how it is ended with all it started."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import shlex
import shutil
import signal
import subprocess
import sys

from pliant.plants.core.errors import PliantError


class CompilerSettingError(PliantError, ValueError):
    """CC, PLIANT_CFLAGS or PLIANT_NATIVE says something that cannot be meant."""


class CompileError(PliantError):
    """The compiler failed, took too long or is missing."""


class CompilerTimeout(CompileError):
    """The compiler took longer than it is given."""


class NoCompiler(CompileError):
    """No compiler works: that holds for every kernel."""


def words(variable: str) -> tuple[str, ...]:
    """An environment variable split as a shell does."""
    value = os.environ.get(variable, "")
    try:
        return tuple(shlex.split(value))
    except ValueError as wrong:
        raise CompilerSettingError(
            f"{variable}={value!r} cannot be split into words as a shell does: {wrong}"
        ) from wrong


def extra_flags() -> tuple[str, ...]:
    """The flags that $PLIANT_CFLAGS adds."""
    return words("PLIANT_CFLAGS")


def candidates() -> list[tuple[str, ...]]:
    """Compiler commands to try, best first: $CC alone where it is set."""
    if os.environ.get("CC"):
        if not (command := words("CC")):
            raise CompilerSettingError(f"CC={os.environ['CC']!r} names no compiler; unset it, or say CC=gcc")
        return [command]
    found: list[tuple[str, ...]] = [(path,) for name in ("cc", "gcc", "clang") if (path := shutil.which(name))]
    if importlib.util.find_spec("ziglang"):
        found.append((sys.executable, "-m", "ziglang", "cc"))
    return found


def run(command: tuple[str, ...], *args: str, text: str = "", limit: float) -> subprocess.CompletedProcess[str]:
    """A finished process, whatever its status, with its output as text; at most `limit` [s].

    Raises CompilerTimeout, its children ended with it, and CompileError where it cannot be started.
    """
    pipe, group = subprocess.PIPE, os.name == "posix"
    try:
        child = subprocess.Popen(
            [*command, *args],
            stdin=pipe,
            stdout=pipe,
            stderr=pipe,
            text=True,
            errors="replace",
            start_new_session=group,
        )
    except (OSError, ValueError) as missing:
        raise CompileError(f"{command[0]} cannot be run: {missing}") from missing
    with child:
        try:
            output, errors = child.communicate(text, timeout=limit)
        except BaseException as ended:
            if group:  # a driver's own children would go on
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(child.pid, signal.SIGKILL)
            child.kill()
            if isinstance(ended, subprocess.TimeoutExpired):
                raise CompilerTimeout(f"{command[0]} took more than {limit:.3g} s") from ended
            raise
    return subprocess.CompletedProcess(child.args, child.returncode, output, errors)


def program(command: tuple[str, ...]) -> tuple[str, int, int]:
    """Path, age and size of a compiler: the same under all its names."""
    path = os.path.realpath(shutil.which(command[0]) or command[0])
    info = os.stat(path)
    return path, info.st_mtime_ns, info.st_size
