"""Laws of joints in C: PD and computed torque, with the motion that they follow and the rigid inverse dynamics."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from pliant.controllers.base.joint_reference import Follow, RestToRest
from pliant.controllers.joint_control.computed_torque import ComputedTorque
from pliant.controllers.joint_control.pd import PD
from pliant.plants.core.casadi_functions import NumericFunction

from .c_text import Law, added, array, clipped, each, number
from .plant_step import expression_code

RAMPS = {"jerk-limited": 0.125, "bang-bang": 0.0}  # of minimum_jerk.py


def pd(law: PD, p: str) -> Law:
    """u = u_ff + share (Kp (r - y) + Kd (dr - dy)), within the limits."""
    n, nu = len(law.joints.positions), len(law.u0)
    limited, clip = clipped(p, nu, *law.limits)
    lack: np.ndarray = law._lack  # type: ignore[attr-defined]
    constants, functions = _reference(law.reference, p)
    constants += array(f"{p}_K", law.K) + array(f"{p}_lack", lack) + limited
    act = f"int i;\nREAL r[{3 * n}], off[{2 * n}];\n{p}_reference(t, r);\n"
    act += each("i", 2 * n, "off[i] = r[i] - y[i];") + each("i", nu, f"u[i] = {p}_lack[i];")
    if law.inverse is not None:
        functions += _inverse(law.inverse, p)
        act = act.replace("REAL r[", f"REAL rigid[{nu}], r[", 1)
        act += f"{p}_inverse(r, r + {2 * n}, rigid);\n" + each("i", nu, "u[i] += rigid[i];")
    act += added(nu, 2 * n, "1", f"{p}_K", "off", "u")
    what = f"PD along {_motion(law.reference)}"
    return Law(p, what, law.reads, nu, (), constants, functions, "", act + clip)


def computed_torque(law: ComputedTorque, p: str) -> Law:
    """u that gives the rigid plant at the measured joints the acceleration asked for."""
    n = len(law.joints.positions)
    limited, clip = clipped(p, n, *law.limits)
    constants, functions = _reference(law.reference, p)
    Kd, Kp = 2 * law.damping * law.bandwidth, law.bandwidth**2
    wanted = f"wanted[i] = r[{2 * n} + i] + {number(Kd)} * (r[{n} + i] - y[{n} + i]) + {number(Kp)} * (r[i] - y[i]);"
    act = f"int i;\nREAL r[{3 * n}], wanted[{n}];\n{p}_reference(t, r);\n{each('i', n, wanted)}"
    act += f"{p}_inverse(y, wanted, u);\n{clip}"
    act = act if "[i]" in act else act.replace("int i;\n", "", 1)
    what = f"computed torque along {_motion(law.reference)}"
    return Law(p, what, law.reads, n, (), constants + limited, functions + _inverse(law.inverse, p), "", act)


def _inverse(inverse: NumericFunction, p: str) -> str:
    """out = u of the rigid plant, from joints and rates, and accelerations."""
    symbols = inverse.function.sx_in()
    function = ca.Function("inverse", symbols, [ca.densify(inverse.function.call(symbols)[0])])
    return expression_code(f"{p}_inverse", function, ("q", "a"), "const REAL *q, const REAL *a")


def _motion(reference: RestToRest | Follow) -> str:
    if isinstance(reference, Follow):
        return f"a motion of {len(reference.positions)} samples {reference.dt!r} s apart"
    return f"a {reference.profile} motion from rest to rest in {reference.duration:.6g} s"


def _reference(reference: RestToRest | Follow, p: str) -> tuple[str, str]:
    """(constants, the function that writes positions, rates and accelerations at t)."""
    n = len(reference.end)
    constants, functions, body = (_followed if isinstance(reference, Follow) else _rest_to_rest)(reference, p, n)
    body = "".join(f"    {line}\n" for line in body.splitlines())
    head = (
        f"/* positions, rates and accelerations to follow at t [s] */\nstatic void {p}_reference(double t, REAL *r)\n"
    )
    return constants, f"{functions}{head}{{\n{body}}}\n\n"


def _followed(reference: Any, p: str, n: int) -> tuple[str, str, str]:
    last = len(reference.positions) - 1
    table = np.hstack([reference.positions, reference.rates, reference.accelerations])
    body = f"const double at = t / {reference.dt!r} + 0.5;\n"
    body += f"const int k = at < 0 ? 0 : at >= {last} ? {last} : (int)at;\nint i;\n"
    body += each("i", 3 * n, f"r[i] = {p}_motion[k * {3 * n} + i];")
    late = f"r[i] += (REAL)(t - {last * reference.dt!r}) * r[{n} + i];"
    body += f"if (k == {last})\n    " + each("i", n, late)
    return array(f"{p}_motion", table), "", body


def _rest_to_rest(reference: Any, p: str, n: int) -> tuple[str, str, str]:
    impulses, T = reference._impulses, reference.time
    constants = array(f"{p}_begin", reference.begin) + array(f"{p}_span", reference.end - reference.begin)
    constants += array(f"{p}_share", [share for _, share in impulses])
    starts = ", ".join(f"{float(start)!r}" for start, _ in impulses)
    constants += f"static const double {p}_starts[{len(impulses)}] = {{{starts}}};\n"
    body = "int i, j;\nREAL way = 0, rate = 0, acceleration = 0, one[3];\n"
    body += f"for (j = 0; j < {len(impulses)}; j++) {{\n    {p}_profile((REAL)((t - {p}_starts[j]) / {T!r}), one);\n"
    for name, k in (("way", 0), ("rate", 1), ("acceleration", 2)):
        body += f"    {name} += {p}_share[j] * one[{k}];\n"
    body += "}\n" + f"for (i = 0; i < {n}; i++) {{\n    r[i] = {p}_begin[i] + way * {p}_span[i];\n"
    body += f"    r[{n} + i] = rate * {number(1 / T)} * {p}_span[i];\n"
    body += f"    r[{2 * n} + i] = acceleration * {number(1 / T**2)} * {p}_span[i];\n}}\n"
    smooth = reference.profile == "minimum-jerk"
    profile = MINIMUM_JERK if smooth else _jerk_limited(RAMPS[reference.profile])
    return constants, profile.replace("NAME", p), body


MINIMUM_JERK = """/* the quintic from 0 to 1 over s in [0, 1], and its two derivatives */
static void NAME_profile(REAL s, REAL *one)
{
    if (s < 0) s = 0;
    if (s > 1) s = 1;
    one[0] = s * s * s * (10 - s * (15 - 6 * s));
    one[1] = 30 * s * s * (1 - s) * (1 - s);
    one[2] = 60 * s * (1 - s) * (1 - 2 * s);
}

"""


def _jerk_limited(ramp: float) -> str:
    """Acceleration that rises over `ramp`, holds, falls to zero at 1/2, then the same braking."""
    top = 4 / (1 - 2 * ramp)
    values = {"TOP": top, "RAMP": ramp, "FASTEST": top * (0.5 - ramp), "SAFE": ramp or 1.0, "HALF": 0.5}
    text = """/* from 0 to 1 over s in [0, 1] with limited acceleration, and its two derivatives */
static void NAME_profile(REAL s, REAL *one)
{
    const int later = s >= <HALF>;
    REAL x = later ? 1 - s : s, y, a, v, way;
    if (s < 0 || s >= 1) {
        one[0] = s < 0 ? (REAL)0 : (REAL)1;
        one[1] = one[2] = 0;
        return;
    }
    y = <HALF> - x;
    if (y < <RAMP>) {
        a = <TOP> * y / <SAFE>;
        v = <FASTEST> - <TOP> * y * y / (2 * <SAFE>);
        way = <HALF> - <FASTEST> * y + <TOP> * y * y * y / (6 * <SAFE>);
    } else if (x < <RAMP>) {
        a = <TOP> * x / <SAFE>;
        v = <TOP> * x * x / (2 * <SAFE>);
        way = <TOP> * x * x * x / (6 * <SAFE>);
    } else {
        a = <TOP>;
        v = <TOP> * (x - <RAMP> / 2);
        way = <TOP> * (<RAMP> * <RAMP> / 6 + (x - <RAMP>) * <RAMP> / 2 + (x - <RAMP>) * (x - <RAMP>) / 2);
    }
    one[0] = later ? 1 - way : way;
    one[1] = v;
    one[2] = later ? -a : a;
}

"""
    for name, value in values.items():
        text = text.replace(f"<{name}>", number(value))
    return text
