"""What noise between samples is to the Kalman filter: integrated where it is white, held where it is not."""

import numpy as np
import pytest

from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.sensors import Sensor
from pliant.plants import LinearModel, LTVModel

DOUBLE = LinearModel.from_matrices(
    [[0, 1], [0, 0]], [[0], [1]], [[1, 0]], E=[[0], [1]], states=["x", "v"], disturbances=["a"], outputs=["seen"]
)


def seen(noise):
    return (Sensor("other", "seen", "", noise=noise),)


def test_white_noise_is_integrated_and_held_noise_is_not():
    """White acceleration of density q: q [[T^3/3, T^2/2], [., T]], by integration of [s, 1]'[s, 1]; held over T:
    q/T [T^2/2, T]'[T^2/2, T], of which the first is T^3/4. Along a nominal that does not move, the same.
    """
    q, T = 0.3, 0.5
    white = Kalman.design(DOUBLE, seen(0.1), {"a": q}, dt=T)
    held = Kalman.design(DOUBLE, seen(0.1), {"a": q}, dt=T, noise="held")
    for found, first in ((white, T**3 / 3), (held, T**3 / 4)):
        step = found.steps[0]
        right = q * np.array([[first, T**2 / 2], [T**2 / 2, T]])
        np.testing.assert_allclose(step.G @ step.W @ step.G.T, right, rtol=1e-12)
    t, many = T * np.arange(40), {}
    for name in "ABECDF":
        value = getattr(DOUBLE, name)
        many[name] = np.broadcast_to(value, (40, *value.shape))
    rest = {name: np.zeros((40, len(getattr(DOUBLE, f"{name}0")))) for name in "xuyw"}
    signals = {k: getattr(DOUBLE, k) for k in ("states", "inputs", "disturbances", "outputs")}
    ltv = LTVModel(t, **many, c=np.zeros((40, 2)), **rest, **signals)
    along = Kalman.along(ltv, seen(0.1), {"a": q}, P0=np.eye(2))
    np.testing.assert_allclose(along.gains[-1].P, white.covariance, rtol=1e-9)
    with pytest.raises(ValueError, match=r"Kalman\.noise = 'pink' must be one of"):
        Kalman.design(DOUBLE, seen(0.1), {"a": q}, dt=T, noise="pink")


def test_a_reading_that_white_noise_enters_takes_its_mean():
    """x' = w, y = x + w: of w with mean m over T, x gets T m, and the reading m, of variance q/T."""
    model = LinearModel.from_matrices([[0.0]], [[0.0]], [[1.0]], E=[[1.0]], F=[[1.0]], outputs=["seen"])
    q, T = 0.7, 0.1
    step = Kalman.design(model, seen(0.2), {"w1": q}, dt=T).steps[0]
    np.testing.assert_allclose(step.G @ step.W @ step.G.T, [[q * T]], rtol=1e-12)
    np.testing.assert_allclose(step.H @ step.W @ step.H.T, [[q / T]], rtol=1e-12)
    np.testing.assert_allclose(step.G @ step.W @ step.H.T, [[q]], rtol=1e-12)
