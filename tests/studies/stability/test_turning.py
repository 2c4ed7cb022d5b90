"""Campbell diagrams and tongues of scenes."""

import math

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.stability import turning


def test_the_speed_is_the_goals_rate_or_else_the_starts():
    assert turning.speed_of(scenes.get("spin-up")) == "hub_angle_rate"
    assert turning.speed_of(scenes.get("spacecraft-spin")) == "rate_z"
    assert turning.speed_of(scenes.get("slider-crank-run")) == "crank_angle_rate"


def test_a_beam_that_turns_stiffens():
    """Southwell's coefficient of the first mode, 1.193, less 1 in the plane of the turn (Wright et al. 1982)."""
    found = turning.campbell_of(scenes.get("spin-up"), 0.0, 6.0)
    squares = found.frequencies[:, 0] ** 2
    slope = (squares - squares[0]) / np.maximum(found.speeds**2 - found.speeds[0] ** 2, 1e-300)
    assert slope[1] == pytest.approx(0.193, rel=0.01)
    for c in found.crossings:
        assert c.frequency == pytest.approx(c.order * c.speed, rel=1e-6)


def test_a_rods_first_mode_is_a_pinned_beams():
    """At low speed f1 = pi/2 sqrt(EI / (rho A L^4)) (Blevins 1979, table 8-1)."""
    scene = scenes.get("slider-crank-run")
    rod = scene.plant.rod
    first = math.pi / 2 * math.sqrt(rod.E * min(rod.I_y, rod.I_z) / (rod.density * rod.area * rod.length**4))
    found = turning.campbell_of(scene, 4.0, 8.0)
    assert found.frequencies[0, 0] / (2 * math.pi) == pytest.approx(first, rel=0.01)


def test_what_is_asked_of_the_wrong_scene_is_refused():
    for call, says in (
        (lambda: turning.campbell_of(scenes.get("single-link-slew"), 0.0, 1.0), "nothing turns"),
        (lambda: turning.campbell_of(scenes.get("spin-up"), 2.0, 1.0), "must rise"),
        (lambda: turning.tongues_of(scenes.get("spin-up"), 1.0, 2.0), "tongues.plant"),
    ):
        with pytest.raises(ValueError, match=says):
            call()
