"""Loops as functions of parameters: sampled ones exact, late inputs by an approximation of stated error."""

import numpy as np
import pytest

from pliant.controllers import LQG, LQR
from pliant.controllers.analysis.linear_laws import LinearLaw, law_of
from pliant.controllers.analysis.loops import closed_loop
from pliant.controllers.robust_analysis.loop_over_box import _late, loop_over_box
from pliant.controllers.robust_analysis.robust_stability import robust_stability
from pliant.envs import scenes

NONE = np.zeros(1)


@pytest.fixture(scope="module")
def slew():
    scene = scenes.get("single-link-slew")
    return scene, LQR.for_scene(scene)


def test_a_sampled_loop_is_what_python_sampling_makes_of_it(slew):
    scene, law = slew
    loop = loop_over_box(scene.plant, law, ("payload.mass",), np.array([1.0]), np.array([0.3]), dict(scene.goal))
    rest = scene.plant.equilibrium(dict(scene.goal))
    truth = closed_loop(scene.plant.linearize(*rest), law)
    assert loop.dt == law.dt
    assert np.sort(np.abs(np.linalg.eigvals(loop.state_matrix(NONE)))) == pytest.approx(
        np.sort(np.abs(np.linalg.eigvals(truth))), rel=1e-9
    )


def test_a_delay_of_a_sampled_law_at_its_ends(slew):
    """No delay, and a whole period: an input more in the register, as a plant read one period late."""
    scene, law = slew
    form = law_of(law)
    loop = loop_over_box(scene.plant, law, ("delay",), np.array([law.dt / 2]), np.array([law.dt / 2]), dict(scene.goal))
    model = scene.plant.linearize(*scene.plant.equilibrium(dict(scene.goal)))
    for side, delay in ((-1.0, 0), (1.0, 1)):
        late = LinearLaw(form.A, form.B, form.C, form.D, form.reads, form.dt, delay)
        ours, theirs = (
            np.abs(np.linalg.eigvals(A)) for A in (loop.state_matrix(np.array([side])), closed_loop(model, late))
        )
        assert ours.max() == pytest.approx(theirs.max(), rel=1e-9)


def test_the_approximation_of_a_delay_is_as_far_off_as_is_said():
    """Of e^(-j w tau): all-pass, 1e-5 off at w tau = 1 and 1.3e-3 at 2, by the one response to the other."""
    tau = 0.1
    A, B, C, D = _late(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.ones((1, 1)), tau)
    for turn, off in ((1.0, 1.05e-5), (2.0, 1.35e-3)):
        s = 1j * turn / tau
        response = (C @ np.linalg.solve(s * np.eye(len(A)) - A, B) + D)[0, 0]
        assert abs(response) == pytest.approx(1.0, rel=1e-12)
        assert 0.5 * off < abs(response - np.exp(-1j * turn)) < off


def test_the_shipped_law_of_two_links_is_judged_as_sampled():
    """As a continuous one it is unstable; between samples it never acts so."""
    scene = scenes.get("two-link-reach")
    law = LQR.for_scene(scene)
    loop = loop_over_box(scene.plant, law, ("payload.mass",), np.array([0.5]), np.array([0.15]), dict(scene.goal))
    assert np.abs(np.linalg.eigvals(loop.state_matrix(NONE))).max() < 1
    form = law_of(law)
    as_continuous = LinearLaw(form.A, form.B, form.C, form.D, form.reads, None)
    assert (
        np.linalg.eigvals(
            loop_over_box(
                scene.plant, as_continuous, ("payload.mass",), np.array([0.5]), np.array([0.15]), dict(scene.goal)
            ).state_matrix(NONE)
        ).real.max()
        > 0
    )


def test_what_is_no_delay(slew):
    scene, law = slew
    for box in ({"delay": (-0.01, 0.01)}, {"delay": (0.01, 0.03)}):
        with pytest.raises(ValueError, match="within one period"):
            robust_stability(scene.plant, law, box, dict(scene.goal))


def test_a_craft_whose_model_tells_its_quaternion_by_three():
    scene = scenes.get("spacecraft-slew")
    law, own = LQG.for_scene(scene), scene.plant.hub.inertia[2][2]
    loop = loop_over_box(
        scene.plant, law, ("hub.inertia.2.2",), np.array([own]), np.array([0.2 * own]), dict(scene.goal)
    )
    truth = closed_loop(scene.plant.linearize(*scene.plant.equilibrium(dict(scene.goal))), law)
    found, known = (np.sort(np.abs(np.linalg.eigvals(A))) for A in (loop.state_matrix(NONE), truth))
    assert found[-len(known) :] == pytest.approx(known[-len(found) :], rel=1e-9)
    assert found.max() < np.abs(np.linalg.eigvals(loop.state_matrix(-4.9 * np.ones(1)))).max()  # nearly no inertia
