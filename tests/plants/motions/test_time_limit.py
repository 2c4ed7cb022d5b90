"""A limit of processor time: motions of every kind stop at it, and are the same to the last bit where it is far."""

import math

import numpy as np
import pytest
from oscillators import Oscillator

from pliant.plants.motions import compile_rule, motion_library, time_limit
from pliant.plants.motions.time_limit import TooLong, check_time, steps_of_a_call, time_left
from pliant.plants.native import kernel_loader

SWING, TIMES = Oscillator(omega=3.0), np.linspace(0.0, 2.0, 21)
WAYS = [{"method": "dop853"}, {"method": "rodas5p"}, {"method": "radau"}, {"method": "cvodes"}]
WAYS += [{"method": method, "step": 0.02} for method in ("rk4", "rk8", "midpoint", "rosenbrock")]
COMPILED = [way for way in WAYS if way["method"] in ("dop853", "rodas5p", "rk4")]


def swung(**options):
    return SWING.simulate([1.0, 0.0], np.ones((21, 1)), TIMES, **options)


@pytest.fixture
def interpreted(monkeypatch):
    monkeypatch.setenv("PLIANT_NATIVE", "0")


@pytest.fixture
def compiled(monkeypatch):
    """Nothing is too short to be compiled."""
    if not kernel_loader.wanted():
        pytest.skip("PLIANT_NATIVE=0: nothing is compiled")
    for price in ("COMPILING", "LOOKING"):
        monkeypatch.setattr(compile_rule, price, (0.0, 0.0))


def ended_at(calls, monkeypatch):
    """The time is over when it has been asked for so many times."""
    told = []

    def clock():
        told.append(None)
        return float(len(told) > calls)

    monkeypatch.setattr(time_limit, "processor_time", clock)
    return told


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way["method"])
def test_every_method_stops_on_the_virtual_machine(way, interpreted, monkeypatch):
    asked = ended_at(8, monkeypatch)
    with pytest.raises(TooLong, match="the motion had come to"), time_limit.time_limit(0.5):
        swung(**way)
    assert len(asked) == 9  # at once, where it is asked next


@pytest.mark.parametrize("way", COMPILED, ids=lambda way: way["method"])
def test_compiled_motions_stop_between_calls_and_are_the_same_where_they_do_not(way, compiled, monkeypatch):
    whole = swung(**way)
    assert whole.stats["native"]
    monkeypatch.setattr(time_limit, "ASKED", 3)  # steps of a call
    with time_limit.time_limit(60.0):
        parts = swung(**way)
    np.testing.assert_array_equal(parts.x, whole.x)
    ended_at(4, monkeypatch)
    with pytest.raises(TooLong), time_limit.time_limit(0.5):
        swung(**way)


def test_of_limits_inside_each_other_the_first_to_end_holds():
    assert time_left() == math.inf and steps_of_a_call(10**6) == 10**6
    with time_limit.time_limit(100.0):
        with time_limit.time_limit(1e9):
            assert 90.0 < time_left() <= 100.0 and steps_of_a_call(10**6) == time_limit.ASKED
        with time_limit.time_limit(10.0):
            assert time_left() <= 10.0
        with pytest.raises(TooLong, match=r"the motion had come to 0\.25 s"), time_limit.time_limit(-1.0):
            check_time(0.25)
        assert time_left() > 90.0
    with time_limit.time_limit(math.inf):
        check_time()
    assert time_left() == math.inf


def test_nothing_is_compiled_that_takes_longer_than_is_left(monkeypatch):
    built = []
    monkeypatch.setenv("PLIANT_NATIVE", "1")
    monkeypatch.setattr(motion_library, "compiler_known", lambda: False)
    monkeypatch.setattr(motion_library, "build", lambda *_: built.append(True))
    kernel = compile_rule.OnDemand(lambda: None, lambda: 1000, "kind", str, str, list, "motions of nothing")
    with time_limit.time_limit(0.5 * kernel.price):
        kernel.library(100.0 * kernel.price)
    assert not built and not kernel.compiled
    kernel.library(100.0 * kernel.price)
    assert built
