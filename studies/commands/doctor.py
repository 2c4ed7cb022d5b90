"""What native code this machine gets: `pliant doctor` and `pliant cache info | clear | verify`."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

from pliant.plants import SingleLinkArm
from pliant.plants.integration.batch_stepper import step_kernel
from pliant.plants.native import compiler, kernel_cache, kernel_loader, thread_pool
from pliant.plants.toolchain import compiler_process

from .console import print_json, say, show
from .options import AsJson


def findings() -> dict[str, Any]:
    """Compiler, flags, vector width, cache and a trial kernel; `advice` says what to do where something is missing."""
    found: dict[str, Any] = {"native wanted": None, "processors": thread_pool.available(), "advice": []}
    try:
        found["native wanted"] = kernel_loader.wanted()
        compiler.candidates(), compiler.extra_flags()  # what CC and PLIANT_CFLAGS say can be read
    except compiler_process.CompilerSettingError as wrong:
        found["advice"].append(str(wrong))
        return found
    found["cache folder"] = str(kernel_cache.folder())
    if not found["native wanted"]:
        found["advice"].append("PLIANT_NATIVE=0 turns native code off; unset it to use compiled kernels")
    try:
        kernel_cache.checked_folder()
        found["cache"] = f"{len(kernel_cache.entries())} files, {_size() / 1e6:.2f} MB"
    except (kernel_cache.CacheError, OSError) as refused:
        found["cache"] = "refused"
        found["advice"].append(str(refused))
    try:
        tools = compiler.toolchain()
    except (compiler.CompileError, kernel_cache.CacheError, OSError) as missing:
        found["compiler"] = None
        if not isinstance(missing, kernel_cache.CacheError):
            found["advice"].append(f"{missing}. Install gcc or clang (or `pip install ziglang`), or set CC")
        elif str(missing) not in found["advice"]:  # the cache was refused before
            found["advice"].append(str(missing))
        return found
    found["compiler"] = " ".join(tools.command)
    found["version"] = tools.version
    found["vector width [bit]"] = tools.width
    found["flags"] = " ".join(tools.compile_flags)
    found["PLIANT_CFLAGS"] = " ".join(compiler.extra_flags()) or "not set"
    found["vector math"] = "libmvec" if "-lmvec" in tools.link_flags else "none: sin and cos are not vectorised"
    if "-lmvec" not in tools.link_flags:
        found["advice"].append("no libmvec: kernels with sin and cos run slower; glibc with gcc or clang has it")
    pooled = thread_pool.spreader() is not None
    found["thread pool"] = "compiled" if pooled else "Python's"
    if not pooled:
        found["advice"].append("the pool of threads in C cannot be built, so that small batches gain less from threads")
    why = _trial()
    found["trial kernel"] = f"not used: {why}" if why else "compiled, agrees with the virtual machine"
    if why and found["native wanted"]:
        found["advice"].append(f"a trial kernel cannot be used, so that others may not be either: {why}")
    return found


def _trial() -> str:
    """Why a small kernel, compiled and checked afresh, is not used; nothing where it is."""
    if not kernel_loader.wanted():
        return "PLIANT_NATIVE=0"
    kernel = step_kernel.__wrapped__(SingleLinkArm.textbook().ladder()[0], "rk4", np.dtype(float))
    assert kernel.source is not None
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "trial.so")
            path.write_bytes(compiler.build(kernel.source()))
            kernel_loader.check(path, kernel.trials(), kernel.dtype, kernel.lanes, "a trial kernel")
    except (compiler.CompileError, kernel_loader.KernelMismatch, OSError) as failure:
        return str(failure)
    return "" if kernel.native else "it is sound, but could not be kept in the cache"


def _size() -> int:
    return sum(path.stat().st_size for path in kernel_cache.entries())


def advise(as_json: bool) -> None:
    """Print the findings."""
    found = findings()
    if as_json:
        print_json(found)
        return
    show("Native code", ("what", "is"), [(name, str(value)) for name, value in found.items() if name != "advice"])
    for line in found["advice"] or ["Nothing is missing."]:
        say(line)


def manage_cache(action: str, as_json: bool) -> bool:
    """Show ("info"), empty ("clear") or check ("verify") the cache; False where a file is refused or damaged."""
    bad: list[str] = []
    result: dict[str, Any] = {"folder": str(kernel_cache.folder())}
    if action == "clear":
        result["removed"] = kernel_cache.clear()
    elif action == "verify":
        bad = _bad_files()
        result |= {"files": len(kernel_cache.entries()), "bad": bad}
    else:
        names = [path.name for path in kernel_cache.entries()]
        result["bytes"] = _size()
        for kind in ("kernel", "point", "threads", "toolchain", "slow", "building"):
            result[f"{kind} files"] = sum(name.startswith(kind) for name in names)
    if as_json:
        print_json(result)
    else:
        show("Cache", ("what", "is"), [(k, "; ".join(v) if isinstance(v, list) else str(v)) for k, v in result.items()])
    return not bad


def _bad_files() -> list[str]:
    """Files that another user could have written, and damaged ones."""
    bad = []
    for path in kernel_cache.entries():
        try:
            kernel_cache.check_own(path)
        except kernel_cache.CacheError as refused:
            bad.append(str(refused))
            continue
        if kernel_cache.unseal(path.read_bytes()) is None:
            bad.append(f"{path.name} is damaged; it will be built again when needed")
    return bad


def doctor(as_json: AsJson = False) -> None:
    """Say which compiler and vector width serve, where the cache is, and what to do if something is missing."""
    advise(as_json)


def cache(
    action: Annotated[Literal["info", "clear", "verify"], typer.Argument(help="What to do with the compiled kernels.")],
    as_json: AsJson = False,
) -> None:
    """Show, empty or check the cache of compiled kernels; verify ends with 1 where a file is refused or damaged."""
    if not manage_cache(action, as_json):
        raise typer.Exit(1)
