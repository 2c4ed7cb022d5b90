"""Perturbations that make I - M Delta singular."""

import numpy as np
import pytest

from pliant.controllers.uncertain_blocks.blocks import Block
from pliant.controllers.uncertain_blocks.power_iteration import lower


@pytest.mark.parametrize("blocks", [(Block("full", 2), Block("complex", 2)), (Block("real", 2), Block("full", 2))])
def test_what_is_returned_is_singular_and_of_the_structure(blocks):
    rng = np.random.default_rng(5)
    M = rng.normal(size=(4, 4)) + 1j * rng.normal(size=(4, 4))
    bound, Delta = lower(M, blocks)
    assert bound > 0
    assert np.linalg.norm(Delta, 2) == pytest.approx(1 / bound, rel=1e-6)
    assert np.linalg.svd(np.eye(4) - M @ Delta, compute_uv=False)[-1] < 1e-6
    assert np.abs(Delta[:2, 2:]).max() == 0 and np.abs(Delta[2:, :2]).max() == 0
    if blocks[0].kind == "real":
        assert np.abs(Delta[:2, :2].imag).max() < 1e-6


def test_nothing_to_perturb():
    assert lower(np.zeros((2, 2)), (Block("real", 2),))[0] == 0
