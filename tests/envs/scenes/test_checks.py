"""What a scene's fields must be."""

import dataclasses
import re

import numpy as np
import pytest

from pliant.envs import scenes


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"limits": (40.0,)}, "limits"),
        ({"limits": (0.0, 1.0)}, "limits"),
        ({"substeps": 0}, "substeps"),
        ({"dt": -0.1}, "dt"),
        ({"duration": 0.001}, "duration"),
        ({"bounds": (("theta1_rate", 0.0),)}, "bounds theta1_rate = 0.0"),
        ({"bounds": (("theta9", 1.0),)}, "theta9"),
        ({"weights": (("theta1", -1.0),)}, "weights theta1 = -1.0"),
        ({"start": (("theta1", np.nan),)}, "start theta1 = nan"),
        ({"effort": (("tau1", 0.0),)}, "effort tau1"),
        ({"observe": ("tip_z",)}, "tip_z"),
        ({"randomise": (("payload.colour", 0.5, 2.0),)}, "colour"),
        ({"randomise": (("payload.mass", 2.0, 0.5),)}, "payload.mass"),
        ({"start_spread": -0.1}, "start_spread"),
        ({"spreads": (("theta1", -0.1),)}, "spreads theta1 = -0.1"),
        ({"goal_rates": (("tip_x", 0.1),)}, "tip_x"),
        ({"nominal_start": (("theta9", 0.1),)}, "theta9"),
        ({"colour": 3}, "colour"),
    ],
)
def test_bad_fields_are_named(changes: dict, says: str) -> None:
    with pytest.raises(ValueError, match=re.escape(says)):
        scenes.get("two-link-reach", **changes)


def test_every_rung_of_the_ladder_must_have_the_names():
    """The elastic states are on no rigid rung: the nominal motion of a goal that names one would be wrong unseen."""
    scene = scenes.get("single-link-slew")
    assert "eta1" in {s.name for s in scene.plant.states}
    assert dataclasses.replace(scene, observe=("eta1",)).observe == ("eta1",)  # of the own plant alone
    for field in ({"goal": (("eta1", 0.1),)}, {"weights": (("eta1", 1.0),)}):
        with pytest.raises(ValueError, match=r"'eta1' is no signal of 'rigid' on the ladder of SingleLinkArm, must be"):
            dataclasses.replace(scene, **field)
