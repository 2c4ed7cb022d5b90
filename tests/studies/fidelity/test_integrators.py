"""Method and step of a chosen plant."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity import integrators as modules
from pliant.studies.fidelity.integrators import in_lanes, integrators
from pliant.studies.physics.physics_motion import physics_motion

SLEW = scenes.get("single-link-slew", duration=0.5, move_time=0.3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_both_keep_the_tolerance_as_simulated(tolerance):
    motions = Motions(SLEW)
    physics, plant = physics_motion(motions, tolerance), SLEW.plant.ladder()[-2]
    rows = [row for row in integrators(motions, physics, plant, tolerance) if row is not None]
    assert rows
    for row in rows:
        options = {"step": row.step} if row.step else {"rtol": row.rtol, "atol": row.rtol / 100}
        found = motions.compared(motions.run(plant, method=row.method, **options))
        error = np.abs(found - physics.outputs).max()
        assert error == pytest.approx(row.error, rel=1e-6) and error + physics.uncertainty <= tolerance
        assert row.seconds > 0 and row.variant == plant.label


def test_none_where_none_keeps_it():
    motions = Motions(SLEW)
    assert integrators(motions, physics_motion(motions, 1e-4), SLEW.plant.ladder()[0], 1e-4) == (None, None)


@pytest.mark.parametrize(("loosest", "native"), [(1e-3, True), (1e-3, False), (1e-8, True)])
def test_the_method_for_stiff_plants_is_tried_where_stability_bounds_the_steps(loosest, native, monkeypatch):
    """Where dop853's loosest tolerance keeps a metre of error and native code can be had; not where a finer does."""
    tolerance = 1.0
    motions, tried = Motions(SLEW), []
    physics, plant, run = physics_motion(motions, 1e-4), SLEW.plant.ladder()[-2], motions.run
    monkeypatch.setattr(motions, "run", lambda plant, **o: (tried.append(o["method"]), run(plant, **o))[1])
    monkeypatch.setattr(modules, "compile_motions", lambda *_: native)
    settings = modules._settings
    finer = [{"rtol": loosest, "atol": loosest / 100}]
    monkeypatch.setattr(modules, "_settings", lambda m, dt: finer if m == "dop853" else settings(m, dt))
    assert modules.integrators(motions, physics, plant, tolerance)[0] is not None
    assert ("rodas5p" in tried) is (native and loosest == 1e-3)


def test_of_many_lanes_a_setting_of_the_stepper_that_keeps_the_tolerance():
    """Played again by a loop of calls, one lane: within the tolerance, and a coarser step of its method is not."""
    motions, tolerance = Motions(SLEW), 1e-4
    physics, plant = physics_motion(motions, tolerance), SLEW.plant.ladder()[-2]
    found = in_lanes(motions, physics, plant, tolerance, 64)
    assert found.lanes == 64 and found.path == "stepper" and found.seconds > 0
    step = plant.stepper(SLEW.dt, method=found.method, batch=1, substeps=round(SLEW.dt / found.step))
    x, states = motions.start(plant)[None].copy(), [motions.start(plant)]
    for u in motions.held[:-1]:
        x = step(x, u)
        states.append(x[0])
    y = plant.measure(np.array(states), motions.held)
    names = [s.name for s in plant.outputs]
    compared = y[:, [names.index(name) for name in SLEW.compare]]
    error = np.abs(compared - physics.outputs).max()
    assert error == pytest.approx(found.error, rel=1e-6) and error + physics.uncertainty <= tolerance
    assert in_lanes(motions, physics, SLEW.plant.ladder()[0], 1e-9, 64) is None
