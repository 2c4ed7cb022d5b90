"""What a run and many runs are worth."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.rollout import rollout
from pliant.studies.closed_loop.scores import BAND, score, summarise

SLEW = scenes.get("single-link-slew")


def test_scores_of_a_motion_known_in_closed_form():
    scene = play(SLEW)
    run = rollout(scene, LQR.for_scene(SLEW))
    t, n = scene.times, len(scene.times)
    signals = np.zeros_like(run.signals)
    places = {name: run.names.index(name) for name in run.names}
    signals[:, places["hub_angle"]] = 1 - np.exp(-3 * t)  # within 5 % from ln(20)/3 = 0.9986 s on
    signals[:, places["tip_deflection"]] = 0.02 * np.exp(-t) * np.cos(40 * t)
    found = score(scene, dataclasses.replace(run, signals=signals, u=np.full((n - 1, 1), 20.0)))
    assert BAND == 0.05 and found.settling == pytest.approx(1.0)
    assert found.peak == pytest.approx(0.02)
    assert found.residual == pytest.approx(0.02 * np.exp(-2.75), rel=0.1)
    assert found.effort == pytest.approx(0.5) and found.at_limit == 0.0
    never = signals.copy()
    never[:, places["hub_angle"]] = 0.9
    assert score(scene, dataclasses.replace(run, signals=never)).settling == np.inf


def test_summary_counts_failures_and_keeps_their_charge():
    scene = play(SLEW)
    good = score(scene, rollout(scene, LQR.for_scene(SLEW)))
    bad = dataclasses.replace(good, cost=100.0, failure="diverged at 1 s", settling=None, peak=None, residual=None)
    row = summarise("s", "varied", "c", [good, bad, good], np.array([1000, 3000, 2000]), [2.0, 4.0])
    assert row.failures == 1 and row.reason == "diverged at 1 s"
    assert row.cost == pytest.approx((2 * good.cost + 100) / 3)
    assert row.ratio == pytest.approx((good.cost + 100) / 6)
    assert (row.ratio_low, row.ratio_high) == (pytest.approx(good.cost / 2), 25.0)
    assert row.act_median == 2.0 and row.settling == good.settling
