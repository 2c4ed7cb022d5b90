"""Sampled loops with one channel late, against motions whose held inputs are followed from event to event."""

import numpy as np
import pytest
import scipy.linalg

from pliant.controllers import LQR, Feedback
from pliant.controllers.analysis.late_loops import shortest
from pliant.controllers.analysis.loops import loop
from pliant.controllers.analysis.margins import margins
from pliant.plants.linear.lti import LinearModel

DT = 0.1


def moved(A, B, x, pieces):
    """x after pieces (duration, u) of constant inputs."""
    n, nu = B.shape
    for duration, u in pieces:
        block = scipy.linalg.expm(duration * np.block([[A, B], [np.zeros((nu, n + nu))]]))
        x = block[:n, :n] @ x + block[:n, n:] @ u
    return x


def growth(model, K, D, at, channel, delay, steps=400):
    """The factor per period by which a motion of the loop grows in the end, by its own events."""
    A, B, C = model.A, model.B, model.C
    rng = np.random.default_rng(1)
    x, inputs = rng.normal(size=len(A)), [np.zeros(B.shape[1])] * 200
    states, sizes = [], []
    m, rest = int(np.floor(delay / DT * (1 + 1e-12))), 0.0
    rest = delay - m * DT
    for k in range(steps):
        held = np.array(inputs[-1])  # what acts as the sample is taken
        if at == "input":
            held[channel] = inputs[-1 - m][channel]
        y = C @ x + D @ held
        states.append((x, [np.array(u) for u in inputs[-2:]]))
        if at == "output":
            back = k - m
            if rest > 0:
                past, acted = (states[back - 1][0], inputs[-1 - m]) if back > 0 else (np.zeros(len(A)), 0 * held)
                then = moved(A, B, past, [(DT - rest, acted)])
                y[channel] = (C @ then + D @ acted)[channel]
            elif m:
                past, acted = (states[back][0], inputs[-1 - m]) if back >= 0 else (np.zeros(len(A)), 0 * held)
                y[channel] = (C @ past + D @ acted)[channel]
        inputs.append(-K @ y)
        early, late = np.array(inputs[-1]), np.array(inputs[-1])
        if at == "input":
            early[channel], late[channel] = inputs[-2 - m][channel], inputs[-1 - m][channel]
        x = moved(A, B, x, [(rest, early), (DT - rest, late)])
        sizes.append(np.linalg.norm(np.concatenate([x, *inputs[-3:]])))
        if sizes[-1] > 1e100 or sizes[-1] < 1e-100:
            inputs = [u / sizes[-1] for u in inputs]
            states = [(s / sizes[-1], u) for s, u in states]
            x = x / sizes[-1]
            sizes = [s / sizes[-1] for s in sizes]
    half = len(sizes) // 2
    return (np.mean(sizes[-20:]) / np.mean(sizes[half : half + 20])) ** (1 / (len(sizes) - half - 20))


def case(seed):
    """A random plant with two inputs and two readings with feedthrough, modes to ten times the Nyquist frequency."""
    rng = np.random.default_rng(seed)
    wn, zeta = rng.uniform(1.0, 300.0, 2), rng.uniform(0.01, 0.3, 2)
    A = scipy.linalg.block_diag(*[[[0, 1], [-(w**2), -2 * z * w]] for w, z in zip(wn, zeta)])
    B, C = rng.normal(size=(4, 2)), rng.normal(size=(2, 4))
    D = rng.normal(size=(2, 2)) * 0.3
    K = rng.normal(size=(2, 2)) * 0.5
    return LinearModel.from_matrices(A, B, C, D, outputs=["a", "b"]), K, D


@pytest.mark.every(4)
@pytest.mark.parametrize("at", ["input", "output"])
@pytest.mark.parametrize("seed", range(4))
def test_the_closed_matrix_grows_as_the_motion_does(seed, at):
    model, K, D = case(seed)
    law = Feedback(K, ("a", "b"), dt=DT)
    late = loop(model, law, at=at).late
    for channel, delay in ((0, 0.0), (1, 0.037), (0, 0.1), (1, 0.263), (0, 0.3)):
        radius = np.abs(np.linalg.eigvals(late.closed(channel, delay))).max()
        assert growth(model, K, D, at, channel, delay) == pytest.approx(radius, rel=2e-2)


@pytest.mark.parametrize("at", ["input", "output"])
def test_without_delay_it_is_the_loop_itself(at):
    model, K, _ = case(7)
    whole = loop(model, Feedback(K, ("a", "b"), dt=DT), at=at)
    for channel in range(2):
        poles = np.linalg.eigvals(whole.late.closed(channel, 0.0))
        for pole in np.linalg.eigvals(whole.closed()):
            assert np.abs(poles - pole).min() < 1e-6


def shaken():
    """A double integrator with a mode of 8 Hz, sampled at 10 Hz, and its LQR."""
    A = np.array([[0, 1.0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1.0], [0, 0, -2500.0, -0.5]])
    model = LinearModel.from_matrices(A, [[0], [1.0], [0], [1.0]])
    return model, LQR.design(model, np.diag([1, 0.1, 100.0, 0.1]), [[0.01]], dt=DT)


def test_a_mode_above_the_nyquist_frequency_bears_less_than_the_sampled_response_says():
    model, law = shaken()
    whole = loop(model, law)
    [c] = margins(whole).channels
    assert 0.05 < c.delay < 0.0625
    radius = lambda delay: np.abs(np.linalg.eigvals(whole.late.closed(0, delay))).max()  # noqa: E731
    assert all(radius(delay) < 1 for delay in np.linspace(0, 0.999 * c.delay, 200))
    assert radius(1.001 * c.delay) > 1
    assert shortest(None, 0, DT, 0.207, np.ones(1)) == pytest.approx(0.2)  # periods


def test_where_only_the_sampled_model_is_known_whole_periods_are_told():
    law = LQR.design(shaken()[0], np.diag([1, 0.1, 100.0, 0.1]), [[0.01]], dt=DT)
    sampled = loop(shaken()[0].discretize(DT), law)
    assert sampled.late is None
    [c] = margins(sampled).channels
    assert c.delay / DT == pytest.approx(round(c.delay / DT), abs=1e-12)


def test_a_loop_whose_response_stays_below_one_bears_every_delay():
    model = LinearModel.from_matrices([[-1.0]], [[1.0]])
    [c] = margins(loop(model, Feedback([[0.5]], ("x1",), dt=0.01))).channels
    assert c.delay == np.inf


def test_many_short_periods_of_delay():
    """x' = u, u = -x late by tau: pi / 2 seconds less half a period, to second order in the period; of more than 64
    periods an eighth of one is left open, on the safe side.
    """
    model = LinearModel.from_matrices([[0.0]], [[1.0]])
    for dt, left in ((0.05, 0.0), (0.01, 1 / 8), (0.001, 1 / 8)):
        [c] = margins(loop(model, Feedback([[1.0]], ("x1",), dt=dt))).channels
        exact = np.pi / 2 - dt / 2
        assert exact - left * dt - dt**2 < c.delay < exact + dt**2


@pytest.mark.parametrize("at", ["input", "output"])
@pytest.mark.parametrize("seed", range(3))
def test_the_response_of_the_cut_loop_is_one_at_its_poles(seed, at):
    """At the poles z of the closed matrix, computed apart: 1 = z^-m T(z)."""
    model, K, _ = case(seed)
    late = loop(model, Feedback(K, ("a", "b"), dt=DT), at=at).late
    for channel in range(2):
        for periods, rest in ((0, 0.0), (0, 0.03), (2, 0.07)):
            poles = np.linalg.eigvals(late.closed(channel, periods * DT + rest)).astype(complex)
            poles = poles[np.abs(poles) > 0.05]
            found = poles**-periods * late.response(channel, np.array([rest]), poles)[0]
            np.testing.assert_allclose(found, 1.0, atol=1e-6)


def test_a_regulator_of_an_undamped_mode_has_margins():
    """Cut, its loop has poles upon the unit circle, at frequencies that are looked at."""
    w = np.pi / 4 / DT
    model = LinearModel.from_matrices([[0.0, w], [-w, 0.0]], [[0.0], [1.0]])
    law = LQR.design(model, np.eye(2), [[1.0]], dt=DT)
    for whole in (loop(model, law), loop(model, law, at="output")):
        for i, c in enumerate(margins(whole).channels):
            if c.delay < np.inf:
                radii = [np.abs(np.linalg.eigvals(whole.late.closed(i, c.delay * f))).max() for f in (0.999, 1.001)]
                assert radii[0] < 1 < radii[1]


@pytest.mark.parametrize(
    ("B", "C", "D", "K"), [((1.0, -0.6), (1.8, -1.3), -0.7, 0.5), ((0.4, 0.4), (-1.2, 0.2), -0.3, -1.0)]
)
def test_an_input_that_passes_just_before_the_next_sample_is_read_at_once(B, C, D, K):
    """Just below one period of delay a reading still holds the input that was given a period ago, at a period the one
    before that. Here the loop grows in between alone; the exact model of a late held input says so.
    """
    dt = 0.5
    model = LinearModel.from_matrices([[0.0, 1.0], [-0.59, 0.0307]], np.transpose([B]), [C], [[D]], outputs=["a"])
    whole = loop(model, Feedback([[K]], ("a",), dt=dt))

    def bears(periods):
        return np.abs(np.linalg.eigvals(whole.late.closed(0, periods * dt))).max() < 1

    assert all(bears(p) for p in (*np.arange(0, 1, 1 / 8), 1.0)) and not bears(1 - 1e-7)
    [c] = margins(whole).channels
    assert 7 / 8 < c.delay / dt < 1 and bears(c.delay / dt - 1e-6) and not bears(c.delay / dt + 1e-6)


def test_a_sampled_response_of_one_and_more_at_the_nyquist_frequency_bears_no_period():
    """x+ = -0.9 x + u, u = -k x: z + 0.9 + k, and late by a period z^2 + 0.9 z + k."""
    model = LinearModel.from_matrices([[-0.9]], [[1.0]], dt=DT)
    for k, borne in ((-1.5, 0.0), (0.05, np.inf)):  # L(-1) = -10 k
        [c] = margins(loop(model, Feedback([[k]], ("x1",), dt=DT))).channels
        assert c.delay == borne
        assert (np.abs(np.roots([1.0, 0.9, k])).max() < 1) == (borne > 0)
