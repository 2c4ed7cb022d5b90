"""Steps taken backward, against CasADi's reverse derivative of the same map and the derivatives formed forward."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from shaken_pendulum import Shaken

from pliant.controllers.analytic_gradients.step_adjoints import StepAdjoints, adjoint_kernel
from pliant.plants import SingleLinkArm, TwoLinkArm
from pliant.plants.integration.step_maps import step_map
from pliant.plants.integration.step_sensitivities import StepSensitivities
from pliant.plants.native import kernel_loader

ONE = SingleLinkArm.textbook()
PLANTS = {
    "one driven": dataclasses.replace(ONE, drive="motion"),
    "two varied": dataclasses.replace(TwoLinkArm.textbook(), modes=(1, 0)).vary("payload.mass"),
}


def points(plant, random_state, batch=3):
    rng = np.random.default_rng(9)
    x = np.array([random_state(plant, seed, 0.3) for seed in range(batch)])
    return x, rng.normal(size=(batch, plant.nu)), rng.normal(size=(batch, plant.nx))


def test_equal_reverse_differentiation_of_the_same_steps_at_their_own_times():
    plant, h, count = Shaken(), 0.1 / 3, 3
    x, u, s = ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("s", 2)
    step, t = step_map(plant, "rk4"), np.array([[0.0], [0.7], [1.3]])
    at, lam = np.array([[0.5, -0.3]] * 3), np.array([[1.0, -2.0]] * 3)
    found = StepAdjoints(plant, 0.1, substeps=count, batch=3)(at, np.full((3, 1), 0.4), lam, t=t)
    for k in range(3):
        y = x
        for i in range(count):
            y = step(t[k, 0] + i * h, y, ca.horzcat(u, u, u), [], plant.nominal_parameters, h)
        want = ca.Function("want", [x, u, s], [ca.jtimes(y, x, s, True), ca.jtimes(y, u, s, True)])
        for have, one in zip(found, want(at[k], 0.4, lam[k])):
            np.testing.assert_allclose(have[k], np.array(one)[:, 0], rtol=1e-11)


@pytest.mark.parametrize("name", PLANTS)
@pytest.mark.parametrize("substeps", [1, 4])
def test_equal_products_with_the_derivatives_formed_forward(name, substeps, random_state):
    plant = PLANTS[name]
    x, u, lam = points(plant, random_state)
    p = np.tile(plant.nominal_parameters, (3, 1)) * np.array([[0.7], [1.0], [1.3]])
    back = StepAdjoints(plant, 0.004, substeps=substeps, batch=3)
    assert back.native == kernel_loader.wanted()
    _, A, B = StepSensitivities(plant, 0.004, substeps=substeps, batch=3)(x, u, p=p)
    for have, J in zip(back(x, u, lam, p=p), (A, B)):
        want = np.einsum("bi,bij->bj", lam, J)
        np.testing.assert_allclose(have, want, atol=1e-12 * np.abs(want).max())


def test_a_lane_depends_neither_on_its_place_nor_on_the_others(random_state):
    plant = PLANTS["one driven"]
    x, u, lam = points(plant, random_state, 11)
    many = [a.copy() for a in StepAdjoints(plant, 0.02, substeps=4, batch=11)(x, u, lam)]
    one = StepAdjoints(plant, 0.02, substeps=4)
    for k in (0, 7, 10):
        for have, want in zip(one(x[k : k + 1], u[k : k + 1], lam[k : k + 1]), many):
            np.testing.assert_array_equal(have[0], want[k])


def test_the_virtual_machine_gives_the_same(monkeypatch, random_state):
    plant = PLANTS["one driven"]
    x, u, lam = points(plant, random_state)
    have = [a.copy() for a in StepAdjoints(plant, 0.02, substeps=4, batch=3)(x, u, lam)]
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    slow = adjoint_kernel.__wrapped__(plant, 4, np.dtype(float))
    assert not slow.native
    work = slow.workspace(3)
    for k, value in ((1, x), (2, u), (5, lam)):
        work.set(k, value)
    work.run((0.005,), 4)
    for k, want in enumerate(have):
        np.testing.assert_allclose(work.get(k), want, atol=1e-12 * np.abs(want).max())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dt": 0.0}, r"StepAdjoints\.dt = 0\.0 must be > 0 \[s\]"),
        ({"batch": 0}, r"StepAdjoints\.batch = 0 must be an integer"),
        ({"substeps": 1.5}, r"StepAdjoints\.substeps = 1\.5 must be an integer"),
        ({"dtype": "int32"}, "dtype = 'int32' must be one of 'float64'"),
    ],
)
def test_bad_input(change, message):
    given = {"dt": 0.01, "substeps": 1, "batch": 1, **change}
    with pytest.raises(ValueError, match=message):
        StepAdjoints(PLANTS["one driven"], given.pop("dt"), **given)
