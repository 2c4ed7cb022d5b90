"""Numbers of a motion that ends: how far disturbances and deviations can push it, each with its bound."""

from __future__ import annotations

from .horizon import FiniteHorizon, finite_horizon

__all__ = ["FiniteHorizon", "finite_horizon"]
