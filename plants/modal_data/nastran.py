"""Matrices by name from NASTRAN's OP4 and OP2 files, with pyYeti."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

Array = np.ndarray


def read_nastran(path: str | Path, mass: str, stiffness: str) -> tuple[Array, Array]:
    """The two real matrices by name from an OP4 file, or OP2 where the name ends so. ImportError without pyYeti."""
    path = Path(path)
    if not path.exists():
        raise ValueError(f"from_nastran: path = {str(path)!r} must be an OP4 or OP2 file")
    try:
        if path.suffix.lower() == ".op2":
            from pyyeti.nastran import op2

            found = op2.rdmats(str(path))
        else:
            from pyyeti.nastran import op4

            found = op4.read(str(path))
    except ImportError as error:
        raise ImportError("ModalData.from_nastran reads NASTRAN files with pyYeti: pip install pyyeti") from error
    except (ValueError, RuntimeError, struct.error) as error:
        raise ValueError(f"from_nastran: {path.name} must be an OP4 or OP2 file: {error}") from error
    found = {name.lower(): value for name, value in found.items()}
    for name in (mass, stiffness):
        if name.lower() not in found:
            raise ValueError(f"from_nastran: {path.name} has no matrix {name!r}; it has {', '.join(sorted(found))}")
    dense = []
    for name in (mass, stiffness):
        value = found[name.lower()]
        value = np.asarray(value.toarray() if hasattr(value, "toarray") else value)
        if np.iscomplexobj(value):
            raise ValueError(f"from_nastran: matrix {name!r} of {path.name} is complex, must be real")
        dense.append(value.astype(float))
    return dense[0], dense[1]
