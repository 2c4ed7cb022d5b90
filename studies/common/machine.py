"""What a measurement was made with: versions and machine, without names of hosts, users or folders."""

from __future__ import annotations

import os
import platform
from importlib import metadata
from pathlib import Path
from typing import Any

from pliant.plants.core.argument_gates import require_count

PACKAGES = ("pliant", "numpy", "scipy", "casadi", "control", "matplotlib")
PATH = (
    "simulate: compiled code of rk4, rk8, rosenbrock, dop853, rodas5p where at hand or where it pays, else the "
    "virtual machine"
)


def processor() -> str:
    """The processor's model name, or its architecture where the system does not tell."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names and names[0] else platform.processor() or platform.machine()


def cores() -> int:
    """Processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def processes(owner: str, jobs: Any) -> int:
    """As joblib counts them: -1 is as many as cores, -2 one less; not 0."""
    found = require_count(owner, "jobs", jobs, -10_000, 10_000)
    if not found:
        raise ValueError(f"{owner}.jobs = 0 must be a number of processes, or -1 for as many as cores")
    return found


def version(package: str) -> str:
    """The installed version, or "not installed"."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def describe() -> dict[str, str]:
    """Versions and machine by name, for a table."""
    found = {
        "processor": processor(),
        "cores": str(cores()),
        "system": f"{platform.system()} {platform.machine()}",
        "evaluation": PATH,
        "python": platform.python_version(),
    }
    return found | {package: version(package) for package in PACKAGES}
