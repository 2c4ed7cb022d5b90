"""A motion played in one call: a point mass whose path, rates and eigenvalues are known in closed form."""

import ctypes

import numpy as np
import pytest

from pliant.plants.motions import played_motion
from pliant.plants.motions.played_motion import LEFT, LONG, NEAR, ODD, PlayedMotion

COUNT, POINTER, NUMBERS = ctypes.c_long, ctypes.c_void_p, ctypes.POINTER(ctypes.c_double)
T = np.array([0.0, 0.5, 1.0, 2.0, 4.0])
STIFF, SEEN = 9.0, []


@ctypes.CFUNCTYPE(COUNT, COUNT, COUNT, NUMBERS, POINTER, NUMBERS, COUNT, *[NUMBERS] * 3, ctypes.POINTER(COUNT))
def marched(last, most, t, counts, u, ahead, w, p, x, at):
    """A mass p thrown at 1 m/s and pushed by u, exact over each interval."""
    for k in range(last):
        h, a = t[k + 1] - t[k], (u[k] + w[0]) / p[0]
        x[2 * k + 2] = x[2 * k] + h * x[2 * k + 1] + h * h * a / 2
        x[2 * k + 3] = x[2 * k + 1] + h * a
    at[0] = last
    return 0


@ctypes.CFUNCTYPE(None, COUNT, COUNT, COUNT, ctypes.POINTER(NUMBERS), ctypes.POINTER(NUMBERS), POINTER, COUNT)
def seen(first, last, ld, given, out, s, n):
    """Rates (v, a), and the distance as a range."""
    for r in range(ld):
        out[0][r], out[0][ld + r] = given[1][ld + r], (given[2][r] + given[3][r]) / given[4][r]
        out[1][r] = abs(given[1][r])


@ctypes.CFUNCTYPE(None, COUNT, COUNT, COUNT, ctypes.POINTER(NUMBERS), ctypes.POINTER(NUMBERS), POINTER, COUNT)
def slopes(first, last, ld, given, out, s, n):
    """Of a mass on a spring, whose eigenvalues are 3i; and where it was asked."""
    SEEN[:] = [given[0][r] for r in range(ld)]
    for r in range(ld):
        for k, value in enumerate((0.0, 1.0, -STIFF, 0.0)):
            out[0][k * ld + r] = value


class Written:
    """What a kernel is asked for."""

    def __init__(self, function, lanes):
        self._run, self.lanes = function, lanes


def thrown(u=0.0, farthest=100.0, bound=3.0, x0=(0.0, 1.0), lanes=4):
    run = played_motion.program.at_hand(np.inf)
    if run is None:
        pytest.skip("no compiler")
    counts, looked_at = np.array([1, 1, 2, 4], dtype=LONG), (np.array([0, 2]), bound, 0.0)
    functions = marched, Written(seen, lanes), Written(slopes, lanes)
    motion = PlayedMotion(run, functions, (2, 1, 1, 1), (2, 1), (T, counts), np.array([farthest]), looked_at)
    motion.x[0], motion.u[:], motion.w[:], motion.p[:] = x0, u, 0.5, 2.0
    return motion, motion.play()


@pytest.mark.parametrize("lanes", [1, 4, 8])
def test_states_and_what_is_seen_stand_in_rows(lanes):
    motion, found = thrown(u=1.5, lanes=lanes)
    assert found == 0 and motion.steps == 8
    np.testing.assert_allclose(motion.x, np.column_stack([T + T**2 / 2, 1 + T]), rtol=1e-14)
    np.testing.assert_allclose(motion.results[0], np.column_stack([1 + T, np.ones(5)]), rtol=1e-14)
    np.testing.assert_allclose(motion.results[1][:, 0], T + T**2 / 2, rtol=1e-14)
    assert SEEN[:2] == [0.0, 1.0]


def test_a_range_that_is_left_is_said():
    """It comes to 4 m + 0.25 m/s^2 (4 s)^2 / 2."""
    assert thrown(farthest=6.0)[1] == 0
    assert thrown(farthest=5.99)[1] == LEFT
    assert thrown(farthest=5.99, bound=0.1)[1] == LEFT | NEAR


def test_a_step_is_near_its_limit_by_the_bound_of_its_eigenvalues():
    """Of [[0, 1], [-9, 0]] the fourth power is 81, and steps are of half a second."""
    assert thrown(bound=1.5 * (1 + 1e-12))[1] == 0
    assert thrown(bound=1.5 * (1 - 1e-12))[1] == NEAR


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e100])
def test_numbers_that_are_none_or_huge_are_odd(bad):
    assert thrown(u=np.array([[0.0], [0.0], [0.0], [0.0], [bad]]))[1] == ODD
    assert thrown(u=bad)[1] == ODD
    assert thrown(x0=(bad, 0.0))[1] == ODD
