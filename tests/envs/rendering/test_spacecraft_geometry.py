"""Hub and panels in space, by hand."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.rendering.spacecraft_geometry import box_of, exaggeration, reach_of, scenery
from pliant.plants.core.quaternions import matrix_of


def test_scenery_by_hand():
    """The textbook hub's box: 6 (I_y + I_z - I_x) / m and so on; panels from 1 m to 7 m, 2 m wide, bent as drawn."""
    scene = scenes.get("spacecraft-slew")
    craft = scene.plant
    np.testing.assert_allclose(box_of(craft) ** 2, np.array([130.0, 230.0, 170.0]) * 6 / 500, rtol=1e-12)
    assert reach_of(craft) == pytest.approx(np.hypot(7.0, 1.0), rel=1e-12)
    x = craft.state(eta1_1=0.01)
    at = craft.layout.quaternion
    x[at] = scene.initial[0][at]
    for factor in (1.0, 20.0):
        seen, true = scenery(craft, x, factor), scenery(craft, x, factor, from_hub=True)
        np.testing.assert_allclose(true.sheets[0] @ matrix_of(x[at]).T, seen.sheets[0], atol=1e-12)
        tip = true.sheets[0][-1].mean(axis=0)  # the first panel's z is the hub's -y
        np.testing.assert_allclose(tip, [7.0, -2 * 0.01 * factor, 0.0], atol=1e-6)
        assert np.linalg.norm(true.sheets[0][-1, 1] - true.sheets[0][-1, 0]) == pytest.approx(2.0)
    assert exaggeration(scene) == 20
