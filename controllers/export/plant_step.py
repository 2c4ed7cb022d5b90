"""A plant's step and outputs in C: the classical Runge-Kutta method, the input held over the step."""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.argument_gates import require_seconds
from pliant.plants.core.signals import names
from pliant.plants.dynamics.plant import Plant
from pliant.plants.native.scalar_codegen import literal, operation

LONGEST = 30_000  # operations of a right-hand side past which compilers take minutes


def expression_code(name: str, function: ca.Function, inputs: tuple[str, ...], arguments: str) -> str:
    """A C function that writes an SX function's one output to `out`, one statement an operation."""
    register: dict[int, str] = {}
    lines: list[str] = []
    for i in range(function.n_instructions()):
        op, args, out = function.instruction_id(i), function.instruction_input(i), function.instruction_output(i)
        if op == ca.OP_OUTPUT:
            lines.append(f"out[{out[1]}] = {register[args[0]]};")
        elif op == ca.OP_INPUT:
            source = inputs[args[0]]
            register[out[0]] = f"(REAL){source}" if source == "t" else f"{source}[{args[1]}]"
        elif op == ca.OP_CONST:
            register[out[0]] = literal(float(function.instruction_constant(i)))
        else:
            values = [f"({v})" if v.startswith(("(", "-")) else v for v in (register[a] for a in args)]
            text = f"{values[0]} / {values[1]}" if op == ca.OP_DIV else operation(op, values)
            lines.append(f"const REAL v{i} = {text};")
            register[out[0]] = f"v{i}"
    body = "".join(f"    {line}\n" for line in lines)
    unused = "".join(f"    (void){v};\n" for v in dict.fromkeys(inputs))
    return f"static void {name}({arguments}, REAL *out)\n{{\n{body}{unused}}}\n\n"


def plant_step(plant: Plant, name: str, dt: float) -> tuple[str, str, str, str]:
    """(what it is, structs, declarations, code); dt [s] is a constant of the code."""
    dt = require_seconds("export_c.dt", dt)
    t, x, u, w, p = plant.symbols
    rates, outputs = (ca.densify(e) for e in plant.expressions)
    f = ca.Function("f", [t, x, u, w, p], [ca.cse(rates)])
    h = ca.Function("h", [t, x, u, w, p], [ca.cse(outputs)])
    if f.n_instructions() > LONGEST:
        raise ValueError(
            f"export_c: {plant.label} has {f.n_instructions()} operations, at most {LONGEST} are written: "
            "take a smaller rung"
        )
    nx, ny = plant.nx, plant.ny
    given, passed = ("t", "x", "u", "w", "p"), "double t, const REAL *x, const REAL *u, const REAL *w, const REAL *p"
    code = expression_code(f"{name}_rates", f, given, passed)
    code += expression_code(f"{name}_measured", h, given, passed)
    arguments, call = f"double t, REAL x[{nx}], const REAL u[{max(plant.nu, 1)}]", "u"
    for letter, count in (("w", plant.nw), ("p", len(plant.varied))):
        arguments += f", const REAL {letter}[{count}]" if count else ""
        call += f", {letter}" if count else ", 0"
    h2 = f"(REAL){dt / 2!r}"
    code += (
        f"void {name}_step({arguments})\n{{\n    REAL k[{nx}], at[{nx}], sum[{nx}];\n    int i;\n"
        f"    {name}_rates(t, x, {call}, k);\n"
        f"    for (i = 0; i < {nx}; i++) {{\n        sum[i] = k[i];\n        at[i] = x[i] + {h2} * k[i];\n    }}\n"
        f"    {name}_rates(t + {dt / 2!r}, at, {call}, k);\n"
        f"    for (i = 0; i < {nx}; i++) {{\n        sum[i] += 2 * k[i];\n        at[i] = x[i] + {h2} * k[i];\n    }}\n"
        f"    {name}_rates(t + {dt / 2!r}, at, {call}, k);\n"
        f"    for (i = 0; i < {nx}; i++) {{\n        sum[i] += 2 * k[i];\n"
        f"        at[i] = x[i] + (REAL){dt!r} * k[i];\n    }}\n"
        f"    {name}_rates(t + {dt!r}, at, {call}, k);\n"
        f"    for (i = 0; i < {nx}; i++) x[i] += (REAL){dt / 6!r} * (sum[i] + k[i]);\n}}\n\n"
    )
    reading = arguments.replace("REAL x", "const REAL x")
    code += f"void {name}_outputs({reading}, REAL y[{ny}])\n{{\n    {name}_measured(t, x, {call}, y);\n}}\n"
    declared = (
        f"/* x(t + {dt!r} s) in the place of x(t), the inputs held */\nvoid {name}_step({arguments});\n"
        f"/* the outputs y */\nvoid {name}_outputs({reading}, REAL y[{ny}]);\n"
    )
    signals = {"x": plant.states, "u": plant.inputs, "w": plant.disturbances, "p": plant.parameters, "y": plant.outputs}
    lines = [f"{letter}: {', '.join(names(found))}" for letter, found in signals.items() if found]
    what = f"{type(plant).__name__}, {plant.label}: a step of {dt!r} s by the classical Runge-Kutta method\n"
    return what + "\n".join(lines), "", declared, code
