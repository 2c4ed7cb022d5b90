"""Ladder, physics, embedding and ranges of beams of strains."""

import dataclasses

import numpy as np
import pytest
from large_beam_cases import BEAM
from strained_cases import ALL, STRAINED, strained

from pliant.plants.core.errors import ValidityWarning


@pytest.mark.parametrize("name", ["free", "clamped", "hinged"])
def test_ladder_shares_names_and_goes_from_cheap_to_dear(name):
    plant = STRAINED[name]
    steps = plant.ladder()
    assert len({step.label for step in steps}) == len(steps) == 10
    assert all(step.outputs == plant.outputs and step.inputs == plant.inputs for step in steps)
    assert all(step.strained or not plant.extensible or not step.extensible for step in steps)
    sizes = [step.nx for step in steps[:4]], [step.nx for step in steps[4:]]
    assert all(found == sorted(found) for found in sizes)


def test_which_effects_of_physics_a_beam_has_and_what_physics_leaves_out():
    assert BEAM.unmodelled == STRAINED["free"].unmodelled == ("bending out of the plane", "torsion", "plasticity")
    assert STRAINED["space"].unmodelled == ("plasticity",)
    assert BEAM.effects == {"extension": False, "shear": False}
    assert STRAINED["moving"].effects == {"extension": True, "shear": False}
    assert BEAM.physics().effects == {"extension": True, "shear": True}
    assert BEAM.physics().without("shear").without("extension").theory == "euler-bernoulli"


def test_physics_has_all_strains_and_more_shapes():
    plant = STRAINED["free"].physics(2)
    assert (plant.modes, plant.stretches, plant.shears) == (7, 3, 3) and plant.extensible
    assert plant.theory == "timoshenko"


@pytest.mark.parametrize(
    ("plant", "simpler"),
    [
        (STRAINED["free"], {"modes": 1, "stretches": 1, "shears": 1}),
        (STRAINED["free"], {"modes": 1, "extensible": False, "theory": "euler-bernoulli"}),
        (STRAINED["moving"], {"modes": 1, "stretches": 1}),
        (strained(extensible=True, modes=3, basis="polynomial"), {"extensible": False, "modes": 2}),
        (strained(planar=False, segments=2, points=9, extensible=True), {"modes": 1, "twists": 1, "extensible": False}),
        (strained(planar=False, twists=3, points=20, **ALL), {"modes": 1, "twists": 1, "shears": 1}),
    ],
)
def test_a_simpler_beam_stands_in_a_richer_one_where_it_stood(plant, simpler):
    """Shapes of `basis` auto are not nested: to 2 % of the length; polynomials are, but for quadrature."""
    cheap = dataclasses.replace(plant, **simpler)
    x = np.zeros(cheap.nx)
    x[: cheap.nx // 2] = [0.01 if s.unit == "1" else 0.3 for s in cheap.coordinates]
    at = np.linspace(0, 1, 5)
    exact = plant.rotation_basis == "polynomial"
    moved = plant.embedding(cheap) @ x
    np.testing.assert_allclose(plant.positions(moved, at), cheap.positions(x, at), atol=1e-4 if exact else 0.04)


def test_ranges_name_what_holds_beyond():
    """A soft bar in its axis: inextensible it is told to have extension, extensible it is bounded by Hooke's law."""
    bar = strained(gravity=(0.0, 0.0, 0.0), rotary=0.0)
    F = 0.02 * bar.beam.E * bar.beam.area
    with pytest.warns(ValidityWarning, match=r"axial strain of the beam 0.02 .* beyond holds: .* extensible=True"):
        bar.simulate(np.zeros(bar.nx), [F, 0.0], [0.0, 1e-5])
    sheared = 0.015 * bar.beam.shear_stiffness
    with pytest.warns(ValidityWarning, match=r'shear strain of the beam 0.015 .* theory="timoshenko"'):
        bar.simulate(np.zeros(bar.nx), [0.0, sheared], [0.0, 1e-5])
    long = dataclasses.replace(bar, extensible=True)
    x = long.equilibrium(tip_force_x=F)[0]
    assert [r.quantity for r in long.validity] == ["strain of the beam's fibres", "shear strain of the beam"]
    with pytest.warns(ValidityWarning, match=r"strain of the beam's fibres 0.02 "):
        long.simulate(x, [F, 0.0], [0.0, 1e-5])


@pytest.mark.parametrize("name", STRAINED)
def test_every_range_is_a_finite_number_that_rest_keeps(name):
    plant = dataclasses.replace(STRAINED[name], gravity=(0.0, 0.0, 0.0))
    values = plant._reached(0.0, np.zeros(plant.nx), np.zeros(plant.nu), np.zeros(plant.nw), [], np.zeros(plant.ny))[0]
    np.testing.assert_allclose(values, 0, atol=1e-12)
