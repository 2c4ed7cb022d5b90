"""The motion of a fine model with a law in the loop."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQG, PD, Feedback
from pliant.envs import scenes
from pliant.studies.common.reference_motions import ClosedMotions, Sampled
from pliant.studies.physics.closed_motion import ClosedMotion, linear_form
from pliant.studies.physics.motion_nodes import MotionNodes
from pliant.studies.physics.node_search import Search, from_simple
from pliant.studies.physics.quasi_linear import NotSettled

OWN = scenes.get("single-link-slew")
STANDING = dataclasses.replace(
    OWN.with_plant(dataclasses.replace(OWN.plant, gravity=9.81, kinematics="linear", modes=1)),
    start=(("hub_angle", np.pi / 2 - 0.1),),
    goal=(("hub_angle", np.pi / 2 + 0.1),),
    move_time=0.6,
    duration=1.0,
)


class Clipped:
    """A law without a linear form: a PD's, the torque through a smooth limit."""

    dt, reads = None, ("hub_angle", "hub_angle_rate")

    def __init__(self, law):
        self.law = law

    def reset(self):
        self.law.reset()

    def act(self, t, y):
        return 60.0 * np.tanh(self.law.act(t, y) / 60.0)


@pytest.fixture(scope="module", params=["PD", "LQG", "no linear form"])
def closed(request):
    laws = {"PD": PD.for_scene, "LQG": LQG.for_scene, "no linear form": lambda s: Clipped(PD.for_scene(s))}
    return ClosedMotions(STANDING, laws[request.param](STANDING), "law")


def test_it_settles_on_the_simulated_closed_loop(closed):
    """The law on the fine model, by dop853: another method. Eight parts of a period."""
    fine = dataclasses.replace(STANDING.plant, kinematics="strain", modes=3)
    nodes = MotionNodes(STANDING.times, closed.held, 8)
    found = from_simple(closed, fine, nodes)
    assert isinstance(found, ClosedMotion)
    before = found.outputs.copy()
    found.settle(1e-8)
    true = closed.run(fine, rtol=1e-9, atol=1e-11)
    error = np.abs(found.outputs - closed.compared(true)).max()
    assert error < 5e-6 and error < 0.05 * np.abs(before - closed.compared(true)).max()
    np.testing.assert_allclose(found.nodes.held[:-1], true.u[:-1], atol=1e-3 * np.abs(true.u).max())


def test_physics_is_known_in_the_loop():
    closed = ClosedMotions(STANDING, PD.for_scene(STANDING), "law")
    known, motion = Search(closed, 1e-4).corrected()
    assert isinstance(motion, ClosedMotion) and known.uncertainty < 5e-5
    richer = closed.outputs(known.physics, 1e-7, method="cvodes")
    assert np.abs(known.outputs - richer).max() <= known.uncertainty + 1e-6


def test_late_readings_are_not_corrected():
    law = Feedback(np.array([[100.0, 20.0]]), ("hub_angle", "hub_angle_rate"))
    assert linear_form(Sampled(law, 0.02), np.zeros(2)).D.tolist() == [[100.0, 20.0]]
    late = LQG.for_scene(STANDING)
    form = linear_form(Sampled(late, 0.02), np.zeros(len(late.reads)))
    assert len(form.A) and form.delay == 0
    with pytest.raises(NotSettled, match="late"):
        linear_form(Sampled(Given(dataclasses.replace(form, delay=1)), 0.02), np.zeros(len(late.reads)))


class Given:
    """A law that tells its own linear form."""

    dt = 0.02

    def __init__(self, form):
        self.linear_form, self.reads = form, form.reads
