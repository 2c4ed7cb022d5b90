"""The C of a linearly implicit step: sizes, coefficients, and which stages share their rates."""

import pytest
from oscillators import Oscillator, Scalar

from pliant.plants.native import kernel_loader
from pliant.plants.rosenbrock import plant_functions, step_source
from pliant.plants.rosenbrock.tableaux import rodas3, rodas5p


def test_every_coefficient_of_a_stage_stands_in_it():
    text = step_source._stages("rodas5p", rodas5p(), (0.0,))
    for row in (*rodas5p().A, *rodas5p().C):
        for number in row[row != 0]:
            assert repr(abs(float(number))) in text
    assert text.count("rhs(") == 9 and text.count("solved(factors, r, k[") == 8


def test_a_stage_that_stands_where_the_one_before_does_takes_its_rates():
    assert step_source._stages("rodas3", rodas3(), (0.0, 0.5, 1.0)).count("rhs(") == 4  # three stages and the defect


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
@pytest.mark.parametrize(("plant", "timed"), [(Oscillator(), 0), (Scalar(), 1)])
def test_a_column_more_where_time_counts(plant, timed):
    functions = plant_functions.rate_function(plant), plant_functions.directional_function(plant)
    text = step_source.written("rodas5p", rodas5p(), *functions, timed=bool(timed))
    assert f"#define TIMED {timed}\n" in text and f"#define NX {plant.nx}" in text
    for entry in ("ENTRY(rates)", "ENTRY(directions)", "ENTRY(compared_rodas5p)"):
        assert entry in text
