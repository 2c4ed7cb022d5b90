import numpy as np
import pytest

from pliant.plants.rigorous.balls import flint
from pliant.plants.rigorous.enclosed_growth import compounds
from pliant.plants.rigorous.enclosed_transition import Piece, transitions


@pytest.mark.parametrize(
    "A, told",
    [
        (np.array([[0.0, 1.0], [0.5, 0.0]]), True),  # e^(0.7 t)
        (np.array([[0.0, 1.0], [0.0, 0.0]]), False),  # drift like t
        (np.array([[0.0, 1.0], [-1.0, -0.1]]), False),
    ],
)
def test_growth_that_builds_on_itself(A, told):
    t = np.linspace(0.0, 16.0, 33)
    with flint().ctx.workprec(96):
        own = [(end, steps) for end, _, steps in transitions([Piece(t, np.repeat(A[None], 33, axis=0))], [])]
        assert compounds(0.0, own) is told
