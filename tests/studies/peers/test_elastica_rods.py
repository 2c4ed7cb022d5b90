"""PyElastica's rod on the scenes. What is left is of second order in its elements, of first in its softening."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.peers.elastica_rods import Rods, Softened
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import BrokenDownError, Setting
from pliant.studies.physics.physics_motion import physics_motion

pytest.importorskip("elastica", reason="PyElastica is not installed")


def extrapolated(scene, settings):
    """Errors over the tolerance: of twice as many elements, and without the share of elements and of softening."""
    machine, truth = machine_of(scene), physics_motion(Motions(scene), scene.tolerance).outputs
    plays = (Rods().player(machine, Setting(n, k, Softened(by))).play()[0] for n, by, k in settings)
    coarse, fine, hard = (machine.outputs(*motion) for motion in plays)
    found = (4 * fine - coarse) / 3 + 2 * (hard - fine)
    return [np.abs(e - truth).max() / scene.tolerance for e in (fine, found)]


def test_spun_up_it_is_within_a_hundredth_but_for_both():
    scene = scenes.get("spin-up", speed=0.3, time=1.0, duration=1.0)
    fine, found = extrapolated(scene, ((8, 20.0, 128), (16, 20.0, 128), (16, 10.0, 256)))
    assert found < 0.02 and fine < 0.5


@pytest.mark.campaign
@pytest.mark.parametrize(
    "name, duration, settings, least",
    [
        ("two-link-reach", 1.0, ((4, 100.0, 256), (8, 100.0, 256), (8, 50.0, 768)), 0.4),
        ("cantilever-drop", 1.0, ((16, 10.0, 800), (32, 10.0, 1200), (32, 5.0, 1600)), 0.4),
    ],
)
def test_most_of_the_error_is_elements_and_softening(name, duration, settings, least):
    fine, found = extrapolated(scenes.get(name, duration=duration), settings)
    assert found < least < fine


def test_steps_that_are_too_long_break_down():
    scene = scenes.get("two-link-reach", duration=0.5)
    with pytest.raises(BrokenDownError, match="too long"):
        Rods().player(machine_of(scene), Setting(4, 8, Softened(100.0))).play()


def test_softened_says_itself():
    assert "/ 10" in str(Softened(10.0)) and str(Softened()) == ""
