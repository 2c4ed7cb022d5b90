"""What an MPC without steady error adds in C: the estimate of a constant disturbance, and the steady state to aim at.

The estimate is offset_free.py's of the controller, the target its steady_target.py: a product without limits, else
quadratic programs of as many rows as inputs, solved as that of the plan is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.controllers.mpc.mpc import MPC
from pliant.controllers.mpc.steady_target import STEPS, Target
from pliant.controllers.solvers.daqp_model import INFINITE

from .c_text import added, array, each, indented, number

STILL = {True: 1e-6, False: 1e-14}  # change of the error in a proximal step that ends them, in single precision or not


@dataclass(frozen=True)
class Parts:
    """C text for each place of an MPC. `before` has off (ny,), the readings' deviations, and fills known."""

    rows: int  # the most of a program
    unknowns: int
    declared: str = ""
    before: str = ""
    after: str = ""
    constants: str = ""
    functions: str = ""
    fields: tuple[str, ...] = ()
    reset: str = ""
    what: str = ""


def offset_free(law: MPC, p: str, single: bool) -> Parts:
    """Of a law that tracks signals."""
    known = law._knowledge
    assert known is not None and known._estimator is not None and known._target is not None
    filter, target = known._estimator, known._target
    nx, nu, ny, n = len(filter.x), filter._G.shape[1], len(filter._e), len(filter.s)
    nt, nd = len(known.reference), n - nx
    seen = len(known._seen)
    values = np.array(list(known.tracked.values()))
    constants = "".join(
        array(f"{p}_{name}", value)
        for name, value in (
            ("y0", known._y0),
            ("origin", known._origin),
            ("filter_A", filter._F),
            ("filter_B", filter._G),
            ("filter_C", filter._H),
            ("filter_L", filter._gain),
            ("filter_first", filter._first),
            ("tracked", values),
            ("aim", values + known.reference),
        )
    )
    declared = f", off[{ny}], given[{nd + nt}], next[{n}]"
    begin = indented(added(nx, ny, "1", f"{p}_filter_first", "off", "s->estimate"))
    correct = added(ny, n, "-1", f"{p}_filter_C", "s->estimate", "off")
    correct += added(n, ny, "1", f"{p}_filter_L", "off", "s->estimate")
    before = f"if (!s->acts) {{\n{begin}}} else {{\n{indented(correct)}}}\n"
    before += each("i", nx, f"known[i] = {p}_origin[i] + s->estimate[i];")
    before += each("i", nd, f"given[i] = s->estimate[{nx} + i];")
    before += each("i", nt, f"given[{nd} + i] = s->aim[i] - {p}_tracked[i];")
    solves = "&s->work, " if target._nearest is not None else ""
    before += f"s->unreached += {p}_target({solves}given, known + {nx});\n"
    before += each("i", nx + nu, f"known[{nx} + i] += {p}_origin[i];")
    before += each("i", seen, f"known[{2 * nx + nu} + i] = s->estimate[{nx} + i];")
    after = each("i", n, "next[i] = 0;") + added(n, n, "1", f"{p}_filter_A", "s->estimate", "next")
    after += each("i", nu, f"known[i] = u[i] - {p}_origin[{nx} + i];")
    after += added(n, nu, "1", f"{p}_filter_B", "known", "next") + each("i", n, "s->estimate[i] = next[i];")
    own, functions, rows, unknowns = _target(target, p, single)
    return Parts(
        rows,
        unknowns,
        declared,
        before,
        after,
        constants + own,
        functions,
        (
            f"REAL estimate[{n}]; /* of the state and the disturbance, from the model's point */",
            f"REAL aim[{nt}]; /* values to bring to: {', '.join(known.tracked)} */",
            "long unreached; /* samples at which the limits kept them from there */",
        ),
        each("i", n, "s->estimate[i] = 0;") + each("i", nt, f"s->aim[i] = {p}_aim[i];") + "s->unreached = 0;\n",
        f"; estimates a disturbance of the {filter.kind}, brings to s.aim: {', '.join(known.tracked)}",
    )


def _target(target: Target, p: str, single: bool) -> tuple[str, str, int, int]:
    """(constants, functions, rows and unknowns of its programs)."""
    nx, nearest, spare = target._nx, target._nearest, target._spare
    n, given = target._map.shape
    nu = n - nx
    constants = array(f"{p}_map", target._map)
    start = each("i", n, "steady[i] = 0;") + added(n, given, "1", f"{p}_map", "given", "steady")
    title = "/* the steady state and input for [disturbance; goals]; 1: the limits keep signals from their goals */\n"
    if nearest is None:
        body = f"int i;\n{start}return 0;\n"
        return (
            constants,
            f"{title}static int {p}_target(const REAL *given, REAL *steady)\n{{\n{indented(body)}}}\n\n",
            0,
            0,
        )
    k, free, few = nearest._reach.shape[1], spare._reach.shape[1], len(nearest._sigma)
    cheapest = np.eye(n) - spare._reach @ (spare._root @ spare._reach).T @ spare._root
    share = np.zeros(k)
    share[:few] = nearest._sigma / nearest._each[:few]
    for name, value in (
        ("least", target._low),
        ("most", target._high),
        ("unit", target._unit),
        ("spare", spare._reach),
        ("spare_M", spare._solver.M),
        ("cheapest", cheapest),
        ("near_start", nearest._start),
        ("near_error", nearest._error),
        ("near_reach", nearest._reach),
        ("near_M", nearest._solver.M),
        ("near_share", share),
        ("near_free", nearest._step / nearest._each**2),
    ):
        constants += array(f"{p}_{name}", value) if np.size(value) else ""
    functions = (
        _bounds(p, nu) + _within(p, n, nu, free) + _nearest(p, (n, nu, k, few, given), nearest._step > 0, single)
    )
    body = f"int i, out = 0;\nREAL near[{n}], low[{nu}], high[{nu}];\n{start}"
    beyond = f"if (steady[{nx} + i] < {p}_least[i] || steady[{nx} + i] > {p}_most[i]) out = 1;"
    body += each("i", nu, beyond)
    body += f"if (!out || {p}_within(w, {p}_least, {p}_most, steady)) return 0;\n"
    body += f"if (!{p}_nearest(w, given, near)) return 1;\n"
    held = f"near[{nx} + i]"
    body += f"for (i = 0; i < {nu}; i++) {{\n    low[i] = {held} < {p}_least[i] ? {held} : {p}_least[i];\n"
    body += f"    high[i] = {held} > {p}_most[i] ? {held} : {p}_most[i];\n}}\n"
    body += each("i", n, "steady[i] = 0;") + added(n, n, "1", f"{p}_cheapest", "near", "steady")
    body += f"if (!{p}_within(w, low, high, steady))\n    " + each("i", n, "steady[i] = near[i];") + "return 1;\n"
    functions += (
        f"{title}static int {p}_target({p}_work *w, const REAL *given, REAL *steady)\n{{\n{indented(body)}}}\n\n"
    )
    return constants, functions, nu, max(k, free)


def _bounds(p: str, nu: int) -> str:
    """What is left to the limits from u, in units of the inputs."""
    far = number(INFINITE)
    return f"""static void {p}_left({p}_work *w, const REAL *low, const REAL *high, const REAL *u)
{{
    int i;
    for (i = 0; i < {nu}; i++) {{
        w->lower[i] = (low[i] - u[i]) / {p}_unit[i];
        w->upper[i] = (high[i] - u[i]) / {p}_unit[i];
        if (w->lower[i] < -{far}) w->lower[i] = -{far};
        if (w->upper[i] > {far}) w->upper[i] = {far};
    }}
}}

"""


def _within(p: str, n: int, nu: int, free: int) -> str:
    """The cheapest steady state within limits, from the cheapest without."""
    title = "/* moves s, where no tracked signal sees it, to the least cost within the limits; 0: there is none */\n"
    head = f"{title}static int {p}_within({p}_work *w, const REAL *low, const REAL *high, REAL *s)\n"
    if not free:
        test = f"if (s[{n - nu} + i] < low[i] || s[{n - nu} + i] > high[i]) return 0;"
        return f"{head}{{\n    int i;\n    (void)w;\n{indented(each('i', nu, test))}    return 1;\n}}\n\n"
    body = f"const {p}_program q = {{{nu}, {free}, {p}_spare_M, 0, 1, 1}};\n{p}_left(w, low, high, s + {n - nu});\n"
    body += f"if ({p}_qp(w, &q, w->lower, w->upper, 1, w->z) != 1) return 0;\n"
    body += added(n, free, "1", f"{p}_spare", "w->z", "s") + "return 1;\n"
    return f"{head}{{\n{indented(body)}}}\n\n"


def _nearest(p: str, sizes: tuple[int, int, int, int, int], proximal: bool, single: bool) -> str:
    """The steady state of least tracking error, by proximal steps."""
    n, nu, k, few, given = sizes
    body = f"const {p}_program q = {{{nu}, {k}, {p}_near_M, 0, 1, 1}};\nint i, round;\n"
    body += f"REAL error[{few}], z[{k}], centre[{k}], largest = 1, moved;\n"
    body += each("i", few, "error[i] = 0;") + added(few, given, "1", f"{p}_near_error", "given", "error")
    body += each("i", few, "if (FABS(error[i]) > largest - 1) largest = 1 + FABS(error[i]);")
    body += each("i", k, "z[i] = 0;")
    step = each("i", k, f"centre[i] = {p}_near_free[i] * z[i];")
    step += each("i", few, f"centre[i] -= {p}_near_share[i] * error[i];")
    step += each("i", n, "s[i] = 0;") + added(n, given, "1", f"{p}_near_start", "given", "s")
    step += added(n, k, "1", f"{p}_near_reach", "centre", "s") + f"{p}_left(w, {p}_least, {p}_most, s + {n - nu});\n"
    step += f"if ({p}_qp(w, &q, w->lower, w->upper, 1, w->z) != 1) return 0;\nmoved = 0;\n"
    step += f"for (i = 0; i < {k}; i++) {{\n    const REAL next = centre[i] + w->z[i];\n"
    step += f"    const REAL change = FABS({p}_near_share[i] * (next - z[i]));\n"
    step += "    if (change > moved) moved = change;\n    z[i] = next;\n}\n"
    step += f"if (round && moved <= {number(STILL[single])} * largest) break;\n"
    rounds = STEPS if proximal else 1
    body += f"for (round = 0; round < {rounds}; round++) {{\n{indented(step)}}}\n"
    body += each("i", n, "s[i] = 0;") + added(n, given, "1", f"{p}_near_start", "given", "s")
    body += added(n, k, "1", f"{p}_near_reach", "z", "s") + "return 1;\n"
    title = "/* the steady state of least tracking error within the limits; 0: not found */\n"
    return f"{title}static int {p}_nearest({p}_work *w, const REAL *given, REAL *s)\n{{\n{indented(body)}}}\n\n"
