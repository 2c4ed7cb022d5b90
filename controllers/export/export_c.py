"""export_c: a controller, a filter or a plant's step as one C file and its header, without allocation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.controllers.base.controller import Feedback
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.filters.filter import Filter
from pliant.controllers.filters.filtered import Filtered
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.controllers.linear_quadratic.tvlqr import TVLQR
from pliant.controllers.mpc.mpc import MPC
from pliant.plants.core.argument_gates import require_choice
from pliant.plants.dynamics.plant import Plant
from pliant.plants.files.atomic_files import require_path, write_text

from .c_text import PRECISIONS, Law, c_name, files
from .estimators import kalman, lqg
from .plant_step import plant_step
from .predictive import mpc
from .state_feedback import feedback, filtered, linear, lqr, tvlqr

LONGEST_NAMES = 110  # characters of a line of the comment


def export_c(what: Any, path: str | Path, *, dt: float | None = None, precision: str = "double") -> tuple[Path, Path]:
    """Write NAME.c and NAME.h for `path` = folder/NAME.c; the two paths.

    what: LQR, LQG, TVLQR (by time), MPC (about a goal, its states read), Feedback, Kalman, a LinearLaw, a sampled
    Filter, Filtered, or a plant, whose step of dt [s] by the classical Runge-Kutta method it is. precision: "double"
    or "single".

    The code is C99, allocates nothing, keeps its state in `NAME_state` and calls but <math.h>:
    `NAME_reset(&s)`, then once a period `NAME_act(&s, t, y, u)`; of a plant `NAME_step(t, x, u)`. `y` has the order
    that the header's comment gives, which is that of `what.reads`. It gives what `act` gives but for rounding; numbers
    that are not finite are the caller's to keep out.

    Example
    -------
    >>> export_c(LQR.for_scene(scene), "flight/pointing.c", precision="single")
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
    header, source = files(name, _folded(head), struct, declared, code, precision)
    other = target.with_suffix(".h")
    write_text(target, source)
    write_text(other, header)
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
    raise ValueError(
        f"export_c: {type(what).__name__} has no C form; give LQR, LQG, TVLQR, MPC, Feedback, Kalman, a LinearLaw, "
        "a Filter, what is Filtered, or a plant"
    )


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
