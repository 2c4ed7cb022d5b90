"""Speed against accuracy, measured: settings, runs, rows that are kept, pages."""

from .measure import chart

__all__ = ["chart"]
