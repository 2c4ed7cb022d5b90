"""A motion in one compiled call: where it ends, nothing has looked at the steps in between.

The naive way takes the last row of a call that was told to go on: of x' = x^2 from 1, which is infinite at t = 1, rk4
then gives numbers beyond 1e300, infinity or none at all, and of a plant past the step limit a motion that has grown
without a word. Pliant stops in the step that has no finite result, says when, where and how long that was, checks the
step limit on the way, and refuses a library that is wrong. Exact: x = 1 / (1 - t).
"""

import numpy as np
import pytest
from oscillators import Oscillator
from vibrations import Blowing

from pliant.plants import IntegrationError, StabilityLimitError
from pliant.plants.integration import batch_stepper
from pliant.plants.motions import adaptive_steps, compile_rule, motion_library
from pliant.plants.native import compiler, kernel_loader
from pliant.plants.native.kernel_loader import NativeWarning

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
TIMES = np.linspace(0.0, 4.0, 41)


BLOWING = Blowing()


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    for price in ("COMPILING", "LOOKING"):
        monkeypatch.setattr(compile_rule, price, (0.0, 0.0))


def test_the_naive_way_goes_on_past_infinity():
    step = BLOWING.stepper(0.1, check=False)
    x = np.ones((1, 1))
    for _ in range(40):
        x = step(x)
    assert not np.isfinite(x).all()  # and nothing was raised


@pytest.mark.parametrize(("method", "step"), [("rk4", 0.02), ("rk8", 0.05)])
def test_pliant_stops_in_the_step_that_has_no_result(method, step):
    with pytest.raises(IntegrationError, match=f"{method} diverged at t = .* with a step of {step} s") as stopped:
        BLOWING.simulate([1.0], None, TIMES, method=method, step=step)
    assert 1.0 - step < stopped.value.time < 1.0 + 20 * step and np.isfinite(stopped.value.state).all()
    assert stopped.value.state[0] > 1 / step


def test_an_adaptive_motion_says_that_it_cannot_go_on(monkeypatch):
    with pytest.raises(IntegrationError, match=r"dop853 stopped at t = 1 s, its step having fallen to") as stopped:
        BLOWING.simulate([1.0], None, TIMES)
    assert abs(stopped.value.time - 1.0) < 1e-9
    monkeypatch.setattr(adaptive_steps, "MOST_STEPS", 9)
    with pytest.raises(IntegrationError, match=r"after 9 steps, the last of") as stopped:
        BLOWING.simulate([1.0], None, TIMES)
    np.testing.assert_allclose(stopped.value.state, 1 / (1 - stopped.value.time), rtol=1e-8)


def test_past_the_step_limit_the_motion_is_refused_and_within_it_holds():
    stiff = Oscillator(omega=100.0)  # the limit of rk4: 2.83 / 100 s
    with pytest.raises(StabilityLimitError, match=r"needs a step of at most 0\.02828 s"):
        stiff.simulate([1.0, 0.0], None, TIMES, method="rk4", step=0.05)
    within = stiff.simulate([1.0, 0.0], None, TIMES, method="rk8", step=0.005)
    assert within.stats["native"]
    np.testing.assert_allclose(within.x[:, 0], np.cos(100 * TIMES), atol=1e-4)


def test_a_limit_that_is_passed_on_the_way_is_told_before_what_came_of_it():
    """x' = x^2 + u from -1, then with u = -1e4: x falls to where its mode 2 x is too fast for the step."""
    u = np.where(np.arange(len(TIMES)) < 20, 0.0, -1e4)[:, None]
    told = []
    for native in (False, True):
        with pytest.MonkeyPatch.context() as patch, pytest.raises((StabilityLimitError, IntegrationError)) as stopped:
            patch.setenv("PLIANT_NATIVE", "01"[native])
            BLOWING.simulate([-1.0], u, TIMES, method="rk4", step=0.1)
        told.append((type(stopped.value), str(stopped.value)[:60]))
    assert told[0] == told[1]


def test_a_wrong_library_is_refused_and_the_virtual_machine_goes_on(monkeypatch, tmp_path):
    plant = Oscillator(omega=1.25)
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(motion_library, "_loaded", {})
    monkeypatch.setattr(kernel_loader, "_told", set())
    batch_stepper.motion_kernel.cache_clear()
    build = compiler.build
    monkeypatch.setattr(compiler, "build", lambda source: build(source.replace("x[i] + h * (", "x[i] + 1.001 * h * (")))
    with pytest.warns(NativeWarning, match="motions of Oscillator .* disagrees with the virtual machine"):
        motion = plant.simulate([1.0, 0.0], None, TIMES, method="rk8", step=0.05)
    assert not motion.stats["native"]
    assert len(list(tmp_path.glob("motion-*.so"))) <= 1  # of what is seen on it, which is sound
    np.testing.assert_allclose(motion.x[:, 0], np.cos(1.25 * TIMES), atol=1e-9)
    batch_stepper.motion_kernel.cache_clear()


def test_without_a_compiler_it_is_the_virtual_machines_motion(monkeypatch):
    def missing():
        raise compiler.NoCompiler("no working C compiler: none is installed")

    plant = Oscillator(omega=1.5)
    batch_stepper.motion_kernel.cache_clear()
    monkeypatch.setattr(motion_library, "_loaded", {})
    monkeypatch.setattr(motion_library, "compiler_known", lambda: False)
    monkeypatch.setattr(motion_library, "key", lambda *_: missing())
    monkeypatch.setattr(kernel_loader, "_told", set())
    with pytest.warns(NativeWarning, match="no working C compiler"):
        motion = plant.simulate([1.0, 0.0], None, TIMES, method="rk4", step=0.01)
    assert not motion.stats["native"]
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    np.testing.assert_array_equal(motion.x, plant.simulate([1.0, 0.0], None, TIMES, method="rk4", step=0.01).x)
    batch_stepper.motion_kernel.cache_clear()
