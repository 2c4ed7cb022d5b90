"""MPC about an equilibrium in C: the law without limits, and a quadratic program of fixed size where it breaks one.

The program is the controller's own (least_distance_qp.py), solved from no active set at each sample (qp_source.py).
Where that fails, the C code gives the law without limits, within the limits, and counts a failure.
"""

from __future__ import annotations

import numpy as np

from pliant.controllers.mpc.exact_penalty import SLACK
from pliant.controllers.mpc.mpc import MPC
from pliant.controllers.solvers.daqp_model import CURVATURE

from .c_text import Law, added, array, clipped, each, number
from .qp_source import QP

DOUBLE = {"TOLERANCE": 1e-9, "DEFINITE": 1e-12, "KEPT": 1e-6}  # the violation of a row that passes for none, the share
SINGLE = {"TOLERANCE": 2e-6, "DEFINITE": 2e-6, "KEPT": 2e-2}  # of a row's square that others leave, a row that is kept


def mpc(law: MPC, p: str, precision: str) -> Law:
    """Of one step, whose state is read: not along a nominal, not free of offset."""
    if len(law._steps) != 1:
        raise ValueError(f"export_c: an MPC along a nominal has {len(law._steps)} programs, must be about a goal")
    if law.tracked:
        raise ValueError(f"export_c: MPC.track = {tuple(law.tracked)} needs its estimator, which has no C form")
    step, limits, single = law._steps[0], law.limits, precision == "single"
    (m, nz), nu, size = step.solver.M.shape, len(step.u), step.G.shape[1]
    ny = len(law.reads)
    limited, clip = clipped(p, nu, limits.low, limits.high)
    constants = array(f"{p}_G", step.G[m:]) + array(f"{p}_u0", step.u) + limited
    fields: list[str] = []
    start = f"int i;\nREAL known[{size}];\n" + each("i", ny, "known[i] = y[i];")
    reset = ""
    if law._drift is not None:
        constants += array(f"{p}_drift", law._drift)
        start += each("i", ny, f"known[i] -= (REAL)({p}_drift[i] * t);")
    if limits.remembers:
        constants += array(f"{p}_last", np.clip(law.origin[1], limits.low, limits.high))
        constants += array(f"{p}_change", limits.change)
        fields.append(f"REAL last[{nu}];")
        reset = "int i;\n" + each("i", nu, f"s->last[i] = {p}_last[i];")
        start += each("i", nu, f"known[{size - nu} + i] = s->last[i];")
    act = each("i", nu, f"u[i] = {p}_u0[i];") + added(nu, size, "1", f"{p}_G", "known", "u")
    functions = ""
    if m:
        soft = step.solver.soft
        price = max(step.solver.penalty, 1e-12) / 2
        constants += array(f"{p}_rows", step.G[:m]) + array(f"{p}_low_rows", step.low)
        constants += array(f"{p}_high_rows", step.high) + array(f"{p}_M", step.solver.M)
        constants += array(f"{p}_first", step.first)
        constants += f"static const char {p}_soft[{m}] = {{{', '.join(str(int(v)) for v in soft)}}};\n"
        numbers = (SINGLE if single else DOUBLE) | {"PRICE": price, "COMPLIANCE": 1 / (CURVATURE * price)}
        constants += f"enum {{ {p}_ROWS = {m}, {p}_NZ = {nz}, {p}_ROUNDS = {10 * (m + nz)} }};\n"
        constants += "".join(f"#define {p}_{name} ({number(value)})\n" for name, value in numbers.items())
        functions = QP.replace("NAME", p)
        act += _limited(p, (m, nz, nu, size), law.exact and bool(soft.any()))
        fields += ["long failures; /* programs that were not solved */", f"{p}_work work;"]
        reset += "s->failures = 0;\n"
    act += clip
    if limits.remembers:
        held = f"if (u[i] > s->last[i] + {p}_change[i]) u[i] = s->last[i] + {p}_change[i];"
        other = f"if (u[i] < s->last[i] - {p}_change[i]) u[i] = s->last[i] - {p}_change[i];"
        act += each("i", nu, f"{{\n    {held}\n    {other}\n    s->last[i] = u[i];\n}}")
    what = f"MPC, horizon {law.horizon}: {m} rows, {nz} unknowns"
    return Law(
        p, what, law.reads, nu, tuple(fields), constants, functions, reset, start + act, _work(p, m, nz) if m else ""
    )


def _work(p: str, m: int, nz: int) -> str:
    """The struct in which the program is solved."""
    return (
        f"typedef struct {{\n    int count, set[{m}];\n    signed char side[{m}], yields[{m}];\n"
        f"    REAL mu[{m}], d[{m}], dz[{nz}], z[{nz}], lower[{m}], upper[{m}], K[{m * (m + 1) // 2}];\n}} {p}_work;\n"
    )


def _limited(p: str, sizes: tuple[int, int, int, int], exact: bool) -> str:
    """Statements that add the first input of the plan where the law without limits breaks a row."""
    m, nz, nu, size = sizes
    body = (
        "{\n    NAME_work *w = &s->work;\n    int broken = 0, found;\n"
        "    for (i = 0; i < NAME_ROWS; i++) w->d[i] = 0;\n"
        f"    {added(m, size, '1', 'NAME_rows', 'known', 'w->d')}"
        "    for (i = 0; i < NAME_ROWS; i++) {\n"
        "        w->lower[i] = NAME_low_rows[i] - w->d[i];\n        w->upper[i] = NAME_high_rows[i] - w->d[i];\n"
        "        if (w->lower[i] > 0 || w->upper[i] < 0) broken = 1;\n    }\n"
        "    if (broken) {\n        found = NAME_qp(w, w->lower, w->upper, 0, w->z);\n"
    )
    if exact:
        wider = "            for (i = 0; i < NAME_ROWS; i++) {\n"
        wider += "                w->lower[i] -= SLACK * (REAL)NAME_soft[i];\n"
        wider += "                w->upper[i] += SLACK * (REAL)NAME_soft[i];\n            }\n"
        body += (
            "        for (i = 0; i < w->count && found == 1; i++)\n            if (w->yields[w->set[i]]) found = 2;\n"
            "        if (found == 2) { /* is there a plan without excess? */\n"
            f"            REAL soft[{nz}];\n            int hard;\n"
            "            for (i = 0; i < NAME_NZ; i++) soft[i] = w->z[i];\n"
            "            hard = NAME_qp(w, w->lower, w->upper, 1, w->z);\n"
            f"            if (hard != 1) {{\n{wider.replace('            ', '                ')}"
            "                hard = NAME_qp(w, w->lower, w->upper, 1, w->z);\n            }\n"
            "            if (hard != 1)\n                for (i = 0; i < NAME_NZ; i++) w->z[i] = soft[i];\n"
            "            found = 1;\n        }\n"
        ).replace("SLACK", number(SLACK))
    body += (
        f"        if (found == 1) {added(nu, nz, '1', 'NAME_first', 'w->z', 'u').strip()}\n"
        "        else s->failures++;\n    }\n}\n"
    )
    return body.replace("NAME", p)
