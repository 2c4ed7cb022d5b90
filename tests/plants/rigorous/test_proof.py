import numpy as np
import pytest
from scipy.special import mathieu_a

from pliant.plants.rigorous.enclosed_transition import Piece
from pliant.plants.rigorous.proof import of_constant, of_cycle, of_motion


def oscillator(stiffness, t, damping=0.0):
    A = np.zeros((len(t), 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -stiffness, -2 * damping
    return A


def test_constant():
    found = of_constant(np.array([[0.0, 1.0], [-2.0, -3.0]]))  # -1 and -2
    assert (found.verdict, found.growth, found.kind) == ("stable", "decays", "constant")
    assert found.rate[0] <= -1.0 <= found.rate[1] and "a theorem" in found.said
    assert of_constant(np.array([[0.5]]), 0.1).rate == pytest.approx((np.log(0.5) / 0.1,) * 2)
    chain = of_constant(np.eye(3, k=1))
    assert (chain.verdict, chain.growth) == ("marginal", "polynomial") and "t^2" in chain.words
    with pytest.raises(ValueError, match="at most 12"):
        of_constant(np.eye(13))


def test_a_moving_frame_that_frozen_roots_call_stable():
    # Markus and Yamabe 1960: x = e^(t/2) (cos t, -sin t) grows, frozen eigenvalues have real part -1/4
    t = np.linspace(0.0, np.pi, 161)
    c, s = np.cos(t), np.sin(t)
    A = np.array([[-1 + 1.5 * c * c, 1 - 1.5 * s * c], [-1 - 1.5 * s * c, -1 + 1.5 * s * s]]).transpose(2, 0, 1)
    found = of_cycle([Piece(t, A, np.pi)], [], np.pi, np.ones(2))
    assert found.verdict == "unstable"
    assert found.largest == pytest.approx((np.exp(np.pi / 2),) * 2, rel=1e-7)  # what 161 nodes show
    assert found.rate[0] == pytest.approx(0.5, abs=1e-7)
    np.testing.assert_allclose(np.sort(found.roots.real), [-np.exp(np.pi / 2), -np.exp(-np.pi)], rtol=1e-7)
    assert (found.radii < 1e-14).all()


@pytest.mark.parametrize("off, told", [(-1e-6, "undecided"), (1e-6, "unstable")])
def test_the_edge_of_a_tongue(off, told):
    # x'' + (a - 2 q cos 2t) x = 0: the tongue about 1 at q = 1 ends at b_1 < a < a_1(1) = 1.859108 (Abramowitz and
    # Stegun 20.1, scipy's mathieu_a); without damping nothing outside it can be told from the circle
    a, t = mathieu_a(1, 1.0) - off, np.linspace(0.0, np.pi, 321)
    A = oscillator(a - 2 * np.cos(2 * t), t)
    found = of_cycle([Piece(t, A, np.pi)], [], np.pi, np.ones(2))
    assert found.verdict == told
    assert (
        of_cycle([Piece(t, oscillator(a - 2 * np.cos(2 * t), t, 0.01), np.pi)], [], np.pi, np.ones(2)).verdict
        == "stable"
    )


def test_states_that_nothing_moves_are_marginal_as_a_theorem():
    t = np.linspace(0.0, 1.0, 9)
    A = np.zeros((9, 2, 2))
    A[:, 0, 1], A[:, 1, 1] = 1.0 + t**3, -1.0
    found = of_cycle([Piece(t, A, 1.0)], [], 1.0, np.ones(2))
    assert (found.verdict, found.growth) == ("marginal", "bounded") and found.largest == (1.0, 1.0)


def test_motion_with_a_closed_form():
    # dx/dt = (t^3 - 1) x and -x: exp(t^4/4 - t), smallest at 1 s
    t = np.arange(0, 25) / 16.0
    A = np.zeros((25, 2, 2))
    A[:, 0, 0], A[:, 1, 1] = t**3 - 1, -1.0
    found = of_motion([Piece(t, A)], [], np.array([1.0, 0.5]))
    assert found.verdict == "stable" and found.peak == (1.0, 1.0) and found.peak_time == 0.0
    truth = np.exp(1.5**4 / 4 - 1.5)
    assert found.end[0] <= truth * (1 + 4e-16) and found.end[1] >= truth * (1 - 4e-16) and np.ptp(found.end) < 1e-14
    np.testing.assert_allclose(np.diagonal(found.transition), [truth, np.exp(-1.5)], rtol=1e-14)
    assert found.transition_error.max() < 1e-15


def test_the_peak_is_also_that_just_after_a_jump():
    # decay by e^-1, times 50, decay by e^-8: largest after the jump, at 1 s
    t = np.linspace(0.0, 1.0, 3)
    pieces = [Piece(t, np.full((3, 1, 1), -1.0)), Piece(t + 1, np.full((3, 1, 1), -8.0))]
    found = of_motion(pieces, [np.array([[50.0]])], np.ones(1))
    assert found.peak == pytest.approx((50 / np.e,) * 2, rel=1e-14) and found.peak_time == 1.0
    assert found.end == pytest.approx((50 * np.exp(-9),) * 2, rel=1e-14) and found.verdict == "stable"


@pytest.mark.parametrize(
    "rate, drifting, told",
    [
        ([[0.0, 0.1], [0.0, -1.0]], (), "bounded"),
        ([[0.0, 1.0], [0.0, 0.0]], (0,), "drift"),  # x0 ends 32 away
        ([[0.0, 1.0], [0.5, 0.0]], (), "unstable"),
    ],
)
def test_verdicts_of_a_motion(rate, drifting, told):
    t = np.linspace(0.0, 32.0, 33)
    found = of_motion([Piece(t, np.repeat(np.array(rate)[None], 33, axis=0))], [], np.ones(2), drifting)
    assert found.verdict == told
