"""RODAS3 over lanes in loops: what `simulate` gives, each lane by itself, with the Jacobian in either form."""

import dataclasses

import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import SingleLinkArm
from pliant.plants.integration import batch_stepper
from pliant.plants.native import compiler, kernel_loader
from pliant.plants.native.kernel_loader import NativeWarning
from pliant.plants.rosenbrock import lanes_source, plant_functions

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
ARM = dataclasses.replace(SingleLinkArm.textbook(), kinematics="stiffened", modes=2)


@pytest.fixture(autouse=True)
def in_loops(monkeypatch):
    monkeypatch.setattr(plant_functions, "STRAIGHT", 0)
    batch_stepper.step_kernel.cache_clear()
    yield
    batch_stepper.step_kernel.cache_clear()


@pytest.mark.parametrize("written_out", [0, 60_000], ids=["directions", "whole"])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_lanes_step_as_simulate_does(monkeypatch, dtype, written_out):
    """Stiff lanes, which exchange rows, beside soft ones."""
    monkeypatch.setattr(plant_functions, "WRITTEN_OUT", written_out)
    rng = np.random.default_rng(0)
    x0, u = 0.01 * rng.normal(size=(5, ARM.nx)), rng.normal(size=(5, ARM.nu))
    step = ARM.stepper(0.05, method="rosenbrock", batch=5, substeps=5, dtype=dtype)
    assert step.native and ("directional" if not written_out else "whole") in step.kernel.source()
    after = step(x0.astype(dtype), u)
    for lane in range(5):
        want = ARM.simulate(x0[lane], u[lane], [0.0, 0.05], method="rosenbrock", step=0.01).x[-1]
        size = np.abs(want).max()
        np.testing.assert_allclose(after[lane], want, atol=(1e-10 if dtype == "float64" else 3e-4) * size)


def test_a_lane_depends_on_nothing_but_itself():
    rng = np.random.default_rng(1)
    x0 = rng.normal(size=(8, ARM.nx)) * 10.0 ** -rng.uniform(1, 4, (8, 1))
    step = ARM.stepper(0.02, method="rosenbrock", batch=8)
    order = rng.permutation(8)
    np.testing.assert_array_equal(step(x0[order]), step(x0)[order])


def test_time_counts_and_nothing_is_written_for_the_rest():
    """x' = sin t from 0."""
    step = Scalar(rate=0.0).stepper(0.5, method="rosenbrock", batch=3, substeps=50)
    after = step(np.zeros((3, 1)), t=1.0)
    np.testing.assert_allclose(after, np.cos(1.0) - np.cos(1.5), atol=1e-8)
    assert "#define TIMED 1" in lanes_source.steps_of(Scalar(), np.dtype(float))
    assert "#define TIMED 0" in lanes_source.steps_of(Oscillator(), np.dtype(float))


def test_wrong_factors_are_refused(monkeypatch, tmp_path):
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(kernel_loader, "_told", set())
    build = compiler.build
    monkeypatch.setattr(compiler, "build", lambda source: build(source.replace("-= part *", "-= (T)1.0001 * part *")))
    with pytest.warns(NativeWarning, match="rosenbrock steps of Oscillator .* disagrees"):
        assert not Oscillator(omega=8.125, zeta=0.3).stepper(0.02, method="rosenbrock", batch=2).native
