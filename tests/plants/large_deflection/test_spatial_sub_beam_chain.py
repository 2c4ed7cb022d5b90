"""The chain in space against the planar one, its energies and the exact beam."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from chain_cases import BEAM, LOADED, chain

from pliant.plants import LagrangianPlant, Payload

SPACE = [
    ("clamped", {"segments": 2}),
    ("driven", {"segments": 1, "frame": "tangent", "of": LOADED}),
    ("hinged", {"segments": 2, "frame": "tangent", "of": LOADED}),
]


@pytest.mark.every(3)
@pytest.mark.parametrize(("root", "given"), SPACE)
def test_spatial_chain_in_the_plane_is_the_planar_one(root, given):
    flat = chain(**given, root=root)
    space = dataclasses.replace(flat, planar=False)
    n, N = flat.nx // 2, space.nx // 2
    rng = np.random.default_rng(4)
    x, u, w = (0.4 * rng.uniform(-1, 1, k) for k in (flat.nx, flat.nu, flat.nw))
    if root != "clamped":
        x[0] = 9.0  # more than a turn
    X = np.zeros(2 * N)
    X[:n], X[N : N + n] = x[:n], x[n:]
    U, W = (np.append(z, 0.0) if len(z) == 2 else z for z in (u, w))
    a, A = flat.dynamics(x, u, w=w)[n:], space.dynamics(X, U, w=W)[N:]
    np.testing.assert_allclose(A, np.append(a, np.zeros(N - n)), rtol=0, atol=1e-10 * np.abs(a).max())
    np.testing.assert_allclose(space.measure(X)[: flat.ny], flat.measure(x), atol=1e-12)
    assert space.energy(X) == pytest.approx(flat.energy(x), rel=1e-12)


def test_spatial_equations_are_those_of_the_energies():
    tensor = ((0.02, 0.003, 0.001), (0.003, 0.03, 0.002), (0.001, 0.002, 0.04))
    beam = dataclasses.replace(LOADED.beam, I_y=2 * LOADED.beam.I_z)
    loaded = dataclasses.replace(LOADED, beam=beam, payload=Payload(0.3, tensor, (0.1, 0.2, 0.15)))
    plant = chain(2, 1, "tangent", of=loaded, planar=False)
    t, x, u, w, _ = plant.symbols
    derived = ca.Function("derived", [x, u], list(LagrangianPlant.equations(plant, t, x, u, w)))
    built = ca.Function("built", [x, u], list(plant.equations(t, x, u, w)))
    rng = np.random.default_rng(1)
    point = [0.4 * rng.uniform(-1, 1, k) for k in (plant.nx, plant.nu)]
    for expected, got in zip(derived(*point), built(*point)):
        scale = np.abs(np.asarray(expected)).max()
        np.testing.assert_allclose(np.asarray(got), np.asarray(expected), rtol=0, atol=1e-12 * scale)


@pytest.mark.campaign
def test_spatial_chain_hangs_where_the_exact_beam_does():
    """Sideways gravity and a payload beside the axis: bending in two planes with torsion."""
    load = Payload(mass=0.2, inertia=0.01, offset=(0.0, 0.0, 0.3))
    bent = dataclasses.replace(BEAM, payload=load, gravity=(0.0, -6.0, -7.0), planar=False, modes=3, twists=1)
    places = []
    for plant in (bent, chain(1, of=bent), chain(2, of=bent)):
        x, _ = plant.equilibrium()
        places.append(plant.positions(x, np.ones(1))[0])
    away = [np.linalg.norm(place - places[0]) for place in places[1:]]
    assert away[1] < 0.02 and away[1] < away[0] / 4
