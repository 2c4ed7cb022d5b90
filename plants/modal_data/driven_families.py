"""The modes of modal data, by the motions of the root that drive them: along or about one axis, a family each."""

from __future__ import annotations

import numpy as np

from .integrals import axial
from .modal_data import ModalData

PART = 1e-6  # of the largest: a mode that the root's motion drives less takes no part in it
LEAST = 0.05  # of what a last mode does: motions faster than it move what is left out by more than at rest
TAIL = 50  # modes left out that are summed


def before_the_last(data: ModalData) -> int:
    """Modes that are slower than the last of any family."""
    return min((int(family[-1]) for family in _families(data)), default=data.n)


def left_out(data: ModalData, *, turned: bool) -> float:
    """What modes that the data do not hold do, as a share of what the last that they hold does, as of uniform panels.

    Mode k of one that is turned at its root bends its tip by (2k - 1)^-6 of the first, as its frequency grows with
    (2k - 1)^2 and its part in the turn falls with it; of one that is moved by (2k - 1)^-5. The later a family's last
    mode, the less are those left out smaller: the largest family tells.
    """
    last = 2 * max((len(family) for family in _families(data)), default=1) - 1
    return max(LEAST, sum((last / (last + 2 * k)) ** (6 if turned else 5) for k in range(1, TAIL)))


def _families(data: ModalData) -> list[np.ndarray]:
    """Places, slowest first, of the modes that take part in each motion of the root, along or about one axis."""
    order = np.argsort(np.diag(data.stiffness) / np.diag(data.modal_mass), kind="stable")
    driven = np.abs(np.hstack([data.R, axial(data.moments)]))[order]  # (n, 6)
    if not driven.size:
        return []
    takes_part = driven > PART * driven.max(axis=0)
    return [np.flatnonzero(column) for column in takes_part.T if column.any()]
