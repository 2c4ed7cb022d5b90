"""An arm whose motion takes windows of time, found once."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.fine_model import compared, start_of
from pliant.studies.physics.motion_nodes import MotionNodes
from pliant.studies.physics.node_search import from_simple
from pliant.studies.physics.time_windows import window_by_window

WITHIN = 1e-6  # [m]


@pytest.fixture(scope="session")
def falling() -> Any:
    """Two soft links without friction that fall from where springs and torques held them: (motions, nodes, from the
    rigid arm, window by window).
    """
    own = scenes.get("two-link-reach")
    links = {
        name: dataclasses.replace(link, E=0.3 * link.E, damping=0.0)
        for name, link in (("link1", own.plant.link1), ("link2", own.plant.link2))
    }
    arm = dataclasses.replace(own.plant, gravity=9.81, joint_friction=(0.0, 0.0), **links)
    at = {"start": (("theta1", 2.0), ("theta2", 0.5)), "duration": 1.5, "move_time": 1.0, "dt": 0.015}
    scene = dataclasses.replace(own.with_plant(arm), **at)
    motions, fine = Motions(scene, np.zeros((len(scene.times), 2))), arm.physics()
    nodes, start = MotionNodes(scene.times, motions.held, 2), start_of(motions, fine)
    found = window_by_window(fine, arm.ladder()[0], nodes, start, compared(motions, fine), WITHIN)
    return motions, nodes, from_simple(motions, fine, nodes), found
