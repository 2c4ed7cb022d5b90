"""Frequencies and roots against the reference file."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from pliant.plants import MassMatrixError
from pliant.plants.spacecraft.environment import Environment, Orbit
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

REFERENCE = json.loads((Path(__file__).parents[2] / "reference" / "spacecraft.json").read_text())
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def nearest(found, wanted):
    """Largest distance of a wanted root from the found ones."""
    return max(np.abs(found - complex(*root)).min() for root in wanted)


def test_free_frequencies(hinged):
    np.testing.assert_allclose(CRAFT.natural_frequencies(), REFERENCE["free_frequencies_rad_s"], rtol=1e-9)
    wanted = REFERENCE["hinge_stiffness_modulated"]["hinge_frequencies_rad_s"]
    np.testing.assert_allclose(hinged().natural_frequencies(), wanted, rtol=1e-9)
    roots = np.sort(np.abs(hinged().linearize(hinged().state()).eigenvalues))
    np.testing.assert_allclose(roots[roots > 0.1][::2], wanted, rtol=1e-3)  # damped a little


@pytest.mark.parametrize("axis", "xy")
def test_frozen_roots_in_spin(axis):
    model = CRAFT.linearize(CRAFT.state({f"rate_{axis}": 0.1}))
    assert nearest(model.eigenvalues, REFERENCE["spin_0.1_rad_s"][axis]) < 1e-8
    apart = [z for z in model.eigenvalues if abs(z) > 1e-5]
    wanted = np.array([complex(*z) for z in REFERENCE["spin_0.1_rad_s"][axis]])
    wanted = np.concatenate([wanted, wanted.conj()])
    assert max(np.abs(wanted - z).min() for z in apart) < 1e-7


def test_gravity_gradient_frequencies():
    """Roll = y, pitch = z, yaw = x: body axes (x, y, z) along the orbit axes (z, x, y)."""
    craft = dataclasses.replace(CRAFT, environment=Environment(orbit=Orbit(rate=1e-3)))
    x = craft.state(quaternion_0=0.5, quaternion_1=-0.5, quaternion_2=-0.5, quaternion_3=-0.5)
    R = craft.turn(x)
    np.testing.assert_allclose(R, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
    x[craft.layout.omega] = R.T @ [0.0, -1e-3, 0.0]
    assert np.abs(craft.dynamics(x)).max() < 1e-8  # centrifugal forces and tidal tension stretch nothing to first order
    ratios = np.abs(craft.linearize(x).eigenvalues.imag) / 1e-3
    for wanted in REFERENCE["gravity_gradient"]["frequencies_over_orbital_rate"]:
        assert np.abs(ratios - wanted).min() < 1e-5
    assert craft.linearize(x).eigenvalues.real.max() < 1e-7


@pytest.mark.parametrize("axes", [((1.0, 0.0, 0.0),), ((0.0, 1.0, 0.0), (0.0, 1.0, 0.0))], ids=["slender", "parallel"])
def test_a_hinge_that_turns_nothing_has_no_frequency(hinged, axes):
    craft = hinged(axes=axes)
    for call in (craft.natural_frequencies, lambda: craft.linearize(craft.state())):
        with pytest.raises(
            MassMatrixError, match="no inertia about one of its hinge's axes, or two of these are paral"
        ):
            call()
