"""Import what commands and tests use, so that the bytecode of that is written now and not by every process at once.

What is not installed is passed over: PyTorch and Stable-Baselines3 come with the extra `rl`.
"""

import contextlib
import importlib

import pliant.controllers
import pliant.envs
import pliant.plants
import pliant.studies

PACKAGES = (pliant.plants, pliant.envs, pliant.controllers, pliant.studies)
OTHERS = (
    "control",
    "matplotlib.pyplot",
    "scipy.stats",
    "stable_baselines3",
    "torch",
    "distributed",
    "mpmath",
    "pytest",
)

if __name__ == "__main__":
    for package in PACKAGES:
        for name in package.__all__:
            getattr(package, name)
    for name in ("pliant.studies.commands.cli", *OTHERS):
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
