"""Derivatives of an MPC's first input against central differences of the law, inside its limits and at them."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import MPC, DifferentiableMPC
from pliant.envs import scenes
from pliant.plants import PliantError


def first(law, y):
    law.law.reset()
    return law.law.act(0.0, y)


def central(f, h):
    return (f(h) - f(-h)) / (2 * h)


@pytest.mark.parametrize(
    ("name", "share", "active"), [("single-link-slew", 0.3, 0), ("two-link-reach", 0.3, 0), ("two-link-reach", 1.0, 8)]
)
def test_against_differences(name, share, active):
    """1e-5 is asked; differences leave 1e-7. `active` limits of the plan bind, the first input's not all among them."""
    scene = scenes.get(name)
    law, rng = DifferentiableMPC.for_scene(scene), np.random.default_rng(0)
    nx = scene.plant.nx
    y = scene.target[0] + share * (scene.initial[0] - scene.target[0]) + 1e-3 * rng.normal(size=nx)
    found = law.derivative(y)
    assert found.active == active and found.margin > 1e-4
    np.testing.assert_array_equal(found.u, first(law, y))
    wanted = np.stack([central(lambda h, e=e: first(law, y + h * e), 1e-5) for e in np.eye(nx)], axis=1)
    np.testing.assert_allclose(found.state, wanted, atol=1e-7 * np.abs(wanted).max())
    own = {**law.Q, **law.R}
    for column, weight in zip(found.weights.T, law.names):
        if own[weight]:
            moved = central(lambda h, w=weight: first(law.with_weights({w: own[w] * (1 + h)}), y), 1e-4)
            np.testing.assert_allclose(own[weight] * column, moved, rtol=1e-5, atol=1e-7)

    def with_point(h, e):
        model = law.model
        other = dataclasses.replace(model, x0=model.x0 + h * e, y0=model.y0 + model.C @ (h * e))
        return first(DifferentiableMPC(other, law.Q, law.R, **law._made), y)

    e = rng.normal(size=nx)
    moved = central(lambda h: with_point(h, e), 1e-5)
    np.testing.assert_allclose(found.reference @ e, moved, rtol=1e-5, atol=1e-7 * np.abs(found.reference).max())


def test_a_saturated_input_does_not_move():
    scene = scenes.get("single-link-slew")
    law = DifferentiableMPC.for_scene(scene)
    found = law.derivative(scene.initial[0])
    assert found.u.tolist() == [scene.limits[0]] and found.active > 1
    assert np.abs(found.weights).max() < 1e-9 and np.abs(found.state).max() < 1e-9


def test_its_law_is_the_mpc_of_the_scene():
    scene = scenes.get("single-link-slew")
    same, law = MPC.for_scene(scene), DifferentiableMPC.for_scene(scene)
    for share in (0.2, 1.0):
        y = scene.target[0] + share * (scene.initial[0] - scene.target[0])
        same.reset()
        np.testing.assert_allclose(law.derivative(y).u, same.act(0.0, y), rtol=1e-12)


def test_bad_input():
    scene = scenes.get("single-link-slew")
    law = DifferentiableMPC.for_scene(scene)
    with pytest.raises(ValueError, match=r"DifferentiableMPC\.y"):
        law.derivative(np.zeros(5))
    with pytest.raises(ValueError, match=r"DifferentiableMPC\.with_weights"):
        law.with_weights({"nothing": 1.0})
    with pytest.raises(ValueError, match=r"DifferentiableMPC\.R"):
        DifferentiableMPC(law.model, law.Q, {"hub_torque": 0.0}, dt=0.02)
    with pytest.raises(PliantError, match="point of all states"):
        DifferentiableMPC.for_scene(scenes.get("spin-up"))
    with pytest.raises(PliantError, match="no slope"):
        gentle = DifferentiableMPC.for_scene(scenes.get("single-link-slew-gentle"))
        gentle.derivative(gentle.model.x0 + np.array([0.0, 0.02, 0.0, 0.0, 0.0, 0.0]))
