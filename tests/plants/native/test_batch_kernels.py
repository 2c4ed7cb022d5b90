"""Kernels of many lanes against integration one by one: layout, lanes, threads, precision."""

import numpy as np
import pytest

from pliant.plants import SingleLinkArm, TwoLinkArm
from pliant.plants.integration.batch_stepper import rate_function, step_kernel
from pliant.plants.native import kernel_loader
from pliant.plants.native.batch_kernels import as_dtype, map_kernel, random_points

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()


def states(batch: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    size = np.r_[1.0, 1.0, np.full(4, 0.01), 1.0, 1.0, np.full(4, 0.1)]
    return rng.uniform(-1, 1, (batch, 12)) * size


def test_rk4_steps_equal_simulate() -> None:
    x0, u = states(3), np.array([2.0, -1.0])
    step = ARM.stepper(0.01, batch=3, substeps=20)
    after = step(x0, u)
    for x, have in zip(x0, after):
        want = ARM.simulate(x, u, np.array([0.0, 0.01]), method="rk4", step=0.0005).x[-1]
        np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-10)


def test_rosenbrock_steps_equal_simulate() -> None:
    x0, u = states(2)[:, [0, 2, 3, 6, 8, 9]], np.array([2.0])
    after = LINK.stepper(0.01, method="rosenbrock", batch=2, substeps=5)(x0, u)
    want = LINK.simulate(x0[1], u, np.array([0.0, 0.01]), method="rosenbrock", step=0.002).x[-1]
    np.testing.assert_allclose(after[1], want, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("lanes", [None, 1])
def test_rk8_steps_equal_simulate(lanes: int | None) -> None:
    x0, u = states(3), np.array([2.0, -1.0])
    kernel = step_kernel(ARM, "rk8", as_dtype("float64"), lanes)
    assert kernel.native == kernel_loader.wanted()
    work = kernel.workspace(3)
    work.set(1, x0)
    work.set(2, u)
    work.run((0.002,), 5)
    for x, have, stepped in zip(x0, work.get(0), ARM.stepper(0.01, method="rk8", batch=3, substeps=5)(x0, u)):
        want = ARM.simulate(x, u, np.array([0.0, 0.01]), method="rk8", step=0.002).x[-1]
        np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(stepped, want, rtol=1e-9, atol=1e-10)


def test_midpoint_runs_on_the_virtual_machine() -> None:
    step = ARM.stepper(0.001, method="midpoint", batch=2)
    assert not step.native
    want = ARM.simulate(states(2)[0], np.zeros(2), np.array([0.0, 0.001]), method="midpoint", step=0.001).x[-1]
    np.testing.assert_allclose(step(states(2))[0], want, rtol=1e-10, atol=1e-12)


def test_parameters_differ_per_lane() -> None:
    arm = ARM.vary("payload.mass")
    x0, masses = states(5), np.linspace(0.1, 2.0, 5)[:, None]
    after = arm.stepper(0.005, batch=5, substeps=5)(x0, np.zeros(2), masses)
    for x, mass, have in zip(x0, masses, after):
        want = arm.simulate(x, None, np.array([0.0, 0.005]), p=mass, method="rk4", step=0.001).x[-1]
        np.testing.assert_allclose(have, want, rtol=1e-8, atol=1e-9)


def test_a_lane_depends_neither_on_its_place_nor_on_the_batch() -> None:
    x0, u = states(29), np.array([1.0, 0.5])
    whole = ARM.stepper(0.01, batch=29, substeps=10)(x0, u)
    alone = ARM.stepper(0.01, batch=1, substeps=10)
    for k in (0, 7, 28):
        assert np.array_equal(alone(x0[k : k + 1], u)[0], whole[k])
    turned = ARM.stepper(0.01, batch=29, substeps=10)(x0[::-1].copy(), u)
    assert np.array_equal(turned[::-1], whole)


def test_threads_change_nothing() -> None:
    x0 = states(640)
    one = ARM.stepper(0.01, batch=640, threads=1, substeps=10)(x0, np.zeros(2))
    two = ARM.stepper(0.01, batch=640, threads=2, substeps=10)(x0, np.zeros(2))
    assert np.isfinite(one).all()
    assert np.array_equal(one, two)


def test_fortran_order_is_used_in_place() -> None:
    x = np.asfortranarray(states(64))
    want = ARM.stepper(0.003, batch=64)(x.copy(), np.ones(2))
    step = ARM.stepper(0.003, batch=64)
    after = step(x, np.ones(2), out=x)
    assert after is x
    assert np.array_equal(x, want)


def test_single_precision_follows_double() -> None:
    x0 = states(16)
    double = ARM.stepper(0.01, batch=16, substeps=10)(x0, np.zeros(2))
    single = ARM.stepper(0.01, batch=16, substeps=10, dtype="float32")(x0.astype(np.float32), np.zeros(2))
    assert single.dtype == np.float32
    error = np.abs(single - double).max() / np.abs(double).max()
    # The accelerations solve M a = r, which no order of additions spoils by more than M's condition number, its rows
    # scaled alike, times the unit roundoff of 24 bits (Higham 2002, Section 10.1): 5e4 * 6e-8, 3e-3.
    scaled = [M / np.sqrt(np.outer(np.diag(M), np.diag(M))) for M in map(ARM.mass_matrix, x0)]
    assert 0 < error < max(map(np.linalg.cond, scaled)) * 2.0**-24 < 4e-3


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: ARM.stepper(0.0, batch=4), "stepper.dt = 0.0 must be > 0"),
        (lambda: ARM.stepper(0.01, batch=0), "stepper.batch = 0 must be an integer from 1"),
        (lambda: ARM.stepper(0.01, method="euler"), "stepper.method = 'euler' must be one of 'rk4'"),
        (lambda: ARM.stepper(0.01, dtype="int32"), "native.dtype = 'int32' must be one of 'float64'"),
        (lambda: ARM.stepper(0.003, batch=4)(np.zeros((3, 12))), r"stepper.x has shape \(3, 12\), must be \(4, 12\)"),
        (lambda: ARM.stepper(0.003, batch=4)(np.zeros((4, 12)), np.zeros(3)), "stepper.u has shape"),
    ],
)
def test_bad_input_is_named(build, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        build()


@pytest.mark.campaign
def test_compiled_plant_gives_the_same_functions() -> None:
    fast = ARM.compile()
    x, u = states(9), np.array([0.3, -0.2])
    assert fast == ARM
    np.testing.assert_allclose(fast.dynamics(x, u), ARM.dynamics(x, u), rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(fast.measure(x[0], u), ARM.measure(x[0], u), rtol=1e-12, atol=1e-14)
    for batch in (x, x[3]):
        for have, want in zip(fast.jacobians(batch, u), ARM.jacobians(batch, u)):
            assert have.shape == want.shape
            np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-9 * np.abs(want).max(initial=1.0))
    assert np.array_equal(fast.jacobians(x, u)[0][4], fast.jacobians(x[4], u)[0])  # a point equals its lane


def test_workspace_refuses_arrays_that_are_not_whole_vectors() -> None:
    kernel = map_kernel(rate_function(ARM), random_points(ARM, np.random.default_rng(0)))
    if kernel.kernel is None:
        pytest.skip("no compiler")
    with pytest.raises(ValueError, match="a multiple of 8"):
        kernel.kernel.bind([np.zeros((1, 12))], [np.zeros((1, 12))])
