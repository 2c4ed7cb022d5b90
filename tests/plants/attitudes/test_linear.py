"""Linear models along motions of plants with quaternions, against the difference of two motions."""

import dataclasses

import numpy as np
import pytest
from moved_states import moved

from pliant.plants import LinearModel, LTVModel
from pliant.plants.core.quaternions import product, quaternion


def test_along_a_motion(craft):
    """The error of the LTV model falls with the square of the deviation."""
    x, t = moved(craft, 5, 0.5), np.linspace(0, 1, 101)
    motion = craft.simulate(x, [0.3], t)
    model = craft.linearize_along(motion)
    assert isinstance(model, LTVModel)
    np.testing.assert_allclose(model.c, 0.0, atol=1e-6)
    xi = np.random.default_rng(6).uniform(-1, 1, craft.small.n)
    errors = []
    for h in (1e-2, 1e-3):
        near = craft.simulate(apart(craft, x, h * xi), [0.3], t)
        predicted = model.simulate(h * xi)[0][-1]
        errors.append(np.abs(between(craft, motion.x[-1], near.x[-1]) - predicted).max())
    assert errors[1] < 2e-2 * errors[0]
    assert errors[1] < 1e-5


def apart(plant, x, xi):
    """The state that is away from x by deviations, exactly in the turns."""
    y = x + plant.small.forward(x) @ xi
    for a in plant.attitudes:
        y[a.quaternion] = product(x[a.quaternion], quaternion(xi[plant.small.turn(a)]))
    return plant.consistent(y)


def between(plant, x, y):
    return plant.small.back(x) @ (y - x)


def test_signs(craft):
    """A nominal whose quaternion changes its sign without rates is refused; with them it is the same model."""
    motion = craft.simulate(moved(craft, 5, 0.5), [0.3], np.linspace(0, 0.5, 26))
    a = craft.attitudes[0]
    x = motion.x.copy()
    x[10:, a.quaternion] *= -1
    flipped = dataclasses.replace(motion, x=x, dx=None)
    with pytest.raises(ValueError, match=r"the quaternion of 'base' changes its sign at t = 0\.2 s"):
        craft.linearize_along(flipped)
    x[3, a.quaternion] *= 2
    with pytest.raises(ValueError, match=r"FlexibleTree\.x: the quaternion of 'base' has norm 2, must be 1"):
        craft.linearize_along(dataclasses.replace(motion, x=x))


def test_own_states(craft):
    x = moved(craft, 7)
    model = craft.linearize(x, attitude="quaternion")
    assert isinstance(model, LinearModel)
    np.testing.assert_array_equal(model.A, craft.jacobians(x)[0])
    with pytest.raises(ValueError, match=r"linearize\.attitude = 'euler' must be one of"):
        craft.linearize(x, attitude="euler")


def test_jumps(craft):
    """An impulse changes speeds alone: turns pass, and the map is that of the equations."""
    x = moved(craft, 8, 0.3)
    after = x.copy()
    after[len(craft.coordinates) :] += (craft.jacobians(x)[1] @ [0.2])[len(craft.coordinates) :]
    J, j = craft.jump_map(x, np.array([0.2]), after=after)
    n = craft.small.n // 2
    np.testing.assert_allclose(J[:n, :n], np.eye(n), atol=1e-12)
    np.testing.assert_allclose(j, 0.0, atol=1e-10)
    after[craft.attitudes[0].quaternion] = [0, 1, 0, 0]
    with pytest.raises(ValueError, match="the attitude of 'base' jumps by"):
        craft.jump_map(x, np.array([0.2]), after=after)
