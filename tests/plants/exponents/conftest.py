"""Models of A(t) by its nodes."""

import numpy as np
import pytest
from known_systems import ltv

from pliant.plants import LinearModel


@pytest.fixture
def along():
    def made(t, A):
        return ltv(np.asarray(t), np.array([A(s) for s in t]))

    return made


@pytest.fixture
def still():
    def made(A):
        A = np.asarray(A, dtype=float)
        return LinearModel.from_matrices(A, np.zeros((len(A), 0)))

    return made


@pytest.fixture
def turn():
    def made(angle):
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s], [s, c]])

    return made
