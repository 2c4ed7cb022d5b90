"""MuJoCo's chains on the scenes."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from evidence import agrees

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.peers.mujoco_chain import INTEGRATORS, Chain
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import BrokenDownError, Setting
from pliant.studies.physics.physics_motion import physics_motion

pytest.importorskip("mujoco", reason="MuJoCo is not installed")
REFERENCE = Path(__file__).parents[2] / "reference" / "large_beam.json"


def outputs(scene, setting):
    machine = machine_of(scene)
    motion, _ = Chain().player(machine, setting).play()
    return machine.outputs(*motion)


def off(scene, found):
    """Largest error against physics, over the tolerance."""
    return np.abs(found - physics_motion(Motions(scene), scene.tolerance).outputs).max() / scene.tolerance


def released(parts, k):
    """The tip of the released cantilever at the reference's times, and what the reference says: M0, to 1e-6 m."""
    scene = scenes.get("cantilever-drop", dt=0.02)
    (tip, _), _ = Chain().player(machine_of(scene), Setting(parts, k, "RK4")).play()
    rows = json.loads(REFERENCE.read_text())["release"]["M0_inextensible"]
    return tip[[round(r["t"] / scene.dt) for r in rows]], np.array([[10.0 + r["u"], r["v"]] for r in rows])


def test_release_is_of_second_order_in_segments():
    errors = [np.abs(np.subtract(*released(n, n)[:2])).max() for n in (8, 16)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.2) and errors[1] < 0.03


@pytest.mark.campaign
def test_release_extrapolated_is_the_reference():
    """Hundreds of segments would come to a hundredth of the tolerance; three chains and their order come near it."""
    tips = [released(n, 2 * n)[0] for n in (12, 24, 48)]
    twice = [(4 * b - a) / 3 for a, b in pairwise(tips)]
    best = (16 * twice[1] - twice[0]) / 15
    assert np.abs(best - released(8, 8)[1]).max() < 3e-5


def test_slew_extrapolated_is_within_a_hundredth():
    scene = scenes.get("single-link-slew", duration=1.0)
    coarse, fine = (outputs(scene, Setting(n, k, "RK4")) for n, k in ((4, 16), (8, 64)))
    assert 0.01 < off(scene, fine) < 0.3 * off(scene, coarse)
    agrees(
        physics_motion(Motions(scene), scene.tolerance).outputs,
        (4 * fine - coarse) / 3,
        within=0.01 * scene.tolerance,
        absolute=True,
        of="SingleLinkArm",
        what="outputs of single-link-slew over 1 s",
        source="MuJoCo 4.0.0, chains of 4 and 8 segments, extrapolated",
        kind="other program",
    )


@pytest.mark.campaign
@pytest.mark.parametrize(
    "name, chains", [("spin-up", ((16, 48), (32, 192))), ("two-link-reach", ((8, 128), (16, 1024)))]
)
def test_extrapolated_it_is_within_a_hundredth(name, chains):
    scene = scenes.get(name)
    coarse, fine = (outputs(scene, Setting(n, k, "RK4")) for n, k in chains)
    assert off(scene, (4 * fine - coarse) / 3) < 0.01


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_every_integrator_plays_a_prescribed_root(integrator):
    scene = scenes.get("spin-up", time=1.0, duration=1.0, speed=0.2)
    assert off(scene, outputs(scene, Setting(8, 64, integrator))) < 1.0


def test_steps_that_are_too_long_break_down(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BrokenDownError, match="too long"):
        outputs(scenes.get("cantilever-drop"), Setting(32, 1, "RK4"))
    assert not any(tmp_path.iterdir()) and capfd.readouterr() == ("", "")
