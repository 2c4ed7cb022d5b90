"""Boxes of a plant's own parameters."""

import boxes
import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.controllers.robust_analysis.robust_stability import over_box, robust_stability
from pliant.envs import scenes
from pliant.plants.core import parameters
from pliant.plants.core.errors import PliantError


def test_a_spring_whose_damping_may_be_lost():
    """x'' + (0.2 + 0.3 d1) x' + (1 + 0.1 d2) x = 0 is at its limit at d1 = -2/3."""
    found = over_box(
        lambda d: np.array([[0.0, 1.0], [-1 - 0.1 * d[1], -0.2 - 0.3 * d[0]]]), {"c": (-0.1, 0.5), "k": (0.9, 1.1)}
    )
    assert found.unstable_at == pytest.approx(2 / 3, rel=1e-6)
    assert found.stable_to == pytest.approx(2 / 3, rel=0.02) and found.stable_to < 2 / 3
    assert found.worst["c"] == pytest.approx(0.0, abs=1e-6)
    assert "unstable within the box" in found.words
    assert found.mu[0] == pytest.approx(1.5, rel=1e-6) and found.mu[1] > 1.5


def test_parts_of_a_box_show_what_one_norm_does_not():
    """x[k+1] = r R(0.3 + d1) x turns at any angle and falls where r = 0.9 + 0.2 d2 < 1: up to d2 = 1/2."""

    def sampled(d):
        c, s = np.cos(0.3 + d[0]), np.sin(0.3 + d[0])
        return (0.9 + 0.2 * d[1]) * np.array([[c, -4 * s], [s / 4, c]])

    found = over_box(sampled, {"turn": (1.0, 3.0), "size": (1.0, 3.0)}, dt=0.1)
    assert found.unstable_at == pytest.approx(0.5, rel=1e-6)
    assert 0.48 < found.stable_to < 0.5 and found.parts > 1 and found.form is None


def test_what_is_no_box():
    for box in ({}, {"a": (1.0, 1.0)}, {"a": (2.0, 1.0)}, {"a": 3.0}):
        with pytest.raises(ValueError, match="over_box"):
            over_box(lambda d: -np.eye(1), box)
    with pytest.raises(PliantError, match="grows by 1"):
        over_box(lambda d: np.eye(1), {"a": (0.0, 1.0)})
    with pytest.raises(PliantError, match="neither grows nor dies out"):
        over_box(lambda d: np.diag([1 - 1e-15, 0.5 + 0.1 * d[0]]), {"a": (0.0, 1.0)}, dt=0.1)


def test_a_sample_of_the_campaign():
    found = boxes.run(0, 300)
    assert not found["wrong"] and found["gap"] < 0.02


@pytest.mark.campaign
def test_two_links_within_two_percent_and_by_monte_carlo():
    scene = scenes.get("two-link-reach")
    plant, names = scene.plant, ("payload.mass", "link1.E", "link2.E")
    rest = plant.equilibrium(dict(scene.goal))
    law = LQR.design(
        plant.linearize(*rest), Q={"tip_x": 100.0, "tip_y": 100.0, "theta1": 10.0}, R={"tau1": 0.01, "tau2": 0.01}
    )
    middle = np.array([parameters.get(plant, n) for n in names])
    found = robust_stability(plant, law, {n: (0.7 * m, 1.3 * m) for n, m in zip(names, middle)}, dict(scene.goal))
    assert found.mu[1] / found.mu[0] < 1.02
    rng, varied = np.random.default_rng(0), plant.vary(*names)
    sides = rng.uniform(-1, 1, (10_000, 3))
    sides[:5000] = np.sign(sides[:5000]) * np.where(rng.random((5000, 3)) < 0.5, 1.0, np.abs(sides[:5000]))
    p = middle * (1 + 0.3 * found.stable_to * sides)
    x, u = np.tile(rest[0], (len(p), 1)), np.tile(rest[1], (len(p), 1))
    A, B = varied.jacobians(x, u, p=p)[:2]
    assert np.linalg.eigvals(A - B @ law.K).real.max() < 0


def test_looks_that_run_out_are_told(monkeypatch):
    """r R(1 + d1) as above in a box that is stable: with few looks not all of it is shown."""

    def sampled(d):
        c, s = np.cos(1 + d[0]), np.sin(1 + d[0])
        return (0.8 + 0.02 * d[1]) * np.array([[c, -4 * s], [s / 4, c]])

    told = {}
    for looks in (3, 3000):
        for name, count in (("LOOKS_AT_MAP", 1), ("FIRST", looks), ("LOOKS", looks), ("BY_SCALINGS", 0)):
            monkeypatch.setattr(f"pliant.controllers.robust_analysis.robust_stability.{name}", count)
        told[looks] = over_box(sampled, {"turn": (1.0, 3.0), "size": (1.0, 3.0)}, dt=0.1)
    assert told[3].cut_short and "ran out" in told[3].words and told[3].stable_to < told[3].most
    assert not told[3000].cut_short and "ran out" not in told[3000].words
    assert told[3000].stable_to == told[3000].most


@pytest.mark.parametrize("effect", [0.0, 1e-13])
def test_a_parameter_without_effect_takes_nothing_from_a_continuous_loop(effect):
    """x'' + (0.5 - 0.1 d1) x' + x = 0, and d2 of nothing: as many boxes as are looked at."""
    box = {"damping": (1.0, 3.0), "other": (1.0, 3.0)}
    found = over_box(lambda d: np.array([[0.0, 1.0], [-1.0 + effect * d[1], -0.5 + 0.1 * d[0]]]), box)
    assert found.stable_to == found.most and found.unstable_at is None and "1.9 boxes" in found.words
