"""MuJoCo's cable on the scenes that it can hold."""

import json
from pathlib import Path

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.peers.mujoco_cable import Cable
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import Setting
from pliant.studies.physics.physics_motion import physics_motion

REFERENCE = Path(__file__).parents[2] / "reference" / "large_beam.json"


def test_what_it_cannot_hold():
    assert "joint" in Cable().why_not(machine_of(scenes.get("two-link-reach")))
    assert "damping" in Cable().why_not(machine_of(scenes.get("single-link-slew")))
    assert Cable().why_not(machine_of(scenes.get("spin-up"))) == ""


def played(scene, parts, k):
    pytest.importorskip("mujoco", minversion="4", reason="MuJoCo 4 is not installed")
    return Cable().player(machine_of(scene), Setting(parts, k, "discrete")).play()[0]


def test_spun_up_within_its_order():
    """Of second order in points, of first in steps: without both little is left."""
    scene = scenes.get("spin-up", speed=0.3, time=1.0, duration=1.0)
    truth = physics_motion(Motions(scene), scene.tolerance).outputs
    coarse, fine, short = (machine_of(scene).outputs(*played(scene, n, k)) for n, k in ((8, 16), (16, 16), (16, 32)))
    found = (4 * fine - coarse) / 3 + 2 * (short - fine)
    errors = [np.abs(e - truth).max() / scene.tolerance for e in (fine, found)]
    assert errors[1] < 0.1 and errors[1] < errors[0] / 4


@pytest.mark.campaign
def test_release_is_of_second_order_in_points():
    """M0, which the reference knows to 1e-6 m, but for what edges' rotary inertia and steps leave."""
    scene = scenes.get("cantilever-drop", dt=0.02)
    rows = json.loads(REFERENCE.read_text())["release"]["M0_inextensible"]
    at, truth = [round(r["t"] / scene.dt) for r in rows], np.array([[10.0 + r["u"], r["v"]] for r in rows])
    tips = [played(scene, n, 128)[0][at] for n in (8, 16)]
    errors = [np.abs(tip - truth).max() for tip in (*tips, (4 * tips[1] - tips[0]) / 3)]
    assert 3 < errors[0] / errors[1] < 5 and errors[2] < errors[1] / 2
