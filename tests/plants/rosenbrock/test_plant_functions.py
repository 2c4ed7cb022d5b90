"""What linearly implicit methods take of a plant, against closed forms and central differences."""

import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import SingleLinkArm
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.rosenbrock import plant_functions

ARM = SingleLinkArm.textbook()


def test_slopes_of_an_oscillator_are_its_matrices():
    plant = Oscillator(omega=3.0, zeta=0.5)
    both, drift = plant_functions.slopes(plant)(0.0, [1.0, 2.0], [0.0], [0.0], [])
    np.testing.assert_allclose(both, [[0.0, 1.0, 0.0], [-9.0, -3.0, 1.0]])
    np.testing.assert_array_equal(drift, np.zeros((2, 1)))


def test_time_counts_where_the_rates_depend_on_it():
    """x' = rate x + sin t."""
    plant = Scalar(rate=-2.0)
    assert plant_functions.changing_in_time(plant) and not plant_functions.changing_in_time(ARM)
    assert plant_functions.slopes(plant)(0.3, [1.0], [], [], [])[1] == pytest.approx(np.cos(0.3))
    change = NumericFunction(plant_functions.directional_function(plant))(0.3, [1.0], [], [], [], 2.0, [5.0], [])[0]
    assert change == pytest.approx(2 * np.cos(0.3) - 10.0)


def test_a_direction_is_the_jacobian_times_it_and_the_central_difference():
    rng = np.random.default_rng(3)
    x, v = 0.05 * rng.normal(size=ARM.nx), rng.normal(size=ARM.nx)
    given = (0.0, x, np.ones(ARM.nu), np.zeros(ARM.nw), [])
    along = NumericFunction(plant_functions.directional_function(ARM))(*given, 0.0, v, np.zeros(ARM.nu))[0]
    A = plant_functions.slopes(ARM)(*given)[0][:, : ARM.nx]
    np.testing.assert_allclose(along, A @ v, rtol=1e-10, atol=1e-10 * np.abs(A @ v).max())
    h = 1e-5
    ahead, behind = (ARM.dynamics(x + s * h * v, np.ones(ARM.nu)) for s in (1, -1))
    np.testing.assert_allclose(along, (ahead - behind) / (2 * h), atol=1e-6 * np.abs(along).max())


def test_writing_out_the_jacobian_takes_several_times_the_operations():
    along = plant_functions.directional_function(ARM).n_instructions()
    whole = plant_functions.slopes(ARM).function.n_instructions()
    assert along < 3 * plant_functions.rate_function(ARM).n_instructions() and whole > 1.2 * along
