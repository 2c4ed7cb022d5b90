"""What each effect of physics is worth."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics import effects
from pliant.studies.physics.physics_motion import physics_motion

SLEW = scenes.get("single-link-slew", duration=0.5, move_time=0.3)


@pytest.fixture(scope="module")
def found():
    motions = Motions(SLEW)
    physics = physics_motion(motions, 1e-4)
    return motions, physics, effects.of(motions, physics, SLEW.plant.ladder()[1])


@pytest.mark.parametrize("name", ["bending", "shortening of the bent links", "exact rotations", "shear"])
def test_an_effect_is_worth_what_two_simulations_differ_by(found, name):
    """Of the chosen plant where it has it, else of physics; to a tenth, and to what both are known to."""
    motions, physics, told = found
    worth = {e.name: e for e in told}[name]
    whole = SLEW.plant.ladder()[1] if worth.kept else physics.physics
    true = np.abs(motions.outputs(whole.without(name), 1e-10) - motions.outputs(whole, 1e-10)).max()
    assert worth.change == pytest.approx(true, rel=0.1, abs=2 * physics.uncertainty)


def test_the_largest_comes_first_and_what_the_chosen_one_has_is_kept(found):
    _, _, told = found
    assert [e.change for e in told] == sorted((e.change for e in told), reverse=True)
    assert {e.name for e in told if e.kept} == {"bending"}
    assert effects.of(Motions(SLEW), None, SLEW.plant) == ()


def test_what_is_left_out_sums_up_to_the_error(found):
    """Over time, where effects are small enough to add: to a tenth of the error, and to what physics is known to."""
    motions, physics, told = found
    chosen = SLEW.plant.ladder()[1]
    error = physics.outputs - motions.outputs(chosen, 1e-10)
    left_out = sum(e.over_time for e in told if not e.kept and e.over_time is not None)
    assert np.abs(left_out - error).max() < 0.1 * np.abs(error).max() + 2 * physics.uncertainty
    shapes = next(e for e in told if e.name == effects.SHAPES)
    assert shapes.change == pytest.approx(np.abs(shapes.over_time).max()) and "over_time" not in shapes.to_json()


def test_of_a_plant_with_no_other_effect_all_error_is_its_shapes():
    """A beam let go, by one shape: it hardly stretches, and shears less."""
    scene = scenes.get("cantilever-drop", duration=0.2)
    motions = Motions(scene)
    physics = physics_motion(motions, 1e-2)
    told = {e.name: e for e in effects.of(motions, physics, scene.plant.ladder()[0])}
    assert not any(e.kept for e in told.values()) and set(told) == {effects.SHAPES, "extension", "shear"}
    apart = np.abs(physics.outputs - motions.converged(motions.ladder[0])).max()
    assert told[effects.SHAPES].change == pytest.approx(apart, rel=5e-2)


def test_of_a_plant_that_does_not_bend_only_bending_is_told(found):
    """What refines bending is part of it; the sum of all is the error of the rigid plant."""
    motions, physics, _ = found
    rigid = SLEW.plant.ladder()[0]
    told = [e for e in effects.of(motions, physics, rigid) if e.name not in physics.estimated]
    bending = next(e for e in told if e.name == "bending")
    assert {e.name for e in told} <= {"bending", effects.SHAPES}
    true = np.abs(motions.outputs(rigid, 1e-10) - physics.outputs).max()
    assert bending.change == pytest.approx(true, rel=0.02)


def test_of_a_link_spun_as_it_is_told_bending_is_worth_all_its_deflection():
    """Without bending no speed is free: the tip's deflection then is zero."""
    scene = scenes.get("spin-up", time=0.5, duration=0.1)
    motions = Motions(scene)
    physics = physics_motion(motions, 1e-3)
    told = {e.name: e for e in effects.of(motions, physics, physics.physics)}
    assert told["bending"].kept and told["bending"].change == pytest.approx(np.abs(physics.outputs).max(), rel=1e-9)


def test_a_motion_that_two_effects_ask_for_is_found_once(monkeypatch):
    """Of a plant that lacks one effect alone, that one's and SHAPES'."""
    motions = Motions(SLEW)
    physics, asked, own = physics_motion(motions, 1e-4), [], effects.outputs_of
    chosen = next(p for p in SLEW.plant.ladder() if [*p.effects.values()].count(False) == 1)
    monkeypatch.setattr(effects, "outputs_of", lambda m, plant, *more: (asked.append(plant), own(m, plant, *more))[1])
    effects.of(motions, physics, chosen)
    assert len(asked) == len(set(asked))
