"""Numbers of a motion that ends: how far disturbances and deviations can push it, each with its bound."""

from __future__ import annotations

from .horizon import FiniteHorizon, finite_horizon
from .pointing import PointingBudget, pointing_budget

__all__ = ["FiniteHorizon", "PointingBudget", "finite_horizon", "pointing_budget"]
