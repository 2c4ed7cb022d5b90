"""The edge of stability in doubles: a multiplier of 1 -+ 1e-13 as an integrator finds it; balls that are wrapped.

Doubles give a number that may lie on either side of the circle. Balls know which side, or that they do not know. But
a product of balls is wrapped at each step: of a turn that keeps every length nothing is left after some hundred steps,
unless the frame turns with it.
"""

import numpy as np
import pytest
from periodic_models import model_of
from scipy.integrate import solve_ivp

from pliant.plants.stability import assess

flint = pytest.importorskip("flint", reason="python-flint is an extra: pip install pliant[rigorous]")

T = np.arange(-16, 17) / 16.0
EDGE = 2.0**-44


def rate(t, c):
    """Its integral from -1 to 1 is -2 c: the multiplier is e^(-2c). A spline through dyadic nodes is this cubic."""
    return 16 * t**3 - 16 * t - c


@pytest.mark.parametrize("c, told", [(EDGE, "stable"), (-EDGE, "unstable"), (0.0, "undecided")])
def test_a_multiplier_within_1e_13_of_the_circle(c, told):
    model = model_of(T, rate(T, c)[:, None, None])
    assert assess(model, period=2.0).verdict not in ("stable", "unstable")  # honest, and no answer
    found = assess(model, period=2.0, rigorous=True)
    assert found.proof.verdict == told
    low, high = found.proof.largest
    assert low <= 1 - 2 * c + 2 * c * c <= high and high - low < 1e-15


def test_an_integrator_claims_the_wrong_side():
    told = {}
    for c in (EDGE, -EDGE):
        run = solve_ivp(lambda t, x, c=c: rate(t, c) * x, (-1, 1), [1.0], method="DOP853", rtol=1e-12, atol=1e-15)
        told[c] = run.y[0, -1]
        assert abs(told[c] - np.exp(-2 * c)) > 2 * EDGE  # its error is larger than what is asked
    assert (told[EDGE] < 1) == (told[-EDGE] < 1)  # one of the two claims is wrong


def test_balls_without_frames_blow_up():
    from pliant.plants.rigorous.balls import matrix
    from pliant.plants.rigorous.enclosed_transition import Frames, Piece, transitions

    t = np.arange(0, 401) / 4.0  # 64 turns
    A = 4.0 * (1 + 1e-3 * t)[:, None, None] * np.array([[0.0, 1.0], [-1.0, 0.0]])
    with flint.ctx.workprec(64):
        frames, wrapped = Frames(2), matrix(np.eye(2))
        for _, _, steps in transitions([Piece(t, A)], []):
            for P in steps:
                frames.times(P)
                wrapped = P * wrapped
        assert max(float(x.rad()) for x in frames.whole.entries()) < 1e-13
        assert max(float(x.rad()) for x in wrapped.entries()) > 1e6
