"""Shapes of a free end carry no force and no moment at the tip: a payload's are met slowly, and no count of them tells.

The naive basis converges as 1/N from above, each rung near the next and all of them wrong; shapes that meet the loaded
end's own condition are exact with as many of them as there are frequencies asked for.
"""

import dataclasses

import numpy as np
import pytest
from beam_elements import Mesh
from scipy.linalg import eigh

from pliant.plants import LargeDeflectionBeam, Payload
from pliant.plants.beams import STEEL, Beam, coupled_frequencies, frequencies
from pliant.plants.beams.shape_functions import basis
from pliant.plants.large_deflection.tangent_field import Rotations
from pliant.plants.large_deflection.torsion import TorsionShapes

ROD = Beam.circular(1.0, 0.01, STEEL)
HEAVY = Payload(mass=1.0, inertia=((2e-2, 0.0, 0.0), (0.0, 1e-2, 0.0), (0.0, 0.0, 1e-2)))


def spatial(**changes):
    return LargeDeflectionBeam(
        beam=ROD, payload=HEAVY, planar=False, gravity=(0.0, 0.0, 0.0), **{"basis": "modes", **changes}
    )


def lowest_twist(shapes, load):
    """omega^2 I_p rho L^2/(G J) of the fundamental by Ritz on shapes with `load` at the tip."""
    xi, w = np.polynomial.legendre.leggauss(60)
    xi, w = (1 + xi) / 2, w / 2
    value, slope, tip = shapes(xi), shapes(xi, 1), shapes(np.ones(1))[0]
    M = value.T @ (w[:, None] * value) + load * np.outer(tip, tip)
    return np.linalg.eigvals(np.linalg.solve(M, slope.T @ (w[:, None] * slope))).real.min() ** 0.5


def test_twists_of_a_free_end_err_as_one_over_their_number_and_those_of_the_loaded_end_do_not():
    load = HEAVY.about_tip(0) / (ROD.density * ROD.polar_moment * ROD.length)
    exact = TorsionShapes(1, load).roots[0]
    naive = [lowest_twist(TorsionShapes(n), load) / exact - 1 for n in (1, 2, 4, 8)]
    assert naive[0] > 0.1 and naive[3] > 0.01
    np.testing.assert_allclose(np.array(naive[1:-1]) / np.array(naive[2:]), 2.0, atol=0.2)
    assert lowest_twist(TorsionShapes(1, load), load) == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("twists", [1, 2])
def test_spatial_beam_has_the_exact_frequency_of_torsion(twists):
    """Bending and torsion of a clamped rod with a payload, none missed: Wittrick and Williams' count."""
    exact = coupled_frequencies(ROD, 4, HEAVY)[1]
    found = spatial(modes=2, twists=twists).natural_frequencies()
    assert np.abs(found / exact - 1).min() < 1e-9


def test_flaps_know_their_own_inertia():
    """About y the payload is as heavy to turn as a second beam, about z light; each plane by its own closed form."""
    load = Payload(mass=1.0, inertia=((0.5, 0.0, 0.0), (0.0, 0.4, 0.0), (0.0, 0.0, 0.11)))
    plant = dataclasses.replace(spatial(modes=2), payload=load, twists=0)
    exact = [frequencies(ROD, 2, payload=Payload(mass=1.0, inertia=moment)) for moment in (0.4, 0.11)]
    np.testing.assert_allclose(plant.natural_frequencies(), np.sort(np.concatenate(exact)), rtol=2e-4)


def pinned_elements(mass, inertia, coupling, elements=40):
    """beta of a pinned, loaded beam of cubic elements without its rigid rotation: too high by O(h^4)."""
    mesh = Mesh(elements)
    value, curvature = (mesh.cubic(d, clamped=False) for d in (0, 2))
    K, M = curvature.T @ (mesh.weights[:, None] * curvature), value.T @ (mesh.weights[:, None] * value)
    M[-2:, -2:] += [[mass, coupling], [coupling, inertia]]
    return eigh(K, M, eigvals_only=True)[1:] ** 0.25


@pytest.mark.parametrize(
    "load", [Payload(mass=0.5), Payload(mass=3.0, inertia=0.3), Payload(1.0, 0.1, (0.4, 0.0, 0.0))]
)
def test_hinged_beam_has_its_frequencies_with_any_payload(load):
    """Against forty Hermite elements; modes of a free end are off by per cents with as many shapes."""
    hinged = LargeDeflectionBeam(
        beam=ROD, root="hinged", payload=load, gravity=(0.0, 0.0, 0.0), basis="modes", modes=3, points=20
    )
    scale = np.sqrt(ROD.EI / ROD.linear_density) / ROD.length**2
    exact = scale * pinned_elements(*load.ratios(ROD.mass, ROD.length).values())[:3] ** 2
    np.testing.assert_allclose(hinged.natural_frequencies()[-3:], exact, rtol=3e-4)
    naive = Rotations(basis("pinned-free", 3), True)
    at = hinged.fields.tangents.points
    mass, inertia, coupling = load.ratios(ROD.mass, ROD.length).values()
    moved, tip, turn = at.root @ naive(at.xi), at.weight @ naive(at.xi), naive(np.ones(1))[0]
    M = moved.T @ moved + mass * np.outer(tip, tip) + inertia * np.outer(turn, turn)
    M += coupling * (np.outer(tip, turn) + np.outer(turn, tip))
    omega = scale * np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, naive.stiffness)).real)[1:])
    assert (omega / exact - 1).max() > 0.01
