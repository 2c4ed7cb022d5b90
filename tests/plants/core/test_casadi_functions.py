"""Functions called with NumPy arrays: one point, batches, shapes, threads, pickles, common subexpressions.

What is built for one plant serves all equal ones, in the same symbols.
"""

import contextlib
import dataclasses
import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.core import casadi_functions
from pliant.plants.core.casadi_functions import FEW, MAPS_KEPT, Built, built_once, function

a, b = ca.SX.sym("a", 2), ca.SX.sym("b")
MADE = function("made", [a, b], [ca.vertcat(a[0] * b, a[1] + b, 1.0), a @ a.T])


def test_one_point_and_a_batch():
    vector, square = MADE(np.array([2.0, 3.0]), 10.0)
    assert vector.tolist() == [20.0, 13.0, 1.0]
    assert square.tolist() == [[4.0, 6.0], [6.0, 9.0]]
    vectors, squares = MADE(np.array([[2.0, 3.0], [1.0, 0.0]]), np.array([[10.0], [5.0]]), batch=2)
    assert vectors.tolist() == [[20.0, 13.0, 1.0], [5.0, 5.0, 1.0]]
    assert squares[1].tolist() == [[1.0, 0.0], [0.0, 0.0]]


def test_rows_and_columns_are_not_exchanged():
    matrix = function("matrix", [a], [ca.SX(ca.vertcat(a.T, 2 * a.T, 3 * a.T))], matrices=True)
    assert matrix(np.array([1.0, 5.0]))[0].tolist() == [[1.0, 5.0], [2.0, 10.0], [3.0, 15.0]]
    column = function("column", [a], [a], matrices=True)
    assert column(np.array([1.0, 5.0]))[0].shape == (2, 1)


def test_results_are_the_callers_own():
    first = MADE(np.array([1.0, 1.0]), 1.0)[0]
    MADE(np.array([7.0, 7.0]), 7.0)
    assert first.tolist() == [1.0, 2.0, 1.0]


def test_threads_and_pickles_give_the_same():
    again = pickle.loads(pickle.dumps(MADE))
    points = np.random.default_rng(0).normal(size=(200, 2))
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda x: again(x, 2.0)[0], points))
    np.testing.assert_array_equal(found, np.column_stack([2 * points[:, 0], points[:, 1] + 2, np.ones(200)]))


def test_many_batch_sizes_do_not_pile_up():
    for size in range(2, 3 * MAPS_KEPT):
        MADE(np.ones((size, 2)), np.ones((size, 1)), batch=size)
    assert len(MADE._local.buffers) <= MAPS_KEPT


def test_a_raw_function_loses_what_it_computes_twice_once_it_is_called_often_and_keeps_its_values():
    twice = function("twice", [a], [ca.sin(a[0] * a[1]) + ca.cos(a[0] * a[1]) + a[0] * a[1]])
    point = np.array([0.3, 0.7])
    operations, first = twice._function.n_instructions(), twice(point)[0]
    for _ in range(FEW):
        again = twice(point)[0]
    assert not twice.raw and twice._function.n_instructions() < operations
    np.testing.assert_array_equal(again, first)


def test_whoever_asks_for_the_function_has_it_without_common_subexpressions():
    twice = function("twice", [a], [ca.sin(a[0] * a[1]) + ca.cos(a[0] * a[1])])
    assert twice.raw and twice.function.n_instructions() < 9 and not twice.raw
    assert twice(np.array([0.3, 0.7]))[0] == pytest.approx(np.sin(0.21) + np.cos(0.21), rel=1e-15)


ARM = SingleLinkArm.textbook()
X = np.array([0.3, 0.01, 0.002, 0.5, 0.1, 0.02])


@dataclass(frozen=True)
class Counted:
    """A stand-in for a plant, which says when it is asked to build."""

    value: Any
    built = 0

    @property
    def nominal(self):
        return self

    @built_once
    def symbols(self):
        type(self).built += 1
        return ca.SX.sym("x")

    @built_once
    def expression(self):
        return self.symbols * self.value


@pytest.fixture(autouse=True)
def emptied(monkeypatch):
    monkeypatch.setattr(built_once, "_kept", type(built_once._kept)())
    monkeypatch.setattr(Counted, "built", 0)


def test_equal_instances_share_what_was_built():
    first, again, other = Counted(2.0), Counted(2.0), Counted(3.0)
    assert again.expression is first.expression and Counted.built == 1
    assert other.expression is not first.expression and Counted.built == 2
    assert first.__dict__["expression"] is first.expression  # found without asking again


def test_all_that_an_instance_takes_is_in_the_same_symbols(monkeypatch):
    """Where its equals were forgotten and built anew in between."""
    monkeypatch.setattr(casadi_functions, "KEPT", 1)
    early, late = Counted(2.0), Counted(2.0)
    symbols = early.symbols
    assert Counted(5.0).symbols is not symbols  # forgets the first
    assert late.symbols is not symbols and late.expression is not None
    assert float(ca.Function("f", [symbols], [early.expression])(4.0)) == pytest.approx(8.0)
    assert len(built_once._kept) == 1


def test_equal_plants_in_two_threads_are_built_once():
    """Each waits for the other, so that both would build if nothing kept them from it."""
    together = threading.Barrier(2, timeout=0.5)

    @dataclass(frozen=True)
    class Slow(Counted):
        @built_once
        def symbols(self):
            with contextlib.suppress(threading.BrokenBarrierError):
                together.wait()
            return ca.SX.sym("x")

    plants = [Slow(2.0), Slow(2.0)]
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(lambda plant: plant.symbols, plants)
    assert first is second and together.broken


def test_what_has_no_hash_builds_its_own():
    assert Counted([1.0]).symbols is not Counted([1.0]).symbols


def test_plants_made_anew_give_the_same_and_build_nothing():
    first, again = SingleLinkArm.textbook(), SingleLinkArm.textbook()
    assert again is not first and again.symbols is first.symbols
    np.testing.assert_array_equal(again.dynamics(X), first.dynamics(X))
    assert again._dynamics is first._dynamics
    assert pickle.loads(pickle.dumps(again)) == first


def test_a_varied_plant_builds_in_its_own_parameters():
    varied, plain = ARM.vary("link.length"), dataclasses.replace(ARM)
    assert varied.symbols is not plain.symbols
    np.testing.assert_allclose(varied.dynamics(X), ARM.dynamics(X), rtol=1e-12)
    doubled = varied.dynamics(X, p=2 * varied.nominal_parameters)
    assert np.abs(doubled - ARM.dynamics(X)).max() > 1e-3
    assert dataclasses.replace(varied, varied=()).symbols is plain.symbols


@pytest.mark.campaign
def test_a_compiled_plant_keeps_its_native_functions_to_itself():
    native = SingleLinkArm.textbook().compile()
    fresh = SingleLinkArm.textbook()
    np.testing.assert_allclose(native.dynamics(X), fresh.dynamics(X), rtol=1e-12)
    assert type(fresh._dynamics) is type(ARM._dynamics)


def test_what_is_kept_by_a_key_is_built_once_by_one_thread():
    made, kept = [], Built()
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda k: kept.of(k % 2, lambda: made.append(k) or object()), range(40)))
    assert len(made) == 2 and len(set(map(id, found))) == 2
