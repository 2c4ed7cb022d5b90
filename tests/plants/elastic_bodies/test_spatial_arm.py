"""A spatial arm of two flexible links, its axes not parallel, against Exudyn's kinematic tree of rigid segments."""

import json
from pathlib import Path

import numpy as np
import pytest
import spatial_arm as arm
from evidence import agrees

REFERENCE = Path(__file__).resolve().parents[2] / "reference" / "spatial_arm.json"


def test_moves_as_exudyns():
    """Over 1 s, both links' ends: within 1e-3 of the largest deflection, which is a tenth of a link's length. Exudyn's
    own error is the second order of its segments' length, extrapolated; tests/campaigns/spatial_arm_exudyn.py makes the
    file.
    """
    told = json.loads(REFERENCE.read_text())
    t, ends, deflection = arm.played((3, 3, 2, 0), rtol=1e-5)
    np.testing.assert_allclose(told["t"], t)
    assert deflection > 0.1
    assert told["known_to"] < 5e-4 * deflection
    off = list(told["springs"].values())  # with 4, 8 and 16 springs a link
    assert off[0] == pytest.approx(4 * off[1], rel=0.1) and off[1] == pytest.approx(4 * off[2], rel=0.1)
    for name, positions in ends.items():
        assert np.ptp(told[name], axis=0).max() > 0.5
        about = {"of": "FlexibleTree", "source": "Exudyn 1.13.6, ObjectKinematicTree", "kind": "other program"}
        what = f"{name} of a spatial arm of two flexible links over 1 s [m]"
        agrees(positions, told[name], within=1e-3 * deflection, what=what, absolute=True, **about)
