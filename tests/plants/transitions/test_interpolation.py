"""What an interpolant misses between its nodes, against the function that it was made from."""

import numpy as np
import pytest

from pliant.plants.transitions.interpolation import Interpolant

WAVES = {
    "cosine": lambda t: np.cos(2 * np.pi * t),
    "sharp": lambda t: np.exp(2 * np.sin(2 * np.pi * t)),
    "kinks": lambda t: np.abs(np.sin(np.pi * (t + 0.123))),
    "jumps": lambda t: np.where((t + 0.271) % 1 < 0.4, 1.0, -1.0),
    "saw": lambda t: (t + 0.377) % 1.0,
}
GRIDS = {
    "equidistant": lambda m: np.linspace(0.0, 1.0, m + 1),
    "graded": lambda m: np.linspace(0, 1, m + 1) + 0.12 * np.sin(2 * np.pi * np.linspace(0, 1, m + 1)),
    "random": lambda m: np.r_[0.0, np.sort(np.random.default_rng(m).uniform(0, 1, m - 1)), 1.0],
}


def missed(f, wave, t, parts=200):
    """Integral (m,) of |f - wave| over each interval, by the midpoint rule."""
    inner = t[:-1, None] + np.diff(t)[:, None] * (np.arange(parts) + 0.5) / parts
    return np.abs(f(inner.ravel())[:, 0] - wave(inner.ravel())).reshape(len(t) - 1, parts).mean(1) * np.diff(t)


@pytest.mark.every(6)
@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("name", WAVES)
@pytest.mark.parametrize("m", (6, 10, 16, 40, 150, 900))
@pytest.mark.parametrize("periodic", (True, False))
def test_the_bound_covers_what_is_missed(name, grid, m, periodic):
    wave, t = WAVES[name], GRIDS[grid](m)
    values = wave(t)
    values[-1] = values[0] if periodic else values[-1]
    f = Interpolant(t, values[:, None], periodic=periodic)
    true = missed(f, wave, t)
    assert true.sum() <= 1.02 * f.area.sum()
    np.testing.assert_allclose(f(t[:-1])[:, 0], values[:-1], atol=1e-9)


def test_jumps_and_kinks_have_the_bounds_of_their_closed_forms():
    """A jump J leaves h J/2 open, a kink ds in mid-interval h^2 ds/8 of at most h^2 ds/4."""
    t, h = np.linspace(0.0, 1.0, 41), 1 / 40
    jump = Interpolant(t, np.where(t < 0.51, 0.0, 3.0)[:, None])
    assert h * 3 / 2 <= jump.area.sum() < 1.4 * h * 3 / 2 and jump.area[20, 0] == jump.area.max()
    kink = Interpolant(t, (2 * np.abs(t - 0.5125))[:, None])
    assert h**2 * 4 / 8 <= kink.area[20, 0] < 1.2 * h**2 * 4 / 4


def test_a_ramp_between_two_neighbouring_intervals_is_covered():
    """Each interval's neighbour holds a kink of its own, and shows another slope than the wave's on that side."""
    rng = np.random.default_rng(4)
    for _ in range(300):
        t = np.r_[0.0, np.cumsum(rng.uniform(0.1, 2.0, 16))]
        k = int(rng.integers(4, 11))
        low, high = t[k] + (t[k + 1] - t[k]) * rng.uniform(0, 1), t[k + 1] + (t[k + 2] - t[k + 1]) * rng.uniform(0, 1)

        def wave(s, low=low, high=high):
            return np.interp(s, [low, high], [0.0, 1.0])

        f = Interpolant(t, wave(t)[:, None])
        assert missed(f, wave, t).sum() <= 1.01 * f.area.sum()


@pytest.mark.parametrize("m", (13, 20, 32))
@pytest.mark.parametrize("share", (0.3, 1 / 3, 0.337, 0.4))
@pytest.mark.parametrize("mirrored", (False, True))
def test_a_kink_beside_the_end_is_covered_in_the_first_interval_too(m, share, mirrored):
    """A third of the way into the second interval the fourth difference of the first five nodes is zero:
    f = max(0, t - 1 - s) has (3-s) - 4(2-s) + 6(1-s) = 1 - 3s."""
    t = np.linspace(0.0, 1.0, m + 1)
    kink = 1 - (1 + share) / m if mirrored else (1 + share) / m

    def wave(s):
        return np.maximum(0.0, s - kink)

    f = Interpolant(t, wave(t)[:, None])
    assert (missed(f, wave, t) <= 1.01 * f.area[:, 0] + 1e-12).all()


def test_two_kinks_beside_the_end_do_not_hide_each_other():
    """As ramps of two intervals; the first interval has a neighbour at one side alone."""
    t = np.linspace(0.0, 1.0, 17)

    def wave(s):
        return -0.71 * np.maximum(0.0, s - 0.15 / 16) + 0.31 * np.maximum(0.0, s - 1.66 / 16)

    for mirrored in (False, True):

        def own(s, mirrored=mirrored):
            return wave(1 - s if mirrored else s)

        f = Interpolant(t, own(t)[:, None])
        assert missed(f, own, t).sum() <= 1.01 * f.area.sum()


def test_smooth_data_are_known_to_the_fourth_order_and_harmonics_to_rounding():
    wave, sizes = WAVES["sharp"], []
    for m in (64, 128, 256):
        t = GRIDS["graded"](m)
        f = Interpolant(t, wave(t)[:, None])
        sizes.append(f.area.sum())
        assert f.area.sum() < 60 * missed(f, wave, t).sum()
    assert np.log2(sizes[0] / sizes[2]) / 2 > 3.5
    t = np.linspace(0.0, 1.0, 33)
    f = Interpolant(t, WAVES["cosine"](t)[:, None], periodic=True)
    assert f.waves.all() and f.area.sum() < 1e-13 and f.harmonics <= 2


def test_one_quiet_coefficient_shows_nothing():
    """A square wave of half a period has no even harmonics: the last of 12 is zero, and all is open."""
    t = np.linspace(0.0, 1.0, 25)
    values = np.where(t % 1 < 0.5 - 1e-9, 1.0, -1.0)
    values[-1] = values[0]
    f = Interpolant(t, values[:, None], periodic=True)
    assert not f.waves.any() and f.area.sum() >= 2 * (2 / 24 / 2)


def test_integral_of_each_kind():
    for name in ("cosine", "sharp", "kinks"):
        for grid in GRIDS.values():
            t = grid(60)
            f = Interpolant(t, WAVES[name](t)[:, None], periodic=True)
            fine = (np.arange(200_000) + 0.5) / 200_000
            found, error = f.integral(0)
            assert abs(found - WAVES[name](fine).mean()) <= error + 1e-9


def test_a_small_jump_beside_a_large_one_is_no_smooth_stretch():
    """The large one makes every wider difference large, beside which the small one's look as if they fell."""
    t, h = np.linspace(0.0, 1.0, 41), 1 / 40
    for apart in (3, 4, 5, 6, 7):
        edge = (10.5 + apart) * h
        f = Interpolant(t, (np.where(t < 10.5 * h, 0.0, 2.0) + np.where(t < edge, 0.0, 0.1))[:, None])
        assert f.area[10 + apart, 0] >= h * 0.1 / 4  # closed form: J h/4 for one in mid-interval
