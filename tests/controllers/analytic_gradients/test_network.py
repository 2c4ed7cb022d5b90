"""The network's passes: against differences, and a last layer that least squares can set."""

import numpy as np

from pliant.controllers.analytic_gradients.network import Network

NETWORK = Network(3, 2, width=8)
RNG = np.random.default_rng(0)
THETA = NETWORK.start(RNG) + 0.1 * RNG.standard_normal(NETWORK.size)
Z = RNG.standard_normal((5, 3))
WEIGHTS = RNG.standard_normal((5, 2))


def total(theta: np.ndarray, z: np.ndarray) -> float:
    return float((WEIGHTS * NETWORK.forward(NETWORK.layers(theta), z).v).sum())


def test_slopes_are_those_of_differences() -> None:
    at = NETWORK.layers(THETA)
    seen = NETWORK.forward(at, Z)
    dz, d1, d2 = NETWORK.backward(at, seen, WEIGHTS)
    gradient, h = NETWORK.gradient(seen, d1, d2, WEIGHTS), 1e-6
    for i in range(NETWORK.size):
        step = np.zeros(NETWORK.size)
        step[i] = h
        assert abs((total(THETA + step, Z) - total(THETA - step, Z)) / (2 * h) - gradient[i]) < 1e-8
    for i in np.ndindex(Z.shape):
        step = np.zeros(Z.shape)
        step[i] = h
        assert abs((total(THETA, Z + step) - total(THETA, Z - step)) / (2 * h) - dz[i]) < 1e-8


def test_layers_are_views() -> None:
    theta = THETA.copy()
    NETWORK.layers(theta).b3[:] = 7.0
    assert (theta[-2:] == 7.0).all() and len(theta) == NETWORK.size


def test_a_linear_law_is_fitted() -> None:
    network = Network(3, 2, width=64)
    theta = network.start(np.random.default_rng(1))
    assert not network.forward(network.layers(theta), Z).v.any()
    z = np.random.default_rng(2).uniform(-1.0, 1.0, (2000, 3))
    law = z @ np.array([[0.5, -0.2], [0.1, 0.4], [0.0, 0.3]]) + [0.1, -0.2]
    network.fit_output(theta, z, law)
    off = network.forward(network.layers(theta), z).v - law
    assert np.sqrt(np.mean(off**2)) < 0.01 * np.sqrt(np.mean(law**2))


def test_a_law_that_is_cut_off_is_fitted_before_the_cut() -> None:
    """A law of slope 10, within its limits at one point in fifteen; plain least squares of what is left is 0.11 off."""
    network = Network(2, 1, width=32)
    theta = network.start(np.random.default_rng(1))
    z = np.random.default_rng(2).uniform(-2.0, 2.0, (2000, 2))
    law = np.clip(z @ np.array([[10.0], [-2.5]]), -1.0, 1.0)
    network.fit_output(theta, z, law)
    found = np.clip(network.forward(network.layers(theta), z).v, -1.0, 1.0)
    assert np.mean(np.abs(found - law)) < 0.05
