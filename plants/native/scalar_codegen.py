"""C source from CasADi SX functions: straight-line code over a block of lanes, which the compiler vectorises.

Every array is structure-of-arrays: `x[k][l]` is element k of lane l in a block of W lanes. Each SX operation is one
assignment to a local constant; the loop over l carries `#pragma omp simd`. Divisions by the same value share one
reciprocal, for a division costs as much as twenty products.
"""

from __future__ import annotations

import casadi as ca

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
LONGEST = 20_000  # operations in one function; the compiler's time grows faster than the length


class TooLong(Exception):
    """A function has more operations than a compiler takes in good time."""


def operations(function: ca.Function) -> int:
    """How many operations an SX function holds."""
    return int(function.n_instructions())


def check_length(name: str, function: ca.Function) -> None:
    """Raise TooLong for a function that compilers take too long for."""
    if operations(function) > LONGEST:
        raise TooLong(f"{name} has {operations(function)} operations, at most {LONGEST} are compiled")


def block_function(name: str, function: ca.Function) -> str:
    """A C function over W lanes: inputs and outputs as T (*)[W], in the order of the SX function's nonzeros."""
    check_length(name, function)
    inputs = [f"const T (*restrict i{k})[W]" for k in range(function.n_in())]
    outputs = [f"T (*restrict o{k})[W]" for k in range(function.n_out())]
    lines = [f"static void {name}({', '.join(inputs + outputs)}) {{", "  LANES for (int l = 0; l < W; l++) {"]
    lines += [f"    {line}" for line in _statements(function)]
    return "\n".join([*lines, "  }", "}", ""])


def _statements(function: ca.Function) -> list[str]:
    register: dict[int, str] = {}
    reciprocal: dict[str, str] = {}
    constants: dict[str, float] = {}
    lines: list[str] = []
    for i in range(function.n_instructions()):
        op, args, out = function.instruction_id(i), function.instruction_input(i), function.instruction_output(i)
        if op == ca.OP_OUTPUT:
            lines.append(f"o{out[0]}[{out[1]}][l] = {register[args[0]]};")
            continue
        new = f"v{i}"
        if op == ca.OP_INPUT:
            value = f"i{args[0]}[{args[1]}][l]"
        elif op == ca.OP_CONST:
            number = float(function.instruction_constant(i))
            register[out[0]] = literal(number)
            constants[register[out[0]]] = number
            continue
        elif op == ca.OP_DIV:
            top, bottom = register[args[0]], register[args[1]]
            if bottom not in reciprocal:
                reciprocal[bottom] = f"r{i}"
                lines.append(f"const T r{i} = (T)1 / {bottom};")
            value = reciprocal[bottom] if constants.get(top) == 1.0 else f"{top} * {reciprocal[bottom]}"
        else:
            value = operation(op, [register[a] for a in args])
        lines.append(f"const T {new} = {value};")
        register[out[0]] = new
    return lines


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
