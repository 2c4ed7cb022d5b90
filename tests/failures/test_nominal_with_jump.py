"""A nominal with a jump: models joined by what the jump does to a deviation."""

import dataclasses

import numpy as np
import pytest
from scipy.linalg import expm

from pliant.plants import LTVModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV
from pliant.plants.stability import assess, floquet, frozen_time, growth, lyapunov, slow_variation


def constant(A, start, stop, nodes=41):
    t = np.linspace(start, stop, nodes)
    zero = {
        k: np.zeros((nodes, *s)) for k, s in {"B": (2, 0), "E": (2, 0), "C": (0, 2), "D": (0, 0), "F": (0, 0)}.items()
    }
    rows = {"c": np.zeros((nodes, 2)), "x": np.zeros((nodes, 2)), "u": np.zeros((nodes, 0)), "y": np.zeros((nodes, 0))}
    many = np.broadcast_to(np.asarray(A, dtype=float), (nodes, 2, 2))
    return LTVModel(t, many, **zero, **rows, states=("x", "v"), inputs=(), disturbances=(), outputs=())


SOFT, HARD = np.array([[0.0, 1.0], [-1.0, -0.02]]), np.array([[0.0, 1.0], [-9.0, -0.02]])
REBOUND = (np.diag([1.0, -0.8]), np.array([0.3, 0.0]))


def test_growth_is_the_product_of_the_pieces_and_the_jump():
    model = PiecewiseLTV((constant(SOFT, 0.0, 1.3), constant(HARD, 1.3, 2.0)), (REBOUND,))
    found = growth(model, scale=(1.0, 1.0))
    exact = expm(HARD * 0.7) @ REBOUND[0] @ expm(SOFT * 1.3)
    assert found.total == pytest.approx(np.linalg.norm(exact, 2), rel=1e-12)
    assert np.sum(found.exponents) * 2.0 == pytest.approx(np.log(abs(np.linalg.det(exact))), rel=1e-10)
    assert found.curve[40] == pytest.approx(np.linalg.norm(expm(SOFT * 1.3), 2), rel=1e-12)  # just before the jump
    without = growth([constant(SOFT, 0.0, 1.3), constant(HARD, 1.3, 2.0)], scale=(1.0, 1.0))
    assert without.total == pytest.approx(np.linalg.norm(expm(HARD * 0.7) @ expm(SOFT * 1.3), 2), rel=1e-12)


def switched(count):
    """Soft for a quarter of its cycle, hard for a quarter of its own: pumped (Meissner's equation)."""
    pieces, t = [], 0.0
    for k in range(count):
        A, omega = ((SOFT, 1.0), (HARD, 3.0))[k % 2]
        pieces.append(constant(A, t, t + np.pi / (2 * omega)))
        t = pieces[-1].t[-1]
    return pieces


def test_each_piece_decays_and_together_they_grow():
    pieces = switched(8)
    assert all(assess(piece).stable for piece in pieces)
    verdict = assess(pieces)
    assert (verdict.verdict, verdict.method) == ("unstable", "growth")
    assert verdict.evidence["frozen_time"].suggests == "stable"
    assert verdict.reasons["floquet"] == "the nominal has jumps"
    assert "jumps" in verdict.reasons["slow_variation"] and "jumps" in verdict.reasons["lyapunov"]
    # Three times the amplitude in each pair of quarters, less what the damper takes.
    assert verdict.evidence["growth"].total == pytest.approx(3.0**4, rel=0.2)


def test_a_jump_that_takes_enough_makes_it_stable():
    pieces = switched(8)
    catch = tuple((np.diag([0.3, 0.3]), np.zeros(2)) for _ in pieces[1:])
    verdict = assess(PiecewiseLTV(tuple(pieces), catch))
    assert (verdict.verdict, verdict.method) == ("stable", "growth")


def test_a_spline_through_the_jump_would_be_wrong_and_bad_pieces_are_refused():
    first, second = constant(SOFT, 0.0, 1.3), constant(HARD, 1.3, 2.0)
    t = np.r_[first.t, second.t[1:]]
    smooth = dataclasses.replace(
        first,
        **{k: np.concatenate([getattr(first, k), getattr(second, k)[1:]]) for k in "ABECDFcxuyw"},
        t=t,
    )
    wrong, right = growth(smooth).total, growth([first, second], scale=growth(smooth).scale).total
    assert abs(wrong / right - 1) > 1e-4
    with pytest.raises(ValueError, match=r"pieces\[1\].* 1.5 must be 1.3"):
        growth([first, constant(HARD, 1.5, 2.0)])
    with pytest.raises(ValueError, match="pieces have no smooth period"):
        floquet([first, second])
    assert not slow_variation([first, second]) and not lyapunov([first, second])
    assert len(frozen_time([first, second]).t) == 82
