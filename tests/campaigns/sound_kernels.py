"""Kernels without a fault: how far rounding moves them, by compiler, and that the check lets all of them pass.

    python tests/campaigns/sound_kernels.py

Every kind of kernel of every scene (tests/cases/kernels.py) in both precisions, and rates and step maps as functions of
one point, by gcc, by clang, and for x86-64-v3, as far as they are there. The campaign fails where a sound kernel is
refused; z is the largest error in what rounding explains, at a point and over the points: agreement.py's MOST and
TOGETHER stand well above.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

import by_seed
import kernels
import numpy as np

from pliant.envs import scenes
from pliant.plants.integration.batch_stepper import rate_function
from pliant.plants.integration.step_maps import step_map
from pliant.plants.native import compiler, kernel_loader, single_point
from pliant.plants.rounding.agreement import KernelMismatch

SETTINGS = (("gcc", ""), ("clang", ""), ("gcc", "-march=x86-64-v3"))
PATIENCE = 600.0  # [s] for one compilation, also on a machine that is busy
SINGLES = ("rates", "rk4 map", "rosenbrock map")


def names() -> list[tuple[str, str]]:
    """Kernel and precision, those of one point in double precision alone."""
    once = ("observations", "newton")
    many = [
        (n, p) for n in kernels.of_scenes() for p in ("float64", "float32") if p == "float64" or not n.endswith(once)
    ]
    return many + [(f"{scene} point {kind}", "float64") for scene in scenes.names() for kind in SINGLES]


def _point(name: str) -> Any:
    scene, kind = name.split(" point ")
    plant = scenes.get(scene).plant
    return rate_function(plant) if kind == "rates" else step_map(plant, kind.removesuffix(" map"))


def run(seed: int) -> dict[str, Any]:
    """One kernel by one compiler."""
    setting, (name, precision) = SETTINGS[seed % len(SETTINGS)], names()[seed // len(SETTINGS)]
    row: dict[str, Any] = {"seed": seed, "kernel": name, "precision": precision, "by": " ".join(setting).strip()}
    if not shutil.which(setting[0]):
        return row | {"state": "no such compiler"}
    os.environ["CC"], os.environ["PLIANT_CFLAGS"], os.environ["PLIANT_NATIVE"] = *setting, "0"
    compiler.toolchain.cache_clear()
    point = _point(name) if " point " in name else None
    kernel = None if point is not None else kernels.of_scenes()[name](np.dtype(precision))
    os.environ["PLIANT_NATIVE"], compiler.TIMEOUT = "1", PATIENCE
    began = time.perf_counter()
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "kernel.so")
            if kernel is None:
                writer = single_point.ca.CodeGenerator("point")
                writer.add(point)
                path.write_bytes(compiler.build(writer.dump(), single_point.PLAIN))
            else:
                path.write_bytes(compiler.build(kernel.source()))
            compiled = time.perf_counter()
            if kernel is None:
                z = single_point.check(single_point._load(point.name(), path), point, name)
            else:
                z = kernel_loader.check(path, kernel.trials(), kernel.dtype, kernel.lanes, name)
    except (NotImplementedError, compiler.CompileError) as why:
        return row | {"state": "not compiled", "why": str(why)[:200]}
    except KernelMismatch as refused:
        return row | {"state": "refused", "why": str(refused)}
    ended = time.perf_counter()
    return row | {"state": "sound", "z": list(z), "compile": compiled - began, "check": ended - compiled}


def summary(rows: list[dict[str, Any]]) -> str:
    """By compiler and precision."""
    lines = [
        "by                         precision  sound  refused  not compiled  z at a point  together  check/compile"
    ]
    for by in sorted({r["by"] for r in rows}):
        for precision in ("float64", "float32"):
            mine = [r for r in rows if r["by"] == by and r["precision"] == precision]
            sound = [r for r in mine if r["state"] == "sound"]
            most, together = np.max([r["z"] for r in sound], axis=0) if sound else (np.nan, np.nan)
            share = sum(r["check"] for r in sound) / max(1e-9, sum(r["compile"] for r in sound))
            refused, other = (sum(r["state"] == s for r in mine) for s in ("refused", "not compiled"))
            counts = f"{len(sound):5d} {refused:8d} {other:13d}"
            lines.append(f"{by:26s} {precision}   {counts} {most:13.2f} {together:9.2f} {share:14.2f}")
    lines += [
        f"refused: {r['kernel']} {r['precision']} by {r['by']}: {r['why']}" for r in rows if r["state"] == "refused"
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    by_seed.main(__doc__ or "", len(names()) * len(SETTINGS), run, summary, lambda row: row["state"] == "refused")
