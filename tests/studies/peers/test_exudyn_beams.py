"""Exudyn's beams on the scenes: their errors fall far below the tolerance."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from evidence import agrees

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.peers.exudyn_beams import Beams, Solver
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import BrokenDownError, Setting
from pliant.studies.physics.physics_motion import physics_motion

pytest.importorskip("exudyn", reason="Exudyn is not installed")
REFERENCE = Path(__file__).parents[2] / "reference" / "large_beam.json"


def both(scene, setting, program=None):
    """Its outputs and those of physics."""
    machine, truth = machine_of(scene), physics_motion(Motions(scene), scene.tolerance)
    motion, _ = (program or Beams()).player(machine, setting).play()
    return machine.outputs(*motion), truth.outputs


def off(scene, setting, program=None):
    """Largest error against physics, over the tolerance."""
    return np.abs(np.subtract(*both(scene, setting, program))).max() / scene.tolerance


@pytest.mark.parametrize("name", ["single-link-slew", pytest.param("two-link-reach", marks=pytest.mark.campaign)])
def test_error_falls_to_a_hundredth_of_the_tolerance(name):
    scene = scenes.get(name, duration=1.0)
    error = off(scene, Setting(4, 4, Solver(tolerance=1e-6)))
    found, own = both(scene, Setting(4, 64, Solver(tolerance=1e-6)))
    agrees(
        own,
        found,
        within=min(0.01, error / 10) * scene.tolerance,
        absolute=True,
        of=type(scene.plant).__name__,
        what=f"outputs of {name} over 1 s",
        source="Exudyn 1.13.6, four beams a link",
        kind="other program",
    )


def released():
    """The cantilever as the reference has it: shear coefficient 1, the reference's times among the control times."""
    scene = scenes.get("cantilever-drop", dt=0.02)
    beam = dataclasses.replace(scene.plant.beam, shear_coefficient=1.0)
    return scene, machine_of(scene.with_plant(dataclasses.replace(scene.plant, beam=beam)))


def off_release(machine, setting, theory="M1_timoshenko"):
    """Largest error [m] of the tip against the reference, which knows it to 3e-7 m, at its times."""
    (tip, _), _ = Beams().player(machine, setting).play()
    rows = json.loads(REFERENCE.read_text())["release"][theory]
    return max(np.abs(tip[round(r["t"] / machine.dt)] - [10.0 + r["u"], r["v"]]).max() for r in rows)


@pytest.mark.campaign
def test_release_against_the_reference():
    scene, machine = released()
    errors = [off_release(machine, Setting(n, 160, Solver(tolerance=1e-6, sparse=True))) for n in (8, 16, 28)]
    assert errors[2] < 0.01 * scene.tolerance and errors[0] > errors[1] > errors[2]


def test_release_to_a_tenth_of_the_tolerance():
    scene, machine = released()
    assert off_release(machine, Setting(12, 16, Solver())) < 0.1 * scene.tolerance


@pytest.mark.campaign
def test_what_is_left_of_spin_up_is_the_axis_that_stretches():
    scene = scenes.get("spin-up")
    setting = Setting(4, 16, Solver(tolerance=1e-6))
    assert 0.01 < off(scene, setting) < 0.025  # Pliant's arm does not stretch
    assert off(scene, setting, Beams(stiffer=10.0)) < 0.01


def test_steps_that_are_too_long_break_down():
    with pytest.raises(BrokenDownError, match="too long"):
        Beams().player(machine_of(scenes.get("cantilever-drop")), Setting(8, 1, Solver())).play()


def test_solver_says_itself():
    assert str(Solver()) == "trapezoidal rule, dense, modified Newton to 0.0001"
    assert str(Solver(0.9, 1e-3, True, False)) == "generalized alpha 0.9, sparse, Newton to 0.001"
    assert Solver() not in Beams().beside(Solver())
