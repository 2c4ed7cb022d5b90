"""The C of a motion by steps of its own: what it holds."""

import pytest
from oscillators import Oscillator

from pliant.plants.native import kernel_loader
from pliant.plants.rosenbrock import adaptive_source, plant_functions
from pliant.plants.rosenbrock.tableaux import rodas5p


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
def test_one_motion_by_the_methods_own_power_of_the_error():
    """The embedded method is of order 4: steps go by the fifth root."""
    plant = Oscillator()
    functions = plant_functions.rate_function(plant), plant_functions.directional_function(plant)
    text = adaptive_source.adaptive_source("rodas5p", rodas5p(), *functions, timed=False)
    assert text.count("long adaptive(") == 1 and "POW(error, (T)-0.2)" in text
    assert text.index("static void stages_rodas5p") < text.index("long adaptive(")
