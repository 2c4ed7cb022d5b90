"""Parameters as inputs: rates and slopes are those of the plant with these parameters."""

import numpy as np

from pliant.envs import scenes
from pliant.envs.gradients.parameter_inputs import ParameterInputs
from pliant.plants.core.casadi_functions import function


def test_rates_and_slopes_are_the_plants() -> None:
    plant, rng = scenes.get("single-link-slew").varied_plant, np.random.default_rng(0)
    steered = ParameterInputs(plant)
    assert steered == ParameterInputs(plant) and hash(steered) == hash(ParameterInputs(plant))
    x, u, c = 0.1 * rng.standard_normal((1, plant.nx)), np.array([[2.0]]), np.array([[0.5, -0.3]])
    rest = np.zeros((1, 1)), x, np.hstack([u, c]), np.zeros((1, plant.nw)), np.zeros((1, 0))
    p = plant.nominal_parameters + steered.scale * c
    rate = steered._dynamics(*rest, batch=1)[0]
    np.testing.assert_allclose(rate, plant.dynamics(x, u, p=p), rtol=1e-10)
    slopes = function("slopes", list(steered.symbols), [steered.slopes()], matrices=True)(*rest, batch=1)[0][0]
    h = 1e-5
    for k in range(2):
        step = h * steered.scale * np.eye(2)[k]
        change = (plant.dynamics(x, u, p=p + step) - plant.dynamics(x, u, p=p - step))[0] / (2 * h)
        np.testing.assert_allclose(slopes[:, plant.nx + 1 + k], change, rtol=1e-5, atol=1e-7 * np.abs(change).max())
