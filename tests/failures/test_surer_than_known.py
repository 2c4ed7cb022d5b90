"""Floquet, growth and eigenvalues where the data do not carry an answer: nothing is said that is not known."""

import numpy as np
import pytest
from scipy.linalg import expm

from pliant.plants import LTVModel
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV
from pliant.plants.stability import assess, floquet, growth


def model_of(t, A):
    nt, n, z = len(t), A.shape[-1], np.zeros
    none = (z((nt, n, 0)), z((nt, n, 0)), z((nt, 0, n)), z((nt, 0, 0)), z((nt, 0, 0)))
    rows = {"c": z((nt, n)), "x": z((nt, n)), "u": z((nt, 0)), "y": z((nt, 0))}
    return LTVModel(
        t, A, *none, **rows, states=tuple(f"x{k}" for k in range(n)), inputs=(), disturbances=(), outputs=()
    )


def meissner(t, mean, depth, damping=0.0):
    """x'' + 2 d x' + (mean +- depth) x = 0, a square wave of period 2 pi."""
    A = np.zeros((len(t), 2, 2))
    A[:, 0, 1], A[:, 1, 1] = 1.0, -2 * damping
    A[:, 1, 0] = -(mean + depth * np.where(t % (2 * np.pi) < np.pi - 1e-9, 1, -1))
    return model_of(t, A)


def exact(mean, depth, damping=0.0):
    """Multipliers as the product of two closed forms."""
    halves = [expm(np.pi * np.array([[0, 1], [-(mean + s * depth), -2 * damping]])) for s in (1, -1)]
    return np.linalg.eigvals(halves[1] @ halves[0])


GRIDS = {
    "equidistant": lambda m: np.linspace(0.0, 1.0, m + 1),
    "graded": lambda m: np.linspace(0.0, 1.0, m + 1) ** 1.5,
    "random": lambda m: np.r_[0.0, np.sort(np.random.default_rng(m).uniform(0, 1, m - 1)), 1.0],
}


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("nodes", (24, 50, 200, 1500))
@pytest.mark.parametrize("mean, depth, damping", [(0.25, 0.2, 0.0), (1.0, 0.6, 0.07585), (0.6, 0.1, 0.01)])
def test_square_waves_between_nodes(grid, nodes, mean, depth, damping):
    """Deep in a tongue (2.17), just past its threshold (0.995) and well away: the error covers what is true."""
    t = 2 * np.pi * GRIDS[grid](nodes)
    found = floquet(meissner(t, mean, depth, damping), 2 * np.pi)
    wanted = exact(mean, depth, damping)
    apart = min(np.abs(found.multipliers - w).max() for w in (wanted, wanted[::-1]))
    assert apart <= found.error.max()
    size = np.abs(wanted).max()
    assert found.verdict in ("undecided", "unstable" if size > 1 else "stable")
    assert found.least <= size <= found.most
    if nodes == 1500 and abs(size - 1) > 0.02:
        assert found.verdict != "undecided"
    np.testing.assert_allclose(np.sort(np.abs(np.linalg.eigvals(found.monodromy))), np.sort(np.abs(found.multipliers)))


def test_a_thin_tongue_is_not_rounded_onto_the_circle():
    """|lambda| - 1 = 1e-5, or so: what is said of it holds, at every number of nodes."""
    depth, low, high = 0.2, 0.25, 0.6
    for _ in range(60):  # the edge of the first tongue, by its trace
        middle = (low + high) / 2
        low, high = (low, middle) if abs(exact(middle, depth).sum()) < 2 else (middle, high)
    mean = low - 1e-11
    size = np.abs(exact(mean, depth)).max()
    assert 1e-6 < size - 1 < 1e-4
    for nodes in (30, 300, 2000):
        found = floquet(meissner(np.linspace(0, 2 * np.pi, nodes + 1), mean, depth), 2 * np.pi)
        assert found.verdict != "stable" and found.error.max() >= size - 1


@pytest.mark.parametrize("damped_first", [True, False])
def test_a_period_that_the_model_does_not_have(damped_first):
    """Damping that drifts, far less than a fast state's entry pulses: entry by entry, at every shift."""
    t = np.linspace(0, 600 * np.pi, 6001)
    A = np.zeros((6001, 3, 3))
    A[:, 0, 1], A[:, 1, 0], A[:, 2, 2] = 1, -4, -30 + 25 * np.cos(t)
    drift = 0.03 - 0.12 * t / t[-1]
    A[:, 1, 1] = -(drift if damped_first else drift[::-1])
    with pytest.raises(ValueError, match=r"differs from A\(t\) by .* of its range .* \(x1, x1\) after \d+ periods?"):
        assess(model_of(t, A), period=2 * np.pi)


def test_a_mismatch_that_is_small_counts_as_an_error():
    """A(t) that creeps by 2e-6 of its range a period is accepted; what is known of the multipliers says so."""
    t = np.linspace(0, 6 * np.pi, 301)
    A = np.zeros((301, 2, 2))
    A[:, 0, 1], A[:, 1, 1], A[:, 1, 0] = 1, -0.2, -(1.3 - np.cos(t) * (1 + 1e-7 * t))
    crept = floquet(model_of(t, A), 2 * np.pi)
    A[:, 1, 0] = -(1.3 - np.cos(t))
    kept = floquet(model_of(t, A), 2 * np.pi)
    assert kept.error.max() < 1e-9 < 1e-6 < crept.error.max() < 1e-4


@pytest.mark.parametrize("size", (2, 3, 4))
@pytest.mark.parametrize("dt", (None, 1e-3))
def test_a_rotated_chain_of_integrators(size, dt):
    """t^(n-1): no exponential. A k-fold root is known to eps^(1/k) only, its mean to rounding."""
    Q = np.linalg.qr(np.random.default_rng(size).standard_normal((size, size)))[0]
    N = np.diag(np.ones(size - 1), 1)
    A = Q @ (N if dt is None else np.eye(size) + N) @ Q.T
    found = assess(LinearModel.from_matrices(A, np.zeros((size, 0)), dt=dt))
    assert found.verdict in ("marginal", "undecided")
    if size == 2:
        assert found.verdict == "marginal" and found.growth == "polynomial" and "t^1" in found.why
    assert found.margin_bound < 0 or found.margin_bound != found.margin_bound
    straight = assess(LinearModel.from_matrices(N if dt is None else np.eye(size) + N, np.zeros((size, 0)), dt=dt))
    assert (straight.verdict, straight.growth) == ("marginal", "polynomial") and f"t^{size - 1}" in straight.why


def test_equal_modes_that_do_not_share_a_direction_stay_bounded():
    A = np.kron(np.eye(2), np.array([[0.0, 2.0], [-2.0, 0.0]]))
    Q = np.linalg.qr(np.random.default_rng(5).standard_normal((4, 4)))[0]
    found = assess(LinearModel.from_matrices(Q @ A @ Q.T, np.zeros((4, 0))))
    assert (found.verdict, found.growth) == ("marginal", "bounded")


@pytest.mark.every(3)
@pytest.mark.parametrize("onset", (2.0, 5.0, 7.0, 9.0))
@pytest.mark.parametrize("rate", (5.0, 40.0))
def test_a_drift_that_starts_late_is_drift(onset, rate):
    """x' = g(t) v, v' = 0: bounded for bounded v. ln|Phi| rises, but as much over half the window as over all."""
    t = np.linspace(0, 10, 401)
    A = np.zeros((401, 3, 3))
    A[:, 2, 2] = -0.3 - 0.1 * np.sin(t)  # beside one that decays
    A[:, 0, 1] = rate / (1 + np.exp(-5 * (t - onset)))
    found = assess(model_of(t, A))
    assert found.verdict in ("bounded", "drift") and not found.evidence["growth"].compounds
    if found.evidence["growth"].total > 12:
        assert (found.verdict, found.growth, found.drifting[0]) == ("drift", "polynomial", found.drifting[0])
    A[:, 0, 1], A[:, 0, 0] = 0.0, 0.6 * (1 + 0.1 * np.sin(t))
    assert growth(model_of(t, A)).compounds


@pytest.mark.parametrize("A", [[[-1, 2], [2, -1]], [[-1, 2], [0, 1]]])
def test_a_part_that_feels_what_is_left_out_is_refused(A):
    with pytest.raises(ValueError, match="x1 feels x2, which is left out"):
        assess(LinearModel.from_matrices(A, np.zeros((2, 0))), states=["x1"])
    t = np.linspace(0, 1, 11)
    varying = np.repeat(np.array(A, float)[None], 11, 0)
    varying[:-1, 0, 1] = 0.0  # felt at one time only
    with pytest.raises(ValueError, match="x0 feels x1"):
        growth(model_of(t, varying), states=["x0"])
    assert assess(LinearModel.from_matrices([[-1.0, 0.0], [3.0, 1.0]], np.zeros((2, 0))), states=["x1"]).stable


def pieces_of(matrices, lengths, turns=1):
    found, t = [], 0.0
    for A, h in zip(matrices * turns, lengths * turns):
        found.append(model_of(np.linspace(t, t + h, 5), np.repeat(np.asarray(A, float)[None], 5, 0)))
        t = found[-1].t[-1]
    return found


SWITCHED = ([[0.0, 1.0], [-1.0, -0.02]], [[0.0, 1.0], [-9.0, -0.02]])


@pytest.mark.parametrize("turns", (1, 2, 4))
@pytest.mark.parametrize("lengths", [[1.3, 0.7], [np.pi / 2, np.pi / 6]])
def test_pieces_have_a_monodromy_matrix(turns, lengths):
    wanted = expm(np.array(SWITCHED[1]) * lengths[1]) @ expm(np.array(SWITCHED[0]) * lengths[0])
    pieces = pieces_of(list(SWITCHED), lengths, turns)
    found = floquet(pieces, sum(lengths))
    np.testing.assert_allclose(found.monodromy, wanted, atol=1e-12)
    grows = np.abs(np.linalg.eigvals(wanted)).max() > 1
    for verdict in (assess(pieces, period=sum(lengths)), assess(pieces, periodic=True)):
        assert (verdict.verdict, verdict.method) == ("unstable" if grows else "stable", "floquet")


def test_impacts_count_into_the_period_and_bad_periods_of_pieces_are_refused():
    pieces, J = pieces_of(list(SWITCHED), [1.3, 0.7], 2), np.diag([1.0, -0.8])
    jumps = ((J, np.zeros(2)), (np.eye(2), np.zeros(2)), (J, np.zeros(2)))
    wanted = expm(np.array(SWITCHED[1]) * 0.7) @ J @ expm(np.array(SWITCHED[0]) * 1.3)
    np.testing.assert_allclose(floquet(PiecewiseLTV(tuple(pieces), jumps), 2.0).monodromy, wanted, atol=1e-12)
    with pytest.raises(ValueError, match="piece 3 differs from piece 1"):
        floquet(PiecewiseLTV(tuple(pieces), (*jumps[:2], (np.eye(2), np.zeros(2)))), 2.0)
    with pytest.raises(ValueError, match="the pieces cover 4 s, no whole number"):
        floquet(pieces, 1.5)
    with pytest.raises(ValueError, match="a period must begin where a piece does"):
        floquet(pieces, 1.0)


def test_fast_beside_slow_keeps_the_slow_ones_digits():
    """1e15 between them: the slow root comes from Rayleigh quotients, -1 + 1/(1 - 1e15) or so."""
    for coupling in (0.0, 1.0):
        A = np.array([[-1e15, coupling], [coupling, -1.0]])
        found = assess(LinearModel.from_matrices(A, np.zeros((2, 0))))
        assert found.verdict == "stable" and found.margin == pytest.approx(1.0, rel=1e-9)
        A[1, 1] = 1e-3
        assert assess(LinearModel.from_matrices(A, np.zeros((2, 0)))).verdict == "unstable"


def test_no_states():
    found = assess(LinearModel.from_matrices(np.zeros((0, 0)), np.zeros((0, 0))))
    assert found.verdict == "stable" and found.margin == np.inf
    assert assess(model_of(np.linspace(0, 1, 5), np.zeros((5, 0, 0)))).verdict == "stable"


def test_arguments_that_could_have_no_effect_are_refused():
    constant, t = LinearModel.from_matrices([[-1.0]], np.zeros((1, 0))), np.linspace(0, 1, 33)
    pulsed = model_of(t, (-1 + 0.5 * np.cos(2 * np.pi * t))[:, None, None])
    for call in (
        lambda: assess(constant, window=1.0),
        lambda: assess(constant, period=-1.0),
        lambda: assess(pulsed, period=1.0, periodic=False),
        lambda: assess(pulsed, window=9.0),
        lambda: floquet(pulsed, tolerance=0.0),
        lambda: growth(pulsed, duration=3.0),
        lambda: growth(pulsed, points=1),
    ):
        with pytest.raises(ValueError):
            call()


@pytest.mark.parametrize("slow", (-1e-6, 1e-6))
def test_a_mode_a_thousand_million_times_faster(slow):
    """e^(-1e9 T) beside e^(slow T), hidden by a rotation and by units: decided where A is constant (its rates are those
    that it was made with), and with what would decide where it pulses.
    """
    Q = np.linalg.qr(np.random.default_rng(2).standard_normal((2, 2)))[0]
    for S in (np.eye(2), np.diag([1.0, 1e9])):
        A = S @ np.diag([-1e9, slow]) @ np.linalg.inv(S)
        still = assess(LinearModel.from_matrices(A, np.zeros((2, 0))), period=10.0)
        assert still.verdict == ("unstable" if slow > 0 else "stable")
        assert still.margin == pytest.approx(-slow, rel=1e-6)
    turned = assess(LinearModel.from_matrices(Q @ np.diag([-1e9, slow]) @ Q.T, np.zeros((2, 0))))
    assert turned.verdict in ("marginal", still.verdict)  # rounding of 1e9 is 1e-7, some of which it hangs on
    t = np.linspace(0.0, 10.0, 41)
    pulsing = model_of(t, Q @ np.diag([-1e9, slow]) @ Q.T * (1 + 0.1 * np.cos(np.pi / 5 * t))[:, None, None])
    open_ = assess(pulsing, period=10.0)
    assert open_.verdict == "undecided" and "leave out the fastest modes" in open_.why
    with pytest.raises(ValueError, match="leave out the fastest modes"):
        floquet(pulsing, 10.0)
