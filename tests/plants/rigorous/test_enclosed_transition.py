import numpy as np
import pytest

from pliant.plants.rigorous import enclosed_transition
from pliant.plants.rigorous.balls import flint, matrix, radii
from pliant.plants.rigorous.enclosed_transition import Frames, Piece, TooLong, transitions


def over(pieces, jumps=(), bits=96):
    with flint().ctx.workprec(bits):
        frames, times = Frames(pieces[0].A.shape[-1]), []
        for t, jump, steps in transitions(pieces, jumps):
            times.append(t)
            for P in jump + steps:
                frames.times(P)
        return frames.whole, times


def turning(t, rate=3.0):
    """Phi = rotation by the integral of rate (1 + t^3), which four nodes or more show exactly."""
    return (rate * (1 + t**3))[:, None, None] * np.array([[0.0, 1.0], [-1.0, 0.0]])


def test_a_turn_of_many_steps_stays_as_narrow_as_its_bits():
    t = np.arange(0, 129) / 16.0  # to 8 s: the angle is 3 (8 + 8^4/4)
    M, times = over([Piece(t, turning(t))])
    with flint().ctx.workprec(160):
        angle = flint().arb(3 * (8 + 1024))
        assert M[0, 0].overlaps(angle.cos()) and M[0, 1].overlaps(angle.sin())
    assert radii(M, np.array([[float(x.mid()) for x in M.entries()]]).reshape(2, 2)).max() < 1e-15
    np.testing.assert_array_equal(times, t[1:])
    assert max(float(x.rad()) for x in M.entries()) < 1e-22


def test_until_a_time_between_nodes():
    t = np.arange(0, 17) / 8.0
    M, times = over([Piece(t, turning(t), 1.3)])
    with flint().ctx.workprec(160):
        end = flint().arb(1.3)
        angle = 3 * (end + end**4 / 4)
        assert M[0, 0].overlaps(angle.cos()) and M[0, 0].rad() < 1e-24
    assert times[-1] == pytest.approx(1.3)


def test_jumps_between_pieces_and_after_the_last():
    t = np.array([0.0, 1.0])
    pieces = [Piece(t, np.zeros((2, 2, 2))), Piece(t + 1, np.zeros((2, 2, 2)))]
    J = [np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1.0, 0.0], [1.0, 1.0]])]
    M, _ = over(pieces, J)
    assert all((M - matrix(J[1] @ J[0]))[i, j].contains(0) for i in range(2) for j in range(2))


def test_too_many_steps(monkeypatch):
    monkeypatch.setattr(enclosed_transition, "MOST_STEPS", 3)
    t = np.arange(0, 17) / 8.0
    with pytest.raises(TooLong, match="leave out the fastest modes"):
        over([Piece(t, turning(t))])
