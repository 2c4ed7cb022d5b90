"""A CasADi function on many rows at once, without compiling it: its instructions read by one small C program.

CasADi's virtual machine asks for every instruction anew at each point, which takes ten times as long as the arithmetic.
Here each instruction is done for a block of rows before the next one is looked at, in a loop over vectors. The C serves
every function, so that it is compiled once a machine; of each function only the list of instructions is read. These
are the virtual machine's own, in its order, on the same numbers: results are the same to the last bit.

The C is looked for in the cache, and compiled when the virtual machine has spent on rows, in this process, what
compiling takes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.errors import PliantError
from pliant.plants.native import compiler, kernel_cache, kernel_loader
from pliant.plants.native.compiler import CompileError
from pliant.plants.toolchain import shared_library

Array = np.ndarray
BLOCK = 32  # rows: every value of a function of a thousand operations stays in the second cache
EXACT = (
    "-O3",
    "-fno-fast-math",
    "-ffp-contract=off",
    "-fno-trapping-math",
    "-fno-math-errno",
)  # after the kernels' own
READING = 700  # rows on the virtual machine that reading a function's instructions takes, however many
EACH = 4e-9  # [s] of an instruction on the virtual machine
COMPILING = 1.0  # [s]: so much is spent on rows before the C is compiled
UNARY = {
    "ASSIGN": "a", "NEG": "-a", "SQ": "a * a", "TWICE": "a + a", "INV": "1. / a", "SQRT": "sqrt(a)", "SIN": "sin(a)",
    "COS": "cos(a)", "TAN": "tan(a)", "ASIN": "asin(a)", "ACOS": "acos(a)", "ATAN": "atan(a)", "EXP": "exp(a)",
    "LOG": "log(a)", "SINH": "sinh(a)", "COSH": "cosh(a)", "TANH": "tanh(a)", "FABS": "fabs(a)",
    "SIGN": "a < 0 ? -1. : a > 0 ? 1. : a", "NOT": "!a", "FLOOR": "floor(a)", "CEIL": "ceil(a)",
}  # fmt: skip
BINARY = {
    "ADD": "a + b", "SUB": "a - b", "MUL": "a * b", "DIV": "a / b", "POW": "pow(a, b)", "CONSTPOW": "pow(a, b)",
    "ATAN2": "atan2(a, b)", "FMIN": "fmin(a, b)", "FMAX": "fmax(a, b)", "LT": "a < b", "LE": "a <= b", "EQ": "a == b",
    "NE": "a != b", "AND": "a && b", "OR": "a || b", "IF_ELSE_ZERO": "a != 0 ? b : 0.",
}  # fmt: skip
FIRST = 3  # 0 .. 2: an input, a constant, an output
NUMBER = {int(getattr(ca, f"OP_{name}")): FIRST + k for k, name in enumerate([*UNARY, *BINARY])}
SIMD = {"ASSIGN", "NEG", "SQ", "TWICE", "INV", "SQRT", "FABS", "ADD", "SUB", "MUL", "DIV"}

_SOURCE = """
#include <math.h>
#define B {block}
#define EACH for (int l = 0; l < B; l++)
/* code: (n, 4) operation, where its result goes, its operands; w: (.., B) values of a block of rows
   in[k], of width ni[k] and stride si[k] from row to row; out[k] of stride so[k] */
void rows(long count, long n, const int *code, const double *constants, const double *const *in, const long *si,
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


def source() -> str:
    """The C program."""
    cases = []
    for k, (name, value) in enumerate([*UNARY.items(), *BINARY.items()], start=FIRST):
        second = " const double b = y[l];" if name in BINARY else ""
        hint = '_Pragma("omp simd") ' if name in SIMD else ""
        cases.append(f"        case {k}: {hint}EACH {{ const double a = x[l];{second} z[l] = {value}; }} break;")
    return _SOURCE.format(block=BLOCK, cases="\n".join(cases))


class Tape:
    """The instructions of an SX function, for rows of its arguments. NotImplementedError for one that C has not."""

    def __init__(self, function: ca.Function, run: Any) -> None:
        self._run = run
        if not all(function.nnz_in(i) == function.numel_in(i) for i in range(function.n_in())):
            raise NotImplementedError("a sparse argument")
        if not all(function.nnz_out(i) == function.numel_out(i) for i in range(function.n_out())):
            raise NotImplementedError("a sparse result")
        self.widths = [function.numel_in(i) for i in range(function.n_in())]
        self.sizes = [function.numel_out(i) for i in range(function.n_out())]
        constants: list[float] = []
        code: list[tuple[int, int, int, int]] = []
        for k in range(function.n_instructions()):
            op, to, of = function.instruction_id(k), function.instruction_output(k), function.instruction_input(k)
            if op == ca.OP_INPUT:
                code.append((0, to[0], of[0], of[1]))
            elif op == ca.OP_CONST:
                code.append((1, to[0], len(constants), 0))
                constants.append(float(function.instruction_constant(k)))
            elif op == ca.OP_OUTPUT:
                code.append((2, to[0], of[0], to[1]))
            elif op in NUMBER:
                code.append((NUMBER[op], to[0], of[0], of[-1]))
            else:
                raise NotImplementedError(f"CasADi's operation {op}")
        self._code = np.array(code, dtype=np.intc).reshape(-1, 4)
        self._constants = np.array(constants, dtype=float)
        self._values = BLOCK * (int(self._code[:, 1].max(initial=0)) + 1)
        self._outputs = np.array(self.sizes, dtype=_LONG)

    def __call__(self, values: Sequence[Any], count: int) -> list[Array]:
        """Results (count, size), a column after another, of values (count, width) or (width,) or numbers."""
        given = [_rows(value, count, width) for value, width in zip(values, self.widths, strict=True)]
        strides = np.array([a.strides[0] // a.itemsize for a in given], dtype=_LONG)
        found = [np.empty((count, size)) for size in self.sizes]
        places = [
            (ctypes.c_void_p * max(1, len(arrays)))(*(a.ctypes.data for a in arrays)) for arrays in (given, found)
        ]
        work = np.empty(self._values)
        self._run(
            count,
            len(self._code),
            self._code.ctypes.data,
            self._constants.ctypes.data,
            places[0],
            strides.ctypes.data,
            places[1],
            self._outputs.ctypes.data,
            work.ctypes.data,
        )
        return found


def _places(arrays: Sequence[Array]) -> Any:
    """Where each begins, in C."""
    return (ctypes.c_void_p * max(1, len(arrays)))(*(a.ctypes.data for a in arrays))


def _rows(value: Any, count: int, width: int) -> Array:
    """(count, width), each row's numbers beside each other; of a shared row all rows are that one."""
    array = np.asarray(value, dtype=float)
    if array.ndim < 2 or len(array) == 1 < count:
        array = np.ascontiguousarray(np.broadcast_to(array.reshape(-1) if array.size != 1 else array.ravel(), (width,)))
        return np.broadcast_to(array, (count, width))
    array = np.broadcast_to(array, (count, width))
    if (width > 1 and array.strides[1] != array.itemsize) or array.strides[0] % array.itemsize:
        array = np.ascontiguousarray(array)
    return array


_LONG = np.dtype(ctypes.c_long)


class _Library:
    """The compiled C, where it is at hand or has come to pay."""

    def __init__(self) -> None:
        self.spent = 0.0  # [s] by the virtual machine on rows
        self.run: Any = None
        self._looked = self._refused = False

    def at_hand(self, coming: float) -> Any:
        """The C function; None where it is not there, and `coming` seconds more do not make it pay."""
        if self.run is None and not self._refused and kernel_loader.wanted():
            self.spent += coming
            if not self._looked or self.spent > COMPILING:
                self._find(self.spent > COMPILING)
        return self.run if kernel_loader.wanted() else None

    def _find(self, pays: bool) -> None:
        text = source()
        try:
            with kernel_loader.generating:
                self._looked = True
                if not pays and not kernel_loader.compiler_known():
                    return
                name = f"tape-{compiler.digest(text, compiler.toolchain())}.so"
                if pays or kernel_cache.path_of(name) is not None:
                    self.run = kernel_cache.kept(name, lambda: compiler.build(text, EXACT), _load, _check)
        except (PliantError, NotImplementedError, OSError):  # the virtual machine goes on; kernels tell why
            self._refused = True


def _load(path: Path) -> Any:
    (run,) = shared_library.functions(path, "rows")
    count, pointer = ctypes.c_long, ctypes.c_void_p
    run.argtypes, run.restype = [count, count, *[pointer] * 7], None
    return run


def _check(path: Path) -> None:
    """That every operation gives the virtual machine's own bits; CompileError."""
    a, b = ca.SX.sym("a", 2), ca.SX.sym("b")
    each = [a[0].__class__.unary(getattr(ca, f"OP_{name}"), a[0]) for name in UNARY if name != "ASSIGN"]
    each += [ca.SX.binary(getattr(ca, f"OP_{name}"), a[1], b) for name in BINARY]
    function = ca.Function("each", [a, b], [ca.vertcat(*each), a * b + 1.5])
    rng = np.random.default_rng(0)
    points = [rng.uniform(-1.0, 1.0, (3 * BLOCK + 5, n)) for n in (2, 1)]
    machine = NumericFunction(function)
    machine.rows_read = None
    expected = machine(*points, batch=len(points[0]))
    for found, known in zip(Tape(function, _load(path))(points, len(points[0])), expected):
        if not np.array_equal(found, known.reshape(found.shape), equal_nan=True):
            raise CompileError("rows evaluated in C have other numbers than CasADi's virtual machine gives")


library = _Library()


class RowsRead:
    """Asked by a NumericFunction for its rows: a tape, once as many rows as reading it takes have come."""

    def __init__(self, function: ca.Function) -> None:
        self._function = function
        self._left: float = READING if function.is_a("SXFunction") else np.inf
        self._operations = function.n_instructions() if function.is_a("SXFunction") else 0
        self._tape: Tape | None = None

    def __call__(self, count: int) -> Callable[[Sequence[Any], int], list[Array]] | None:
        """What evaluates `count` rows; None: the virtual machine."""
        if self._tape is not None:
            return self._tape if kernel_loader.wanted() else None
        self._left -= count
        run = library.at_hand(EACH * count * self._operations) if self._left < np.inf else None
        if self._left > 0 or run is None:
            return None
        try:
            self._tape = Tape(self._function, run)
        except NotImplementedError:
            self._left = np.inf
        return self._tape
