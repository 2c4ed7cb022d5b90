"""A motion by the adaptive pair of order 8(5,3) without compiling its plant: the loop in C, the rates by their tape.

One small C program serves every plant. It chooses its steps by the loop of compiled motions, so that a motion is the
same to rounding. A step takes a third of what it takes on the virtual machine, and reading the instructions as long as
twenty steps.
"""

from __future__ import annotations

import ctypes
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import LONG
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.runge_kutta_tableaux import dop853_errors, rk8
from pliant.plants.native.compiler import CompileError
from pliant.plants.rows.instruction_tape import Tape
from pliant.plants.rows.tape_programs import Program, run_source
from pliant.plants.toolchain import shared_library

from .motion_library import AdaptiveMotion
from .motion_source import adaptive_loop

Array = np.ndarray

_PAIR = """
#include <string.h>
#define SOUND(v) ((v) - (v) == 0)
#define T double
#define NX n
#define FABS fabs
#define POW pow
/* Of n states: tape (count, code, constants, values), A (12, 12), b, c, e5, e3 (12,) in one array `pair`; of `scratch`
   (16 n + values) */
long adaptive(long n, long nu, long count, const int *code, const double *constants, const double *pair,
              double *scratch, long last, long most, long restart, const double *t, const double *u, const double *w,
              const double *p, double *x, const double *s, double *now, long *at) {
  const double *A = pair, *b = A + 144, *c = b + 12, *e5 = c + 12, *e3 = e5 + 12;
  double *z = scratch, *after = z + n, *y = after + n, *k = y + n, *values = k + 12 * n, pivot;
  double stage;
  const long none[5] = {0, 0, 0, 0, 0};
"""
_ATTEMPT = """\
      const double *in[5] = {&stage, y, u + j * nu, w, p};
      for (int i = 0; i < 12; i++) {
        for (long l = 0; l < n; l++) {
          double sum = 0;
          for (int m = 0; m < i; m++) sum += A[12 * i + m] * k[m * n + l];
          y[l] = z[l] + trial * sum;
        }
        stage = time + c[i] * trial;
        double *out[2] = {k + i * n, &pivot};
        run(1, 1, count, code, constants, in, none, out, none, values);
      }
      double s5 = 0, s3 = 0;
      int sound = 1;
      for (long l = 0; l < n; l++) {
        double sum = 0, d5 = 0, d3 = 0;
        for (int m = 0; m < 12; m++) {
          sum += b[m] * k[m * n + l]; d5 += e5[m] * k[m * n + l]; d3 += e3[m] * k[m * n + l];
        }
        after[l] = z[l] + trial * sum;
        const double scale = s[1] + s[0] * fmax(fabs(z[l]), fabs(after[l]));
        s5 += d5 / scale * (d5 / scale); s3 += d3 / scale * (d3 / scale);
        sound &= SOUND(after[l]);
      }
      const double bottom = s5 + 0.01 * s3, error = bottom != 0 ? trial * s5 / sqrt(bottom * n) : 0;
      sound &= SOUND(error);"""


def source() -> str:
    """The C program."""
    return run_source() + _PAIR + adaptive_loop(_ATTEMPT)


def _load(path: Path) -> Any:
    (run,) = shared_library.functions(path, "adaptive")
    count, pointer = ctypes.c_long, ctypes.c_void_p
    run.argtypes, run.restype = [count] * 3 + [pointer] * 4 + [count] * 3 + [pointer] * 8, count
    return run


def _check(run: Any) -> None:
    """That an oscillator under a constant push goes as it does; CompileError."""
    x, u = ca.SX.sym("x", 2), ca.SX.sym("u")
    rates = [ca.vertcat(x[1], u - 4 * x[0])]
    function = ca.Function("rates", [ca.SX.sym("t"), x, u, ca.SX(0, 1), ca.SX(0, 1)], rates)
    t = np.linspace(0.0, 1.0, 6)
    z = np.vstack([[1.0, 0.0], np.zeros((5, 2))])
    arrays = (t, np.full((6, 1), 2.0), np.zeros(0), np.zeros(0), z)
    motion = TapePair(Tape(function, None), 2, 1).adapted(run, arrays, (1e-10, 1e-12, 10.0, 0.2, 0.9, 1e-13, 1000))
    status = motion.march(0, 5, 0.01, restart=True)
    exact = np.column_stack([0.5 + 0.5 * np.cos(2 * t), -np.sin(2 * t)])
    if status or not np.allclose(z, exact, rtol=0, atol=1e-9):
        raise CompileError("the motion of an oscillator has other numbers than it has")


program = Program("pair", source, _load, _check)


class TapePair:
    """The adaptive pair for the rates (t, x, u, w, p) -> dx/dt on a tape."""

    def __init__(self, tape: Tape, nx: int, nu: int) -> None:
        self.tape, self.nx, self.nu = tape, nx, nu
        tableau, (fifth, third) = rk8(), dop853_errors()
        self.numbers = np.concatenate([tableau.A.ravel(), tableau.b, tableau.c, fifth, third]).astype(float)

    def adapted(self, run: Any, arrays: Any, settings: Any) -> AdaptiveMotion:
        """A motion on arrays (t, u, w, p, x), with the numbers s of the C."""
        tape, scratch = self.tape, np.empty(16 * self.nx + self.tape.values)
        own = [a.ctypes.data for a in (tape.code, tape.constants, self.numbers, scratch)]
        function = partial(run, self.nx, self.nu, len(tape.code), *own)
        return AdaptiveMotion(function, [*arrays, np.array(settings, dtype=float)], scratch)


@lru_cache(maxsize=32)
def pair(plant: PlantLike) -> TapePair | None:
    """Of a plant; None where it has operations that C has not, or too many."""
    function = plant._dynamics._function
    if not function.is_a("SXFunction") or function.n_instructions() > 2 * LONG:
        return None
    try:
        return TapePair(Tape(function, None), plant.nx, plant.nu)
    except NotImplementedError:
        return None


def at_hand(plant: PlantLike, coming: float) -> tuple[TapePair, Any] | None:
    """(the pair on the plant's tape, its C), where these are at hand; `coming` seconds are to be saved."""
    run = program.at_hand(coming)
    found = None if run is None else pair(plant)
    return None if found is None else (found, run)
