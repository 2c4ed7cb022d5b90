"""Gauss's method for a linear model held over blocks of a motion's parts."""

import itertools

import numpy as np
import pytest
from scipy.linalg import expm

from pliant.studies.physics.block_collocation import HeldModel

A = np.array([[0.0, 1.0, 0.0], [-30.0, -0.4, 2.0], [0.5, 0.0, -1.0]])
START = np.array([1.0, -2.0, 0.5])
PUSH = np.array([0.3, -1.0, 2.0])


def exact(ends, models, edges):
    """delta at the ends by matrix exponentials of each block's A, the push held."""
    found = [START]
    for a, b in itertools.pairwise(ends):
        M = models[np.searchsorted(edges, (a + b) / 2, side="right") - 1]
        grown = np.zeros((4, 4))
        grown[:3, :3], grown[:3, 3] = M, PUSH
        found.append((expm(grown * (b - a)) @ np.append(found[-1], 1.0))[:3])
    return np.array(found)


def test_it_converges_at_order_four_over_blocks():
    models, edges = np.array([A, 1.5 * A, A.T]), np.array([0.0, 0.5, 1.0, 2.0])
    errors = []
    for parts in (20, 40, 80):
        ends = np.linspace(0.0, 2.0, parts + 1)
        c = np.broadcast_to(PUSH, (parts, 2, 3))
        delta, _, _ = HeldModel(edges, models).over(ends).response(c, START)
        errors.append(np.abs(delta - exact(ends, models, edges)).max())
    assert (np.log2(np.array(errors[:-1]) / errors[1:]) > 3.8).all()


def test_parts_of_different_lengths_in_a_block_are_each_their_own_step():
    """The same steps with a block for each: one inverse is for equal steps alone."""
    ends = np.array([0.0, 0.1, 0.3, 0.35, 0.7, 1.0])
    c = np.random.default_rng(3).normal(size=(5, 2, 3))
    shared = HeldModel(np.array([0.0, 1.0]), A[None]).over(ends).response(c, START)
    own = HeldModel(ends, np.repeat(A[None], 5, axis=0)).over(ends).response(c, START)
    for a, b in zip(shared, own):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-13)


def test_slopes_at_the_gauss_points_are_those_of_the_model():
    ends = np.linspace(0.0, 1.0, 11)
    c = np.random.default_rng(4).normal(size=(10, 2, 3))
    _, inner, slopes = HeldModel(np.array([0.0, 1.0]), A[None]).over(ends).response(c, START)
    np.testing.assert_allclose(slopes, inner @ A.T + c, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("stiffness", [1e4, 1e8, 1e12])
def test_a_mode_too_fast_for_the_steps_follows_its_load(stiffness):
    """An oscillator of which a step holds many periods, pushed smoothly: the static deflection, to a small part."""
    M = np.array([[0.0, 1.0], [-stiffness, -2 * 0.01 * stiffness**0.5]])
    ends = np.linspace(0.0, 1.0, 21)
    t = (ends[:-1, None] + np.diff(ends)[:, None] * (0.5 + np.array([-1, 1]) * 3**0.5 / 6)).ravel()
    load = (np.sin(np.pi * t / 2) ** 4).reshape(20, 2)
    c = np.stack([np.zeros_like(load), load], axis=2)
    delta, _, _ = HeldModel(np.array([0.0, 1.0]), M[None]).over(ends).response(c, np.zeros(2))
    np.testing.assert_allclose(delta[-1, 0], 1 / stiffness, rtol=0.05)


def test_the_transpose_agrees_with_the_response_to_rounding():
    """Two functionals of deltas at all ends, over blocks and steps of different lengths."""
    rng, ends = np.random.default_rng(5), np.array([0.0, 0.1, 0.3, 0.35, 0.7, 1.0, 1.4])
    steps = HeldModel(np.array([0.0, 0.5, 1.4]), np.array([A, A.T])).over(ends)
    c, weights = rng.normal(size=(6, 2, 3)), rng.normal(size=(7, 3, 2))
    delta = steps.response(c, START)[0]
    influence, of_start = steps.influence(weights)
    found = np.einsum("mgnq,mgn->q", influence, c) + of_start.T @ START
    np.testing.assert_allclose(found, np.einsum("mnq,mn->q", weights, delta), rtol=1e-12)


def test_inputs_of_periods_act_as_what_they_push_and_are_asked_where_each_begins():
    """Held inputs of a law on the states, u = -(2, 1, 0) delta: the exponential of each period under them."""
    ends, B, K = np.linspace(0.0, 2.0, 81), np.array([[0.0], [1.0], [0.5]]), np.array([[2.0, 1.0, 0.0]])
    steps = HeldModel(np.array([0.0, 2.0]), A[None]).over(ends)
    c = np.broadcast_to(PUSH, (80, 2, 3))
    found, _, _ = steps.closed_response(c, np.broadcast_to(B, (80, 2, 3, 1)), START, 4, lambda k, delta: -K @ delta)
    delta, h = START, 0.1
    for k in range(20):
        np.testing.assert_allclose(found[4 * k], delta, atol=1e-5)
        grown = np.zeros((4, 4))
        grown[:3, :3], grown[:3, 3] = A, PUSH - B @ K @ delta
        delta = (expm(grown * h) @ np.append(delta, 1.0))[:3]
    still = steps.closed_response(c, np.zeros((80, 2, 3, 1)), START, 4, lambda k, delta: np.ones(1))
    for one, other in zip(still, steps.response(c, START), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)
