"""Steps with their derivatives against CasADi's automatic differentiation of the same map, and differences of steps."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from shaken_pendulum import Shaken

from pliant.plants import FlexibleSpacecraft, LargeDeflectionBeam, SingleLinkArm, SliderCrank, TwoLinkArm
from pliant.plants.integration.step_maps import step_map
from pliant.plants.integration.step_sensitivities import StepSensitivities, sensitivity_kernel, slopes_function
from pliant.plants.native import kernel_loader
from pliant.plants.native.scalar_codegen import operations
from pliant.plants.toolchain import straight_line

ARM = TwoLinkArm.textbook()
PLANTS = {
    "two": dataclasses.replace(ARM, kinematics="stiffened", basis="payload", modes=(1, 1)),
    "two varied": dataclasses.replace(ARM, modes=(1, 0)).vary("payload.mass"),
    "one": SingleLinkArm.textbook(),
    "one driven": dataclasses.replace(SingleLinkArm.textbook(), drive="motion"),
    "large": dataclasses.replace(LargeDeflectionBeam.textbook(), modes=2),
    "crank": SliderCrank.textbook(),
    "craft": dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="rigid"),
}
SAMPLE = ("one driven", "craft")


def points(plant, random_state, batch=3):
    x = np.array([random_state(plant, seed, 0.3) for seed in range(batch)])
    return x, np.random.default_rng(9).normal(size=(batch, plant.nu))


def differentiated(plant, h, count, t=0.0):
    """(x, u) -> x+, dx+/dx, dx+/du of `count` symbolic steps of h [s] from t [s], by CasADi."""
    x, u = ca.SX.sym("x", plant.nx), ca.SX.sym("u", plant.nu)
    step, y = step_map(plant, "rk4"), x
    for k in range(count):
        y = step(t + k * h, y, ca.horzcat(u, u, u), np.zeros(plant.nw), plant.nominal_parameters, h)
    return ca.Function("reference", [x, u], [y, ca.jacobian(y, x), ca.jacobian(y, u)])


@pytest.mark.parametrize(
    "name", [*SAMPLE, *(pytest.param(n, marks=pytest.mark.campaign) for n in PLANTS if n not in SAMPLE)]
)
def test_equal_automatic_differentiation_of_the_same_map(name, random_state):
    plant = PLANTS[name]
    h, count = (2e-5 if name == "crank" else 2e-3), 2
    x, u = points(plant, random_state)
    both = StepSensitivities(plant, h * count, substeps=count, batch=3)
    assert both.native == kernel_loader.wanted()
    x_next, A, B = both(x, u)
    reference = differentiated(plant, h, count)
    for k in range(3):
        for have, want in zip((x_next[k], A[k], B[k]), reference(x[k], u[k])):
            want = np.array(want).reshape(have.shape)
            np.testing.assert_allclose(have, want, rtol=1e-10, atol=1e-10 * np.abs(want).max())


def test_stages_and_steps_are_at_their_own_times():
    plant, t = Shaken(), np.array([[0.0], [0.7], [1.3]])
    x, u = np.array([[0.5, -0.3]] * 3), np.array([[0.4]] * 3)
    both = StepSensitivities(plant, 0.1, substeps=3, batch=3)
    assert both.native == kernel_loader.wanted()
    found = both(x, u, t=t)
    for k in range(3):
        for have, want in zip(found, differentiated(plant, 0.1 / 3, 3, float(t[k, 0]))(x[k], u[k])):
            np.testing.assert_allclose(have[k], np.array(want).reshape(have[k].shape), rtol=1e-10, atol=1e-12)


@pytest.mark.every(2)
@pytest.mark.parametrize("name", ["two", "one driven"])
def test_equal_differences_of_the_stepper(name, random_state):
    plant = PLANTS[name]
    (x,), (u,) = points(plant, random_state, 1)
    x_next, A, B = (a[0].copy() for a in StepSensitivities(plant, 0.01, substeps=5)(x[None], u[None]))
    d = 1e-6
    moved = d * np.vstack([np.eye(plant.nx + plant.nu), -np.eye(plant.nx + plant.nu)])
    step = plant.stepper(0.01, substeps=5, batch=len(moved))
    ends = step(x + moved[:, : plant.nx], u + moved[:, plant.nx :])
    found = ((ends[: len(moved) // 2] - ends[len(moved) // 2 :]) / (2 * d)).T
    want = np.hstack([A, B])
    np.testing.assert_allclose(found, want, atol=1e-7 * np.abs(want).max())
    np.testing.assert_allclose(plant.stepper(0.01, substeps=5)(x[None], u[None])[0], x_next, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("name", ["two", "one driven", "craft"])
def test_slopes_are_the_plants_jacobians(name, random_state):
    plant = PLANTS[name]
    (x,), (u,) = points(plant, random_state, 1)
    rate, J = slopes_function(plant)(0.0, x, u, np.zeros(plant.nw), plant.nominal_parameters)
    A, B = plant.jacobians(x, u)[:2]
    np.testing.assert_allclose(np.array(rate)[:, 0], plant.dynamics(x, u), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(np.array(J), np.hstack([A, B]), rtol=1e-9, atol=1e-11 * np.abs(A).max())


def test_a_lane_depends_neither_on_its_place_nor_on_the_others(random_state):
    plant = PLANTS["two"]
    x, u = points(plant, random_state, 11)
    many = [a.copy() for a in StepSensitivities(plant, 0.02, substeps=2, batch=11)(x, u)]
    one = StepSensitivities(plant, 0.02, substeps=2)
    for k in (0, 7, 10):
        for have, want in zip(one(x[k : k + 1], u[k : k + 1]), many):
            np.testing.assert_array_equal(have[0], want[k])


@pytest.mark.campaign
def test_parameters_by_lane(random_state):
    plant = PLANTS["two varied"]
    x, u = points(plant, random_state, 2)
    _, A, _ = StepSensitivities(plant, 0.01, batch=2)(x[[0, 0]], u[[0, 0]], p=np.array([[0.3], [0.9]]))
    for k, mass in enumerate((0.3, 0.9)):
        heavy = dataclasses.replace(ARM, modes=(1, 0), payload=dataclasses.replace(ARM.payload, mass=mass))
        want = StepSensitivities(heavy, 0.01)(x[:1], u[:1])[1][0]
        np.testing.assert_allclose(A[k], want, rtol=1e-9, atol=1e-11 * np.abs(want).max())


@pytest.mark.campaign
def test_long_slopes_in_pieces_give_the_same(monkeypatch, random_state):
    plant = PLANTS["one"]
    x, u = points(plant, random_state)
    have = [a.copy() for a in StepSensitivities(plant, 0.01, batch=3)(x, u)]
    monkeypatch.setattr(straight_line, "LENGTHENED", 100)
    pieces = sensitivity_kernel.__wrapped__(plant, np.dtype(float))
    assert pieces.native == kernel_loader.wanted() and operations(slopes_function(plant)) > 300
    work = pieces.workspace(3)
    work.set(1, x)
    work.set(2, u)
    work.run((0.01,), 1)
    np.testing.assert_allclose(work.get(0), have[0], rtol=1e-12, atol=1e-14)
    S = work.get(1).reshape(3, plant.nx, -1)
    np.testing.assert_allclose(S[:, :, : plant.nx], have[1], atol=1e-12 * np.abs(have[1]).max())
    np.testing.assert_allclose(S[:, :, plant.nx :], have[2], atol=1e-12 * np.abs(have[2]).max())


def test_the_virtual_machine_gives_the_same(monkeypatch, random_state):
    plant = PLANTS["two"]
    x, u = points(plant, random_state)
    have = [a.copy() for a in StepSensitivities(plant, 0.02, substeps=2, batch=3)(x, u)]
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    slow = sensitivity_kernel.__wrapped__(plant, np.dtype(float))
    assert not slow.native
    work = slow.workspace(3)
    work.set(1, x)
    work.set(2, u)
    work.run((0.01,), 2)
    np.testing.assert_allclose(work.get(0), have[0], rtol=1e-11, atol=1e-12)
    S = work.get(1).reshape(3, plant.nx, -1)
    np.testing.assert_allclose(S[:, :, : plant.nx], have[1], atol=1e-11 * np.abs(have[1]).max())
    np.testing.assert_allclose(S[:, :, plant.nx :], have[2], atol=1e-11 * np.abs(have[2]).max())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dt": 0.0}, r"StepSensitivities\.dt = 0\.0 must be > 0 \[s\]"),
        ({"batch": 0}, r"StepSensitivities\.batch = 0 must be an integer"),
        ({"substeps": 1.5}, r"StepSensitivities\.substeps = 1\.5 must be an integer"),
        ({"dtype": "int32"}, "dtype = 'int32' must be one of 'float64'"),
    ],
)
def test_bad_input(change, message):
    given = {"dt": 0.01, "substeps": 1, "batch": 1, **change}
    with pytest.raises(ValueError, match=message):
        StepSensitivities(PLANTS["one"], given.pop("dt"), **given)
