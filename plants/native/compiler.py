"""The C compiler of this machine: which one, which of its flags help, and how a shared library is made with it.

What made gcc vectorise straight-line code over lanes: -O2 -march=native -ffast-math -fopenmp-simd, its vectoriser with
the cost model of -O3, the math calls kept apart (gcc merges sin and cos of one angle to sincos, which has no vector
form) and no SLP vectoriser. All of -O3 takes half as long again to compile and runs no faster (twelve kernels of six
scenes). clang keeps the calls apart by itself, finds their vector forms only where they are built in, and must not
unroll the lanes before it looks at them: else it leaves the loop scalar, at a third of the speed. -ffast-math is on the
compile step only: on the link step gcc would add crtfastmath.o, which sets flush-to-zero for the whole process.

Environment: CC names the compiler. PLIANT_CFLAGS adds flags after Pliant's own, so that they win, to the compile step
alone: PLIANT_CFLAGS=-mno-avx512f, or -march=x86-64-v3 for kernels that all of a cluster's processors run. Both are part
of a kernel's key in the cache, and are read once a process.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pliant.plants.core.errors import PliantError

from . import kernel_cache

TIMEOUT = 60.0  # [s] for one compilation; past it the virtual machine serves
REQUIRED = ("-fPIC", "-std=gnu11")
OPTIONAL = (
    "-march=native",
    "-ffast-math",
    "-fopenmp-simd",
    "-fno-tree-slp-vectorize",
)
MATH_APART = tuple(f"-fno-builtin-{name}{suffix}" for name in ("sin", "cos") for suffix in ("", "f"))
GCC = ("-O2", "-ftree-vectorize", "-fvect-cost-model=dynamic", *MATH_APART)
CLANG = ("-O3", "-fno-unroll-loops", "-fveclib=libmvec")
LONG_SOURCE, QUICK = 100_000, ("-O1", "-ftree-vectorize")  # half the time to compile, a twentieth more to run
PROBE = """#include <math.h>
void probe(double *x) { _Pragma("omp simd") for (int l = 0; l < 8; l++) x[l] = sin(x[l]) + cos(x[l]); }
"""


def extra_flags() -> tuple[str, ...]:
    """The flags that $PLIANT_CFLAGS adds, split as a shell does."""
    return tuple(shlex.split(os.environ.get("PLIANT_CFLAGS", "")))


class CompileError(PliantError):
    """The compiler failed, took too long or is missing."""


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


def candidates() -> list[tuple[str, ...]]:
    """Compiler commands to try, best first: $CC alone where it is set."""
    if os.environ.get("CC"):
        return [tuple(shlex.split(os.environ["CC"]))]
    found: list[tuple[str, ...]] = [(path,) for name in ("cc", "gcc", "clang") if (path := shutil.which(name))]
    if importlib.util.find_spec("ziglang"):
        found.append((sys.executable, "-m", "ziglang", "cc"))
    return found


def _run(command: tuple[str, ...], *args: str, text: str = "") -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run([*command, *args], input=text, capture_output=True, text=True, timeout=TIMEOUT)
    except subprocess.TimeoutExpired as late:
        raise CompileError(f"{command[0]} took more than {TIMEOUT:.0f} s; a smaller model compiles faster") from late
    except OSError as missing:
        raise CompileError(f"{command[0]} cannot be run: {missing}") from missing


def _stamp(command: tuple[str, ...]) -> str:
    """Changes when the compiler or the CPU does; costs no process."""
    path = shutil.which(command[0]) or command[0]
    info = os.stat(path)
    cpu = platform.processor() + platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        lines = cpuinfo.read_text().splitlines()
        cpu += "".join(sorted({s for s in lines if s.startswith(("model name", "flags", "Features"))}))
    tried = OPTIONAL, GCC, CLANG, PROBE, extra_flags()
    parts = (*command, os.path.realpath(path), info.st_mtime_ns, info.st_size, cpu, *tried)
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:24]


@functools.cache
def toolchain() -> Toolchain:
    """The first compiler that works, remembered between processes; CompileError where there is none."""
    tried = []
    for command in candidates():
        try:
            name = f"toolchain-{_stamp(command)}.json"
            if stored := kernel_cache.read_text(name):
                fields: dict[str, Any] = json.loads(stored)
                fields = {k: tuple(v) if isinstance(v, list) else v for k, v in fields.items()}
                return Toolchain(**fields)
            found = _probe(command)
            kernel_cache.write(name, json.dumps(asdict(found)).encode())
            return found
        except (CompileError, OSError) as failure:
            tried.append(f"{' '.join(command)}: {failure}")
    raise CompileError("no working C compiler: " + ("; ".join(tried) or "install gcc or clang, or set CC"))


def _probe(command: tuple[str, ...]) -> Toolchain:
    version, extra = _run(command, "--version").stdout.splitlines(), extra_flags()
    native = _run(command, "-march=native", *extra, "-dM", "-E", "-x", "c", "-").stdout
    macros = native or _run(command, *extra, "-dM", "-E", "-x", "c", "-").stdout
    flags = list(REQUIRED)
    wide = ("-mprefer-vector-width=512",) if "__AVX512F__" in macros else ()
    own = CLANG if "__clang__" in macros else GCC
    with tempfile.TemporaryDirectory() as folder:
        source, output = Path(folder, "probe.c"), Path(folder, "probe.o")
        source.write_text(PROBE)

        def takes(*more: str) -> bool:
            done = _run(command, *flags, "-Werror", *more, "-c", str(source), "-o", str(output))
            return done.returncode == 0

        if not takes():
            raise CompileError("does not compile a small C file")
        flags += [flag for flag in (*OPTIONAL, *wide, *own) if takes(flag)]
        if extra and not takes(*extra):
            raise CompileError(f"does not take PLIANT_CFLAGS={shlex.join(extra)}")
        flags += extra
        takes()  # the object with all flags, for the link probe
        link = []
        for libraries in (("-lmvec", "-lm"), ("-lm",), ()):
            done = _run(command, "-shared", str(output), "-o", str(Path(folder, "probe.so")), *libraries)
            if done.returncode == 0:
                link = list(libraries)
                break
        else:
            raise CompileError(f"does not link a shared library: {done.stderr.strip()[:200]}")
    widths = ((512, "__AVX512F__"), (256, "__AVX__"), (128, "__SSE2__"), (128, "__ARM_NEON"))
    width = next((bits for bits, macro in widths if macro in macros), 64)
    target = hashlib.sha256(macros.encode()).hexdigest()[:24]
    return Toolchain(command, version[0] if version else "", target, width, tuple(flags), tuple(link))


def _flags_for(source: str, tools: Toolchain) -> tuple[str, ...]:
    """The toolchain's compile flags, and for a long source those that gcc is quicker with; added ones stay last."""
    own = len(tools.compile_flags) - len(extra_flags())
    quick = QUICK if len(source) > LONG_SOURCE and CLANG[1] not in tools.compile_flags else ()
    return (*tools.compile_flags[:own], *quick, *tools.compile_flags[own:])


def digest(source: str, tools: Toolchain) -> str:
    """The name under which what is compiled from a source is kept."""
    return hashlib.sha256(f"{source}\n{tools.key}\n{_flags_for(source, tools)}".encode()).hexdigest()[:32]


def build(source: str, flags: tuple[str, ...] = ()) -> bytes:
    """The shared library made from C source, as bytes."""
    tools = toolchain()
    with tempfile.TemporaryDirectory() as folder:
        c, o, so = (str(Path(folder, f"kernel.{end}")) for end in ("c", "o", "so"))
        Path(c).write_text(source)
        for arguments in (
            (*_flags_for(source, tools), *flags, "-c", c, "-o", o),
            ("-shared", o, "-o", so, *tools.link_flags, *flags),
        ):
            done = _run(tools.command, *arguments)
            if done.returncode:
                raise CompileError(f"{tools.command[0]} failed: {done.stderr.strip()[:500]}")
        return Path(so).read_bytes()
