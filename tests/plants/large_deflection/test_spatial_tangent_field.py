"""The rotation field in space against the planar one, its frames and bar theory."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from large_beam_cases import BEAM, VARIANTS, large
from scipy.spatial.transform import Rotation

from pliant.plants import LargeDeflectionBeam, Payload
from pliant.plants.beams import STEEL, Beam


def extended(plant, n, a):
    """A planar plant's coordinates in the spatial one's order."""
    out = np.zeros(plant.nx // 2)
    out[:n] = a
    return out


@pytest.mark.every(2)
@pytest.mark.parametrize("name", ["clamped", "hinged", "driven", "loaded", "polynomial"])
def test_spatial_beam_in_the_plane_is_the_planar_one(name):
    flat = dataclasses.replace(VARIANTS[name], gravity=(1.0, -9.8, 0.0))
    space = dataclasses.replace(flat, planar=False)
    n = flat.nx // 2
    rng = np.random.default_rng(3)
    for _ in range(3):
        q, v = rng.uniform(-1, 1, n), 2 * rng.uniform(-1, 1, n)
        u, w = rng.uniform(-1, 1, flat.nu), rng.uniform(-1, 1, flat.nw)
        x = np.concatenate([q, v])
        X = np.concatenate([extended(space, n, q), extended(space, n, v)])
        U, W = (np.append(z, 0.0) if len(z) == 2 else z for z in (u, w))
        a, A = flat.dynamics(x, u, w=w)[n:], space.dynamics(X, U, w=W)[space.nx // 2 :]
        np.testing.assert_allclose(A, extended(space, n, a), rtol=0, atol=1e-10 * np.abs(a).max())
        np.testing.assert_allclose(space.measure(X)[: flat.ny], flat.measure(x), atol=1e-12)
        assert space.energy(X) == pytest.approx(flat.energy(x), rel=1e-12)


def test_spatial_release_does_not_know_which_way_is_down():
    times = [0.0, 0.5, 1.0, 1.5]
    flat = large(modes=2).simulate(np.zeros(4), None, times, rtol=1e-9, atol=1e-11)
    g = 9.8 / np.sqrt(2)
    space = large(planar=False, modes=2, gravity=(0.0, -g, -g))
    motion = space.simulate(np.zeros(space.nx), None, times, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(motion["tip_x"], flat["tip_x"], atol=1e-7)
    np.testing.assert_allclose(motion["tip_y"], flat["tip_y"] / np.sqrt(2), atol=1e-7)
    np.testing.assert_allclose(motion["tip_z"], flat["tip_y"] / np.sqrt(2), atol=1e-7)
    np.testing.assert_allclose(motion["tip_twist"], 0, atol=1e-9)


def section_frames(plant, q, xi):
    """R_z exp(Phi) R_x(a) at xi (k,), with a summed up by the trapezium rule from its own definition."""
    sections = plant.fields.sections
    h, beta, gamma, twist = (rows @ q for rows in sections._rows(xi))
    _, beta_s, gamma_s, _ = (rows @ q for rows in sections._rows(xi, 1))
    phi2 = np.maximum(beta**2 + gamma**2, 1e-12)
    rate = (1 - np.cos(np.sqrt(phi2))) / phi2 * (beta * gamma_s - gamma * beta_s)
    a = twist + np.concatenate([[0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(xi))])
    zero = np.zeros_like(a)
    swing = Rotation.from_rotvec(np.column_stack([zero, beta, gamma]))
    return (
        Rotation.from_rotvec(np.column_stack([zero, zero, h]))
        * swing
        * Rotation.from_rotvec(np.column_stack([a, zero, zero]))
    )


@pytest.mark.every(3)
@pytest.mark.parametrize("name", ["space", "space loaded", "space rigid in torsion"])
def test_strains_and_spins_of_the_spatial_beam_against_its_frames(name):
    """Strain and kinetic energy from finite differences of the sections' frames, made by another library."""
    plant = dataclasses.replace(VARIANTS[name], points=20)
    n, beam = plant.nx // 2, plant.beam
    rng = np.random.default_rng(4)
    q, v = 0.6 * rng.uniform(-1, 1, n), rng.uniform(-1, 1, n)
    xi = np.linspace(0.0, 1.0, 20001)
    frames = section_frames(plant, q, xi)
    k = (frames[:-1].inv() * frames[1:]).as_rotvec() / np.diff(xi)[:, None] / beam.length
    density = beam.GJ * k[:, 0] ** 2 + beam.E * beam.I_y * k[:, 1] ** 2 + beam.EI * k[:, 2] ** 2
    q_sx, v_sx = ca.SX.sym("q", n), ca.SX.sym("v", n)
    sections = plant.fields.sections
    energies = ca.Function("e", [q_sx, v_sx], [sections.strain_energy(q_sx), sections.kinetic(q_sx, v_sx)])
    strained, turning = (float(e) for e in energies(q, v))
    assert strained == pytest.approx(density.mean() * beam.length / 2, rel=1e-6)
    h = 1e-5
    spin = (section_frames(plant, q - h * v, xi).inv() * section_frames(plant, q + h * v, xi)).as_rotvec()
    spin /= 2 * h
    inertia = beam.density * np.array([beam.polar_moment, beam.I_y, beam.I_z])
    kinetic = (np.trapezoid(spin**2 @ inertia, xi) * beam.length) / 2
    load = plant.payload.inertia
    if isinstance(load, tuple):
        kinetic += spin[-1] @ np.array(load) @ spin[-1] / 2
    assert turning == pytest.approx(kinetic, rel=1e-6)


@pytest.mark.campaign
def test_offset_payload_twists_the_spatial_beam_as_bar_theory_says():
    """A weight beside the axis of a stiff beam: a small twist m g y L/(G J)."""
    stiff = dataclasses.replace(BEAM.beam, E=1e6 * BEAM.beam.E, G=1e3 * BEAM.beam.G)
    plant = large(beam=stiff, planar=False, modes=2, twists=2, payload=Payload(mass=0.5, offset=(0.0, 0.0, 0.4)))
    x, u = plant.equilibrium()
    twist = plant.measure(x, u)[-1]
    assert twist == pytest.approx(0.5 * 9.8 * 0.4 * 10.0 / stiff.GJ, rel=1e-4)


def damped(**changes):
    return dataclasses.replace(Beam.circular(1.0, 0.01, STEEL), damping=1e-3, **changes)


def bent_and_twisting(beam):
    plant = LargeDeflectionBeam(beam=beam, planar=False, modes=2, twists=2, gravity=(0.0, 0.0, 0.0))
    x = np.zeros(plant.nx)
    x[:3] = 1.0, 0.3, -0.5
    x[plant.nx // 2 :] = 0.7, -0.2, 0.4, 0.1, 10.0, -3.0
    return plant, x


def test_fibres_of_a_round_section_lose_what_those_of_a_nearly_round_one_do():
    """Material axes turn with the twist; the loss is continuous where the moments become equal, and when varied."""
    lost = []
    for unequal in (0.0, 1e-12, -1e-12):
        beam = damped()
        plant, x = bent_and_twisting(dataclasses.replace(beam, I_y=beam.I_z * (1 + unequal)))
        lost.append(plant.power(x)[1])
    np.testing.assert_allclose(lost, lost[0], rtol=1e-10)
    plant, x = bent_and_twisting(damped())
    for path in ("beam.I_y", "beam.I_z", "beam.damping"):
        assert plant.vary(path).power(x)[1] == pytest.approx(lost[0], rel=1e-12)


@pytest.mark.parametrize("unequal", [1.0, 2.0])
def test_loss_is_that_of_the_strain_rates_of_material_frames(unequal):
    """c int stiffness (dk/dt)^2 ds with k of the sections' frames by SciPy's rotations, d/dt by differences."""
    beam = damped()
    beam = dataclasses.replace(beam, I_y=unequal * beam.I_z)
    plant, x = bent_and_twisting(beam)
    plant = dataclasses.replace(plant, points=20)
    n, xi, h = plant.nx // 2, np.linspace(0.0, 1.0, 4001), 1e-5

    def strains(q):
        frames = section_frames(plant, q, xi)
        return (frames[:-1].inv() * frames[1:]).as_rotvec() / np.diff(xi)[:, None] / beam.length

    rate = (strains(x[:n] + h * x[n:]) - strains(x[:n] - h * x[n:])) / (2 * h)
    lost = (rate**2 @ np.array([beam.GJ, beam.E * beam.I_y, beam.EI])).mean() * beam.length * beam.damping
    assert plant.power(x)[1] == pytest.approx(lost, rel=1e-5)
