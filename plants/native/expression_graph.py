"""A function's values in order, with CasADi's products and additions read as sums of products again."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

ADDITIONS = (ca.OP_ADD, ca.OP_SUB, ca.OP_NEG)
PRODUCTS = (ca.OP_MUL, ca.OP_SQ, ca.OP_TWICE)

Term = tuple[int, int, int]  # sign, and the nodes of two factors


@dataclass
class Node:
    """One value: an input (where: argument, element), a constant, a sum of terms, or an operation on earlier nodes."""

    op: int
    args: tuple[int, ...] = ()
    where: tuple[int, int] = (0, 0)
    constant: float | None = None
    terms: list[Term] = field(default_factory=list)
    depth: int = 0  # one more than that of the deepest node it needs
    place: tuple[int, int] | None = None  # the vector and its element that hold it; slp_packing.py

    @property
    def given(self) -> bool:
        """Whether there is nothing to compute."""
        return self.constant is not None or self.op == ca.OP_INPUT


class Graph:
    """nodes: all of them; kept: those that are not just a part of one sum, in order; outputs: (output, element, node).

    A quotient is a product with the reciprocal, of which every divisor has one.
    """

    def __init__(self, function: ca.Function) -> None:
        self.nodes: list[Node] = []
        self.outputs: list[tuple[int, int, int]] = []
        self._constants: dict[float, int] = {}
        self._reciprocals: dict[int, int] = {}
        self.one, self._two = self._constant(1.0), self._constant(2.0)
        self._read(function)
        self._inside = self._parts()
        self.kept = [i for i in range(len(self.nodes)) if i not in self._inside]
        for i in self.kept:
            node = self.nodes[i]
            if node.op in ADDITIONS + PRODUCTS:
                node.terms = self._terms(i)
            below = [a for _, *factors in node.terms for a in factors] or node.args
            node.depth = 1 + max((self.nodes[a].depth for a in below), default=-1)

    def _add(self, op: int, *args: int, where: tuple[int, int] = (0, 0)) -> int:
        self.nodes.append(Node(op, args, where))
        return len(self.nodes) - 1

    def _constant(self, number: float) -> int:
        if number not in self._constants:
            self._constants[number] = self._add(ca.OP_CONST)
            self.nodes[-1].constant = number
        return self._constants[number]

    def _reciprocal(self, of: int) -> int:
        if of not in self._reciprocals:
            self._reciprocals[of] = self._add(ca.OP_INV, of)
        return self._reciprocals[of]

    def _read(self, function: ca.Function) -> None:
        register: dict[int, int] = {}
        for i in range(function.n_instructions()):
            op, args, out = function.instruction_id(i), function.instruction_input(i), function.instruction_output(i)
            if op == ca.OP_OUTPUT:
                self.outputs.append((out[0], out[1], register[args[0]]))
            elif op == ca.OP_INPUT:
                register[out[0]] = self._add(op, where=(args[0], args[1]))
            elif op == ca.OP_CONST:
                register[out[0]] = self._constant(float(function.instruction_constant(i)))
            elif op == ca.OP_DIV:
                register[out[0]] = self._add(ca.OP_MUL, register[args[0]], self._reciprocal(register[args[1]]))
            elif op == ca.OP_INV:
                register[out[0]] = self._reciprocal(register[args[0]])
            elif op == ca.OP_ASSIGN:
                register[out[0]] = register[args[0]]
            else:
                register[out[0]] = self._add(op, *[register[a] for a in args])

    def _parts(self) -> set[int]:
        """Nodes that are used once, by an addition."""
        used: dict[int, list[int]] = {}
        for node in self.nodes:
            for a in node.args:
                used.setdefault(a, []).append(node.op)
        put_out = {i for _, _, i in self.outputs}
        return {
            i
            for i, by in used.items()
            if len(by) == 1 and by[0] in ADDITIONS and i not in put_out and self.nodes[i].op in ADDITIONS + PRODUCTS
        }

    def _terms(self, i: int) -> list[Term]:
        found: list[Term] = []
        waiting = [(1, i)]
        while waiting:
            sign, k = waiting.pop()
            node = self.nodes[k]
            if k != i and k not in self._inside:
                found.append((sign, k, self.one))
            elif node.op in PRODUCTS:
                first = self._two if node.op == ca.OP_TWICE else node.args[0]
                found.append((sign, first, node.args[-1]))
            else:
                waiting.append((sign if node.op == ca.OP_ADD else -sign, node.args[-1]))
                waiting += [(sign, a) for a in node.args[:-1]]
        return found
