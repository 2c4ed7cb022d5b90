"""Blocks and the scalings that commute with them."""

import numpy as np
import pytest

from pliant.controllers.uncertain_blocks.blocks import Block, require_blocks, structure


def test_scalings_commute_with_perturbations():
    blocks = (Block("real", 2), Block("complex", 2), Block("full", 3))
    of, rng = structure(blocks), np.random.default_rng(1)
    assert len(of.D) == 4 + 4 + 1 and len(of.G) == 4 and len(of.groups) == 5
    D, G = np.tensordot(rng.normal(size=len(of.D)), of.D, 1), np.tensordot(rng.normal(size=len(of.G)), of.G, 1)
    Delta = np.zeros((7, 7), dtype=complex)
    Delta[:2, :2], Delta[2:4, 2:4] = 0.3 * np.eye(2), (0.1 + 0.5j) * np.eye(2)
    Delta[4:, 4:] = rng.normal(size=(3, 3)) + 1j * rng.normal(size=(3, 3))
    np.testing.assert_allclose(D @ Delta, Delta @ D, atol=1e-14)
    np.testing.assert_allclose(G @ Delta, Delta.conj().T @ G, atol=1e-14)


def test_blocks_that_do_not_fill_the_matrix():
    with pytest.raises(ValueError, match="sizes add up to 2"):
        require_blocks("of", (Block("real", 2),), 3)
    with pytest.raises(ValueError, match=r"Block\.kind"):
        Block("imaginary")
