"""Equations of beams of strains: those of their energies, in balance with their power, in the limit known ones."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from evidence import agrees
from large_beam_cases import LOAD, VARIANTS, large
from random_plants import dimension, rescaled
from scipy.linalg import eigh
from strained_cases import STRAINED, strained, unit_states

from pliant.plants import LagrangianPlant
from pliant.plants.beams import basis


def names(signals):
    return [s.name for s in signals]


@pytest.mark.every(2)
@pytest.mark.parametrize("name", STRAINED)
def test_equations_are_those_of_the_energies(name):
    """M and r against the base class's derivatives of T, V and D."""
    plant = STRAINED[name]
    t, x, u, w, _ = plant.symbols
    M, r, T, V = LagrangianPlant.equations(plant, t, x, u, w)
    derived = ca.Function("derived", [x, u, w], [M, r, T, V])
    built = ca.Function("built", [x, u, w], list(plant.equations(t, x, u, w)))
    rng = np.random.default_rng(1)
    for _ in range(2):
        point = [unit_states(plant, rng), rng.uniform(-1, 1, plant.nu), rng.uniform(-1, 1, plant.nw)]
        for expected, got in zip(derived(*point), built(*point)):
            scale = np.abs(np.asarray(expected)).max()
            np.testing.assert_allclose(np.asarray(got), np.asarray(expected), rtol=0, atol=1e-12 * scale)


@pytest.mark.every(2)
@pytest.mark.parametrize("name", STRAINED)
def test_energy_changes_at_the_net_power(name):
    plant = STRAINED[name]
    rng = np.random.default_rng(2)
    x = unit_states(plant, rng)
    u, w = rng.uniform(-1, 1, plant.nu), rng.uniform(-1, 1, plant.nw)
    put_in, lost = plant.power(x, u, w=w)
    symbols = plant.symbols
    T, V = (
        plant.kinetic_energy(*ca.vertsplit(symbols[1], plant.nx // 2)),
        plant.potential_energy(symbols[1][: plant.nx // 2]),
    )
    gradient = ca.Function("gradient", [symbols[1]], [ca.gradient(T, symbols[1]), ca.gradient(V, symbols[1])])
    parts = [np.asarray(g).ravel() * plant.dynamics(x, u, w=w) for g in gradient(x)]
    assert np.sum(parts) == pytest.approx(put_in - lost, abs=1e-11 * np.abs(parts).sum())


@pytest.mark.every(2)
@pytest.mark.parametrize("name", STRAINED)
def test_rates_among_the_outputs_are_derivatives_of_the_outputs_and_all_vanish_at_rest(name):
    plant = STRAINED[name]
    x = unit_states(plant, np.random.default_rng(3))
    n = plant.nx // 2
    slopes = dict(zip(names(plant.outputs), plant.jacobians(x)[3] @ np.concatenate([x[n:], np.zeros(n)])))
    y = dict(zip(names(plant.outputs), plant.measure(x)))
    for output, rate in plant.output_rates.items():
        assert y[rate] == pytest.approx(slopes[output], rel=1e-10), output
    rest = dict(zip(names(plant.outputs), plant.measure(np.zeros(plant.nx))))
    places = [rest.pop(k) for k in ("tip_x", "tip_y")]
    np.testing.assert_allclose(places, plant.positions(np.zeros(plant.nx), [1.0])[0, :2], atol=1e-12)
    np.testing.assert_allclose(list(rest.values()), 0, atol=1e-12)
    assert plant.energy(np.zeros(plant.nx)) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("name", ["clamped", "hinged", "driven", "loaded"])
def test_a_beam_of_strains_without_extension_and_shear_is_the_beam_of_rotations(name):
    """With a follower force that is not there; more points, as both rules are exact to a few digits only."""
    plain = dataclasses.replace(VARIANTS[name], points=20)
    plant = dataclasses.replace(plain, tip_loads=("force", "follower"))
    assert plant.strained and not plain.strained
    x = 0.6 * np.random.default_rng(4).uniform(-1, 1, plain.nx)
    F = [0.3, -0.4]
    if plain.root == "driven":
        got, expected = plant.dynamics(x, [0.5], w=[*F, 0.0, 0.0]), plain.dynamics(x, [0.5], w=F)
    else:
        got, expected = plant.dynamics(x, [*F, 0.0, 0.0]), plain.dynamics(x, F)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
    np.testing.assert_allclose(plant.measure(x), plain.measure(x), atol=1e-11)
    assert plant.energy(x) == pytest.approx(plain.energy(x), rel=1e-11)


@pytest.mark.parametrize("name", ["free", "moving", "space"])
def test_it_moves_alike_in_other_units(name):
    """Lengths, masses and times in units of 2, 3 and 5 of the former."""
    plant, by = STRAINED[name], 1 / np.array([2.0, 3.0, 5.0])
    rng = np.random.default_rng(9)
    given = unit_states(plant, rng), rng.uniform(-1, 1, plant.nu), rng.uniform(-1, 1, plant.nw)
    signals = plant.states, plant.inputs, plant.disturbances
    sizes = [np.array([np.prod(by ** dimension(s.unit)) for s in kind]) for kind in signals]
    x, u, w = (value * size for value, size in zip(given, sizes))
    rate = plant.dynamics(*given[:2], w=given[2]) * sizes[0] / by[2]
    scale = np.abs(rate / sizes[0]).max() * sizes[0]
    np.testing.assert_allclose(rescaled(plant, by).dynamics(x, u, w=w) / scale, rate / scale, rtol=0, atol=1e-11)


def test_a_free_beam_that_nothing_acts_on_keeps_its_momentum():
    """Linear that of the root's coordinates, angular that of a turn of the whole about the origin; no damping."""
    beam = dataclasses.replace(STRAINED["free"].beam, damping=0.0)
    plant = dataclasses.replace(STRAINED["free"], beam=beam, gravity=(0.0, 0.0, 0.0))
    x = unit_states(plant, np.random.default_rng(5))
    motion = plant.simulate(x, None, [0.0, 0.02, 0.04], rtol=1e-10, atol=1e-12)
    n = plant.nx // 2

    def momenta(state):
        M = plant.mass_matrix(state)
        p = (M @ state[n:])[:2]  # on the root's coordinates: the whole beam's
        shift = np.zeros(n)
        shift[:3] = -state[1], state[0], 1.0  # a turn about the origin
        return [*p, float(shift @ M @ state[n:])]

    first, *later = (momenta(s) for s in motion.x)
    for found in later:
        np.testing.assert_allclose(found, first, rtol=1e-8, atol=1e-8 * np.abs(first).max())


def test_a_moving_root_is_a_free_one_that_is_held_on_its_way():
    """Accelerations that the free root has by itself make the moving root's beam move alike."""
    free = strained(root="free", extensible=True, tip_loads=("force", "moment"), basis="polynomial")
    moving = dataclasses.replace(free, root="moving")
    x = unit_states(free, np.random.default_rng(6))
    load = [0.3, 0.5, -0.2]
    rate = free.dynamics(x, load)
    np.testing.assert_allclose(moving.dynamics(x, rate[free.nx // 2 :][:3], w=load), rate, rtol=1e-9)


def test_a_root_that_only_turns_is_a_driven_one():
    driven = large(root="driven", payload=LOAD, tip_loads=("force", "moment"))
    moving = dataclasses.replace(driven, root="moving")
    n = driven.nx // 2
    x = np.random.default_rng(7).uniform(-0.5, 0.5, driven.nx)
    q, v = x[:n], x[n:]
    X = np.concatenate([[0.0, 0.0], q, [0.0, 0.0], v])
    got = moving.dynamics(X, [0.0, 0.0, 0.7], w=[1.0, 2.0, 0.5])[n + 4 :]
    np.testing.assert_allclose(got, driven.dynamics(x, [0.7], w=[1.0, 2.0, 0.5])[n:], rtol=1e-10)


def test_a_root_carried_through_space_adds_a_uniform_weight():
    """Accelerated, the beam is bent as by weight the other way, seen from the root; the root's angle turns at will."""
    moving = STRAINED["space moving"]
    driven = dataclasses.replace(moving, root="driven", gravity=(1.0 - 3.0, -9.8 - 2.0, 0.5 + 4.0))
    n = driven.nx // 2
    x = unit_states(driven, np.random.default_rng(10))
    X = np.concatenate([[0.3, 0.2, 0.1], x[:n], [1.0, 2.0, 3.0], x[n:]])
    w = np.array([1.0, 2.0, 3.0, 0.5, -0.5, 0.2])
    got = moving.dynamics(X, [3.0, 2.0, -4.0, 0.7], w=w)[n + 6 :]
    np.testing.assert_allclose(got, driven.dynamics(x, [0.7], w=w)[n:], rtol=1e-8, atol=1e-9 * np.abs(got).max())
    line = moving.positions(X, [0.0, 1.0]) - driven.positions(x, [0.0, 1.0])
    np.testing.assert_allclose(line, [[0.3, 0.2, 0.1]] * 2, atol=1e-12)


def test_the_plane_is_a_part_of_space():
    """Bent, stretched and sheared in the plane alone, the spatial beam moves as the planar one."""
    options = {
        "rest_curvature": 0.7,
        "extensible": True,
        "theory": "timoshenko",
        "points": 24,
        "gravity": (1.0, -9.8, 0.0),
    }
    flat = strained(root="driven", basis="polynomial", tip_loads=("force", "follower"), **options)
    space = dataclasses.replace(flat, planar=False)
    here = [names(space.states).index(name) for name in names(flat.states)]
    x = unit_states(flat, np.random.default_rng(8), 0.5)
    X = np.zeros(space.nx)
    X[here] = x
    rate = space.dynamics(X, [0.4], w=[1.0, 2.0, 0.0, 0.5, -0.3, 0.0])
    np.testing.assert_allclose(rate[here], flat.dynamics(x, [0.4], w=[1.0, 2.0, 0.5, -0.3]), rtol=1e-8, atol=1e-7)
    others = np.delete(rate, here)
    np.testing.assert_allclose(others, 0, atol=1e-9 * np.abs(rate).max())
    np.testing.assert_allclose(space.measure(X)[: flat.ny], flat.measure(x), atol=1e-9)


def test_frequencies_of_a_free_beam_against_timoshenko_and_euler():
    """Free-free roots of cos x cosh x = 1 (R. D. Blevins, 1979): 4.73004, 7.85320, 10.9956; slender, so to 1e-3."""
    beam = dataclasses.replace(STRAINED["free"].beam, I_y=1e-9, I_z=1e-9, damping=0.0)
    plant = strained(beam=beam, root="free", gravity=(0.0, 0.0, 0.0), modes=8, extensible=True, theory="timoshenko")
    unit = np.sqrt(beam.EI / (beam.linear_density * beam.length**4))
    found = plant.natural_frequencies()[:3] / unit
    agrees(
        found,
        np.array([4.73004, 7.85320, 10.9956]) ** 2,
        within=1e-3,
        of="LargeDeflectionBeam",
        what="frequencies of a slender free beam, with shear and extension",
        source="Blevins (1979), table 8-1",
        kind="table",
    )


def test_frequencies_of_a_stubby_cantilever_against_the_timoshenko_beams():
    """The exact roots of a clamped Timoshenko beam with rotary inertia, Ritz, by 20 polynomials of `beams.basis`."""
    beam = dataclasses.replace(STRAINED["clamped"].beam, I_y=2e-5, I_z=2e-5, damping=0.0)
    plant = strained(beam=beam, gravity=(0.0, 0.0, 0.0), modes=10, shears=9, theory="timoshenko", basis="polynomial")
    other = basis("polynomial", 20, **beam.section_ratios)
    K = other.stiffness + other.shear / beam.section_ratios["shear"]
    M = other.mass + beam.section_ratios["rotary"] * other.rotary
    known = np.sqrt(eigh(K, M, eigvals_only=True)[:3])
    unit = np.sqrt(beam.EI / (beam.linear_density * beam.length**4))
    np.testing.assert_allclose(plant.natural_frequencies()[:3] / unit, known, rtol=1e-6)
