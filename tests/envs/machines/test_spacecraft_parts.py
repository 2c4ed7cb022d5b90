"""The panels of the spacecraft scenes, by hand."""

import numpy as np
import pytest

from pliant.envs.machines.spacecraft_parts import ALONG_Y, FLAT, LINE, UPRIGHT, panels, turned


@pytest.mark.parametrize("mounts", [FLAT, UPRIGHT, ALONG_Y])
def test_two_panels_of_12_kg_on_opposite_sides(mounts) -> None:
    left, right = panels(mounts)
    for panel, mount in zip((left, right), mounts):
        assert panel.data.mass == pytest.approx(12.0)  # two lines of 6 m x 1e-3 m^2 x 1000 kg/m^3
        np.testing.assert_allclose(np.array(mount) @ np.array(mount).T, np.eye(3), atol=1e-15)
        assert np.linalg.det(mount) == pytest.approx(1.0)
    np.testing.assert_allclose(np.array(left.position), -np.array(right.position), atol=1e-15)
    assert np.linalg.norm(left.position) == pytest.approx(1.0)


def test_first_bending_frequency_is_0_15_hz() -> None:
    """A clamped-free beam: 1.8751^2 sqrt(E I / m) / L^2 (Blevins, Formulas for Natural Frequency, Table 8-1)."""
    omega = 1.8751**2 * np.sqrt(LINE.E * LINE.I_y / (LINE.density * LINE.area)) / LINE.length**2
    assert omega / (2 * np.pi) == pytest.approx(0.15, rel=1e-2)


def test_turned_is_the_quaternion_of_half_the_angle() -> None:
    assert dict(turned(90.0, "y")) == pytest.approx(
        {"quaternion_0": 0.5**0.5, "quaternion_1": 0.0, "quaternion_2": 0.5**0.5, "quaternion_3": 0.0}
    )
