"""Bounds of structured singular values of matrices against published values."""

import numpy as np
import pytest
from evidence import agrees

from pliant.controllers.uncertain_blocks.blocks import Block, structure
from pliant.controllers.uncertain_blocks.power_iteration import lower
from pliant.controllers.uncertain_blocks.scalings import allowed, upper

ROWS = np.array(
    [
        [-1 + 6j, 2 - 3j, 3 + 8j, 3 + 8j, -5 - 9j, -6 + 2j],
        [4 + 2j, -2 + 5j, -6 - 7j, -4 + 11j, 8 - 7j, 12 - 1j],
        [5 - 4j, -4 - 8j, 1 - 3j, -6 + 14j, 2 - 5j, 4 + 16j],
    ]
)
MIXED = (Block("real"), Block("real"), Block("full", 2), Block("full"), Block("full"))


def morton_doyle():
    """Packard and Doyle 1993, section 9.4; the numbers as in SOSTOOLS' demo 5."""
    alpha, beta = 3 + np.sqrt(3), np.sqrt(3) - 1
    a, b, d = np.sqrt(2 / alpha), 1 / np.sqrt(alpha), -np.sqrt(beta / alpha)
    f = (1 + 1j) * np.sqrt(1 / (alpha * beta))
    U = np.array([[a, 0], [b, b], [b, 1j * b], [d, f]])
    V = np.array([[0, a], [b, -b], [b, -1j * b], [-1j * f, -d]])
    return U @ V.conj().T


def test_mixed_blocks():
    M = np.vstack([ROWS, ROWS])
    found = upper(M, structure(MIXED))
    agrees(
        found.beta,
        41.74753408,
        within=2e-4,
        of="robust_stability",
        what="upper bound of mu, mixed blocks",
        source="SLICOT AB13MD, example program results",
        kind="other program",
    )
    assert found.beta >= lower(M, MIXED)[0]
    assert found.beta == pytest.approx(np.sqrt(allowed(M, found.D, found.G)), rel=1e-9)


def test_four_blocks_of_which_the_bound_is_not_reached():
    """mu = 0.8723 (Packard and Doyle 1993; SOSTOOLS shows 0.8724 from above), no D shows less than 1."""
    M, four = morton_doyle(), (Block("full"),) * 4
    told = {"of": "robust_stability", "source": "Packard and Doyle (1993), section 9.4", "kind": "table"}
    agrees(lower(M, four)[0], 0.8723, within=1e-4, absolute=True, what="mu of Morton and Doyle's matrix", **told)
    agrees(upper(M, structure(four)).beta, 1.0, within=1e-9, what="its bound by scalings, which is not reached", **told)


def test_one_block_has_closed_forms():
    rng = np.random.default_rng(1)
    M = rng.normal(size=(4, 4)) + 1j * rng.normal(size=(4, 4))
    assert upper(M, structure((Block("full", 4),))).beta == pytest.approx(np.linalg.norm(M, 2), rel=1e-9)
    spectral = np.abs(np.linalg.eigvals(M)).max()
    assert upper(M, structure((Block("complex", 4),))).beta == pytest.approx(spectral, rel=1e-4)
    values = np.linalg.eigvals(M.real)
    real = np.abs(values[np.abs(values.imag) < 1e-12]).max(initial=0.0)
    assert upper(M.real, structure((Block("real", 4),))).beta == pytest.approx(real, rel=1e-4, abs=1e-4)


def test_three_full_blocks_meet():
    """The bound is the value for up to three full complex blocks (Doyle 1982)."""
    rng, three = np.random.default_rng(2), (Block("full", 2),) * 3
    M = rng.normal(size=(6, 6)) + 1j * rng.normal(size=(6, 6))
    assert upper(M, structure(three)).beta == pytest.approx(lower(M, three)[0], rel=1e-4)


def test_other_scalings_than_found_elsewhere_do_better():
    M = np.vstack([ROWS, ROWS])
    bad = upper(M[::-1, ::-1], structure(MIXED))
    assert upper(M, structure(MIXED), bad).beta == pytest.approx(41.7475, rel=2e-3)
    assert upper(M, structure(MIXED), enough=60.0).beta <= 60
