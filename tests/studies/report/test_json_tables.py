"""Tables for programs."""

import numpy as np

from pliant.envs import scenes
from pliant.studies.report.json_tables import linear_table, motion_table, scene_table

SLEW = scenes.get("single-link-slew", duration=0.2, move_time=0.1)


def test_scene_and_motion():
    assert scene_table(SLEW)["states"] == 6 and scene_table(SLEW)["limits"] == (40.0,)
    motion = SLEW.open_loop(rtol=1e-6, atol=1e-8)
    found = motion_table(SLEW, motion)
    assert found["cost"] == SLEW.cost(motion) and found["units"]["hub_torque"] == "N m"
    assert set(found["signals"]) == set(found["units"]) and len(found["signals"]["tip_x"]) == 11


def test_linear_model_with_names_and_matrices():
    model = SLEW.plant.linearize(*SLEW.target)
    found = linear_table(model)
    assert found["states"][0] == "hub_angle" and found["A"] is model.A
    assert np.shape(found["C"]) == (len(found["outputs"]), len(found["states"]))
