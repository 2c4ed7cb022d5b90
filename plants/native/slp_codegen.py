"""C source of one lane, in which equal operations of a function fill vectors: see slp_packing.py.

Every vector is an array g[N] in memory, for a scalar is read back from there, or spread over a vector, at no cost.
"""

from __future__ import annotations

from collections.abc import Iterable

import casadi as ca

from .expression_graph import Graph
from .scalar_codegen import block_function, literal, operation, operations
from .slp_packing import CONSTANT, Operand, Packing, Vector

GAIN = 1.75  # scalar operations that one operation replaces on average; with fewer, scalar code is as fast or faster
LONGEST = 20_000  # operations among which equal ones are looked for


def lane_function(name: str, function: ca.Function, width: int, registers: int) -> str:
    """A C function of one lane with vectors of `width` elements, called as `scalar_codegen.block_function`'s at W = 1.

    registers: of the machine, that one vector takes. Where vectors gain little, it is block_function's.
    """
    if operations(function) > LONGEST:
        return block_function(name, function)
    graph = Graph(function)
    packing = Packing(graph, width)
    if packing.gain(registers) < GAIN:
        return block_function(name, function)
    inputs = [f"const T (*restrict i{k})[W]" for k in range(function.n_in())]
    outputs = [f"T (*restrict o{k})[W]" for k in range(function.n_out())]
    lines: list[str] = []
    for scalars, numbers in packing.order:
        lines += [_scalar(graph, i) for i in scalars]
        for number in numbers:
            vector = packing.vectors[number]
            lines += _sum(graph, vector, number, width) if vector.op is None else _call(graph, vector, number, width)
    lines += [f"o{k}[{e}][0] = {_value(graph, i)};" for k, e, i in graph.outputs]
    body = "\n".join(f"  {line}" for line in lines)
    return f"static void {name}({', '.join(inputs + outputs)}) {{\n{body}\n}}\n"


def _value(graph: Graph, i: int) -> str:
    node = graph.nodes[i]
    if node.constant is not None:
        return literal(node.constant)
    if node.op == ca.OP_INPUT:
        return f"i{node.where[0]}[{node.where[1]}][0]"
    return f"v{i}" if node.place is None else f"g{node.place[0]}[{node.place[1]}]"


def _added(products: Iterable[tuple[int, str, str]]) -> str:
    one, text = literal(1.0), ""
    for sign, a, b in products:
        text += " - " if sign < 0 else " + "
        text += a if b == one else b if a == one else f"{a} * {b}"
    return text.removeprefix(" + ").strip()


def _scalar(graph: Graph, i: int) -> str:
    node = graph.nodes[i]
    if node.terms:
        value = _added((sign, _value(graph, a), _value(graph, b)) for sign, a, b in node.terms)
    else:
        value = operation(node.op, [_value(graph, a) for a in node.args])
    return f"const T v{i} = {value};"


def _sum(graph: Graph, vector: Vector, number: int, width: int) -> list[str]:
    rows = {k: row for row, k in enumerate(vector.tables)}

    def factor(operand: Operand) -> str:
        kind, which = operand
        return f"g{which}[l]" if kind == "each" else _value(graph, which)

    products = []
    for k, (sign, a, b) in enumerate(vector.shapes):
        first = f"c{number}[{rows[k]}][l]" if k in rows else factor(a)
        products.append((sign, first, literal(1.0) if b[1] == CONSTANT else factor(b)))
    table = ", ".join("{" + ", ".join(map(repr, row)) + "}" for row in vector.tables.values())
    constants = [f"static const T c{number}[{len(rows)}][{width}] ALIGNED = {{{table}}};"] if rows else []
    return [*constants, *_loop(number, width, _added(products))]


def _call(graph: Graph, vector: Vector, number: int, width: int) -> list[str]:
    assert vector.op is not None
    if vector.source is not None:
        return _loop(number, width, operation(vector.op, [f"g{vector.source}[l]"]))
    first = vector.elements[0]  # fills the places that are left
    arguments = [graph.nodes[vector.elements.get(l, first)].args[0] for l in range(width)]
    gathered = ", ".join(_value(graph, i) for i in arguments)
    return [
        f"const T a{number}[{width}] ALIGNED = {{{gathered}}};",
        *_loop(number, width, operation(vector.op, [f"a{number}[l]"])),
    ]


def _loop(number: int, width: int, value: str) -> list[str]:
    return [
        f"T g{number}[{width}] ALIGNED;",
        f"LANES for (int l = 0; l < {width}; l++) g{number}[l] = {value};",
        f"KEEP(g{number});",
    ]
