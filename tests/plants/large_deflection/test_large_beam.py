"""LargeDeflectionBeam as a plant: its signals, its ladder, what it refuses, and its native kernel."""

import dataclasses
import pickle

import numpy as np
import pytest

from pliant.plants import Beam, LargeDeflectionBeam, Payload, StabilityLimitError

BEAM = LargeDeflectionBeam.textbook()
CHAIN = {"kinematics": "substructured", "segments": 2, "modes": 2}


def large(**changes):
    return dataclasses.replace(BEAM, **changes)


def names(signals):
    return [s.name for s in signals]


def test_parameters_are_those_of_the_reference(reference):
    given = reference("large_beam")["release"]["parameters"]
    beam = BEAM.beam
    assert (beam.length, beam.density, beam.E) == (given["L_m"], given["rho_kg_m3"], given["E_Pa"])
    assert (beam.area, beam.I_y, beam.I_z) == (given["A_m2"], given["I_m4"], given["I_m4"])
    assert pytest.approx(given["E_Pa"] / (2 * (1 + given["nu"])), rel=1e-12) == beam.G
    assert BEAM.gravity == (0.0, -given["g_m_s2"], 0.0)


def test_signals():
    assert names(BEAM.states) == ["bend1", "bend2", "bend3", "bend1_rate", "bend2_rate", "bend3_rate"]
    assert names(BEAM.inputs) == ["tip_force_x", "tip_force_y"] and BEAM.disturbances == ()
    driven = large(root="driven")
    assert names(driven.inputs) == ["hub_acceleration"]
    assert names(driven.disturbances) == ["tip_force_x", "tip_force_y"]
    assert names(driven.coordinates)[0] == "hub_angle" and driven.outputs[0].name == "hub_angle"
    assert names(large(root="hinged").coordinates)[0] == "root_angle"
    assert names(large(**CHAIN).coordinates) == ["bend1_1", "bend1_2", "bend2_1", "bend2_2"]
    links = large(planar=False, **(CHAIN | {"modes": 1}))
    assert names(links.coordinates) == ["bend1_1", "bend2_1", "flap1_1", "flap2_1", "twist1_1", "twist2_1"]
    space = large(planar=False, modes=1)
    assert names(space.coordinates) == ["bend1", "flap1", "twist1"]
    assert names(space.inputs)[-1] == "tip_force_z"
    assert names(space.outputs)[: BEAM.ny] == names(BEAM.outputs)


def test_a_coordinate_is_the_rotation_of_the_tip_it_brings():
    q = np.array([0.3, -0.2, 0.05])
    y = dict(zip(names(BEAM.outputs), BEAM.measure(np.concatenate([q, np.zeros(3)]))))
    assert y["tip_angle"] == pytest.approx(q.sum(), rel=1e-13)


def test_default_state_is_straight_along_x_at_rest():
    for plant in (BEAM, large(**CHAIN), large(planar=False, modes=2), large(planar=False, **CHAIN)):
        y = dict(zip(names(plant.outputs), plant.measure(np.zeros(plant.nx))))
        assert y.pop("tip_x") == pytest.approx(10.0, rel=1e-14)
        np.testing.assert_allclose(list(y.values()), 0, atol=1e-13)
        assert plant.energy(np.zeros(plant.nx)) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("root", ["clamped", "hinged", "driven"])
@pytest.mark.parametrize("kinematics", ["strain", "substructured"])
def test_rates_among_the_outputs_are_derivatives_of_the_outputs(root, kinematics):
    plant = large(root=root, kinematics=kinematics)
    x = np.random.default_rng(5).uniform(-0.6, 0.6, plant.nx)
    A_rate = plant.jacobians(x)[3] @ np.concatenate([x[plant.nx // 2 :], np.zeros(plant.nx // 2)])
    slope = dict(zip(names(plant.outputs), A_rate))
    y = dict(zip(names(plant.outputs), plant.measure(x)))
    for name, of in (
        ("tip_u_rate", "tip_x"),
        ("tip_v_rate", "tip_y"),
        ("tip_deflection_rate", "tip_deflection"),
    ):
        assert y[name] == pytest.approx(slope[of], rel=1e-11)


def test_rigid_rotation_of_the_hub_changes_neither_deflection_nor_motion():
    plant = large(root="driven", gravity=(0.0, 0.0, 0.0))
    x = np.random.default_rng(6).uniform(-0.6, 0.6, plant.nx)
    turned = x.copy()
    turned[0] += 1.2
    np.testing.assert_allclose(plant.dynamics(turned, [0.4]), plant.dynamics(x, [0.4]), rtol=1e-11, atol=1e-10)
    k = names(plant.outputs).index("tip_deflection")
    np.testing.assert_allclose(plant.measure(turned)[k:], plant.measure(x)[k:], rtol=1e-12)


def test_mirror_image_falls_in_mirror_image():
    x = np.random.default_rng(7).uniform(-0.6, 0.6, BEAM.nx)
    up = large(gravity=(0.0, 9.8, 0.0))
    one, other = BEAM.dynamics(x, [0.3, 0.4]), up.dynamics(-x, [0.3, -0.4])
    np.testing.assert_allclose(other, -one, rtol=0, atol=1e-12 * np.abs(one).max())


def test_hanging_equilibrium_and_its_linear_model():
    x, u = BEAM.equilibrium()
    np.testing.assert_allclose(BEAM.dynamics(x, u), 0, atol=1e-9)
    y = dict(zip(names(BEAM.outputs), BEAM.measure(x)))
    assert -0.5 < y["tip_y"] / 10 < -0.3
    model = BEAM.linearize(x, u)
    np.testing.assert_allclose(np.sort(np.abs(model.eigenvalues))[::2], BEAM.natural_frequencies(x), rtol=1e-9)


def test_damped_beam_comes_to_rest_in_the_hanging_equilibrium():
    plant = large(beam=dataclasses.replace(BEAM.beam, damping=0.3), modes=2)
    motion = plant.simulate(np.zeros(4), None, [0.0, 60.0], rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(motion.x[-1], plant.equilibrium()[0], atol=1e-5)


def test_parameters_can_vary():
    # Polynomials do not depend on the payload, as natural modes do.
    loaded = large(payload=Payload(mass=0.2), basis="polynomial")
    plant = loaded.vary("beam.E", "payload.mass", "gravity.1", "beam.length")
    x = np.random.default_rng(8).uniform(-0.5, 0.5, plant.nx)
    p = [0.9 * BEAM.beam.E, 0.3, -5.0, 9.0]
    beam = dataclasses.replace(BEAM.beam, E=p[0], length=p[3])
    other = dataclasses.replace(loaded, beam=beam, payload=Payload(mass=p[1]), gravity=(0.0, p[2], 0.0))
    np.testing.assert_allclose(plant.dynamics(x, p=p), other.dynamics(x), rtol=1e-11)
    np.testing.assert_allclose(plant.dynamics(x), loaded.dynamics(x), rtol=1e-11)


def test_ladder_shares_names_and_goes_from_cheap_to_dear():
    for plant in (BEAM, large(root="driven", **CHAIN), large(planar=False)):
        steps = plant.ladder()
        assert len(set(steps)) == len(steps) and {type(s) for s in steps} == {LargeDeflectionBeam}
        assert all(step.outputs == plant.outputs and step.inputs == plant.inputs for step in steps)
        assert len({step.label for step in steps}) == len(steps)
    sizes = [step._dynamics.function.n_instructions() for step in BEAM.ladder()]
    assert sizes == sorted(sizes)


def test_pickles_and_compares():
    plant = large(root="hinged", modes=2)
    plant.dynamics(np.zeros(plant.nx))
    assert pickle.loads(pickle.dumps(plant)) == plant


def test_native_rk4_over_the_whole_release(reference):
    """Three coordinates and steps of 0.025 s: within 3e-3 m of the reference at all its times."""
    step = BEAM.stepper(0.025, batch=8)
    x, seen = np.zeros((8, BEAM.nx), order="F"), {}
    for k in range(1, 121):
        x = step(x, np.zeros(2))
        seen[k] = x[0].copy()
    for row in reference("large_beam")["release"]["M0_inextensible"]:
        if (row["t"] / 0.025) % 1 < 1e-9:
            y = BEAM.measure(seen[round(row["t"] / 0.025)])
            np.testing.assert_allclose(y[2:4], [row["u"], row["v"]], rtol=0, atol=3e-3)
    if step.native:
        slow = BEAM.simulate(np.zeros(BEAM.nx), None, np.arange(121) * 0.025, method="rk4", step=0.025)
        np.testing.assert_allclose(seen[120], slow.x[-1], rtol=0, atol=1e-9)


def test_step_past_the_limit_is_refused():
    with pytest.raises(StabilityLimitError, match="strain, modes 6"):
        large(modes=6).simulate(np.zeros(12), None, [0.0, 1.0], method="rk4", step=0.02)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"root": "afloat"}, r"root = 'afloat' must be one of 'clamped', 'hinged', 'driven', 'free', 'moving'"),
        ({"kinematics": "linear"}, r"kinematics = 'linear' must be one of"),
        ({"frame": "buckens"}, r"frame = 'buckens' must be one of"),
        ({"basis": "sine"}, r"basis = 'sine' must be one of"),
        ({"modes": 0}, r"modes = 0 must be an integer from 1 to 30"),
        ({"segments": 2}, r"basis of segments = 'modes' must be one of 'auto', 'polynomial'"),
        ({"segments": 0, "kinematics": "substructured"}, r"segments = 0 must be an integer from 1 to 32"),
        ({"gravity": (0.0, -9.8)}, r"gravity = \(0.0, -9.8\) must be three numbers"),
        ({"gravity": (0.0, float("nan"), 0.0)}, r"gravity\[1\] = nan"),
        ({"points": 1}, r"points = 1 must be an integer from 2 to 64"),
        ({"twists": -1}, r"twists = -1 must be an integer from 0 to 12"),
        ({"planar": "no"}, r"planar = 'no' must be True or False"),
    ],
)
def test_bad_input_is_named(changes, message):
    with pytest.raises(ValueError, match=message):
        large(**changes)


def test_positions_take_one_state():
    with pytest.raises(ValueError, match=r"x has shape \(2, 6\), must be \(6,\)"):
        BEAM.positions(np.zeros((2, 6)), np.linspace(0, 1, 3))


def test_keyword_constructor():
    beam = Beam(length=1.0, area=1e-4, I_y=1e-9, I_z=1e-9, J=2e-9, density=2700.0, E=70e9, G=27e9)
    plant = LargeDeflectionBeam(beam=beam)
    assert plant.root == "clamped" and plant.kinematics == "strain" and plant.planar
    assert plant.gravity == (0.0, -9.8, 0.0) and plant.segments == 1 and plant.modes == 3
    assert plant.rotation_basis == "tip-force" and BEAM.rotation_basis == "modes"
    assert dataclasses.replace(plant, planar=False).rotation_basis == "modes"
    assert dataclasses.replace(plant, modes=30).label == "strain, modes 30"  # more than there are for a tip force


@pytest.mark.parametrize("basis", ["modes", "polynomial", "tip-force"])
def test_root_angle_is_the_direction_in_which_the_beam_leaves_its_root(basis):
    for root in ("hinged", "driven"):
        plant = large(root=root, basis=basis, points=20)
        x = np.random.default_rng(9).uniform(-0.6, 0.6, plant.nx)
        near = plant.positions(x, np.array([1e-5]))[0]
        assert np.arctan2(near[1], near[0]) == pytest.approx(x[0], abs=1e-4)
