"""What a scene is, on a page: its signals, limits, prices and what is drawn, as tables, and what simple laws return."""

from .markdown import markdown
from .tables import Table, tables

__all__ = ["Table", "markdown", "tables"]
