"""Tangents of a motion: closed forms, differences at the step that rounding and curvature give, missing compilers."""

import numpy as np
import pytest
from springs import SPRING, VARIED

from pliant.plants import SingleLinkArm
from pliant.plants.identification import tangent_motion
from pliant.plants.identification.tangent_motion import TangentMotion, evenly_spaced, measured_function

P = VARIED.nominal_parameters
NONE = np.zeros(0)


def played(plant, t, x0, u, p, *, step=0.01, hold="zero-order"):
    w, seeds, directions = np.zeros(plant.nw), np.zeros((len(plant.varied), plant.nx)), np.eye(len(plant.varied))
    return TangentMotion(plant)(t, x0, u, w, p, seeds, directions, step=step, hold=hold)


def free(t, m, c, k):
    """x(t) of the free spring from (1, 0): exp(-a t) (cos w t + a/w sin w t)."""
    a = c / (2 * m)
    w = np.sqrt(k / m - a * a)
    return np.exp(-a * t) * (np.cos(w * t) + a / w * np.sin(w * t))


def test_tangents_of_a_free_vibration_are_those_of_its_closed_form():
    t = np.linspace(0.0, 3.0, 61)
    x, s = played(VARIED, t, np.array([1.0, 0.0]), np.zeros((61, 1)), P, step=0.005)
    assert np.abs(x[:, 0] - free(t, *P)).max() < 1e-11  # order 8: (w h)^8 of 5 rad/s and 5 ms is 4e-13
    for j in range(3):
        h = 1e-20  # complex step (Squire and Trapp 1998): no cancellation
        moved = P.astype(complex)
        moved[j] += 1j * h
        assert np.abs(s[:, j, 0] - free(t, *moved).imag / h).max() < 1e-10


def test_a_seed_is_the_transition_matrix():
    t = np.array([0.0, 0.1, 0.35])
    A = np.array([[0.0, 1.0], [-P[2] / P[0], -P[1] / P[0]]])
    from scipy.linalg import expm

    motion = TangentMotion(VARIED)
    _, s = motion(t, np.array([0.3, 0.0]), np.zeros((3, 1)), NONE, P, np.eye(2), np.zeros((2, 3)), step=0.01)
    assert np.abs(s[-1].T - expm(0.35 * A)).max() < 1e-11


def test_tangents_are_the_differences_of_the_discrete_motion():
    """Central differences: error h^2 |x'''|/6 + eps |x|/h, least at h = (3 eps)^(1/3), then some eps^(2/3) = 4e-11."""
    arm = SingleLinkArm(link=SingleLinkArm.textbook().link, hub_inertia=1.3, kinematics="rigid", gravity=9.81)
    arm = arm.vary("hub_inertia", "payload.mass", "link.E")
    t = np.linspace(0.0, 1.0, 101)
    u, p = 2 * np.sin(5 * t)[:, None], arm.nominal_parameters + np.array([0.0, 0.4, 0.0])
    _, s = played(arm, t, arm.rest_state, u, p)
    for j in range(2):
        h = (3 * np.finfo(float).eps) ** (1 / 3) * p[j]
        e = np.eye(3)[j] * h
        ends = [played(arm, t, arm.rest_state, u, p + sign * e)[0] for sign in (1, -1)]
        difference = (ends[0] - ends[1]) / (2 * h)
        assert np.abs(s[:, j] - difference).max() < 1e-8 * np.abs(difference).max()
    assert not s[:, 2].any()  # a rigid link has no modulus


def test_a_ramp_of_the_input_is_followed_where_it_is_linear_between_samples():
    t = np.linspace(0.0, 2.0, 21)
    u = (3.0 * t)[:, None]
    x, _ = played(VARIED, t, np.zeros(2), u, P, hold="linear")
    exact = SPRING.simulate(np.zeros(2), lambda time: np.array([3.0 * time]), t)
    assert np.abs(x - exact.x).max() < 1e-9
    held, _ = played(VARIED, t, np.zeros(2), u, P)
    assert np.abs(held - exact.x).max() > 1e-3


def test_samples_may_be_uneven_and_longer_than_a_call(monkeypatch):
    monkeypatch.setattr(tangent_motion, "AT_ONCE", 16)
    parts = evenly_spaced(np.array([0.1] * 40 + [0.2, 0.1, 0.1]))
    assert parts == [(0, 16), (16, 32), (32, 40), (40, 41), (41, 43)]
    monkeypatch.undo()
    rng = np.random.default_rng(1)
    t = np.concatenate([np.arange(300) * 0.01, 3.0 + np.cumsum(rng.uniform(0.01, 0.2, 10))])
    u = np.where(t > 1.5, 1.0, -1.0)[:, None]
    x, _ = played(VARIED, t, np.zeros(2), u, P)
    assert np.abs(x - SPRING.simulate(np.zeros(2), u, t).x).max() < 1e-9


def test_what_diverges_is_not_a_number_from_there_on():
    t = np.arange(600) * 1.0
    x, s = played(VARIED, t, np.array([1.0, 0.0]), np.zeros((600, 1)), np.array([1e-6, 0.0, 1e6]), step=1.0)
    assert np.isnan(x[-1]).all() and np.isnan(s[-1]).all() and np.isfinite(x[0]).all()


def test_the_virtual_machine_gives_the_same(monkeypatch):
    t = np.linspace(0.0, 0.5, 11)
    arguments = (VARIED, t, np.array([1.0, 0.0]), np.ones((11, 1)), P)
    native = played(*arguments)
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    tangent_motion.tangent_kernel.cache_clear()
    slow = played(*arguments)
    tangent_motion.tangent_kernel.cache_clear()
    assert all(np.abs(a - b).max() < 1e-13 for a, b in zip(native, slow))


@pytest.mark.parametrize("signals", [("place",), ("felt", "v")])
def test_what_is_measured_and_its_slopes(signals):
    x, u = np.array([[0.1, -0.4]]), np.array([[2.0]])
    y, C, D = measured_function(VARIED, signals)(np.zeros((1, 1)), x, u, NONE, P, batch=1)
    m, c, k = P
    a = (2.0 - c * -0.4 - k * 0.1) / m
    expected = {
        "place": (0.1, [1, 0], [0, 0, 0]),
        "v": (-0.4, [0, 1], [0, 0, 0]),
        "felt": (a, [-k / m, -c / m], [-a / m, 0.4 / m, -0.1 / m]),
    }
    for i, name in enumerate(signals):
        for found, right in zip((y[0, i], C[0, i], D[0, i]), expected[name]):
            assert np.allclose(found, right, rtol=1e-12, atol=1e-12)


def test_many_tangents_on_two_processors_are_what_few_are_on_one(monkeypatch):
    monkeypatch.setattr(tangent_motion, "available", lambda: 2)
    t, seeds = np.linspace(0.0, 1.0, 41), np.random.default_rng(0).normal(size=(30, 2))
    motion, none = TangentMotion(VARIED), np.zeros((30, 3))
    options = (t, np.array([0.5, 0.0]), np.ones((41, 1)), NONE, P)
    x, s = motion(*options, seeds, none, step=0.01)
    for k in (0, 13, 29):
        one, tangent = motion(*options, seeds[k : k + 1], none[:1], step=0.01)
        assert (one == x).all() and (tangent[:, 0] == s[:, k]).all()
