import sys

import numpy as np
import pytest

from pliant.plants.rigorous import balls


def test_doubles_go_in_exactly_and_come_out_outwards():
    flint = balls.flint()
    M = balls.matrix(np.array([[0.1, 1e-300], [-3.0, 2.0**60]]))
    assert all(x.is_exact() for x in M.entries())
    with flint.ctx.workprec(200):
        third = flint.arb(1) / 3
        low, high = balls.ends(third)
        assert flint.arb(low) < third < flint.arb(high) and high - low < 1e-15


def test_norm_of_every_member_is_between_the_bounds():
    # Singular values of [[1, 1], [0, 1]]: the golden ratio and its inverse
    flint = balls.flint()
    with flint.ctx.workprec(100):
        low, high = balls.spectral_bounds(balls.matrix(np.array([[1.0, 1.0], [0.0, 1.0]])))
        golden = (1 + flint.arb(5).sqrt()) / 2
        assert low <= golden.upper() and high >= golden.lower() and high - low < 1e-15
        wide = balls.spectral_bounds(balls.widened(balls.matrix(np.eye(3)), flint.arb(1e-3)))
        assert wide[0] <= 1 - 1e-3 and wide[1] >= 1 + 3e-3 - 1e-9  # 0.999 times 1, and 1 + 1e-3 times all ones


def test_radii_hold_every_member():
    flint = balls.flint()
    M = balls.widened(balls.matrix(np.array([[2.0, 0.5]])), flint.arb(0.25))
    assert (balls.radii(M, np.array([[2.0, 0.75]])) >= [[0.25, 0.5]]).all()


def test_without_the_library_the_error_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(ImportError, match=r"pip install pliant\[rigorous\]"):
        balls.flint()
