"""Gains in C: Feedback, LQR with its integrals, TVLQR by time, and any sampled linear law."""

from __future__ import annotations

import numpy as np

from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.controllers.base.controller import Feedback
from pliant.controllers.filters.filtered import Filtered
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.controllers.linear_quadratic.nominal_loop import AHEAD
from pliant.controllers.linear_quadratic.tvlqr import TVLQR

from .c_text import Law, added, array, clipped, each, indented, number, pushed


def feedback(law: Feedback, p: str) -> Law:
    """u = u_ref - K (y - y_ref), within the limits."""
    assert law.y_ref is not None and law.u_ref is not None
    return _gain(p, law.reads, law.K, law.y_ref, law.u_ref, law.limits, "u = u_ref - K (y - y_ref)")


def _gain(
    p: str,
    reads: tuple[str, ...],
    K: np.ndarray,
    y0: np.ndarray,
    u0: np.ndarray,
    limits: tuple[np.ndarray, np.ndarray],
    what: str,
) -> Law:
    nu, ny = K.shape
    limited, clip = clipped(p, nu, *limits)
    act = (
        f"int i;\nREAL e[{ny}];\n"
        + each("i", ny, f"e[i] = y[i] - {p}_y0[i];")
        + each("i", nu, f"u[i] = {p}_u0[i];")
        + added(nu, ny, "-1", f"{p}_K", "e", "u")
        + clip
    )
    constants = array(f"{p}_K", K) + array(f"{p}_y0", y0) + array(f"{p}_u0", u0) + limited
    return Law(p, what, tuple(reads), nu, (), constants, "", "", act)


def lqr(law: LQR, p: str) -> Law:
    """u = u0 - K_x (x - x0) - K_i xi, within the limits; xi stands still where it would push further past one."""
    nx, ni, nu = len(law.x0), len(law.target), len(law.u0)
    what = "u = u0 - K_x (x - x0 - drift t) - K_i xi within the limits; xi integrates"
    if ni and law.dt is None:
        raise ValueError("export_c: an LQR with integrals needs dt, the period at which the C code is called")
    if not ni and law.drift is None and law.K_past is None:
        return _gain(p, law.reads, law.K, law.x0, law.u0, law.limits, "u = u0 - K (x - x0)")
    limited, clip = clipped(p, nu, *law.limits)
    constants = array(f"{p}_K", law.K[:, :nx]) + array(f"{p}_y0", law.x0) + array(f"{p}_u0", law.u0) + limited
    start = f"e[i] = y[i] - {p}_y0[i];"
    if law.drift is not None:
        constants += array(f"{p}_drift", law.drift)
        start = f"e[i] = y[i] - (REAL)({p}_y0[i] + {p}_drift[i] * t);"
    act = f"int i;\nREAL e[{nx}];\n" + each("i", nx, start) + each("i", nu, f"u[i] = {p}_u0[i];")
    act += added(nu, nx, "-1", f"{p}_K", "e", "u")
    if law.K_past is not None:
        late = law.K_past.shape[1]
        constants += array(f"{p}_Kpast", law.K_past) + array(f"{p}_begun", law._begun())
        act += added(nu, late, "-1", f"{p}_Kpast", "s->past", "u") + clip
        act += pushed("past", late, nu, f"u[i] - {p}_u0[i]")
        reset = "int i;\n" + each("i", late, f"s->past[i] = {p}_begun[i];")
        what = "u = u0 - K (x - x0 - drift t) - K_past (inputs on their way less u0) within the limits"
        return Law(p, what, law.reads, nu, (f"REAL past[{late}];",), constants, "", reset, act)
    if not ni:
        return Law(p, what, law.reads, nu, (), constants, "", "", act + clip)
    picks = ", ".join(str(int(k)) for k in law.picks)
    constants += array(f"{p}_Ki", law.K[:, nx:]) + array(f"{p}_target", law.target)
    constants += f"static const int {p}_picks[{ni}] = {{{picks}}};\n"
    moved = f"(y[{p}_picks[j]] - {p}_target[j])"
    if law.drift is not None:
        moved = f"(y[{p}_picks[j]] - (REAL)({p}_picks[j] < {nx} ? {p}_drift[{p}_picks[j]] * t : 0) - {p}_target[j])"
    top = f"next[i] > {p}_high[i] ? next[i] - {p}_high[i] : next[i] < {p}_low[i] ? next[i] - {p}_low[i] : 0"
    past = top if limited else "0"
    act = act.replace("int i;\n", f"int i, j;\nREAL change[{ni}], next[{nu}], excess[{nu}];\n", 1)
    act += added(nu, ni, "-1", f"{p}_Ki", "s->xi", "u")
    act += each("j", ni, f"change[j] = {number(law.dt or 0.0)} * {moved};")
    act += each("i", nu, "next[i] = u[i];")
    act += added(nu, ni, "-1", f"{p}_Ki", "change", "next")
    act += each("i", nu, f"excess[i] = {past};")
    act += (
        f"for (j = 0; j < {ni}; j++) {{\n    REAL push = 0;\n"
        f"    for (i = 0; i < {nu}; i++) push -= excess[i] * {p}_Ki[i * {ni} + j] * change[j];\n"
        "    if (!(push > 0)) s->xi[j] += change[j];\n}\n"
    )
    reset = "int i;\n" + each("i", ni, "s->xi[i] = 0;")
    return Law(p, what, law.reads, nu, (f"REAL xi[{ni}];",), constants, "", reset, act + clip)


def tvlqr(law: TVLQR, p: str) -> Law:
    """u = offset_k - K_k x within the limits, k by the time since `start` or by phase; the last one stays."""
    gains, offsets = np.asarray(law._gains), np.asarray(law._offsets)
    n, nu, ny = gains.shape
    limited, clip = clipped(p, nu, *law.limits)
    constants = array(f"{p}_K", gains) + array(f"{p}_offset", offsets) + limited
    fields: tuple[str, ...] = ()
    reset, act = "", f"int i, k;\ndouble at = (t - {law.start!r}) / {law.dt!r} + 1e-6;\nREAL x[{ny}];\n"
    act += f"k = at < 0 ? 0 : at >= {n - 1} ? {n - 1} : (int)at;\n"
    if law.index == "phase":
        constants += array(f"{p}_path", law._progress._path) + array(f"{p}_scale", law._progress._scale)
        fields, reset, act = ("double phase; /* nodes since reset */",), "s->phase = 0;\n", _by_phase(law, p)
    act += each("i", ny, "x[i] = y[i];")
    if law.drift is not None:
        constants += array(f"{p}_drift", law.drift)
        end = law.start + (n - 1) * law.dt
        act += f"if (k == {n - 1})\n    " + each("i", ny, f"x[i] -= (REAL)({p}_drift[i] * (t - {end!r}));")
    act += each("i", nu, f"u[i] = {p}_offset[k * {nu} + i];")
    act += added(nu, ny, "-1", f"{p}_K + k * {nu * ny}", "x", "u") + clip
    return Law(p, f"u = offset_k - K_k x, k by {law.index}", law.reads, nu, fields, constants, "", reset, act)


def _by_phase(law: TVLQR, p: str) -> str:
    """k, the nearest of the next nodes of the path, moved on by `slowest` to `fastest` nodes (nominal_loop.py)."""
    n, ny = len(law._gains), len(law.reads)
    return f"""int i, j, k = (int)s->phase;
REAL x[{ny}], least = INFINITY;
if (k < {n - 1}) {{
    const int first = k, furthest = (int)(s->phase + {law.fastest!r});
    for (j = first; j < first + {AHEAD}; j++) {{
        REAL away = 0;
        for (i = 0; i < {ny}; i++) {{
            const REAL off = {p}_path[j * {ny} + i] - y[i] * {p}_scale[i];
            away += off * off;
        }}
        if (away < least) {{
            least = away;
            k = j;
        }}
    }}
    if (k > furthest) k = furthest;
    s->phase += {law.slowest!r};
    if (s->phase < k) s->phase = k;
}}
if (k > {n - 1}) k = {n - 1};
"""


def linear(law: LinearLaw, p: str) -> Law:
    """u = -(C s + D y), s' = A s + B y: deviations, without limits."""
    m, ny, nu = len(law.A), len(law.reads), len(law.D)
    if law.dt is None and m:
        raise ValueError("export_c: a law with states needs dt, the period at which the C code is called")
    if law.delay:
        raise ValueError(f"export_c: LinearLaw.delay = {law.delay} must be 0: hand over what has arrived")
    constants = array(f"{p}_D", law.D)
    act = "int i;\n" + (f"REAL next[{m}];\n" if m else "") + each("i", nu, "u[i] = 0;")
    act += added(nu, ny, "-1", f"{p}_D", "y", "u")
    if not m:
        return Law(p, "u = -D y", law.reads, nu, (), constants, "", "", act)
    constants += array(f"{p}_A", law.A) + array(f"{p}_B", law.B) + array(f"{p}_C", law.C)
    act += added(nu, m, "-1", f"{p}_C", "s->x", "u") + each("i", m, "next[i] = 0;")
    act += added(m, m, "1", f"{p}_A", "s->x", "next") + added(m, ny, "1", f"{p}_B", "y", "next")
    act += each("i", m, "s->x[i] = next[i];")
    reset = "int i;\n" + each("i", m, "s->x[i] = 0;")
    what = "u = -(C s + D y), s' = A s + B y"
    return Law(p, what, law.reads, nu, (f"REAL x[{m}];",), constants, "", reset, act)


def filtered(law: Filtered, inside: Law, p: str) -> Law:
    """u = u_ref + F (law - u_ref), within the limits; each input has its own states of F."""
    f, nu = law.whole, inside.inputs
    m, base = len(f.A), np.zeros(nu) if law.u_ref is None else law.u_ref
    free = (np.full(nu, -np.inf), np.full(nu, np.inf))
    limited, clip = clipped(p, nu, *(free if law.limits is None else law.limits))
    constants = array(f"{p}_A", f.A) + array(f"{p}_B", f.B) + array(f"{p}_C", f.C) + array(f"{p}_base", base) + limited
    each_input = f"REAL off = v[i] - {p}_base[i], next[{m}], *x = s->x + i * {m};\nu[i] = {p}_base[i]"
    each_input += f" + {number(f.D[0, 0])} * off;\n{added(1, m, '1', f'{p}_C', 'x', 'u + i')}"
    each_input += each("j", m, f"next[j] = {p}_B[j] * off;") + added(m, m, "1", f"{p}_A", "x", "next")
    each_input += each("j", m, "x[j] = next[j];")
    act = f"int i, j;\nREAL v[{nu}];\n{inside.prefix}_act(&s->law, t, y, v);\n"
    act += f"for (i = 0; i < {nu}; i++) {{\n{indented(each_input)}}}\n" + clip
    reset = f"int i;\n{inside.prefix}_reset(&s->law);\n" + each("i", m * nu, "s->x[i] = 0;")
    fields = (f"{inside.prefix}_state law;", f"REAL x[{m * nu}];")
    what = f"filters of order {m} behind: {inside.what}"
    return Law(p, what, law.reads, nu, fields, constants, inside.code("static "), reset, act, inside.struct)
