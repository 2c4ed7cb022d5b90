"""Rodas5P in native code: the virtual machine's numbers, and what is compared before it is used."""

import dataclasses

import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import IntegrationError, SingleLinkArm
from pliant.plants.integration import motion_run
from pliant.plants.motions import adaptive_steps, compile_rule, motion_library
from pliant.plants.native import compiler, kernel_loader
from pliant.plants.native.kernel_loader import NativeWarning
from pliant.plants.rosenbrock import adaptive, library, plant_functions
from pliant.plants.rosenbrock.tableaux import rodas5p

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
ARM = dataclasses.replace(SingleLinkArm.textbook(), kinematics="stiffened", modes=2)
TIMES = np.linspace(0.0, 0.5, 51)


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    for price in ("COMPILING", "LOOKING"):
        monkeypatch.setattr(compile_rule, price, (0.0, 0.0))


def both(monkeypatch, plant, *given, **options):
    found = []
    for native in "01":
        monkeypatch.setenv("PLIANT_NATIVE", native)
        found.append(plant.simulate(*given, method="rodas5p", **options))
    assert [m.stats["native"] for m in found] == [False, True]
    return found


@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
def test_held_and_constant_inputs_give_the_virtual_machines_numbers(monkeypatch, rtol):
    start = np.zeros(ARM.nx)
    start[0] = 0.2
    held = 0.1 * np.random.default_rng(0).normal(size=(len(TIMES), ARM.nu))
    for u in (held, held[0], None):
        slow, fast = both(monkeypatch, ARM, start, u, TIMES, rtol=rtol, atol=rtol / 100)
        assert slow.stats["steps"] == fast.stats["steps"]
        np.testing.assert_allclose(fast.x, slow.x, rtol=1e-9, atol=1e-10 * np.abs(slow.x).max(axis=0).max())


def test_time_and_pauses_and_progress_change_nothing(monkeypatch):
    """x' = sin t: with a pause every 3 steps, and told of 25 times on the way."""
    plant, t = Scalar(rate=0.0), np.linspace(1.0, 2.0, 26)
    slow, fast = both(monkeypatch, plant, [0.0], None, t, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(fast.x[:, 0], np.cos(1.0) - np.cos(t), atol=1e-7)
    monkeypatch.setattr(adaptive, "A_CALL", 3)
    seen = []
    told = plant.simulate([0.0], None, t, method="rodas5p", rtol=1e-8, atol=1e-8, progress=seen.append)
    np.testing.assert_array_equal(told.x, fast.x)
    assert told.stats["steps"] == fast.stats["steps"] == slow.stats["steps"] and seen[-1] == 2.0 and len(seen) > 3


def test_a_controller_is_asked_once_a_period(monkeypatch):
    class Damper:
        dt, reads = 0.05, ("x_rate",)

        def act(self, t, y):
            return [-0.5 * y[0]]

    slow, fast = both(monkeypatch, Oscillator(), [1.0, 0.0], Damper(), TIMES, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(fast.x, slow.x, atol=1e-10)


def test_a_motion_that_ends_says_where(monkeypatch):
    ends = Scalar(ends=True)  # x' = 2 + sqrt(1 - x), no number beyond x = 1
    told = []
    for native in "01":
        monkeypatch.setenv("PLIANT_NATIVE", native)
        with pytest.raises(IntegrationError, match="rodas5p stopped at t = ") as stopped:
            ends.simulate([0.0], None, np.linspace(0.0, 1.0, 11), method="rodas5p")
        told.append(stopped.value)
    np.testing.assert_allclose(told[1].time, told[0].time, rtol=1e-9)
    np.testing.assert_allclose(told[1].state, told[0].state, rtol=1e-9)
    monkeypatch.setattr(adaptive_steps, "MOST_STEPS", 7)
    with pytest.raises(IntegrationError, match=r"rodas5p stopped at .* after 7 steps"):
        Oscillator().simulate([1.0, 0.0], None, TIMES, method="rodas5p")


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("(T)3.0 * k[0][i]", "(T)3.0001 * k[0][i]"),  # a coefficient of a stage
        ("a[i][k] * f->inverse[k];", "a[i][k] * f->inverse[k] * 1.0001;"),  # of the factors
        ("c * ((T)", "c * 1.0001 * ((T)"),  # dense output
        ("f[i] -= each * (", "f[i] -= each * 1.0001 * ("),  # what dense output is off by
        ("o0[1 * PER] = ", "o0[1 * PER] = 1.0001 * "),  # the Jacobian
    ],
    ids=["stage", "factors", "dense", "defect", "jacobian"],
)
def test_a_wrong_library_is_refused(monkeypatch, tmp_path, right, wrong):
    plant = Oscillator(omega=2.25, zeta=0.1)
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(motion_library, "_loaded", {})
    monkeypatch.setattr(kernel_loader, "_told", set())
    library.adaptive_kernel.cache_clear()
    build = compiler.build

    def broken(source):
        assert right in source or "long adaptive" not in source
        return build(source.replace(right, wrong) if "long adaptive" in source else source)

    monkeypatch.setattr(compiler, "build", broken)
    kernel = library.adaptive_kernel(plant)
    with pytest.warns(NativeWarning, match="motions of Oscillator .* by rodas5p.* disagrees with the virtual machine"):
        assert kernel.library(np.inf) is None
    library.adaptive_kernel.cache_clear()


def test_a_pivot_of_zero_is_exchanged(tmp_path):
    """W = [[0, -1], [9, s]] with a Jacobian that makes its first entry nothing."""
    plant, h = Oscillator(omega=3.0), 0.1
    (kernel, path), shift = (library.adaptive_kernel(plant), tmp_path / "pivots.so"), 1 / (rodas5p().gamma * h)
    path.write_bytes(compiler.build(kernel._source()))
    J = np.array([[shift, 1.0, 0.0], [-9.0, 0.0, 0.0]]).reshape(-1, 1)
    given = [np.zeros((1, 1)), np.ones((2, 1)), np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((0, 1)), J]
    found = [np.zeros((2, 1)) for _ in range(4)]
    kernel_loader.Kernel(path, np.dtype(float), 1, "compared_rodas5p")(given, found, (h, 0.4))
    wanted = library.step_reference(plant_functions.rate_function(plant))(*[a.T for a in given], (h, 0.4), 1)
    for have, want in zip(found, wanted):
        np.testing.assert_allclose(have.T, want, rtol=1e-9)


def test_it_is_compiled_once_and_found_again(monkeypatch, tmp_path):
    plant, built, build = Oscillator(omega=np.e), [], compiler.build
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(compiler, "build", lambda source: (built.append(source), build(source))[1])
    for _ in range(2):
        monkeypatch.setattr(motion_library, "_loaded", {})
        library.adaptive_kernel.cache_clear()
        assert plant.simulate([1.0, 0.0], None, TIMES, method="rodas5p").stats["native"]
    assert sum("long adaptive" in source for source in built) == 1


def test_solutions_of_the_reference_are_numpys():
    rng = np.random.default_rng(0)
    W, r = rng.normal(size=(5, 7, 7)), rng.normal(size=(5, 7))
    found = library._solver(W.copy(), lambda values: values)(r)
    np.testing.assert_allclose(found, np.linalg.solve(W, r[:, :, None])[:, :, 0], rtol=1e-10)


def test_its_price_counts_rates_and_directions():
    kernel = library.adaptive_kernel(ARM)
    assert kernel.operations > 2 * plant_functions.rate_function(ARM).n_instructions()
    assert isinstance(motion_run.RosenbrockRun, type)
