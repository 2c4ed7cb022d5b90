"""Sums of products read back from CasADi's instructions, for expressions counted by hand."""

import casadi as ca
import pytest

from pliant.plants.native.expression_graph import Graph

a, b, c, d = (ca.SX.sym(name) for name in "abcd")


def graph(*results):
    return Graph(ca.Function("f", [a, b, c, d], list(results)))


def value(found, i, inputs):
    """A node's value, by its terms and operations alone."""
    node = found.nodes[i]
    if node.constant is not None:
        return node.constant
    if node.op == ca.OP_INPUT:
        return inputs[node.where[0]]
    if node.terms:
        total = 0.0
        for sign, *factors in node.terms:
            first, second = (value(found, k, inputs) for k in factors)
            total += sign * first * second
        return total
    assert node.op == ca.OP_INV
    return 1.0 / value(found, node.args[0], inputs)


def test_a_sum_of_products_is_one_node():
    """a b - c d + a: three terms, and nothing else to compute."""
    found = graph(a * b - c * d + a)
    last = found.nodes[found.outputs[0][2]]
    assert sorted(sign for sign, *_ in last.terms) == [-1, 1, 1]
    assert [i for i in found.kept if not found.nodes[i].given] == [found.outputs[0][2]]
    assert last.depth == 1


def test_what_two_results_need_is_computed_once():
    shared = a * b
    found = graph(shared + c, shared + d)
    assert len([i for i in found.kept if not found.nodes[i].given]) == 3
    assert [found.nodes[i].depth for _, _, i in found.outputs] == [2, 2]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (a - (b - (c - d)), 2 - 3 + 5 - 7),
        (-(a * b) + c**2, -6 + 25),
        (2 * a + b / d, 4 + 3 / 7),
        (a / d - b / d, (2 - 3) / 7),
    ],
)
def test_signs_squares_doubles_and_quotients(expression, expected):
    found = graph(expression)
    assert value(found, found.outputs[0][2], [2.0, 3.0, 5.0, 7.0]) == pytest.approx(expected, rel=1e-15)


def test_one_divisor_has_one_reciprocal():
    found = graph(a / d, b / d, c / d)
    assert sum(node.op == ca.OP_INV for node in found.nodes) == 1
