"""SoRoMoX's piecewise constant strain on the scene that it can hold."""

import json
from importlib import util
from pathlib import Path

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import Setting
from pliant.studies.peers.soromox_strains import Strains

REFERENCE = Path(__file__).parents[2] / "reference" / "large_beam.json"


def test_what_it_cannot_hold():
    for name in ("two-link-reach", "spin-up", "single-link-slew"):
        assert "fixed base" in Strains().why_not(machine_of(scenes.get(name)))
    assert Strains().why_not(machine_of(scenes.get("cantilever-drop"))) == ""


@pytest.mark.campaign
@pytest.mark.skipif(util.find_spec("soromox") is None, reason="SoRoMoX is not installed")
def test_release_is_of_second_order_in_segments():
    """M0, which the reference knows to 1e-6 m; and without the error of second order within a tolerance."""
    scene = scenes.get("cantilever-drop", dt=0.02)
    machine = machine_of(scene)
    rows = json.loads(REFERENCE.read_text())["release"]["M0_inextensible"]
    at = [round(r["t"] / scene.dt) for r in rows]
    truth = np.array([[10.0 + r["u"], r["v"]] for r in rows])
    coarse, fine = (Strains().player(machine, Setting(n, 2 * n, "Tsit5")).play()[0][0][at] for n in (4, 8))
    errors = [np.abs(tip - truth).max() for tip in (coarse, fine, (4 * fine - coarse) / 3)]
    assert 3 < errors[0] / errors[1] < 5.5 and errors[2] < errors[1]
