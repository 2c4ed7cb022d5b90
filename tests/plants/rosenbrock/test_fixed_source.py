"""RODAS3 in loops: the motions that the written-out step map gives, under every kind of input."""

import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import TwoLinkArm
from pliant.plants.integration import batch_stepper
from pliant.plants.motions import compile_rule, motion_library
from pliant.plants.native import kernel_loader
from pliant.plants.rosenbrock import fixed_source, plant_functions

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
TIMES = np.linspace(0.0, 1.0, 11)


@pytest.fixture(autouse=True)
def in_loops(monkeypatch, tmp_path):
    """Few states too, and nothing is too short to be compiled."""
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(plant_functions, "STRAIGHT", 0)
    monkeypatch.setattr(motion_library, "_loaded", {})
    for price in ("COMPILING", "LOOKING"):
        monkeypatch.setattr(compile_rule, price, (0.0, 0.0))
    batch_stepper.motion_kernel.cache_clear()
    yield
    batch_stepper.motion_kernel.cache_clear()


@pytest.mark.parametrize("u", [[1.0], lambda t: [np.sin(7 * t)], np.sin(7 * TIMES)[:, None]], ids=["1", "u(t)", "held"])
def test_motions_are_those_of_the_virtual_machine(monkeypatch, u):
    plant, found = Oscillator(omega=5.5, zeta=0.2), []
    for native in "01":
        monkeypatch.setenv("PLIANT_NATIVE", native)
        found.append(plant.simulate([1.0, 0.0], u, TIMES, method="rosenbrock", step=0.03))
    assert [m.stats["native"] for m in found] == [False, True]
    np.testing.assert_allclose(found[1].x, found[0].x, rtol=1e-11, atol=1e-12)


def test_time_counts(monkeypatch):
    """x' = sin t: of order three, 1e-2 a step."""
    motion = Scalar(rate=0.0).simulate([0.0], None, TIMES, method="rosenbrock", step=0.01)
    assert motion.stats["native"]
    np.testing.assert_allclose(motion.x[:, 0], 1 - np.cos(TIMES), atol=1e-7)


def test_its_c_holds_no_straight_line_solution():
    """Loops: what it is long by are the rates and their changes, a tenth of the written-out step of twelve states."""
    arm = TwoLinkArm.textbook()
    text = fixed_source.motions_of(arm, "rosenbrock")
    assert "long motion_rosenbrock(" in text and "#define NX 12" in text and "ENTRY(steps_rosenbrock)" in text
    written = plant_functions.rate_function(arm).n_instructions()
    written += plant_functions.directional_function(arm).n_instructions()
    assert written < 0.4 * batch_stepper.step_map(arm, "rosenbrock").n_instructions()
