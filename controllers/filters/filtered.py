"""A controller with filters behind it: each of its inputs passes through all of them, about its reference.

    u = u_ref + F (law(t, y) - u_ref), within the law's limits

Filters that are continuous are sampled at the law's period, each exact at its own frequency.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import Any, final

import numpy as np

from pliant.controllers.analysis.linear_laws import LinearLaw, law_of
from pliant.controllers.base.controller import Controller, moment, reading
from pliant.plants.core.argument_gates import require_all, require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays

from .filter import Filter


@final
@dataclass(eq=False)
class Filtered(OwnsArrays):
    """`law` and the filters behind it, in order. Where the law is continuous it has margins but cannot act."""

    law: Any
    filters: tuple[Filter, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.law, LinearLaw):
            require_instance("Filtered.law", self.law, Controller)
        given = (self.filters,) if isinstance(self.filters, Filter) else self.filters
        self.filters = require_all("Filtered.filters", given, Filter)
        if not self.filters:
            raise ValueError("Filtered.filters = () must hold at least one Filter")
        sampled = [f if f.dt is not None or self.dt is None else f.discretised(self.dt) for f in self.filters]
        for k, one in enumerate(sampled):
            if one.dt != self.dt:
                raise ValueError(f"Filtered.filters[{k}].dt = {one.dt} must be None or the law's, {self.dt}")
        self.whole: Filter = reduce(Filter.then, sampled)  # all of them
        self.reset()

    @property
    def dt(self) -> float | None:
        """The law's period [s]."""
        return self.law.dt  # type: ignore[no-any-return]

    @property
    def reads(self) -> tuple[str, ...]:
        """What the law reads."""
        return tuple(self.law.reads)

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray] | None:
        """(lowest, highest) of the law, where it has any."""
        limits = getattr(self.law, "limits", None)
        if limits is not None and hasattr(limits, "low"):
            return limits.low, limits.high
        return limits

    @property
    def u_ref(self) -> np.ndarray | None:
        """(nu,) about which it filters: the law's u0 or u_ref; None: zero."""
        for law in (self.law, getattr(self.law, "law", None)):
            for name in ("u0", "u_ref"):
                found = getattr(law, name, None)
                if found is not None:
                    return np.asarray(found, dtype=float)
        return None

    def reset(self) -> None:
        """Forget what the law and the filters know."""
        if hasattr(self.law, "reset"):
            self.law.reset()
        self._x: np.ndarray | None = None

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from y (len(reads),) at time t [s]."""
        if self.dt is None or isinstance(self.law, LinearLaw):
            raise PliantError("Filtered acts only behind a sampled controller: give the law dt, and `act`")
        t, y = moment("Filtered", t), reading("Filtered.y", y, len(self.reads))
        wanted = np.asarray(self.law.act(t, y), dtype=float)
        base = np.zeros(len(wanted)) if self.u_ref is None else self.u_ref
        f = self.whole
        if self._x is None:
            self._x = np.zeros((len(f.A), len(wanted)))
        off = wanted - base
        u = base + (f.C @ self._x)[0] + f.D[0, 0] * off
        self._x = f.A @ self._x + f.B * off
        return u if self.limits is None else np.minimum(np.maximum(u, self.limits[0]), self.limits[1])

    @property
    def linear_form(self) -> LinearLaw:
        """Law and filters as one linear law, without limits."""
        law, f = law_of(self.law), self.whole
        one = np.eye(len(law.D))
        A, B, C, D = (np.kron(one, part) for part in (f.A, f.B, f.C, f.D))
        n, m = len(A), len(law.A)
        wide = np.block([[law.A, np.zeros((m, n))], [B @ law.C, A]])
        return LinearLaw(
            wide, np.vstack([law.B, B @ law.D]), np.hstack([D @ law.C, C]), D @ law.D, law.reads, law.dt, law.delay
        )
