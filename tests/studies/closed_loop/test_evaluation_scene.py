"""The plant that controllers are scored on: one fidelity higher, the same quantities, steps that are short enough."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import IntegrationError, MassMatrixError
from pliant.plants.integration.step_maps import step_limit
from pliant.studies.closed_loop.closed_loop import regulator, run
from pliant.studies.closed_loop.evaluation_scene import (
    accurate,
    differing_states,
    finer,
    finer_plant,
    play,
    require_signals,
    signal_ranges,
    step_error,
    varied_ranges,
)

SLEW, REACH = scenes.get("single-link-slew"), scenes.get("two-link-reach")


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach", "cantilever-drop", "slider-crank-run"])
def test_every_body_gets_one_more_mode_and_the_lower_ones_stay(name):
    design = scenes.get(name)
    played = design.with_plant(finer(design.plant))
    modes = np.atleast_1d(design.plant.modes)
    assert np.atleast_1d(played.plant.modes).tolist() == (modes + 1).tolist()
    assert played.plant.nx == design.plant.nx + 2 * len(modes)
    assert {s.name for s in design.plant.states} < {s.name for s in played.plant.states}
    assert differing_states(design, played) == ()


def test_every_appendage_gets_one_more_mode_of_its_modal_data():
    design = scenes.get("spacecraft-slew")
    played = design.with_plant(finer(design.plant))
    assert [a.modes for a in design.plant.appendages] == [1, 1]
    assert [a.modes for a in played.plant.appendages] == [2, 2]
    assert differing_states(design, played) == ()


@pytest.mark.parametrize("name", ["crane-swing", "three-link-flexible", "six-axis-pick"])
def test_every_family_of_a_tree_gets_one_more_shape_and_the_lower_ones_stay(name):
    design = scenes.get(name)
    played = design.with_plant(finer(design.plant))
    bends = [b.name for b in design.plant.bodies if b.beam is not None]
    for before, after in zip(design.plant.bodies, played.plant.bodies, strict=True):
        assert after.modes == (tuple(n + (n > 0) for n in before.modes) if before.name in bends else before.modes)
    assert {s.name for s in design.plant.states} < {s.name for s in played.plant.states}
    assert played.plant.nx > design.plant.nx
    assert differing_states(design, played) == ()


def test_a_tree_that_bends_further_than_shortening_bears_has_exact_rotations():
    """LQR moves the three links as on the design plant only where they have exact rotations, not with shortening."""
    design = scenes.get("three-link-flexible")
    plant, remark = finer_plant(design)
    assert plant.kinematics == "strain" and remark and plant.nx == finer(design.plant).nx
    law, cost = regulator(design), design.cost(run(design, regulator(design)))
    played = design.with_plant(plant)
    assert played.cost(run(played, law)) == pytest.approx(cost, rel=0.02)
    with pytest.raises((MassMatrixError, IntegrationError)):  # the latter of CVODES, which ends in ever shorter steps
        run(design.with_plant(finer(design.plant)), law)
    crane = scenes.get("crane-swing")
    assert finer_plant(crane) == (finer(crane.plant), "")


def test_a_tree_without_beams_is_the_finest_that_there_is():
    with pytest.raises(ValueError, match="the finest that there is"):
        finer(scenes.get("flexible-joint-slew").plant)


def test_plant_without_more_modes_goes_up_its_ladder_to_the_end():
    plant = scenes.get("spacecraft-slew").plant
    whole = dataclasses.replace(plant, appendages=tuple(dataclasses.replace(a, modes=None) for a in plant.appendages))
    assert whole.kinematics == "linear" and finer(whole).kinematics == "stiffened"
    assert finer(whole).nx == whole.nx
    with pytest.raises(ValueError, match="the finest that there is"):
        finer(finer(whole))


def test_other_shapes_under_the_same_names_are_noticed():
    """Polynomial shapes have other tip values than modes, so that eta1 is another quantity."""
    played = SLEW.with_plant(dataclasses.replace(SLEW.plant, basis="polynomial", modes=3))
    assert set(differing_states(SLEW, played)) >= {"eta1", "eta2"}
    with pytest.raises(ValueError, match=r"it reads eta1, which in .* is another shape's coordinate"):
        require_signals(("hub_angle", "eta1"), SLEW, played)
    with pytest.raises(ValueError, match=r"it reads eta9, which .* does not have"):
        require_signals(("hub_angle", "eta9"), SLEW, played)
    require_signals(("hub_angle", "tip_deflection"), SLEW, played)


def test_payload_stiffness_and_damping_vary_by_thirty_per_cent():
    wanted = ("payload.mass", "link1.E", "link1.damping", "link2.E", "link2.damping")
    assert {path: (low, high) for path, low, high in varied_ranges(REACH)} == dict.fromkeys(wanted, (0.7, 1.3))
    craft = {path: (low, high) for path, low, high in varied_ranges(scenes.get("spacecraft-slew"))}
    assert craft["appendages.1.stiffness_factor"] == craft["appendages.0.damping"] == (0.7, 1.3)
    assert craft["hub.inertia.2.2"] == (0.8, 1.2)  # the scene's own


def test_steps_keep_below_the_limit_for_the_stiffest_link_and_the_lightest_payload():
    played = play(dataclasses.replace(REACH, substeps=1), finer(REACH.plant))
    plant, (x, u) = played.varied_plant, played.target
    p = plant.nominal_parameters * [0.7, 1.3, 0.7, 1.3, 0.7]
    assert played.dt / played.substeps < 0.75 * step_limit(plant, x, "rk4", u=u, p=p)


def test_too_coarse_steps_are_refined_until_the_outputs_agree():
    drop = scenes.get("cantilever-drop")
    coarse = dataclasses.replace(play(drop), substeps=1, tolerance=1e-5)
    assert step_error(coarse) > 0.1 * coarse.tolerance
    fine, error = accurate(coarse)
    assert fine.substeps > 1 and error == step_error(fine) <= 0.1 * coarse.tolerance
    motion = drop.plant.simulate(drop.initial[0], None, drop.times, rtol=1e-11, atol=1e-13)  # DOP853, an order-8 method
    step, x = fine.varied_plant.stepper(fine.dt, substeps=fine.substeps), drop.initial[0][None]
    for _ in range(fine.steps):
        x = step(x, np.zeros(2))
    assert np.abs(x[0] - motion.x[-1]).max() < 1e-5


def test_signal_ranges_are_those_of_the_open_loop_motion():
    ranges = signal_ranges(play(SLEW))
    motion = SLEW.plant.simulate(
        SLEW.initial[0], np.array([SLEW.nominal_input(t) for t in SLEW.times]), SLEW.times, rtol=1e-9, atol=1e-11
    )
    known = [s.name for s in SLEW.signals]
    for name in ("hub_angle", "tip_deflection", "tip_deflection_rate"):
        assert ranges[known.index(name)] == pytest.approx(np.ptp(motion[name]), rel=1e-4)
