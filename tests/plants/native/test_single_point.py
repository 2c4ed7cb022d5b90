"""Functions of one point as native code: the virtual machine's numbers, when it pays, where it is not to be had."""

import pickle

import casadi as ca
import numpy as np
import pytest

from pliant.plants import SliderCrank, TwoLinkArm
from pliant.plants.core.casadi_functions import LONG
from pliant.plants.integration.step_maps import step_map
from pliant.plants.native import compiler, kernel_loader, single_point

needs_compiler = pytest.mark.skipif(
    not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: the virtual machine is under test"
)


def rate_of(plant) -> ca.Function:
    return ca.Function("rate", list(plant.symbols), [plant.expressions[0]])


@needs_compiler
@pytest.mark.parametrize("plant", [TwoLinkArm.textbook(), SliderCrank.textbook()], ids=["arm", "crank"])
def test_native_code_gives_the_virtual_machines_numbers(plant) -> None:
    """Every operation is rounded as IEEE 754 says, none is contracted or moved: nothing is left to the compiler."""
    machine = rate_of(plant)
    native = single_point.compiled(machine)
    assert native.class_name() == "External"
    draw = np.random.default_rng(5).normal
    for _ in range(20):
        point = [0.3 * draw(size=machine.size_in(i)) for i in range(machine.n_in())]
        np.testing.assert_array_equal(np.array(native.call(point)[0]), np.array(machine.call(point)[0]))


def test_without_native_code_it_is_the_function_itself(monkeypatch) -> None:
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    machine = rate_of(TwoLinkArm.textbook())
    assert single_point.compiled(machine) is machine


@needs_compiler
@pytest.mark.parametrize("shape", [ca.sin, lambda x: ca.sqrt(0.05 - x)], ids=["finite", "finite near zero alone"])
def test_a_function_that_disagrees_is_not_used(monkeypatch, tmp_path, shape) -> None:
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(single_point, "_made", {})
    x = ca.SX.sym("x")
    machine = ca.Function("rate", [x], [shape(x) * 1.25])
    writes = compiler.build
    monkeypatch.setattr(compiler, "build", lambda source, flags: writes(source.replace("1.25", "1.5"), flags))
    monkeypatch.setattr(kernel_loader, "_told", set())
    with pytest.warns(kernel_loader.NativeWarning, match="disagrees with the virtual machine by 0.2"):
        assert single_point.compiled(machine) is machine
    monkeypatch.setattr(compiler, "build", writes)
    assert single_point.compiled(machine) is not machine  # nothing wrong was left in the cache


@pytest.mark.parametrize("operations", [1, 10, 324, 3659, LONG])
def test_waiting_costs_at_most_as_much_again(operations: int) -> None:
    """After as many calls the virtual machine has lost what compiling costs, to one call."""

    class Counted:
        def n_instructions(self) -> int:
            return operations

    calls = single_point.pays_after(Counted())
    lost = single_point.SAVED * operations * calls
    cost = single_point.START + single_point.PER_OPERATION * operations
    assert cost < lost <= cost + single_point.SAVED * operations


@needs_compiler
def test_a_step_map_goes_on_bit_for_bit_once_it_is_compiled(monkeypatch) -> None:
    plant = SliderCrank.textbook()
    monkeypatch.setattr(single_point, "pays_after", lambda function: 3)
    often = single_point.OftenCalled(step_map(plant, "rk4"))
    at = (0.0, np.full(plant.nx, 0.1), np.zeros(3 * plant.nu), np.zeros(plant.nw), np.zeros(0), 1e-5)
    found = [often(*at)[0] for _ in range(5)]
    assert often._function.class_name() == "External"
    np.testing.assert_array_equal(found[1:], found[:-1])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(often))(*at)[0], found[0])
