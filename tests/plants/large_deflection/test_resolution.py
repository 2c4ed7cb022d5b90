"""Quadrature points: as many as every kind of shape takes, and a refusal of too few."""

import dataclasses

import numpy as np
import pytest
from large_beam_cases import large

from pliant.plants import LargeDeflectionBeam, Payload
from pliant.plants.beams import STEEL, Beam
from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.large_deflection.resolution import Resolved, enough

ROD = Beam.circular(1.0, 0.01, STEEL)


def rod(**changes):
    return LargeDeflectionBeam(beam=ROD, planar=False, gravity=(0.0, 0.0, 0.0), **changes)


def twisting(plant):
    locked = tuple(c.name for c in plant.coordinates if not c.name.startswith("twist"))
    return plant.natural_frequencies(locked=locked)


def test_error_is_the_gauss_rules_own():
    """m points of Gauss integrate xi^(2 m - 1) exactly and not xi^(2 m)."""
    for power, exact in ((2, True), (3, False)):
        kind = Resolved("xi", lambda xi, power=power: xi[:, None] ** power, False, 1e-12)
        assert (kind.error(points(3)) < 1e-13) == exact
    assert enough([kind], 1) == 4


@pytest.mark.parametrize(("modes", "twists"), [(1, 2), (1, 6)])
def test_default_resolves_the_twists_whatever_the_modes(modes, twists):
    """(k + 1/2) pi sqrt(G J/(rho I_p))/L."""
    exact = (np.arange(twists) + 0.5) * np.pi * np.sqrt(ROD.GJ / (ROD.density * ROD.polar_moment)) / ROD.length
    np.testing.assert_allclose(twisting(rod(modes=modes, twists=twists)), exact, rtol=1e-6)


@pytest.mark.parametrize(("modes", "twists"), [(2, 12), (4, 9), (1, 3)])
def test_twists_are_orthogonal_under_the_default_rule(modes, twists):
    at = rod(modes=modes, twists=twists).fields.tangents.points
    psi = np.sin(np.multiply.outer(at.xi, (np.arange(twists) + 0.5) * np.pi))
    np.testing.assert_allclose(psi.T @ (at.weight[:, None] * psi), np.eye(twists) / 2, atol=5e-7)


@pytest.mark.parametrize("twists", [2, 6, 12])
def test_a_chain_resolves_the_twists_of_one_mode(twists):
    """int psi'^2 of xi is 1, of sin(k pi xi) it is (k pi)^2/2."""
    sections = rod(modes=1, twists=twists, kinematics="substructured").fields.sections
    exact = np.append(1.0, (np.pi * np.arange(1, twists)) ** 2 / 2)
    np.testing.assert_allclose(sections._integrals[0][2], np.diag(exact), atol=1e-11 * exact[-1])


@pytest.mark.parametrize("modes", [3, 5])
def test_default_of_a_chain_resolves_its_modes(modes):
    chain = large(kinematics="substructured", modes=modes, gravity=(0.0, 0.0, 0.0))
    finer = dataclasses.replace(chain, points=40).natural_frequencies()
    np.testing.assert_allclose(chain.natural_frequencies(), finer, rtol=1e-6)


@pytest.mark.every(3)
@pytest.mark.parametrize(
    "load", [Payload(), Payload(mass=50.0, inertia=3.0), Payload(mass=5.0, offset=(0.5, 0.0, 0.0))]
)
@pytest.mark.parametrize("basis", ["modes", "polynomial", "tip-force"])
def test_default_resolves_bends_and_flaps_of_any_payload(load, basis):
    plant = LargeDeflectionBeam(beam=ROD, payload=load, basis=basis, modes=3, gravity=(0.0, 0.0, 0.0))
    finer = dataclasses.replace(plant, points=30).natural_frequencies()
    np.testing.assert_allclose(plant.natural_frequencies(), finer, rtol=1e-3)


@pytest.mark.parametrize(
    "given",
    [
        {"modes": 1, "twists": 3, "points": 3},
        {"modes": 3, "twists": 8, "points": 7},
        {"modes": 6, "twists": 1, "points": 6},
        {"modes": 8, "twists": 1, "points": 9, "kinematics": "substructured"},
    ],
)
def test_points_that_are_too_few_are_refused_and_the_number_told_is_enough(given):
    with pytest.raises(ValueError, match=rf"points = {given['points']} are too few .* None takes \d+") as refusal:
        rod(**given)
    enough = int(str(refusal.value).split()[-1])
    assert rod(**given | {"points": enough}).points == enough
    assert rod(**given | {"points": None}).point_count == enough
