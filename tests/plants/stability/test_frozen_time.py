"""Frozen roots and slow variation against closed forms."""

import warnings

import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.stability import assess, frozen_time, slow_variation
from pliant.plants.stability.frozen_time import off_by_rounding


def test_slow_variation_gives_a_rate_that_the_truth_keeps_and_scales_with_the_speed(model_of, integrated):
    def A(t, speed):
        k, d = 4.0 + np.sin(speed * t), 0.6 + 0.2 * np.cos(speed * t)
        return np.array([[0.0, 1.0], [-k, -d]])

    used = []
    for speed in (0.02, 0.04, 0.9):
        t = np.linspace(0.0, 1.5 / speed, 301)
        model = model_of(t, np.array([A(s, speed) for s in t]))
        slow = slow_variation(model)
        used.append(slow.used)
        if slow:
            duration = t[-1]
            true = -np.log(np.linalg.norm(integrated(lambda s, v=speed: A(s, v), (0.0, duration), 2), 2)) / duration
            assert 0 < slow.decay < true + np.log(10) / duration
    assert used[1] == pytest.approx(2 * used[0], rel=1e-2)  # P' is proportional to the speed
    assert used[0] < 1 < used[2] * 4


def test_slow_variation_in_closed_form(model_of):
    """x' = a(t) x: P = -1/(2a), P' = a'/(2 a^2)."""
    t = np.linspace(0.0, 2.0, 401)
    model = model_of(t, (-1.0 - 0.5 * np.sin(t))[:, None, None])
    slow = slow_variation(model)
    a, da = -1.0 - 0.5 * np.sin(t), -0.5 * np.cos(t)
    assert slow.used == pytest.approx(max(0.0, (da / (2 * a**2)).max()), abs=1e-6)
    assert slow.bound == pytest.approx(2 * (a**2).min(), rel=1e-6)
    assert slow and slow.inside == 1 - slow.used


def test_false_growth_in_moving_coordinates(model_of):
    """A free mass in axes that spin up: frozen roots in body axes grow at sqrt(rate/2) or so, inertial ones do not."""
    rate = 0.3
    t = np.linspace(0.0, 2.0, 201)
    A = np.zeros((201, 4, 4))
    A[:, :2, 2:] = np.eye(2)
    spin = rate * t
    A[:, 2:, :2] = spin[:, None, None] ** 2 * np.eye(2) + rate * np.array([[0, 1], [-1, 0]])
    A[:, 2:, 2:] = 2 * spin[:, None, None] * np.array([[0, 1], [-1, 0]])
    body = frozen_time(model_of(t, A), coordinates="body axes")
    assert body.rightmost[0] == pytest.approx(np.sqrt(rate / 2), rel=1e-9) and body.suggests == "unstable"
    verdict = assess(model_of(t, A))
    assert verdict.method != "frozen_time" and verdict.verdict != "stable"


@pytest.mark.parametrize("method", [frozen_time, slow_variation])
def test_sampled_models_have_no_frozen_roots_in_the_s_plane(method):
    """|z| decides there, not the real part: assess knows, the methods for continuous time refuse."""
    arm = SingleLinkArm.textbook()
    sampled = arm.linearize(np.zeros(arm.nx)).discretize(0.01)
    with pytest.raises(ValueError, match=r"model\.dt = 0\.01 must be None"):
        method(sampled)
    assert assess(sampled).verdict in ("marginal", "unstable")


def test_a_chain_of_integrators_says_nothing_of_its_roots_and_warns_of_nothing():
    """Its eigenvectors are one to 1e-292: any root within the root of rounding belongs to it."""
    chain = np.array([[0.0, 1.0], [0.0, 0.0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert off_by_rounding(*np.linalg.eig(chain), chain) == np.inf


@pytest.mark.parametrize(
    ("rate", "said"), [(2e-6, "marginal"), (-2e-6, "marginal"), (0.5, "unstable"), (-0.5, "stable")]
)
def test_a_root_too_small_to_matter_before_the_end_suggests_nothing(rate, said, model_of):
    """e^(2e-6 * 40) - 1 = 8e-5: what is told; the same roots of a model that lasts for ever do suggest something."""
    t = np.linspace(0.0, 40.0, 101)
    A = np.zeros((101, 2, 2))
    A[:, 0, 0], A[:, 1, 1] = rate, -2.0 - 0.3 * np.sin(t / 7)
    found = assess(model_of(t, A), periodic=False)
    words = {**found.reasons, found.method: ""}["frozen_time"]
    assert found.evidence["frozen_time"].suggests == said and words.startswith(f"suggests {said} (rightmost ")
    assert (", by which deviations change by 8e-05 of themselves meanwhile" in words) == (said == "marginal")
    assert frozen_time(model_of(t, A)).suggests == ("unstable" if rate > 0 else "stable")
