"""Controllers, filters and a plant's step as one C file, as .mat and as NumPy files."""

from .arrays import arrays_of, export_arrays
from .export_c import export_c

__all__ = ["arrays_of", "export_arrays", "export_c"]
