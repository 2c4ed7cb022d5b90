"""The C compiler of this machine: which one, which of its flags help, and how a shared library is made with it.

What made gcc vectorise straight-line code over lanes: -O2 -march=native -ffast-math -fopenmp-simd, its vectoriser with
the cost model of -O3, the math calls kept apart (gcc merges sin and cos of one angle to sincos, which has no vector
form) and no SLP vectoriser. All of -O3 takes half as long again to compile and runs no faster (twelve kernels of six
scenes). clang keeps the calls apart by itself, finds their vector forms only where they are built in, and must not
unroll the lanes before it looks at them: else it leaves the loop scalar, at a third of the speed. -ffast-math is on the
compile step only: on the link step gcc would add crtfastmath.o, which sets flush-to-zero for the whole process.

A compiler that takes longer than TIMEOUT is asked once: its process and what that started are ended, and that it hangs,
or from which length of source on it takes too long, is remembered for an hour, also by later processes, under its path,
age and size: a repaired one is asked again.

Environment: CC names the compiler. PLIANT_CFLAGS adds flags after Pliant's own, so that they win, to the compile step
alone: PLIANT_CFLAGS=-mno-avx512f, or -march=x86-64-v3 for kernels that all of a cluster's processors run. Both are part
of a kernel's key in the cache, and are read once a process.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import platform
import shlex
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pliant.plants.toolchain import compiler_process, shared_library, straight_line
from pliant.plants.toolchain.compiler_process import (
    CompileError,
    CompilerTimeout,
    NoCompiler,
    candidates,
    extra_flags,
    program,
)

from . import kernel_cache

TIMEOUT = 60.0  # [s] for one compilation; past it the virtual machine serves
ANSWER, REMEMBERED = 10.0, 3600.0  # [s] for a few lines after a time-out, and how long a time-out is remembered
REQUIRED = ("-fPIC", "-std=gnu11")
OPTIONAL = ("-march=native", "-ffast-math", "-fopenmp-simd", "-fno-tree-slp-vectorize")
MATH_APART = tuple(f"-fno-builtin-{name}{suffix}" for name in ("sin", "cos") for suffix in ("", "f"))
GCC = ("-O2", "-ftree-vectorize", "-fvect-cost-model=dynamic", *MATH_APART)
CLANG = ("-O3", "-fno-unroll-loops", "-fveclib=libmvec")
WIDE = "-mprefer-vector-width=512"
WIDTHS = ((512, "__AVX512F__"), (256, "__AVX__"), (128, "__SSE2__"), (128, "__ARM_NEON"))  # [bit], and its macro
LINKS = (("-lmvec", "-lm"), ("-lm",), ())
LONG_SOURCE, LONGEST, QUICK = 1e5, 4e6, ("-O1", "-ftree-vectorize")  # half the time to compile, a twentieth more to run
PASSES = ("fre", "dominator-opts", "reassoc", "dse", "forwprop")  # a fifth of the time; the longest run as fast without
UNITS = 4  # of a long source that is in parts, compiled beside each other; the same on every machine
PROBE = """#include <math.h>
void probe(double *x) { _Pragma("omp simd") for (int l = 0; l < 8; l++) x[l] = sin(x[l]) + cos(x[l]); }
"""


@dataclass(frozen=True)
class Toolchain:
    """A compiler with the flags that it takes."""

    command: tuple[str, ...]
    version: str  # first line of --version
    target: str  # hash of all macros that the compiler defines: its version and the CPU's resolved features
    width: int  # vector width [bit]
    compile_flags: tuple[str, ...]
    link_flags: tuple[str, ...]

    @property
    def key(self) -> str:
        """What a compiled kernel depends on besides its source."""
        return json.dumps(asdict(self), sort_keys=True)


def _run(
    command: tuple[str, ...], *args: str, text: str = "", limit: float | None = None
) -> subprocess.CompletedProcess[str]:
    return compiler_process.run(command, *args, text=text, limit=TIMEOUT if limit is None else limit)


def _stamp(command: tuple[str, ...]) -> str:
    """Changes when the compiler or the CPU does; costs no process."""
    cpu = platform.processor() + platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        lines = cpuinfo.read_text().splitlines()
        cpu += "".join(sorted({s for s in lines if s.startswith(("model name", "flags", "Features"))}))
    tried = OPTIONAL, GCC, CLANG, PROBE, extra_flags()
    parts = (*command, *program(command), cpu, *tried)
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:24]


@functools.cache
def toolchain() -> Toolchain:
    """The first compiler that works, remembered between processes; NoCompiler where there is none."""
    tried = []
    for command in candidates():
        try:
            if slow := _slow(command, 0):
                raise CompilerTimeout(slow)
            stored = _stored(command)
            if stored is None:
                stored = _probe(command)
                _store(stored)
            return stored
        except (CompileError, OSError) as failure:
            if isinstance(failure, CompilerTimeout) and not _slow(command, 0):
                _remember(command, 0, str(failure))
            tried.append(f"{'CC=' if os.environ.get('CC') else ''}{shlex.join(command)}: {failure}")
    raise NoCompiler("no working C compiler: " + ("; ".join(tried) or "install gcc or clang, or set CC"))


def _toolchain_file(command: tuple[str, ...]) -> str:
    return f"toolchain-{_stamp(command)}.json"


def _store(tools: Toolchain) -> None:
    with contextlib.suppress(OSError):  # a full disk is not the compiler's fault; later processes ask anew
        kernel_cache.write(_toolchain_file(tools.command), json.dumps(asdict(tools)).encode())


def _stored(command: tuple[str, ...]) -> Toolchain | None:
    """What an earlier process found out of a compiler; None where the cache has nothing, or nothing of ours."""
    name = _toolchain_file(command)
    try:
        fields: dict[str, Any] | None = json.loads(kernel_cache.read_text(name) or "null")
        if fields is None:
            return None
        values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in fields.items()}
        found = Toolchain(**values)
        if _plausible(found, command):
            return found
    except (ValueError, TypeError, AttributeError):  # no JSON, no text, other fields
        pass
    kernel_cache.remove(name)
    return None


def _plausible(found: Toolchain, command: tuple[str, ...]) -> bool:
    """Whether a toolchain read from a file is one that `_probe` could have written for this command."""
    extra = extra_flags()
    own = found.compile_flags[len(REQUIRED) : len(found.compile_flags) - len(extra)]
    return (
        found.command == command
        and isinstance(found.version, str)
        and isinstance(found.target, str)
        and found.width in (64, *(bits for bits, _ in WIDTHS))
        and found.compile_flags == (*REQUIRED, *own, *extra)
        and set(own) <= {*OPTIONAL, WIDE, *GCC, *CLANG}
        and found.link_flags in LINKS
    )


_memories: dict[str, tuple[float, int, str]] = {}  # by file: when, from which length on, and what was said


def _memory(command: tuple[str, ...], flags: tuple[str, ...]) -> str:
    key = hashlib.sha256(repr((*command[1:], *program(command), flags)).encode()).hexdigest()[:24]
    return f"slow-{key}.json"


def _slow(command: tuple[str, ...], length: int, flags: tuple[str, ...] = ()) -> str | None:
    """Why a source of this length is not given to a compiler, which took too long within the hour; or None.

    What took too long with some flags says nothing of others, unless nothing is answered: start 0, under no flags.
    """
    for name, long in ((_memory(command, ()), 0 if flags else length), (_memory(command, flags), length)):
        if name not in _memories:
            try:
                when, start, why = json.loads(kernel_cache.read_text(name) or '[0, 0, ""]')
                _memories[name] = float(when), int(start), str(why)
            except (ValueError, TypeError):  # not written by us
                kernel_cache.remove(name)
                _memories[name] = 0.0, 0, ""
        when, start, why = _memories[name]
        if 0 <= time.time() - when < REMEMBERED and long >= start:
            return f"{why}; it is asked again an hour later, or when it changes"
    return None


def _remember(command: tuple[str, ...], start: int, why: str, flags: tuple[str, ...] = ()) -> None:
    """Keep in mind that a compiler takes too long for sources from a length on; 0, with no flags: for all."""
    name = _memory(command, flags)
    _memories[name] = time.time(), start, why
    with contextlib.suppress(OSError, kernel_cache.CacheError):  # this process knows; later ones will find out
        kernel_cache.write(name, json.dumps(_memories[name]).encode())


def _probe(command: tuple[str, ...]) -> Toolchain:
    version, extra = _run(command, "--version").stdout.splitlines(), extra_flags()
    native = _run(command, "-march=native", *extra, "-dM", "-E", "-x", "c", "-").stdout
    macros = native or _run(command, *extra, "-dM", "-E", "-x", "c", "-").stdout
    flags = list(REQUIRED)
    wide = (WIDE,) if "__AVX512F__" in macros else ()
    own = CLANG if "__clang__" in macros else GCC
    with tempfile.TemporaryDirectory() as folder:
        source, output = Path(folder, "probe.c"), Path(folder, "probe.o")
        source.write_text(PROBE)

        def takes(*more: str) -> bool:
            output.unlink(missing_ok=True)
            done = _run(command, *flags, "-Werror", *more, "-c", str(source), "-o", str(output))
            return done.returncode == 0 and output.exists()

        if not takes():
            raise CompileError("does not compile a small C file")
        refused = CompileError(f"does not take PLIANT_CFLAGS={shlex.join(extra)}")
        if extra and not takes(*extra):  # at once, as all that follows is in vain then
            raise refused
        flags += [flag for flag in (*OPTIONAL, *wide, *own) if takes(flag)]
        flags += extra
        if not takes():  # the object with all flags, for the link probe
            raise refused
        link = []
        made = Path(folder, "probe.so")
        for libraries in LINKS:
            done = _run(command, "-shared", str(output), "-o", str(made), *libraries)
            if done.returncode == 0:
                shared_library.written(made, command[0])
                link = list(libraries)
                break
        else:
            added = f" with PLIANT_CFLAGS={shlex.join(extra)}" if extra else ""
            raise CompileError(f"does not link a shared library{added}: {done.stderr.strip()[:200]}")
    width = next((bits for bits, macro in WIDTHS if macro in macros), 64)
    target = hashlib.sha256(macros.encode()).hexdigest()[:24]
    return Toolchain(command, version[0] if version else "", target, width, tuple(flags), tuple(link))


def _flags_for(source: str, tools: Toolchain) -> tuple[str, ...]:
    """The toolchain's compile flags, and for a long source those that it is quicker with; added ones stay last."""
    own = len(tools.compile_flags) - len(extra_flags())
    quick: tuple[str, ...] = QUICK if len(source) > LONG_SOURCE and CLANG[1] not in tools.compile_flags else ()
    if len(source) > LONGEST:  # of clang a sixth of the time; the longest run as fast
        quick = (*QUICK, *(f"-fno-tree-{name}" for name in PASSES)) if quick else QUICK[:1]
    return (*tools.compile_flags[:own], *quick, *tools.compile_flags[own:])


def digest(source: str, tools: Toolchain) -> str:
    """The name under which what is compiled from a source is kept."""
    return hashlib.sha256(f"{source}\n{tools.key}\n{_flags_for(source, tools)}".encode()).hexdigest()[:32]


def build(source: str, flags: tuple[str, ...] = ()) -> bytes:
    """The shared library made from C source, as bytes. CompileError, at once where as much took too long before."""
    tools = toolchain()
    if slow := _slow(tools.command, len(source), flags):
        raise CompileError(slow)
    try:
        return _built(tools, source, flags)
    except CompilerTimeout as late:
        why = f"{late} for {len(source) / 1e3:.0f} kB of C; a smaller model compiles faster"
        try:
            _built(tools, PROBE, limit=ANSWER)
            _remember(tools.command, len(source) // 2, why, flags)
        except CompileError:
            _remember(tools.command, 0, why)
            toolchain.cache_clear()  # another compiler may work
        raise CompilerTimeout(why) from late
    except CompileError:
        if (renewed := _probe(tools.command)) == tools:
            raise
        _store(renewed)  # the compiler, or what it may do, has changed since it was asked
        toolchain.cache_clear()
        return _built(renewed, source, flags)


def _built(tools: Toolchain, source: str, flags: tuple[str, ...] = (), limit: float | None = None) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        units = UNITS if len(source) > LONG_SOURCE and "#if IN_UNIT(" in source else 1
        objects = [str(Path(folder, f"kernel{k}.o")) for k in range(units)]

        def run(*arguments: str) -> None:
            done = _run(tools.command, *arguments, *flags, limit=limit)
            if done.returncode:
                said = done.stderr.strip()[:500] or f"it ended with {done.returncode} and no word"
                raise CompileError(f"{tools.command[0]} failed: {said}")

        def unit(k: int) -> None:
            parts = (f"-DUNITS={units}", f"-DUNIT={k}") if units > 1 else ()
            c = str(Path(folder, f"kernel{k if parts else ''}.c"))
            Path(c).write_text(straight_line.of_unit(source, units, k) if units > 1 else source)
            run(*_flags_for(source, tools), *parts, "-c", c, "-o", objects[k])

        with ThreadPoolExecutor(min(units, os.cpu_count() or 1)) as pool:
            list(pool.map(unit, range(units)))
        run("-shared", *objects, "-o", str(so := Path(folder, "kernel.so")), *tools.link_flags)
        return shared_library.written(so, tools.command[0])
