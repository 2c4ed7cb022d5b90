"""Which field and sections a beam gets, and its root's curvature."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, LargeDeflectionBeam, Payload
from pliant.plants.beams.section import STEEL
from pliant.plants.dynamics.lagrangian import LagrangianPlant
from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.large_deflection.cross_sections import PlanarSections
from pliant.plants.large_deflection.fields import of_chain, of_rotations
from pliant.plants.large_deflection.spatial_sub_beam_chain import SpatialChain
from pliant.plants.large_deflection.spatial_tangent_field import SpatialSections
from pliant.plants.large_deflection.sub_beam_chain import Chain
from pliant.plants.large_deflection.tangent_field import rotations
from pliant.plants.large_deflection.torsion import TorsionShapes

BEAM = LargeDeflectionBeam.textbook().beam


@pytest.mark.parametrize(
    ("given", "kind", "n", "panels"),
    [
        ({"modes": 3}, PlanarSections, 3, 1),
        ({"modes": 3, "root": "hinged"}, PlanarSections, 4, 1),
        ({"modes": 2, "planar": False, "twists": 1}, SpatialSections, 5, 1),
        ({"kinematics": "substructured", "segments": 3, "modes": 2}, PlanarSections, 6, 3),
        ({"kinematics": "substructured", "segments": 3, "modes": 2, "planar": False}, SpatialChain, 15, 3),
    ],
)
def test_kind_and_size(given, kind, n, panels):
    fields = LargeDeflectionBeam(beam=BEAM, **given).fields
    assert isinstance(fields.sections, kind)
    assert len(fields.root_curvature) == n and fields.tangents.points.panels == panels


def test_curvature_at_the_root_of_a_loaded_cantilever():
    """One polynomial, v = xi^2 (static under a tip moment): theta = q xi, curvature q/L from root to tip."""
    bend = rotations("clamped", "polynomial", 1)
    fields = of_rotations(BEAM, Payload(), bend, bend, points(4), None)
    np.testing.assert_allclose(fields.root_curvature, [1.0], rtol=1e-12)
    turned = of_rotations(BEAM, Payload(), rotations("driven", "polynomial", 1), bend, points(4), TorsionShapes(2))
    np.testing.assert_allclose(turned.root_curvature, [0.0, 1.0, 0.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("twists", [None, 1])
def test_root_curvature_of_a_chain_is_the_slope_of_its_rotation(twists):
    """Against differences of the sections' angles at the root: error of first order in the step."""
    chain = Chain(3, 2, "mean-axis", True)
    row = of_chain(BEAM, Payload(), chain, 6, twists).root_curvature
    h = 1e-6
    angles = chain.section_angles(np.array([0.0, h, 2 * h]))
    slope = (-3 * angles[0] + 4 * angles[1] - angles[2]) / (2 * h)
    np.testing.assert_allclose(row[: chain.n], slope, atol=1e-4 * np.abs(slope).max())
    assert not row[chain.n :].any() and np.abs(row[chain.columns(0)]).min() > 0.1


def test_shapes_come_from_the_nominal_where_the_beam_varies():
    beam = Beam.rectangular(1.0, width=0.02, depth=0.002, material=STEEL)
    plant = LargeDeflectionBeam(beam=beam, payload=Payload(mass=0.1))
    varied = plant.vary("payload.mass").symbolic
    np.testing.assert_array_equal(varied.fields.shapes.stiffness, plant.fields.shapes.stiffness)


CANTILEVER = LargeDeflectionBeam.textbook()


@pytest.mark.parametrize(
    "changes", [{"modes": 3}, {"modes": 2, "root": "hinged"}, {"modes": 4, "gravity": (1.0, -3.0, 0.0)}]
)
def test_the_balance_in_nodes_gives_the_accelerations_of_the_energies(changes):
    """Lagrange's equations, differentiated from T and V, which know no nodes."""
    beam = dataclasses.replace(CANTILEVER, **changes)
    t, x, u, w, _ = beam.symbols
    M, r, *_ = LagrangianPlant.equations(beam, t, x, u, w)
    n = M.shape[0]
    rng = np.random.default_rng(1)
    state, pushed = 0.4 * rng.normal(size=2 * n), rng.normal(size=2)
    M, r = (np.array(e) for e in ca.Function("f", [x, u], [M, r])(state, pushed))
    a = np.linalg.solve(M, r)[:, 0]
    np.testing.assert_allclose(beam.dynamics(state, pushed)[n:], a, rtol=1e-9)
    A, B, *_ = beam.jacobians(state, pushed)
    for given, slope in ((x, A), (u, B)):
        for k in range(given.shape[0]):
            ahead = 1e-6 * np.eye(given.shape[0])[k]
            moved = [
                beam.dynamics(state + s * ahead, pushed) if given is x else beam.dynamics(state, pushed + s * ahead)
                for s in (1, -1)
            ]
            found = (moved[0] - moved[1]) / 2e-6
            np.testing.assert_allclose(found, slope[:, k], rtol=1e-5, atol=1e-5 * np.abs(slope).max())


@pytest.mark.parametrize(
    "changes", [{"payload": Payload(mass=0.1)}, {"root": "driven"}, {"kinematics": "substructured"}]
)
def test_other_beams_are_solved_in_their_coordinates(changes):
    beam = dataclasses.replace(CANTILEVER, modes=2, **changes)
    _, x, u, *_ = beam.symbols
    assert beam._in_nodes(x, u, ca.SX(len(beam.coordinates), 1)) is None
    assert np.isfinite(beam.dynamics(np.full(beam.nx, 0.01))).all()


def test_what_a_beam_of_a_varied_density_is_solved_in_has_no_words_of_it():
    varied = dataclasses.replace(CANTILEVER, modes=2).vary("beam.density")
    x = np.array([0.3, -0.1, 0.2, 0.1])
    np.testing.assert_allclose(
        varied.dynamics(x, p=[2766.7]), dataclasses.replace(CANTILEVER, modes=2).dynamics(x), rtol=1e-9
    )
