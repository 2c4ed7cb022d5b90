"""The plan that a predictive controller falls back on where an optimisation fails: its last one, moved on in time."""

from __future__ import annotations

from typing import final

import numpy as np

from pliant.plants.core.signals import OwnsArrays

from .constraints import Step


@final
class LastPlan(OwnsArrays):
    """Of `horizon` steps, made from what was known, p (size,)."""

    def __init__(self, horizon: int, size: int) -> None:
        self.horizon, self.known = horizon, np.zeros(size)
        self.forget()

    def forget(self) -> None:
        """There is no plan."""
        self.step: Step | None = None
        self.z: np.ndarray | None = None
        self.age = 0
        self.known[:] = 0.0

    def keep(self, step: Step, known: np.ndarray, z: np.ndarray | None) -> None:
        """Keep the plan of one act; z None where no limit was active."""
        np.copyto(self.known, known)
        self.step, self.z, self.age = step, z, 0

    def go_on(self) -> np.ndarray | None:
        """The input (nu,) that the plan has for one step later than at the last call; None past its end."""
        self.age += 1
        return None if self.step is None or self.age >= self.horizon else self.inputs()[self.age]

    def inputs(self) -> np.ndarray:
        """All inputs of the plan (horizon, nu)."""
        assert self.step is not None
        G, M, fixed = self.step.plan
        planned = G @ self.known + fixed
        return planned if self.z is None else planned + M @ self.z
