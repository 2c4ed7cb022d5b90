"""When motions are compiled: prices against what the virtual machine has cost, once, and never again where refused."""

import os

import numpy as np
import pytest
from oscillators import Oscillator

from pliant.plants import SingleLinkArm
from pliant.plants.integration.batch_stepper import motion_kernel
from pliant.plants.motions import compile_rule, motion_library
from pliant.plants.motions.compile_rule import OnDemand
from pliant.plants.motions.motion_source import PAIR
from pliant.plants.native import compiler, kernel_loader

needs_compiler = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
LOOK = compile_rule.LOOKING[0] + 1000 * compile_rule.LOOKING[1]
COMPILE = compile_rule.OnDemand(None, lambda: 1000, "", None, None, None, "").price


@pytest.fixture
def asked(monkeypatch):
    """Calls of the cache and of the compiler, neither of which has anything."""
    told = []
    monkeypatch.setenv("PLIANT_NATIVE", "1")
    monkeypatch.setattr(motion_library, "compiler_known", lambda: True)
    monkeypatch.setattr(motion_library, "key", lambda *_: "key")
    monkeypatch.setattr(motion_library, "cached", lambda *_: told.append("cache"))
    monkeypatch.setattr(motion_library, "build", lambda *_: told.append("compiler"))
    return told


def made() -> OnDemand:
    return OnDemand(lambda: None, lambda: 1000, "kind", str, str, list, "motions of nothing")


def test_a_short_motion_asks_for_nothing(asked):
    kernel = made()
    assert kernel.library(0.99 * LOOK) is None and asked == []


def test_a_longer_one_looks_on_disk_once(asked):
    kernel = made()
    for _ in range(3):
        assert kernel.library(0.9 * COMPILE) is None
    assert asked == ["cache"] and not kernel.settled


def test_what_was_spent_counts_and_a_refusal_is_for_good(asked):
    kernel = made()
    kernel.spent = 0.6 * COMPILE
    kernel.library(0.3 * COMPILE)
    assert asked == ["cache"]
    for _ in range(3):
        kernel.library(0.5 * COMPILE)
    assert asked == ["cache", "compiler"] and kernel.settled and kernel.compiled


def test_without_native_code_nothing_is_asked(asked, monkeypatch):
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    kernel = made()
    assert kernel.library(1e9) is None and kernel.settled and asked == []


def test_where_no_compiler_was_ever_asked_the_disk_is_not(monkeypatch, asked):
    monkeypatch.setattr(motion_library, "compiler_known", lambda: False)
    assert made().library(0.9 * COMPILE) is None and asked == []


def test_a_price_is_what_compiling_took_and_at_most_five_times_that():
    """Long functions were priced at a hundred times what they take, and stayed on the virtual machine.

    Taken with gcc 12 at 2.1 GHz: motions of strain beams of 2 to 14 coordinates, and what is seen of them.
    """
    operations = 493, 715, 2144, 6660, 21_009, 54_978, 65_884, 163_620
    took = np.array([0.35, 0.18, 0.64, 0.78, 3.68, 3.62, 5.33, 12.1])
    prices = np.array([OnDemand(None, lambda n=n: n, "", None, None, None, "").price for n in operations])
    assert (prices >= took).all() and (prices <= 5 * took).all()


@needs_compiler
def test_a_library_on_disk_serves_a_motion_that_would_not_pay_for_it(monkeypatch):
    plant, t = Oscillator(omega=2.0), np.linspace(0.0, 2.0, 21)
    motion_kernel(plant, "rk4").spent = 1e9
    plant.simulate([1.0, 0.0], None, t, method="rk4", step=0.1)  # it is on disk by now
    motion_kernel.cache_clear()
    monkeypatch.setattr(motion_library, "_loaded", {})
    built = []
    monkeypatch.setattr(compiler, "build", lambda source: built.append(source))
    assert not plant.simulate([1.0, 0.0], None, t, method="rk4", step=0.1).stats["native"]
    assert plant.simulate([1.0, 0.0], None, t, method="rk4", step=0.002).stats["native"]
    assert plant.simulate([1.0, 0.0], None, t, method="rk4", step=0.1).stats["native"]  # once in memory, for all
    assert built == []


@needs_compiler
def test_an_adaptive_motion_changes_over_on_its_way(monkeypatch):
    """Its steps are not known before: it begins on the virtual machine, and ends where one that stays there does."""
    plant, t = Oscillator(omega=5.0), np.linspace(0.0, 40.0, 401)
    motion_kernel.cache_clear()
    monkeypatch.setattr(compile_rule, "STEPPING", (1e-12, 0.0))
    monkeypatch.setattr(compile_rule, "COMPILING", (5e-10, 0.0))
    motion = plant.simulate([1.0, 0.0], None, t)
    library = motion_kernel(plant, "rk8")
    assert library.compiled or library._library is not None
    assert not motion.stats["native"] and 0.0 < library.spent < motion.stats["seconds"]
    monkeypatch.setitem(os.environ, "PLIANT_NATIVE", "0")
    slow = plant.simulate([1.0, 0.0], None, t)
    assert motion.stats["steps"] == slow.stats["steps"]
    np.testing.assert_allclose(motion.x, slow.x, atol=5 * 200 * np.finfo(float).eps * slow.stats["steps"])


def test_explicit_methods_share_one_kernel():
    """Each had its own: dop853 and rk8 that had looked for the library before rk4's compiled it never looked again."""
    plant = SingleLinkArm.textbook()
    assert motion_kernel(plant, "rk4") is motion_kernel(plant, "rk8") is motion_kernel(plant, PAIR)
    assert motion_kernel(plant, "rk4") is not motion_kernel(plant, "rosenbrock")
