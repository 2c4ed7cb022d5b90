"""The beam with an exact rotation field against a geometrically exact reference, elliptic integrals and beam theory."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pliant.plants import Beam, LagrangianPlant, LargeDeflectionBeam, Payload, SingleLinkArm, beams
from pliant.plants.large_deflection import tangent_field

BEAM = LargeDeflectionBeam.textbook()
LOAD = Payload(mass=0.3, inertia=0.02, offset=(0.1, 0.2, 0.0))
TENSOR = Payload(
    mass=0.3,
    inertia=((0.02, 0.003, 0.001), (0.003, 0.03, 0.002), (0.001, 0.002, 0.04)),
    offset=(0.1, 0.2, 0.15),
)


def large(**changes):
    return dataclasses.replace(BEAM, **changes)


def bent_section(**changes):
    """A damped beam whose section is twice as stiff one way as the other."""
    beam = dataclasses.replace(BEAM.beam, damping=0.01, I_y=2 * BEAM.beam.I_z)
    return large(beam=beam, gravity=(1.0, -9.8, 0.5), **changes)


VARIANTS = {
    "clamped": large(),
    "hinged": large(root="hinged"),
    "driven": large(root="driven", modes=2),
    "loaded": bent_section(payload=LOAD),
    "polynomial": bent_section(root="driven", payload=LOAD, basis="polynomial"),
    "space": large(planar=False, modes=2),
    "space round": large(planar=False, modes=2, root="hinged", payload=TENSOR),
    "space loaded": bent_section(planar=False, modes=2, payload=TENSOR, root="driven", twists=2),
    "space rigid in torsion": bent_section(planar=False, modes=2, twists=0),
}


def test_points_integrate_polynomials_and_their_energy_exactly():
    at = tangent_field.points(5, panels=2)
    xi = np.array([0.0, 0.2, 0.5, 0.77, 1.0])
    np.testing.assert_allclose(at.cumulative(xi) @ at.xi**4, xi**5 / 5, atol=1e-15)
    np.testing.assert_allclose(at.first_moment @ at.xi**3, 1 / 4 - 1 / 5, rtol=1e-14)


@pytest.mark.parametrize("panels", [1, 2])
@pytest.mark.parametrize("m", [3, 6])
def test_energy_is_exact_up_to_the_highest_degree_of_a_field(m, panels):
    """int (int_0^xi s^a)(int_0^xi s^b) = 1/((a + 1)(b + 1)(a + b + 3)) for every a, b <= m - 1."""
    at = tangent_field.points(m, panels)
    moved = at.root @ at.xi[:, None] ** np.arange(m)
    a, b = np.meshgrid(np.arange(m), np.arange(m))
    np.testing.assert_allclose(moved.T @ moved, 1 / ((a + 1) * (b + 1) * (a + b + 3)), rtol=1e-12)


@pytest.mark.parametrize("name", VARIANTS)
def test_equations_are_those_of_the_energies(name):
    """The mass matrix and forces built from Jacobians, against the base class's derivatives of T and V."""
    plant = VARIANTS[name]
    t, x, u, w, _ = plant.symbols
    M, r, T, V = LagrangianPlant.equations(plant, t, x, u, w)
    derived = ca.Function("derived", [x, u, w], [M, r, T, V])
    built = ca.Function("built", [x, u, w], list(plant.equations(t, x, u, w)))
    rng = np.random.default_rng(1)
    for _ in range(3):
        point = [0.7 * rng.uniform(-1, 1, k) for k in (plant.nx, plant.nu, plant.nw)]
        for expected, got in zip(derived(*point), built(*point)):
            scale = np.abs(np.asarray(expected)).max()
            np.testing.assert_allclose(np.asarray(got), np.asarray(expected), rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("name", VARIANTS)
def test_energy_changes_at_the_net_power(name):
    plant = VARIANTS[name]
    rng = np.random.default_rng(2)
    x, u, w = (0.5 * rng.uniform(-1, 1, k) for k in (plant.nx, plant.nu, plant.nw))
    put_in, lost = plant.power(x, u, w=w)
    rate = plant.dynamics(x, u, w=w)
    h = 1e-3 / np.abs(rate).max()
    ahead = [plant.energy(x + k * h * rate) for k in (-2, -1, 1, 2)]
    slope = (ahead[0] - 8 * ahead[1] + 8 * ahead[2] - ahead[3]) / (12 * h)
    scale = abs(put_in) + abs(lost) + np.abs(plant.energy(x)) / h * 1e-13
    assert slope == pytest.approx(put_in - lost, abs=1e-6 * scale + 1e-6 * plant.kinetic(x))


@pytest.mark.parametrize(("modes", "within"), [(3, 3e-3), (6, 1e-4)])
def test_release_at_all_reference_times(reference, modes, within):
    rows = reference("large_beam")["release"]["M0_inextensible"]
    plant = large(modes=modes)
    times = [0.0] + [row["t"] for row in rows]
    motion = plant.simulate(np.zeros(plant.nx), None, times)
    for name in ("u", "v"):
        got = motion[f"tip_{name}"][1:]
        np.testing.assert_allclose(got, [row[name] for row in rows], rtol=0, atol=within)
    energy = plant.energy(motion.x)
    assert np.abs(energy - energy[0]).max() < 1e-8 * plant.kinetic(motion.x).max()


def test_error_falls_with_the_number_of_coordinates(reference):
    row = reference("large_beam")["release"]["M0_inextensible"][2]
    errors = []
    for modes in (2, 4, 6, 8):
        plant = large(modes=modes)
        motion = plant.simulate(np.zeros(plant.nx), None, [0.0, row["t"]], rtol=1e-9, atol=1e-10)
        errors.append(np.hypot(motion["tip_u"][1] - row["u"], motion["tip_v"][1] - row["v"]))
    assert errors[0] < 1e-2 and errors[1] < 1e-3 and errors[2] < 1e-4 and errors[3] < 3e-5


def test_default_points_change_little_against_many():
    """Quadrature error stays well below the error of truncation."""
    for modes, truncation in ((3, 3e-3), (6, 1.6e-4)):
        ends = []
        for points in (None, 4 * modes):
            plant = large(modes=modes, points=points)
            ends.append(plant.simulate(np.zeros(plant.nx), None, [0.0, 1.0, 1.54, 3.0]).y[:, :2])
        assert np.abs(ends[0] - ends[1]).max() < 0.5 * truncation


def test_largest_deflection_stands_where_the_reference_has_it(reference):
    release = reference("large_beam")["release"]
    plant = large(modes=6)
    times = np.linspace(1.5, 1.62, 25)
    motion = plant.simulate(np.zeros(plant.nx), None, np.append(0.0, times))
    for name, found in (("v", release["max_abs_v"]), ("u", release["max_abs_u"])):
        fit = np.polynomial.Polynomial.fit(times, motion[f"tip_{name}"][1:], 6)
        inner = [r.real for r in fit.deriv().roots() if abs(r.imag) < 1e-9 and 1.5 < r.real < 1.62]
        assert min(inner, key=lambda r: fit(r)) == pytest.approx(found["t_s"], abs=2e-3)
        assert min(fit(r) for r in inner) == pytest.approx(found[f"{name}_m"], abs=3e-4)


@pytest.mark.parametrize("load", ["1", "5", "10"])
def test_static_tip_load_against_elliptic_integrals(reference, load):
    across, shortened, angle = reference("large_beam")["static_tip_load"][load]
    plant = large(gravity=(0.0, 0.0, 0.0), basis="polynomial", modes=8)
    force = float(load) * plant.beam.EI / plant.beam.length**2
    x, u = plant.equilibrium(tip_force_y=force)
    y = dict(zip((s.name for s in plant.outputs), plant.measure(x, u)))
    assert y["tip_v"] / 10 == pytest.approx(across, abs=1e-6)
    assert -y["tip_u"] / 10 == pytest.approx(shortened, abs=1e-6)
    assert y["tip_angle"] == pytest.approx(angle, abs=1e-6)


def test_hinged_beam(reference):
    found = reference("large_beam")["hinged_release"]
    plant = large(root="hinged", modes=6)
    motion = plant.simulate(np.zeros(plant.nx), None, [0.0, found["t"]])
    # The reference stretches and shears: up to 2e-4 m.
    assert motion["tip_x"][1] == pytest.approx(found["x"], abs=2e-4)
    assert motion["tip_y"][1] == pytest.approx(found["y"], abs=2e-4)


def spin_up(reference):
    given = reference("large_beam")["spin_up"]
    numbers = given["parameters"]
    beam = Beam(
        length=numbers["L_m"],
        area=numbers["A"],
        I_y=numbers["I"],
        I_z=numbers["I"],
        J=2 * numbers["I"],
        density=numbers["rho"],
        E=numbers["E_Pa"],
        G=numbers["E_Pa"] / 2.6,
    )

    def hub(speed):
        T = numbers["T_s"]
        return lambda t: [speed / T * (1 - np.cos(2 * np.pi * t / T)) if t < T else 0.0]

    return given, beam, hub


def spun(plant, acceleration, times):
    return plant.simulate(np.zeros(plant.nx), acceleration, np.append(0.0, times), rtol=1e-9, atol=1e-11)


def test_spin_up_at_the_reference_times_and_its_peak(reference):
    given, beam, hub = spin_up(reference)
    found, peak = given["W6"], abs(given["W6"]["min_v"])
    times = np.sort([*found["t"], found["t_min"]])
    at = np.searchsorted(times, found["t"]) + 1
    exact = LargeDeflectionBeam(beam=beam, root="driven", gravity=(0.0, 0.0, 0.0), modes=6)
    motion = spun(exact, hub(6.0), times)
    assert motion["tip_deflection"].min() == pytest.approx(found["min_v"], abs=1e-4 * peak)
    # Late in the spin-up the reference's stretch, 7.7e-5 of its length at 6 rad/s, moves the tip by 8e-5 m.
    np.testing.assert_allclose(motion["tip_deflection"][at], found["v"], rtol=0, atol=1e-4)
    arm = SingleLinkArm(link=beam, kinematics="stiffened", drive="motion", modes=2)
    motion = spun(arm, hub(6.0), times)
    assert motion["tip_deflection"].min() == pytest.approx(found["min_v"], abs=5e-3 * peak)
    np.testing.assert_allclose(motion["tip_deflection"][at], found["v"], rtol=0, atol=5e-3 * peak)


def test_spin_up_runs_away_without_stiffening(reference):
    given, beam, hub = spin_up(reference)
    found = given["without_stiffening"]
    arm = SingleLinkArm(link=beam, kinematics="linear", drive="motion", modes=2)
    assert arm.natural_frequencies()[0] == pytest.approx(found["first_frequency"], rel=1e-7)
    times = np.arange(9.0, 9.3, 0.004)
    away = np.abs(spun(arm, hub(6.0), times)["tip_deflection"][1:]) > 10
    assert times[np.argmax(away)] == pytest.approx(found["W6_exceeds_10_m_at"], abs=0.005)
    slow = spun(arm, hub(2.0), np.arange(0.05, 15, 0.05))
    assert slow["tip_deflection"].min() == pytest.approx(found["W2_min_v"], abs=2e-4)


@pytest.mark.parametrize("root", ["clamped", "hinged"])
def test_frequencies_of_the_straight_beam_are_those_of_linear_theory(root):
    """Natural modes diagonalise the straight beam; the tiny rotary inertia lowers the frequencies."""
    plant = large(root=root, modes=4, gravity=(0.0, 0.0, 0.0), points=24)
    boundary = {"clamped": "clamped-free", "hinged": "pinned-free"}[root]
    expected = beams.frequencies(plant.beam, 4, boundary)
    np.testing.assert_allclose(plant.natural_frequencies()[-4:], expected, rtol=2e-4)


def test_payload_modes_diagonalise_the_straight_loaded_beam():
    plant = large(modes=4, gravity=(0.0, 0.0, 0.0), payload=Payload(mass=1.0, inertia=0.1), points=24)
    expected = beams.frequencies(plant.beam, 4, payload=plant.payload)
    np.testing.assert_allclose(plant.natural_frequencies(), expected, rtol=2e-4)


def test_the_axis_keeps_its_length_and_ends_at_the_tip():
    for plant in (large(modes=5, points=24), large(planar=False, modes=4, points=24)):
        x = np.zeros(plant.nx)
        x[: plant.nx // 2] = np.linspace(1.0, -0.6, plant.nx // 2)
        line = plant.outline(x, 2001)[0]
        assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(10.0, rel=1e-5)
        tip = dict(zip((s.name for s in plant.outputs), plant.measure(x)))
        np.testing.assert_allclose(line[-1, :2], [tip["tip_x"], tip["tip_y"]], atol=1e-12)


def extended(plant, n, a):
    """A planar plant's coordinates in the spatial one's order."""
    out = np.zeros(plant.nx // 2)
    out[:n] = a
    return out


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
    sections = plant.sections
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
    sections = plant.sections
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


def test_offset_payload_twists_the_spatial_beam_as_bar_theory_says():
    """A weight beside the axis of a stiff beam: a small twist m g y L/(G J)."""
    stiff = dataclasses.replace(BEAM.beam, E=1e6 * BEAM.beam.E, G=1e3 * BEAM.beam.G)
    plant = large(beam=stiff, planar=False, modes=2, twists=6, payload=Payload(mass=0.5, offset=(0.0, 0.0, 0.4)))
    x, u = plant.equilibrium()
    twist = plant.measure(x, u)[-1]
    expected = 0.5 * 9.8 * 0.4 * 10.0 / stiff.GJ
    # Six sine shapes leave out 8/pi^2 sum_{k > 6} 1/(2 k - 1)^2 = 1/(6 pi^2) of a moment's twist.
    missing = 8 / np.pi**2 * sum(1 / (2 * k - 1) ** 2 for k in range(7, 100000))
    assert twist == pytest.approx(expected * (1 - missing), rel=1e-4)
