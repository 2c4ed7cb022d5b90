"""export_c: a controller, a filter or a plant's step as one C file and its header, without allocation."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.controllers.base.controller import Feedback
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.filters.filter import Filter
from pliant.controllers.filters.filtered import Filtered
from pliant.controllers.joint_control.computed_torque import ComputedTorque
from pliant.controllers.joint_control.pd import PD
from pliant.controllers.learning.policy import Policy
from pliant.controllers.linear_quadratic.delay import Predictive
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.controllers.linear_quadratic.tvlqr import TVLQR
from pliant.controllers.mpc.mpc import MPC
from pliant.controllers.nmpc.nmpc import NMPC
from pliant.controllers.tube_mpc import TubeMPC
from pliant.plants.core.argument_gates import require_choice
from pliant.plants.dynamics.plant import Plant
from pliant.plants.files.atomic_files import Together, require_path

from .c_text import PRECISIONS, Law, c_name, files
from .estimators import kalman, lqg
from .joint_laws import computed_torque, pd
from .plant_step import plant_step, predictive
from .policies import policy
from .predictive import mpc
from .state_feedback import feedback, filtered, linear, lqr, tvlqr

LONGEST_NAMES = 110  # characters of a line of the comment


def export_c(what: Any, path: str | Path, *, dt: float | None = None, precision: str = "double") -> tuple[Path, Path]:
    """Write NAME.c and NAME.h for `path` = folder/NAME.c; the two paths.

    what: LQR, LQG, TVLQR, MPC (about a goal or along a nominal, free of offset or not), PD, ComputedTorque,
    Policy, Predictive, Feedback, Kalman, a LinearLaw, a sampled Filter, Filtered, or a plant, whose step of dt [s] by
    the classical Runge-Kutta method it is. precision: "double" or "single".

    The code is C99, allocates nothing, keeps its state in `NAME_state` and calls but <math.h>:
    `NAME_reset(&s)`, then once a period `NAME_act(&s, t, y, u)`; of a plant `NAME_step(t, x, u)`. `y` has the order
    that the header's comment gives, which is that of `what.reads`; the sizes of constants and state stand there too.
    It gives what `act` gives but for rounding; numbers that are not finite are the caller's to keep out.

    ValueError where `what` has no C form, where it would take more than two million numbers, and for a name that C
    does not take; OSError, which names the file, where one cannot be written: then neither is.

    Example
    -------
    >>> print(*export_c(law, "pointing.c", precision="single"))
    pointing.c pointing.h
    """
    target = require_path("export_c.path", path)
    if target.suffix != ".c":
        raise ValueError(f"export_c.path = {str(path)!r} must end in .c")
    name = c_name("export_c.path: name", target.stem)
    require_choice("export_c", "precision", precision, tuple(PRECISIONS))
    if isinstance(what, Plant):
        if dt is None:
            raise ValueError("export_c.dt = None must be the step in seconds, for a plant")
        head, struct, declared, code = plant_step(what, name, dt)
    else:
        if dt is not None:
            raise ValueError(f"export_c.dt = {dt!r} must be None: a controller has its own")
        law = law_code(what, name, precision)
        period = getattr(what, "dt", None)
        when = "" if period is None else f"\nperiod: {period!r} s"
        head = f"{type(what).__name__}: {law.what}{when}\ny: {', '.join(law.reads)}"
        struct, n, m = law.struct, len(law.reads), law.inputs
        declared = (
            f"void {name}_reset({name}_state *s);\n/* once a period; t [s] */\n"
            f"void {name}_act({name}_state *s, double t, const REAL y[{n}], REAL u[{m}]);\n"
        )
        code = law.code("")
    head += _sizes(name, struct, code, precision)
    header, source = files(name, _folded(head), struct, declared, code, precision)
    other = target.with_suffix(".h")
    with Together() as both:
        both.text(target, source)
        both.text(other, header)
    return target, other


def law_code(what: Any, prefix: str, precision: str) -> Law:
    """One law in C; ValueError for what has no C form."""
    if isinstance(what, LQR):
        return lqr(what, prefix)
    if isinstance(what, Feedback):
        return feedback(what, prefix)
    if isinstance(what, LinearLaw):
        return linear(what, prefix)
    if isinstance(what, TVLQR):
        return tvlqr(what, prefix)
    if isinstance(what, MPC):
        return mpc(what, prefix, precision)
    if isinstance(what, Filtered):
        return filtered(what, law_code(what.law, f"{prefix}__law", precision), prefix)
    if isinstance(what, Filter):
        return linear(LinearLaw(what.A, what.B, -what.C, -what.D, ("signal",), what.dt), prefix)
    if isinstance(what, Kalman):
        return kalman(what, prefix)
    if isinstance(what, LQG):
        return lqg(what, prefix, lambda law, inside: law_code(law, inside, precision))
    if isinstance(what, PD):
        return pd(what, prefix)
    if isinstance(what, ComputedTorque):
        return computed_torque(what, prefix)
    if isinstance(what, Policy):
        return policy(what, prefix)
    if isinstance(what, Predictive):
        return predictive(what, law_code(what.law, f"{prefix}__law", precision), prefix)
    if isinstance(what, NMPC):
        raise ValueError(
            "export_c: NMPC has no C form, its program is made anew from the plant at each sample; give MPC.along a "
            "motion of `plan` or `optimal` (MPC.for_scene(scene, nominal=..)), or a Policy"
        )
    if isinstance(what, TubeMPC):
        raise ValueError(
            "export_c: TubeMPC has no C form, since its ancillary law has none; its `mpc`, the program with tightened "
            "limits, has one, and acts alike wherever a plan keeps them"
        )
    raise ValueError(
        f"export_c: {type(what).__name__} has no C form; give LQR, LQG, TVLQR, MPC, PD, ComputedTorque, Policy, "
        "Predictive, Feedback, Kalman, a LinearLaw, a Filter, what is Filtered, or a plant"
    )


def _sizes(name: str, struct: str, code: str, precision: str) -> str:
    """How much room the constants and the state take."""
    size = {"double": 8, "single": 4}[precision]
    constants = sum(int(n) for n in re.findall(r"^static const REAL \w+\[(\d+)\]", code, re.MULTILINE))
    lines = re.findall(r"^    REAL ([^;]+);", struct, re.MULTILINE)
    state = sum(int(n) for line in lines for n in re.findall(r"\[(\d+)\]", line))
    text = f"\nconstants: {constants:,} numbers, {constants * size:,} bytes"
    return text + (f"; {name}_state: {state:,} numbers, {state * size:,} bytes" if state else "")


def _folded(text: str) -> str:
    """Lines no longer than a comment should be."""
    lines: list[str] = []
    for line in text.splitlines():
        while len(line) > LONGEST_NAMES and " " in line[:LONGEST_NAMES]:
            cut = line[:LONGEST_NAMES].rindex(" ")
            lines.append(line[:cut])
            line = "   " + line[cut:]
        lines.append(line)
    return "\n".join(lines)
