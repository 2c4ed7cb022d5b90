"""stiffening_needed: its predicted error against the difference of the two motions, and its answers."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import Payload
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.stiffening import stiffening_needed
from pliant.studies.papers.single_link import first_frequency, first_root, spin_up_deflections

SLEW = scenes.get("single-link-slew")


def slew(angle, time, **changes):
    return dataclasses.replace(SLEW, goal=(("hub_angle", angle),), move_time=time, **changes)


def measured(scene):
    """Largest difference between the motions without and with stiffening."""
    motions = Motions(scene)
    linear, stiff = (dataclasses.replace(scene.plant, kinematics=k) for k in ("linear", "stiffened"))
    return motions.difference(linear, stiff)


EMPTY = dataclasses.replace(SLEW.plant, payload=Payload())
CASES = {
    "slow": (slew(1.0, 2.0), False),
    "as it is": (SLEW, False),
    "fast": (slew(3.0, 1.0), False),
    "fast, narrow tolerance": (slew(3.0, 1.0, tolerance=1e-4), True),
    "empty hand, fast": (slew(30.0, 3.0, plant=EMPTY), False),
    "empty hand, faster": (slew(60.0, 3.0, plant=EMPTY), True),
    "prescribed hub": (
        slew(3.0, 1.0, plant=dataclasses.replace(SLEW.plant, drive="motion"), limits=(1e3,), effort=()),
        False,
    ),
}


@pytest.mark.every(4)
@pytest.mark.parametrize("name", CASES)
def test_predicted_error_is_the_measured_difference(name):
    scene, needed = CASES[name]
    found, truth = stiffening_needed(scene), measured(scene)
    assert found.error == pytest.approx(truth, rel=0.1)
    assert bool(found) is found.needed is needed is (truth > scene.tolerance)
    assert found.speed < found.critical_speed and found.uncertainty < 0.02 * found.error


def test_error_grows_with_the_deflection_times_the_square_of_the_speed():
    """The same path in less time: speed^2 falls as T^-2, the quasi-static deflection too: T^-4."""
    times = np.array([1.6, 2.0, 2.5])
    plant = dataclasses.replace(SLEW.plant, drive="motion", link=dataclasses.replace(SLEW.plant.link, damping=2e-3))
    found = [
        stiffening_needed(slew(1.0, T, plant=plant, limits=(1e3,), effort=(), compare=("tip_deflection",)))
        for T in times
    ]
    slope = np.polyfit(np.log(times), np.log([f.error for f in found]), 1)[0]
    assert slope == pytest.approx(-4, abs=0.6)


def test_past_the_critical_speed_it_is_needed_without_more_ado():
    scene = slew(80.0, 3.0)
    found = stiffening_needed(scene)
    assert found.needed and found.error == np.inf and found.ratio > 1 and "unstable" in found.why
    assert found.speed == pytest.approx(80.0 * 1.875 / 3.0)


@pytest.mark.campaign
def test_two_links_need_it_under_gravity():
    scene = scenes.get("two-link-reach")
    found = stiffening_needed(scene)
    assert found.needed and measured(scene) > scene.tolerance
    slow = dataclasses.replace(scene, plant=dataclasses.replace(scene.plant, gravity=0.0), move_time=3.0, duration=3.0)
    gentle = stiffening_needed(slow)
    assert not gentle.needed
    assert gentle.error == pytest.approx(measured(slow), rel=0.1)


def test_a_plant_without_the_choice_is_refused():
    said = r"scene 'cantilever-drop': plant\.kinematics = .* must be 'linear' or 'stiffened'"
    with pytest.raises(ValueError, match=said):
        stiffening_needed(scenes.get("cantilever-drop"))


@pytest.mark.campaign
def test_figures():
    """First frequency: flat in I_xx until torsion takes over, then the same for every I_zz."""
    assert first_root(0.005, 0.05) == pytest.approx(1.184573429833, abs=1e-11)
    assert first_root(3.0, 0.005) == pytest.approx(first_root(3.0, 0.05), rel=1e-3)
    assert len(first_frequency(5).axes) == 3
    assert len(spin_up_deflections("euler-bernoulli", times=(1.0,)).axes) == 2


def test_stiffening_follows_the_scenes_own_drive():
    assert stiffening_needed(scenes.get("spin-up")).speed == pytest.approx(6.0, rel=1e-3)
    assert stiffening_needed(scenes.get("spin-up")).needed
    slow = stiffening_needed(scenes.get("spin-up", speed=0.2))
    assert slow.speed == pytest.approx(0.2, rel=1e-3) and not slow.needed
