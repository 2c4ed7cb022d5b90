"""`choose` on machines that are trees: against an arm of exact rotations, and where no model of a tree holds."""

import numpy as np
import pytest

from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleTree, Joint, MassMatrixError, SingleLinkArm, TreeBody, beams
from pliant.plants.beams.payload import Payload
from pliant.studies import choose
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity import climb

LOAD = Payload(mass=0.3, inertia=0.001)
STRIP = beams.Beam.rectangular(0.7, width=0.04, depth=0.006, material=beams.ALUMINIUM)


def scene(links, time, tolerance):
    bodies = [TreeBody(name=f"b{k}", joint=Joint(name=f"j{k}"), beam=STRIP, modes=(2, 0, 0, 0)) for k in range(links)]
    tree = FlexibleTree.serial(bodies, payload=LOAD, gravity=(0.0, 0.0, 0.0))
    start, goal = (tuple((f"j{k}", angle) for k in range(links)) for angle in (0.0, 0.6))
    times = {"move_time": time, "duration": 1.3 * time, "dt": 0.01}
    own = {"compare": ("tip_x", "tip_y"), "tolerance": tolerance, "limits": (50.0,) * links}
    return Scene(name="tree", about="joints turn", plant=tree, start=start, goal=goal, **times, **own)


@pytest.mark.filterwarnings("ignore")
def test_a_tree_of_one_link_is_chosen_for_its_error_from_an_arm_of_exact_rotations():
    """The arm is of other equations, with shear; the same torques."""
    slew = scene(1, 1.0, 1e-3)
    found = choose(slew)
    arm = SingleLinkArm(
        link=STRIP, hub_inertia=0.0, payload=LOAD, kinematics="strain", theory="timoshenko", basis="polynomial", modes=5
    )
    motions = Motions(slew)
    true = arm.simulate(np.zeros(arm.nx), motions.held, slew.times, rtol=1e-8, atol=1e-10)
    own = motions.outputs(found.plant, 1e-8)
    error = np.abs(own - np.column_stack([true["tip_x"], true["tip_y"]])).max()
    chosen = next(r for r in found.rungs if r.chosen)
    assert found.met and error <= chosen.bound <= 1e-3 and error == pytest.approx(chosen.error, rel=0.25)


@pytest.mark.filterwarnings("ignore")
def test_a_tree_whose_physics_is_not_had_ends_in_rows_with_the_reason(monkeypatch):
    def lost(motions, tolerance):
        raise MassMatrixError("the mass matrix is lost", np.zeros(4), -1.0)

    monkeypatch.setattr(climb, "physics_motion", lost)
    found = choose(scene(2, 0.35, 1e-3))
    assert not found.met and "mass matrix" in found.missing[0]
    assert not any(r.chosen for r in found.rungs) and found.to_json()["chosen"] is None
    assert found.text.count("the mass matrix is lost") == 1 and "No variant is chosen" in found.text
    assert all(r.error == np.inf and "physics" in r.note for r in found.rungs)
