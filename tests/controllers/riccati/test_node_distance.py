"""How far few intervals leave the cost to go known, against SciPy's adaptive integration of the model between nodes."""

import warnings
from itertools import pairwise

import nodes
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.controllers import TVLQR, riccati
from pliant.controllers.riccati.node_distance import KNOWN, NodeWarning, doubtful, joined, measured, refined
from pliant.plants.linear.ltv import LTVModel

HORIZON, Q, R = 2.0, np.diag([3.0, 0.5]), np.array([[0.1]])
STIFF = 40.0  # [1/s^2]


def spring(s, swing=1.0, stiff=4.0):
    """A, B, c of a spring that stiffens and slackens, pushed by a varying force and a moving base."""
    A = np.array([[0, 1], [-stiff * (1 + 0.5 * swing * np.sin(3 * s)), -0.2]])
    return A, np.array([[0.0], [1 + 0.5 * swing * np.cos(2 * s)]]), 0.3 * swing * np.array([np.sin(s), np.cos(2 * s)])


def along(nodes, swing=1.0, stiff=4.0):
    t, z = np.linspace(0.0, HORIZON, nodes), np.zeros
    A, B, c = (np.array([spring(s, swing, stiff)[i] for s in t]) for i in range(3))
    empty = z((nodes, 2, 0)), z((nodes, 0, 2)), z((nodes, 0, 1)), z((nodes, 0, 0))
    rows = {"c": c, "x": z((nodes, 2)), "u": z((nodes, 1)), "w": z((nodes, 0)), "y": z((nodes, 0))}
    return LTVModel(t, A, B, *empty, **rows, states=("x", "v"), inputs=("u",), disturbances=(), outputs=())


def integrated(rate, span, start):
    return solve_ivp(rate, span, start.ravel(), method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1].reshape(start.shape)


def exact(t, stiff=4.0):
    """[[P, p], [p', r]] at t = 0, by the Riccati differential equation."""

    def rate(s, y):
        W, (A, B, c) = y.reshape(3, 3), spring(s, stiff=stiff)
        F, G, cost = np.zeros((3, 3)), np.vstack([B, [[0]]]), np.zeros((3, 3))
        F[:2, :2], F[:2, 2], cost[:2, :2] = A, c, Q
        return -(F.T @ W + W @ F + cost - W @ G @ np.linalg.solve(R, G.T @ W)).ravel()

    return integrated(rate, (t[-1], 0.0), np.zeros((3, 3)))


def exact_held(t, stiff=4.0):
    """The same with the input held between nodes: motion and cost integrated, then the recursion of [x; u; 1]."""

    def rate(s, y):
        F, (A, B, c) = y[:16].reshape(4, 4), spring(s, stiff=stiff)
        big, cost = np.zeros((4, 4)), np.zeros((4, 4))
        big[:2], cost[:2, :2], cost[2:3, 2:3] = np.column_stack([A, B, c]), Q, R
        return np.concatenate([(big @ F).ravel(), (F.T @ cost @ F).ravel()])

    W, z = np.zeros((3, 3)), [0, 1, 3]
    for a, b in list(pairwise(t))[::-1]:
        y = integrated(rate, (a, b), np.concatenate([np.eye(4).ravel(), np.zeros(16)]))
        F, M = y[:16].reshape(4, 4)[z], y[16:].reshape(4, 4)
        H = M + F.T @ W @ F
        W = H[np.ix_(z, z)] - np.outer(H[z, 2], H[2, z]) / H[2, 2]
    return W


def told_and_true(solve, truth, nodes, stiff):
    """The error of P that is told, with a warning, and of [[P, p], [p', r]] the true one at t = 0."""
    model = along(nodes, stiff=stiff)
    with pytest.warns(NodeWarning, match=r"intervals between 0 and 2 s .* take \d+ or more"):
        made = solve(model, Q, R)
    made = getattr(made, "regulator", made)
    whole, right = made.root[0] @ made.root[0].T, truth(model.t, stiff)
    size = np.sqrt(np.maximum(np.diagonal(made.root @ made.root.transpose(0, 2, 1), axis1=1, axis2=2).max(axis=0), 0))
    return made.error, float((np.abs(whole - right) / np.outer(size, size)).max())


BOTH = pytest.mark.parametrize(("solve", "truth"), [(riccati.tvlqr, exact), (TVLQR.design, exact_held)])


@BOTH
def test_the_error_that_is_told_is_not_less_than_the_true_one(solve, truth):
    found = [told_and_true(solve, truth, nodes, 4.0) for nodes in (3, 4, 5, 6)]
    assert all(told > KNOWN and true <= told for told, true in found)
    assert found[-1][0] < found[0][0]


@BOTH
def test_nodes_that_show_how_a_stiff_spring_varies_may_be_too_far_apart_for_its_steps(solve, truth):
    """Ten intervals, of which the others put what is left out where it is: a step turns the spring by a radian."""
    told, true = told_and_true(solve, truth, 11, STIFF)
    assert told >= true > KNOWN


def test_one_interval_tells_nothing_and_many_are_silent():
    with pytest.warns(NodeWarning, match="not known"):
        assert measured(along(2), "tvlqr", np.zeros((2, 3, 3)), list, 2, along(2).A) == np.inf
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert riccati.tvlqr(along(41), Q, R).error is None and TVLQR.design(along(41), Q, R).regulator.error is None
        assert (
            riccati.tvlqr(along(3, swing=0.0), Q, R).error == 0.0
        )  # a model that does not vary is known from one node


def test_many_nodes_that_do_not_tell_of_each_other_are_measured_too():
    model = along(41)
    jump = np.array(model.A)
    jump[20:, 1, 0] *= 3.0
    fields = {n: getattr(model, n) for n in ("t", "B", "E", "C", "D", "F", "c", "x", "u", "w", "y")}
    signals = {n: getattr(model, n) for n in ("states", "inputs", "disturbances", "outputs")}
    assert doubtful(model, model.A) is False
    with pytest.warns(NodeWarning):
        assert riccati.tvlqr(LTVModel(A=jump, **fields, **signals), Q, R).error > KNOWN


def test_two_steps_at_a_time_are_one_with_the_input_held():
    """Of a constant model: half the step twice is the step."""
    model = along(5, swing=0.0)
    whole, twice = riccati.sampled_along(model, Q, R), joined(riccati.sampled_along(refined(model), Q, R))
    for a, b in zip(whole, twice):
        np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-12)


def test_a_sample_of_the_campaign():
    """Seeds 116 and 233 pulse as narrowly as the nodes are apart: half of them have no order to go by."""
    rows = [nodes.run(seed) for seed in (116, 233, 1, 5, 8)]
    assert not [row for row in rows if row["wrong"]]
