"""C source from CasADi SX functions: straight-line code over a block of lanes, vector by vector.

Every array is structure-of-arrays: `x[k][l]` is element k of lane l in a block of W lanes. Each SX operation is one
assignment to a local constant, a vector of the machine's width; what C has no vector form of is a loop over its lanes
with `#pragma omp simd`. Divisions by the same value share one reciprocal, for a division costs as much as twenty
products.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.toolchain import straight_line
from pliant.plants.toolchain.straight_line import Statement

BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*"}
COMPARE = {ca.OP_LT: "<", ca.OP_LE: "<=", ca.OP_EQ: "==", ca.OP_NE: "!="}
UNARY = {
    ca.OP_ASSIGN: "{0}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_SQRT: "SQRT({0})",
    ca.OP_SIN: "SIN({0})",
    ca.OP_COS: "COS({0})",
    ca.OP_EXP: "EXP({0})",
    ca.OP_TANH: "TANH({0})",
    ca.OP_FABS: "FABS({0})",
    ca.OP_SIGN: "({0} > 0) - ({0} < 0)",
    ca.OP_NOT: "!({0})",
}
ARITHMETIC = (*BINARY, ca.OP_ASSIGN, ca.OP_NEG, ca.OP_SQ, ca.OP_TWICE)  # the same in C for vectors as for numbers


def operations(function: ca.Function) -> int:
    """How many operations an SX function holds."""
    return int(function.n_instructions())


def block_function(name: str, function: ca.Function) -> str:
    """A C function over W lanes: inputs and outputs as T (*)[W], in the order of the SX function's nonzeros."""
    statements, others = _statements(name, function)
    inputs, outputs = [f"i{k}" for k in range(function.n_in())], [f"o{k}" for k in range(function.n_out())]
    return "".join(_each(name, op) for op in sorted(others)) + straight_line.written(name, inputs, outputs, statements)


def _each(name: str, op: int) -> str:
    """A C function of vectors that does an operation lane by lane, which the compiler vectorises."""
    inputs = "ab"[: 1 + (op not in UNARY and op != ca.OP_INV)]
    values = operation(op, [f"((const T *)&{i})[l]" for i in inputs])
    return (
        f"static inline V {name}_each{op}({', '.join(f'V {i}' for i in inputs)}) {{\n"
        f"  V r; LANES for (int l = 0; l < VL; l++) ((T *)&r)[l] = {values}; return r;\n}}\n"
    )


def _statements(name: str, function: ca.Function) -> tuple[list[Statement], set[int]]:
    """What computes a function, and which operations it does lane by lane."""
    register: dict[int, str] = {}
    reciprocal: dict[str, str] = {}
    constants: dict[str, float] = {}
    statements: list[Statement] = []
    others: set[int] = set()

    def add(new: str, value: str, *needs: str, given: bool = False) -> str:
        statements.append(Statement(new, value, tuple(n for n in needs if n not in constants), given))
        return new

    def vector(value: str) -> str:
        return f"ALL({value})" if value in constants else value

    for i in range(function.n_instructions()):
        op, args, out = function.instruction_id(i), function.instruction_input(i), function.instruction_output(i)
        if op == ca.OP_OUTPUT:
            value = register[args[0]]
            add("", f"o{out[0]}[{out[1]} * PER] = {vector(value)};", value)
        elif op == ca.OP_INPUT:
            register[out[0]] = add(f"v{i}", f"i{args[0]}[{args[1]} * PER]", given=True)
        elif op == ca.OP_CONST:
            number = float(function.instruction_constant(i))
            register[out[0]] = literal(number)
            constants[register[out[0]]] = number
        elif op == ca.OP_DIV:
            top, bottom = register[args[0]], register[args[1]]
            if bottom not in reciprocal:
                reciprocal[bottom] = add(f"r{i}", f"(T)1 / {vector(bottom)}", bottom)
            share = reciprocal[bottom]
            value, needs = (share, [share]) if constants.get(top) == 1.0 else (f"{top} * {share}", [top, share])
            register[out[0]] = add(f"v{i}", value, *needs)
        elif op == ca.OP_INV:
            register[out[0]] = add(f"v{i}", f"(T)1 / {vector(register[args[0]])}", register[args[0]])
        else:
            values = [register[a] for a in args]
            if op in ARITHMETIC:
                value = operation(op, list(map(vector, values)) if all(v in constants for v in values) else values)
            else:
                others.add(op)
                value = f"{name}_each{op}({', '.join(map(vector, values[: 1 + (op not in UNARY)]))})"
            register[out[0]] = add(f"v{i}", value, *values)
    return statements, others


def literal(number: float) -> str:
    """A constant in C."""
    text = repr(number)
    return f"(T){text}" if number >= 0 else f"((T){text})"


def operation(op: int, args: list[str]) -> str:
    """An operation on values by their names in C."""
    a = args[0]
    b = args[1] if len(args) > 1 else ""
    if op in BINARY:
        return f"{a} {BINARY[op]} {b}"
    if op in COMPARE:
        return f"(T)({a} {COMPARE[op]} {b})"
    if op in UNARY:
        return UNARY[op].format(a)
    if op == ca.OP_INV:
        return f"(T)1 / {a}"
    if op == ca.OP_FMIN:
        return f"({a} < {b} ? {a} : {b})"
    if op == ca.OP_FMAX:
        return f"({a} > {b} ? {a} : {b})"
    if op == ca.OP_IF_ELSE_ZERO:
        return f"({a} != 0 ? {b} : (T)0)"
    if op == ca.OP_AND:
        return f"(T)({a} != 0 && {b} != 0)"
    if op == ca.OP_OR:
        return f"(T)({a} != 0 || {b} != 0)"
    if op in (ca.OP_POW, ca.OP_CONSTPOW):
        return f"POW({a}, {b})"
    raise NotImplementedError(f"operation {op} has no C form in scalar_codegen.py")
