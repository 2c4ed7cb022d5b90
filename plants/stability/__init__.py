"""Stability of a linear model about a nominal motion, constant, periodic or neither.

assess(model)          the verdict, from all methods that apply: `assessment`, `verdict`
frozen_time(model)     eigenvalues along the nominal: `frozen_time`
slow_variation(model)  whether they may be believed: `frozen_time`
floquet(model)         multipliers and modes of a periodic model: `floquet`
growth(model)          the transition matrix over windows, finite-time Lyapunov exponents: `transition_growth`
lyapunov(model)        a quadratic certificate that varies with time: `lyapunov_certificate`
finite_horizon(model)  how far disturbances can push a motion before it ends: `plants.finite_horizon`
pointing_budget(..)    absolute, mean and relative performance error over windows: `plants.finite_horizon`
"""

from __future__ import annotations

from pliant.plants.finite_horizon import FiniteHorizon, PointingBudget, finite_horizon, pointing_budget

from .assessment import assess
from .floquet import Floquet, floquet
from .frozen_time import FrozenTime, SlowVariation, frozen_time, slow_variation
from .lyapunov_certificate import Certificate, lyapunov
from .transition_growth import Growth, growth
from .verdict import METHODS, Verdict

__all__ = [
    "METHODS",
    "Certificate",
    "FiniteHorizon",
    "Floquet",
    "FrozenTime",
    "Growth",
    "PointingBudget",
    "SlowVariation",
    "Verdict",
    "assess",
    "finite_horizon",
    "floquet",
    "frozen_time",
    "growth",
    "lyapunov",
    "pointing_budget",
    "slow_variation",
]
