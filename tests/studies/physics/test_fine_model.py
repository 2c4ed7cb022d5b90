"""What Newton's method asks of a fine model, against the model itself."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import MassMatrixError
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics import fine_model
from pliant.studies.physics.motion_nodes import MotionNodes

PHYSICS = {
    name: scenes.get(name).plant.physics()
    for name in ("two-link-reach", "spin-up", "cantilever-drop", "slider-crank-run", "spacecraft-slew")
}
PHYSICS["satellite-arm"] = scenes.get("satellite-arm").plant  # quaternions: more coordinates than speeds
RNG = np.random.default_rng(0)


def points(plant, count=3):
    x = np.tile(plant.rest_state, (count, 1)) + RNG.uniform(-1e-3, 1e-3, (count, plant.nx))
    return np.arange(float(count)), x, RNG.uniform(-1.0, 1.0, (count, plant.nu))


@pytest.mark.parametrize("name", PHYSICS)
def test_a_motion_at_the_models_own_rates_lacks_nothing_and_at_others_what_they_are_off(name):
    """To rounding of the forces: an axial stiffness makes them 1e6 times those that bend."""
    plant = PHYSICS[name]
    t, x, u = points(plant)
    rate = plant.dynamics(x, u, t=t)
    M = fine_model.masses(plant, t, x, u)
    inverse = None if M is None else np.linalg.inv(M)
    off = RNG.uniform(-1.0, 1.0, rate.shape)
    size = np.abs(rate).max()
    assert np.abs(fine_model.lacking(plant, t, x, u, rate, inverse)).max() <= 1e-7 * size
    np.testing.assert_allclose(fine_model.lacking(plant, t, x, u, rate + off, inverse), -off, atol=1e-7 * size)


@pytest.mark.parametrize("name", PHYSICS)
def test_outputs_and_rates_are_the_models_own(name):
    """Also where an output tells an acceleration."""
    plant = PHYSICS[name]
    t, x, u = points(plant)
    y = plant.measure(x, u, t=t)
    np.testing.assert_allclose(fine_model.outputs(plant, t, x, u, range(plant.ny)), y, atol=1e-7 * np.abs(y).max())
    found = fine_model.trajectory(plant, t, x, u)
    rate = plant.dynamics(x, u, t=t)
    np.testing.assert_allclose(found.dx, rate, atol=1e-7 * np.abs(rate).max())
    np.testing.assert_allclose(found.y, y, atol=1e-7 * np.abs(y).max())


def test_a_mass_matrix_that_is_not_definite_is_told():
    """A link of second-order shortening that is bent by far too much."""
    arm = dataclasses.replace(scenes.get("two-link-reach").plant, kinematics="stiffened", modes=(2, 2))
    t, x, u = points(arm)
    x[1, 2:6] = 3.0
    with pytest.raises(MassMatrixError):
        arm.dynamics(x, u)
    with pytest.raises(MassMatrixError):
        fine_model.masses(arm, t, x, u)


def test_a_motion_between_control_times_is_what_is_simulated_there():
    """Against dop853 at all nodes; where a step is too long for the modes there is none."""
    scene = scenes.get("two-link-reach", duration=0.2)
    motions = Motions(scene)
    nodes = MotionNodes(scene.times, motions.held, 2)
    rigid, elastic = motions.ladder[0], dataclasses.replace(scene.plant, modes=(4, 4))
    found = fine_model.between_control_times(rigid, motions.run(rigid, rtol=1e-9, atol=1e-11), nodes)
    known = motions.at_nodes(rigid, nodes.inputs, nodes.all, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.x, known.x, atol=1e-7)
    np.testing.assert_allclose(found.dx, known.dx, atol=1e-4)
    assert fine_model.between_control_times(elastic, motions.run(elastic), nodes) is None
