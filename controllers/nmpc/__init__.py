"""Nonlinear model predictive control by real-time iteration."""

from .nmpc import NMPC

__all__ = ["NMPC"]
