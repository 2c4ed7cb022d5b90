"""MPC in C: the law without limits, and a quadratic program of fixed size where it breaks one.

The program is the controller's own (least_distance_qp.py), solved from no active set at each sample (qp_source.py).
Where that fails, the C code gives the law without limits, within the limits, and counts a failure. Along a nominal
every node has a program of its own, whose references and held inputs are part of its constants.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.controllers.mpc.exact_penalty import SLACK
from pliant.controllers.mpc.mpc import MPC
from pliant.controllers.solvers.daqp_model import CURVATURE

from .c_text import Law, added, array, clipped, each, indented, number, pushed, require_room
from .offset_free import Parts, offset_free
from .qp_source import PROGRAM, QP

DOUBLE = {"TOLERANCE": 1e-9, "DEFINITE": 1e-12, "KEPT": 1e-6}  # the violation of a row that passes for none, the share
SINGLE = {"TOLERANCE": 2e-6, "DEFINITE": 2e-6, "KEPT": 2e-2}  # of a row's square that others leave, a row that is kept


def mpc(law: MPC, p: str, precision: str) -> Law:
    """About a goal or along a nominal, free of offset or not."""
    steps, limits, single = law._steps, law.limits, precision == "single"
    step, nodes = steps[0], len(steps)
    (m, nz), nu, size = step.solver.M.shape, len(step.u), step.G.shape[1]
    _require_small(law, single)
    tracked = offset_free(law, p, single) if law.tracked else Parts(rows=0, unknowns=0)
    limited, clip = clipped(p, nu, limits.low, limits.high)
    constants = _each_node(p, "G", [s.G[m:] for s in steps]) + _each_node(p, "u0", [s.u for s in steps]) + limited
    constants += array(f"{p}_drift", law._drift) if law._drift is not None else ""
    fields, reset = list(tracked.fields), tracked.reset
    start, act = _known(law, p, tracked), ""
    begun = np.zeros(0) if law._knowledge is None else law._knowledge._way.first
    if late := len(begun):
        constants += array(f"{p}_begun", begun)
        fields.append(f"REAL way[{late}];")
        reset += each("i", late, f"s->way[i] = {p}_begun[i];")
        start += each("i", late, f"known[{len(law.reads)} + i] = s->way[i];")
    if limits.remembers:
        constants += array(f"{p}_last", np.clip(law.origin[1], limits.low, limits.high))
        constants += array(f"{p}_change", limits.change)
        fields.append(f"REAL last[{nu}];")
        reset += each("i", nu, f"s->last[i] = {p}_last[i];")
        start += each("i", nu, f"known[{size - nu} + i] = s->last[i];")
    if nodes > 1:
        act += f"const double at = (t - {law._start!r}) / {law.dt!r} + 0.5;\n"
        act += f"const int k = at < 0 ? 0 : at >= {nodes - 1} ? {nodes - 1} : (int)at;\n"

    of = _Tables(p, nodes)
    if m:
        soft = step.solver.soft
        for name, values in (
            ("rows", [s.G[:m] for s in steps]),
            ("low_rows", [s.low for s in steps]),
            ("high_rows", [s.high for s in steps]),
            ("M", [s.solver.M for s in steps]),
            ("first", [s.first for s in steps]),
        ):
            constants += _each_node(p, name, values)
        constants += f"static const char {p}_soft[{m}] = {{{', '.join(str(int(v)) for v in soft)}}};\n"
        price = max(step.solver.penalty, 1e-12) / 2
        act += (
            f"const {p}_program q = {{{m}, {nz}, {of.at('M', m * nz)}, {p}_soft, {number(price)}, "
            f"{number(1 / (CURVATURE * price))}}};\n"
        )
    act = start.replace("DECLARED\n", act, 1)
    act += each("i", nu, f"u[i] = {of.entry('u0', nu)};") + added(nu, size, "1", of.at("G", nu * size), "known", "u")
    functions = constants_of = ""
    if m:
        act += _limited(p, (m, nz, nu, size), law.exact and bool(soft.any()), of)
        fields += ["long failures; /* programs that were not solved */"]
        reset += "s->failures = 0;\n"
    rows, unknowns = max(m, tracked.rows), max(nz if m else 0, tracked.unknowns)
    if rows:
        numbers = SINGLE if single else DOUBLE
        constants_of = "".join(f"#define {p}_{name} ({number(value)})\n" for name, value in numbers.items())
        functions = (PROGRAM + QP).replace("NAME", p) + tracked.functions
        fields.append(f"{p}_work work;")
    else:
        functions = tracked.functions
    act += clip
    if limits.remembers:
        held = f"if (u[i] > s->last[i] + {p}_change[i]) u[i] = s->last[i] + {p}_change[i];"
        other = f"if (u[i] < s->last[i] - {p}_change[i]) u[i] = s->last[i] - {p}_change[i];"
        act += each("i", nu, f"{{\n    {held}\n    {other}\n    s->last[i] = u[i];\n}}")
    act += tracked.after + (pushed("way", late, nu, "u[i]") if late else "")
    where = f", along a nominal of {nodes} nodes from {law._start!r} s on" if nodes > 1 else ""
    what = f"MPC, horizon {law.horizon}: {m} rows, {nz} unknowns{where}{tracked.what}"
    reset = f"int i;\n{reset}" if "[i]" in reset else reset
    constants += tracked.constants + constants_of
    structs = _work(p, rows, unknowns) if rows else ""
    return Law(p, what, law.reads, nu, tuple(fields), constants, functions, reset, act, structs)


@dataclass(frozen=True)
class _Tables:
    """Where the constants of the present node stand, `k` its index."""

    p: str
    nodes: int

    def at(self, name: str, width: int) -> str:
        """The first of `width` numbers."""
        return f"{self.p}_{name}" if self.nodes == 1 else f"{self.p}_{name} + k * {width}"

    def entry(self, name: str, width: int) -> str:
        """Number i of them."""
        return f"{self.p}_{name}[i]" if self.nodes == 1 else f"{self.p}_{name}[k * {width} + i]"


def _require_small(law: MPC, single: bool) -> None:
    """ValueError, with the size that the file would have, where that is out of reach."""
    step = law._steps[0]
    (m, nz), nu, size = step.solver.M.shape, len(step.u), step.G.shape[1]
    constants = len(law._steps) * ((m + nu) * (size + nz) + 2 * m + nu)
    require_room(f"MPC, horizon {law.horizon}", constants, m * (m + 1) // 2 if m else 0, single)


def _each_node(p: str, name: str, values: list[np.ndarray]) -> str:
    return array(f"{p}_{name}", np.concatenate([np.ravel(v) for v in values]))


def _known(law: MPC, p: str, tracked: Parts) -> str:
    """Statements that fill `known`; DECLARED stands where declarations follow."""
    ny, size = len(law.reads), law._steps[0].G.shape[1]
    read = "y[i]" if law._drift is None else f"y[i] - (REAL)({p}_drift[i] * t)"
    declared = f"int i;\nREAL known[{size}]{tracked.declared};\nDECLARED\n"
    if not law.tracked:
        return declared + each("i", ny, f"known[i] = {read};")
    return declared + each("i", ny, f"off[i] = {read} - {p}_y0[i];") + tracked.before


def _work(p: str, m: int, nz: int) -> str:
    """The struct in which programs are solved."""
    return (
        f"typedef struct {{\n    int count, known, set[{m}];\n    signed char side[{m}], yields[{m}];\n"
        f"    REAL mu[{m}], d[{m}], dz[{nz}], z[{nz}], lower[{m}], upper[{m}], K[{m * (m + 1) // 2}];\n}} {p}_work;\n"
    )


def _limited(p: str, sizes: tuple[int, int, int, int], exact: bool, of: _Tables) -> str:
    """Statements that add the first input of the plan where the law without limits breaks a row."""
    m, nz, nu, size = sizes
    low, high = (of.entry(name, m) for name in ("low_rows", "high_rows"))
    body = (
        f"{p}_work *w = &s->work;\nint broken = 0, found;\n"
        + each("i", m, "w->d[i] = 0;")
        + added(m, size, "1", of.at("rows", m * size), "known", "w->d")
        + f"for (i = 0; i < {m}; i++) {{\n    w->lower[i] = {low} - w->d[i];\n    w->upper[i] = {high} - w->d[i];\n"
        "    if (w->lower[i] > 0 || w->upper[i] < 0) broken = 1;\n}\n"
        f"if (broken) {{\n    found = {p}_qp(w, &q, w->lower, w->upper, 0, w->z);\n"
    )
    if exact:
        body += f"""    for (i = 0; i < w->count && found == 1; i++)
        if (w->yields[w->set[i]]) found = 2;
    if (found == 2) {{ /* is there a plan without excess? */
        REAL soft[{nz}];
        int hard;
        for (i = 0; i < {nz}; i++) soft[i] = w->z[i];
        hard = {p}_qp(w, &q, w->lower, w->upper, 1, w->z);
        if (hard != 1) {{
            for (i = 0; i < {m}; i++) {{
                w->lower[i] -= {number(SLACK)} * (REAL){p}_soft[i];
                w->upper[i] += {number(SLACK)} * (REAL){p}_soft[i];
            }}
            hard = {p}_qp(w, &q, w->lower, w->upper, 1, w->z);
        }}
        if (hard != 1)
            for (i = 0; i < {nz}; i++) w->z[i] = soft[i];
        found = 1;
    }}
"""
    body += f"    if (found == 1) {added(nu, nz, '1', of.at('first', nu * nz), 'w->z', 'u').strip()}\n"
    body += "    else s->failures++;\n}\n"
    return f"{{\n{indented(body)}}}\n"
