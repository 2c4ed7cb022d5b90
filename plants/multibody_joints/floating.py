"""Inputs that take the joints of a machine with a free base from rest to rest: the base moves as its momentum says.

No force acts on the whole but its weight, so that the base's momentum stays zero: M_bb v_b + M_bj v_j = 0. Neither its
place nor its attitude matters to the joints.
"""

from __future__ import annotations

import numpy as np

from pliant.plants.integration.inverse_dynamics import InverseDynamics

Array = np.ndarray
FREE_SPEEDS = 6  # speeds of a free base, the first


class Floating(InverseDynamics):
    """See `InverseDynamics`; exact where the bodies are rigid."""

    def _carried(self, x: Array) -> Array:
        v = slice(len(self.plant.coordinates), None)
        M, x = self.plant.mass_matrix(x), x.copy()
        momentum = (M[:, :FREE_SPEEDS, FREE_SPEEDS:] @ x[:, v][:, FREE_SPEEDS:, None])[:, :, 0]
        at = v.start
        x[:, at : at + FREE_SPEEDS] = -np.linalg.solve(M[:, :FREE_SPEEDS, :FREE_SPEEDS], momentum[:, :, None])[:, :, 0]
        return x
