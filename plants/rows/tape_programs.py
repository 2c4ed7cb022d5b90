"""The C that does the instructions of any function, each for a block of rows, and when it is compiled.

It serves every function, so that a machine compiles it once: it is looked for in the cache, and compiled when the
virtual machine has spent, in this process, what compiling takes.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import casadi as ca

from pliant.plants.core.errors import PliantError
from pliant.plants.native import compiler, kernel_cache, kernel_loader

BLOCK = 32  # rows: every value of a function of a thousand operations stays in the second cache
EXACT = (
    "-O3",
    "-fno-fast-math",
    "-ffp-contract=off",
    "-fno-trapping-math",
    "-fno-math-errno",
)  # after the kernels' own
COMPILING = 1.0  # [s] spent on the virtual machine before the C is compiled
UNARY = {
    "ASSIGN": "a", "NEG": "-a", "SQ": "a * a", "TWICE": "a + a", "INV": "1. / a", "SQRT": "sqrt(a)", "SIN": "sin(a)",
    "COS": "cos(a)", "TAN": "tan(a)", "ASIN": "asin(a)", "ACOS": "acos(a)", "ATAN": "atan(a)", "EXP": "exp(a)",
    "LOG": "log(a)", "SINH": "sinh(a)", "COSH": "cosh(a)", "TANH": "tanh(a)", "FABS": "fabs(a)",
    "SIGN": "a < 0 ? -1. : a > 0 ? 1. : a", "NOT": "!a", "FLOOR": "floor(a)", "CEIL": "ceil(a)",
}  # fmt: skip
BINARY = {
    "ADD": "a + b", "SUB": "a - b", "MUL": "a * b", "DIV": "a / b", "POW": "pow(a, b)", "CONSTPOW": "pow(a, b)",
    "ATAN2": "atan2(a, b)",
    # of zeros of two signs the first, as the virtual machine takes; C leaves it open
    "FMIN": "a <= b || b != b ? a : b", "FMAX": "a >= b || b != b ? a : b",
    "LT": "a < b", "LE": "a <= b", "EQ": "a == b",
    "NE": "a != b", "AND": "a && b", "OR": "a || b", "IF_ELSE_ZERO": "a != 0 ? b : 0.",
}  # fmt: skip
FIRST = 3  # 0 .. 2: an input, a constant, an output
NUMBER = {int(getattr(ca, f"OP_{name}")): k for k, name in enumerate(["INPUT", "CONST", "OUTPUT", *UNARY, *BINARY])}
SIMD = {"ASSIGN", "NEG", "SQ", "TWICE", "INV", "SQRT", "FABS", "ADD", "SUB", "MUL", "DIV"}

_RUN = """
#include <math.h>
#define EACH for (int l = 0; l < B; l++)
/* code: (n, 4) operation, where its result goes, its operands; w: (.., B) values of a block of rows
   in[k] of stride si[k] from row to row; out[k] of stride so[k] */
static inline __attribute__((always_inline)) void run(
    const int B, long count, long n, const int *code, const double *constants, const double *const *in, const long *si,
    double *const *out, const long *so, double *w) {{
  for (long r = 0; r < count; r += B) {{
    const long left = count - r < B ? count - r : B;
    const int *c = code;
    for (long k = 0; k < n; k++, c += 4) {{
      double *z = w + (long)c[1] * B;
      const double *x = w + (long)c[2] * B, *y = w + (long)c[3] * B;
      switch (c[0]) {{
        case 0: {{
          const double *from = in[c[2]] + r * si[c[2]] + c[3];
          for (long l = 0; l < B; l++) z[l] = from[(l < left ? l : left - 1) * si[c[2]]];
          break;
        }}
        case 1: EACH z[l] = constants[c[2]]; break;
        case 2: {{
          double *to = out[c[1]] + r * so[c[1]] + c[3];
          for (long l = 0; l < left; l++) to[l * so[c[1]]] = x[l];
          break;
        }}
{cases}
      }}
    }}
  }}
}}
"""
_ROWS = """
void rows(long count, long n, const int *code, const double *constants, const double *const *in, const long *si,
          double *const *out, const long *so, double *w) {
  run(32, count, n, code, constants, in, si, out, so, w);
}
"""


def run_source() -> str:
    """The C function `run`, which does a tape for rows, B at a time."""
    cases = []
    for k, (name, value) in enumerate([*UNARY.items(), *BINARY.items()], start=FIRST):
        second = " const double b = y[l];" if name in BINARY else ""
        hint = '_Pragma("omp simd") ' if name in SIMD else ""
        cases.append(f"        case {k}: {hint}EACH {{ const double a = x[l];{second} z[l] = {value}; }} break;")
    return _RUN.format(cases="\n".join(cases))


def source() -> str:
    """The C program of many rows."""
    return run_source() + _ROWS.replace("32", str(BLOCK))


class Program:
    """Compiled C that serves all functions, where it is at hand or has come to pay: `kind` names it in the cache.

    price: what has to be spent without it before it is compiled [s].
    """

    def __init__(
        self,
        kind: str,
        source: Callable[[], str],
        load: Callable[[Path], Any],
        check: Callable[[Any], None],
        price: float = COMPILING,
    ) -> None:
        self._kind, self._source, self._load, self._check, self._price = kind, source, load, check, price
        self.spent = 0.0  # [s] by the virtual machine on rows
        self.run: Any = None
        self._looked = self._refused = False

    def at_hand(self, coming: float) -> Any:
        """The C function; None where it is not there, and `coming` seconds more do not make it pay."""
        if self.run is None and not self._refused and kernel_loader.wanted():
            self.spent += coming
            if not self._looked or self.spent > self._price:
                self._find(self.spent > self._price)
        return self.run if kernel_loader.wanted() else None

    def _find(self, pays: bool) -> None:
        text = self._source()
        try:
            with kernel_loader.generating:
                self._looked = True
                if not pays and not kernel_loader.compiler_known():
                    return
                name = f"{self._kind}-{compiler.digest(text, compiler.toolchain())}.so"
                if pays or kernel_cache.path_of(name) is not None:
                    self.run = kernel_cache.kept(
                        name,
                        lambda: compiler.build(text, EXACT),
                        self._load,
                        lambda path: self._check(self._load(path)),
                    )
        except (PliantError, NotImplementedError, OSError):  # the virtual machine goes on; kernels tell why
            self._refused = True
