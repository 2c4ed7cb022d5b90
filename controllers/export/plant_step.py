"""A plant's step and outputs in C: the classical Runge-Kutta method, the input held over the step; and the law that
predicts with it what its late inputs will meet."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np

from pliant.controllers.linear_quadratic.delay import Predictive
from pliant.controllers.riccati.late_inputs import periods_of
from pliant.plants.core.argument_gates import require_seconds
from pliant.plants.core.signals import names
from pliant.plants.dynamics.plant import Plant
from pliant.plants.native.scalar_codegen import literal, operation

from .c_text import Law, array, clipped, each

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


class Step(NamedTuple):
    """Functions NAME_step and NAME_outputs of a plant."""

    step: str
    outputs: str
    arguments: str  # of the step
    reading: str  # of the outputs, before y


def step_functions(plant: Plant, name: str, dt: float, linkage: str = "") -> Step:
    """dt [s] is a constant of the code; `linkage`: "" or "static "."""
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
    arguments, call = f"double t, REAL x[{nx}], const REAL u[{max(plant.nu, 1)}]", "u"
    for letter, count in (("w", plant.nw), ("p", len(plant.varied))):
        arguments += f", const REAL {letter}[{count}]" if count else ""
        call += f", {letter}" if count else ", 0"
    h2 = f"(REAL){dt / 2!r}"
    step = expression_code(f"{name}_rates", f, given, passed) + (
        f"{linkage}void {name}_step({arguments})\n{{\n    REAL k[{nx}], at[{nx}], sum[{nx}];\n    int i;\n"
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
    measured = expression_code(f"{name}_measured", h, given, passed) + (
        f"{linkage}void {name}_outputs({reading}, REAL y[{ny}])\n{{\n    {name}_measured(t, x, {call}, y);\n}}\n\n"
    )
    return Step(step, measured, arguments, reading)


def plant_step(plant: Plant, name: str, dt: float) -> tuple[str, str, str, str]:
    """(what it is, structs, declarations, code)."""
    dt = require_seconds("export_c.dt", dt)
    found = step_functions(plant, name, dt)
    declared = (
        f"/* x(t + {dt!r} s) in the place of x(t), the inputs held */\nvoid {name}_step({found.arguments});\n"
        f"/* the outputs y */\nvoid {name}_outputs({found.reading}, REAL y[{plant.ny}]);\n"
    )
    signals = {"x": plant.states, "u": plant.inputs, "w": plant.disturbances, "p": plant.parameters, "y": plant.outputs}
    lines = [f"{letter}: {', '.join(names(found))}" for letter, found in signals.items() if found]
    what = f"{type(plant).__name__}, {plant.label}: a step of {dt!r} s by the classical Runge-Kutta method\n"
    return what + "\n".join(lines), "", declared, found.step + found.outputs


def predictive(law: Predictive, inside: Law, p: str) -> Law:
    """The law on the state that its input will meet, by the plant's own steps over the inputs on their way."""
    plant, nu, nx, picks = law.plant, inside.inputs, law.plant.nx, law._picks
    wait, part = periods_of(law.delay)
    if part:
        raise ValueError(f"export_c: Predictive.delay = {law.delay} must be whole periods")
    found = step_functions(plant, f"{p}__plant", law.dt / law._ahead.substeps, "static ")
    limited, clip = clipped(p, nu, law._low, law._high)
    constants = array(f"{p}_start", law._ahead.first) + limited
    constants += f"static const int {p}_picks[{len(picks)}] = {{{', '.join(map(str, picks))}}};\n"
    more = ""
    for letter, values in (("w", np.zeros(plant.nw)), ("p", np.asarray(plant.nominal_parameters, dtype=float).ravel())):
        if len(values):
            constants += array(f"{p}_{letter}", values)
            more += f", {p}_{letter}"
    late = f"s->waiting + ((s->first + k) % {wait}) * {nu}"
    act = f"int i, j, k;\nREAL x[{nx}], z[{nx + plant.ny}], seen[{len(picks)}], *v;\n" + each("i", nx, "x[i] = y[i];")
    act += f"for (k = 0; k < {wait}; k++)\n    for (j = 0; j < {law._ahead.substeps}; j++)"
    act += f" {p}__plant_step(0, x, {late}{more});\n" + each("i", nx, "z[i] = x[i];")
    if law._outputs:
        act += f"{p}__plant_outputs(0, x, s->waiting + ((s->first + {wait - 1}) % {wait}) * {nu}{more}, z + {nx});\n"
    act += each("i", len(picks), f"seen[i] = z[{p}_picks[i]];")
    act += f"{inside.prefix}_act(&s->law, t + {wait * law.dt!r}, seen, u);\n"
    act += f"v = s->waiting + s->first * {nu};\n" + each("i", nu, "v[i] = u[i];") + clip.replace("u[i]", "v[i]")
    act += f"s->first = (s->first + 1) % {wait};\n"
    reset = f"int i;\n{inside.prefix}_reset(&s->law);\ns->first = 0;\n"
    reset += each("i", wait * nu, f"s->waiting[i] = {p}_start[i % {nu}];")
    fields = (f"{inside.prefix}_state law;", "int first;", f"REAL waiting[{wait * nu}]; /* inputs on their way */")
    functions = found.step + (found.outputs if law._outputs else "") + inside.code("static ")
    what = f"{wait} periods of delay, predicted by {plant.label}, before: {inside.what}"
    return Law(p, what, law.reads, nu, fields, constants, functions, reset, act, inside.struct)
