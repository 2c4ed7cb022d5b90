"""A Kalman filter of steady gain in C, alone or with the law that acts on its estimate (LQG)."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import Any

import numpy as np

from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.plants.core.signals import names

from .c_text import Law, added, array, each, pushed


def kalman(filter: Kalman, p: str) -> Law:
    """The estimate x (nx,) from [sensors; inputs held since the last sample]."""
    if len(filter.gains) > 1:
        raise ValueError(
            f"export_c: the Kalman filter has {len(filter.gains)} gains, must have the steady one: P0 = None, `design`"
        )
    step, L = filter.steps[-1], filter.gains[-1].L
    n, ns, nu, nx, nb = len(step.A), len(step.C), filter.u0.shape[1], filter.x0.shape[1], step.B.shape[1]
    fresh = copy(filter)
    fresh.reset()
    nominal = {"x0": filter.x0[0], "u0": filter.u0[0], "y0": filter.y0[0], "start": fresh._x}
    matrices = {"A": step.A, "B": step.B, "C": step.C, "D": step.D, "c": step.c, "L": L}
    constants = "".join(array(f"{p}_{name}", value) for name, value in (nominal | matrices).items())
    du, fields = "du", [f"REAL x[{n}];"]
    act = f"int i;\nREAL du[{nu}], off[{ns}], next[{n}];\n" + each("i", nu, f"du[i] = y[{ns} + i] - {p}_u0[i];")
    ahead, reset = "", "int i;\n" + each("i", n, f"s->x[i] = {p}_start[i];")
    if filter.input_delay:  # the first of the inputs on their way are those that act
        du, first = "s->asked", fresh._asked.values
        constants += array(f"{p}_asked", first)
        fields.append(f"REAL asked[{len(first)}];")
        reset += each("i", len(first), f"s->asked[i] = {p}_asked[i];")
        ahead = pushed("asked", len(first), nu, "du[i]")
    ahead += each("i", n, f"next[i] = {p}_c[i];") + added(n, n, "1", f"{p}_A", "s->x", "next")
    ahead += added(n, nb, "1", f"{p}_B", du, "next") + each("i", n, "s->x[i] = next[i];")
    act += "if (s->acts) {\n" + "".join(f"    {line}\n" for line in ahead.splitlines()) + "}\n"
    act += each("i", ns, f"off[i] = y[i] - {p}_y0[i];") + added(ns, n, "-1", f"{p}_C", "s->x", "off")
    act += added(ns, nb, "-1", f"{p}_D", du, "off") + added(n, ns, "1", f"{p}_L", "off", "s->x")
    act += each("i", nx, f"u[i] = {p}_x0[i] + s->x[i];")
    held = tuple(f"held {name}" for name in names(filter.model.inputs))
    what = "Kalman filter: y is the sensors, then the inputs held since the last sample; u is the estimate"
    return Law(p, what, filter.reads + held, nx, tuple(fields), constants, "", reset, act)


def lqg(law: LQG, p: str, code_of: Callable[[Any, str], Law]) -> Law:
    """u = law(estimate), the filter told what was given."""
    inside, seen = code_of(law.law, f"{p}__law"), kalman(law.filter, f"{p}__filter")
    ns, nu, nx = len(law.filter.reads), inside.inputs, seen.inputs
    nominal = np.broadcast_to(law.filter.u0[0], (nu,))
    constants = array(f"{p}_start", nominal)
    act = f"int i;\nREAL known[{ns + nu}], x[{nx}];\n"
    act += each("i", ns, "known[i] = y[i];") + each("i", nu, f"known[{ns} + i] = s->u[i];")
    act += f"{seen.prefix}_act(&s->filter, t, known, x);\n"
    if law._rows is None:
        act += f"{inside.prefix}_act(&s->law, t, x, u);\n"
    else:
        rows, base = law._rows
        constants += array(f"{p}_rows", rows) + array(f"{p}_base", base)
        act = act.replace("x[", f"read[{len(base)}], x[", 1) + each("i", len(base), f"read[i] = {p}_base[i];")
        act += added(len(base), nx, "1", f"{p}_rows", "x", "read")
        act += f"{inside.prefix}_act(&s->law, t, read, u);\n"
    act += each("i", nu, "s->u[i] = u[i];")
    reset = f"int i;\n{seen.prefix}_reset(&s->filter);\n{inside.prefix}_reset(&s->law);\n"
    reset += each("i", nu, f"s->u[i] = {p}_start[i];")
    fields = (f"{seen.prefix}_state filter;", f"{inside.prefix}_state law;", f"REAL u[{nu}];")
    functions = seen.code("static ") + inside.code("static ")
    what = f"u = law(estimate); the law: {inside.what}"
    return Law(p, what, law.reads, nu, fields, constants, functions, reset, act, seen.struct + inside.struct)
