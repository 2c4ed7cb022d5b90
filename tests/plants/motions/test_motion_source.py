"""The C of motions: what it defines, and that a wrong one is noticed before it is used."""

import casadi as ca
import numpy as np
import pytest
from oscillators import Oscillator

from pliant.plants.integration.step_maps import METHODS, step_map
from pliant.plants.motions import motion_source
from pliant.plants.native import kernel_loader

PLANT = Oscillator()


def rates():
    return ca.Function("rate", list(PLANT.symbols), [ca.densify(PLANT.expressions[0])])


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
def test_explicit_methods_share_the_rates():
    source = motion_source.explicit_source(rates(), {name: METHODS[name].input_times for name in ("rk4", "rk8")})
    assert source.count("static void rate(") == 1 and "#define NX 2" in source and "#define NU 1" in source
    for entry in ("long motion_rk4(", "long motion_rk8(", "long adaptive(", "ENTRY(rates)", "ENTRY(steps_rk8)"):
        assert entry in source


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
def test_the_linearly_implicit_method_holds_its_step_map():
    source = motion_source.implicit_source(step_map(PLANT, "rosenbrock"))
    assert "long motion_rosenbrock(" in source and "adaptive" not in source and "#define NU 1" in source


def test_inputs_are_taken_where_a_stage_stands():
    """rk4 reads start, middle, middle, end of its three values; rk8 one value a stage."""
    text = motion_source._explicit_step("rk4", METHODS["rk4"].tableau, METHODS["rk4"].input_times)
    assert [text.count(f"(u + {k} * ahead)") for k in range(4)] == [0, 2, 1, 0]
    text = motion_source._explicit_step("rk8", METHODS["rk8"].tableau, METHODS["rk8"].input_times)
    assert all(text.count(f"(u + {k} * ahead)") == 1 for k in range(1, 12))


def test_coefficients_are_written_to_the_last_digit():
    assert motion_source._sum([(0, 1 / 3), (2, -0.1)]) == f"(T){1 / 3!r} * k[0][i] + ((T)-0.1) * k[2][i]"
    assert np.float64(1 / 3) == float(repr(1 / 3))
