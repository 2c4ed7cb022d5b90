"""A CasADi SX function's instructions done in extended precision, beside samples of what rounding makes of them.

The columns of every value are `lanes` points, first as exactly as the machine can, then SAMPLES times with each
operation's result, each input and each constant that the precision does not hold moved at random by as much as the
precision's rounding moves it. The spread of the samples is what rounding may do to the value there, cancellation and
ill-conditioned solutions included, in any order of the same operations (Monte Carlo arithmetic: Parker, "Monte Carlo
arithmetic: exploiting randomness in floating-point arithmetic", UCLA CSD-970002, 1997).

Where `longdouble` is no wider than `double` (MSVC, Apple's ARM) the exact columns of a double are rounded themselves,
as one more sample: `exact` tells.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

Array = np.ndarray
SAMPLES = 8
ROWS = 211  # of noise, taken in turn: prime, so that no loop of a function meets the same ones again
WIDEST = np.longdouble
LIBRARY = 4.0  # units in the last place of vectorised functions (libmvec's promise), of reciprocals and square roots


def _rounded(f: Callable[..., Array]) -> Callable[..., Array]:
    return lambda *a: f(*a).astype(a[0].dtype)


EXACT: dict[int, Callable[..., Array]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_LIFT: lambda a, b: a,
    ca.OP_NEG: np.negative,
    ca.OP_TWICE: lambda a: a + a,
    ca.OP_FABS: np.abs,
    ca.OP_SIGN: np.sign,
    ca.OP_COPYSIGN: np.copysign,
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    ca.OP_LT: _rounded(np.less),
    ca.OP_LE: _rounded(np.less_equal),
    ca.OP_EQ: _rounded(np.equal),
    ca.OP_NE: _rounded(np.not_equal),
    ca.OP_NOT: _rounded(np.logical_not),
    ca.OP_AND: _rounded(np.logical_and),
    ca.OP_OR: _rounded(np.logical_or),
    ca.OP_IF_ELSE_ZERO: lambda a, b: np.where(a != 0, b, 0),
    ca.OP_FMOD: np.fmod,
    ca.OP_REMAINDER: lambda a, b: a - b * np.rint(a / b),
}
ROUNDED_ONCE: dict[int, Callable[..., Array]] = {
    ca.OP_ADD: np.add,
    ca.OP_SUB: np.subtract,
    ca.OP_MUL: np.multiply,
    ca.OP_SQ: np.square,
}
BY_LIBRARY: dict[int, Callable[..., Array]] = {
    ca.OP_DIV: np.divide,
    ca.OP_INV: np.reciprocal,
    ca.OP_SQRT: np.sqrt,
    ca.OP_POW: np.power,
    ca.OP_CONSTPOW: np.power,
    ca.OP_EXP: np.exp,
    ca.OP_EXPM1: np.expm1,
    ca.OP_LOG: np.log,
    ca.OP_LOG1P: np.log1p,
    ca.OP_SIN: np.sin,
    ca.OP_COS: np.cos,
    ca.OP_TAN: np.tan,
    ca.OP_ASIN: np.arcsin,
    ca.OP_ACOS: np.arccos,
    ca.OP_ATAN: np.arctan,
    ca.OP_ATAN2: np.arctan2,
    ca.OP_SINH: np.sinh,
    ca.OP_COSH: np.cosh,
    ca.OP_TANH: np.tanh,
    ca.OP_ASINH: np.arcsinh,
    ca.OP_ACOSH: np.arccosh,
    ca.OP_ATANH: np.arctanh,
    ca.OP_HYPOT: np.hypot,
    ca.OP_ERF: lambda a: np.array([math.erf(v) for v in a], dtype=a.dtype),  # to a double, which LIBRARY covers
}


def _eps(dtype: np.dtype[Any]) -> float:
    return float(np.finfo(dtype).eps)


class Arithmetic:
    """The columns' number format and noise, for kernels of `dtype` at `lanes` points; called, it makes functions."""

    def __init__(self, dtype: np.dtype, lanes: int, seed: int = 0) -> None:
        self.format: np.dtype[Any] = np.dtype(np.float64 if dtype == np.float32 else WIDEST)
        self.precision, self.lanes, self.columns = dtype, lanes, lanes * (1 + SAMPLES)
        self.eps = _eps(dtype)
        draw = np.random.default_rng(seed)
        noise = draw.choice([-1.0, 1.0], (ROWS, self.columns)) * draw.uniform(0.5, 1.0, (ROWS, self.columns))
        noise[:, :lanes] = 0.0
        noise = noise.astype(self.format) * self.format.type(self.eps)
        self.noise, self.library = 1 + noise, 1 + LIBRARY * noise
        self.turn = 0

    @property
    def exact(self) -> bool:
        """Whether the exact columns are free of what rounds a kernel."""
        return _eps(self.format) < 1e-2 * self.eps

    def spread(self, points: Array) -> Array:
        """Points (lanes, n), or a value for all, as columns (all columns, n)."""
        values = np.asarray(points, dtype=self.format)
        return np.tile(values, (1 + SAMPLES, 1)) if values.ndim == 2 else values

    def __call__(self, function: ca.Function, *, matrices: bool = False) -> Extended:
        """The function on columns, called as a `NumericFunction` on a batch."""
        return Extended(function, self, matrices=matrices)

    def moved(self, values: Array) -> Array:
        """Results (all columns, ..) of one operation more, as rounding may have left them."""
        self.turn = (self.turn + 1) % ROWS
        return values * self.noise[self.turn].reshape(-1, *[1] * (np.ndim(values) - 1))

    def moved_apart(self, values: Array) -> Array:
        """The same of as many operations as there are elements of a column, each moved by its own."""
        count = int(np.prod(values.shape[1:]))
        turns = (self.turn + 1 + np.arange(count)) % ROWS
        self.turn = int(turns[-1]) if count else self.turn
        return values * self.noise[turns].T.reshape(values.shape)

    def statistics(self, values: Array) -> tuple[Array, Array]:
        """The exact values (lanes, n) of all columns, and how far the samples stray from them at most."""
        parts = values.reshape(1 + SAMPLES, self.lanes, -1)
        return parts[0], np.abs(parts[1:] - parts[0]).max(axis=0)


def mover(numeric: Any, *, apart: bool = False) -> Callable[[Array], Array]:
    """What moves values as rounding does, of an arithmetic that makes functions numeric; nothing of another maker.

    `apart`: elements of a column each by its own, as sums and products of many different ones need it.
    """
    if not isinstance(numeric, Arithmetic):
        return lambda values: values
    return numeric.moved_apart if apart else numeric.moved


class Extended:
    """An SX function over all columns of an arithmetic. NotImplementedError for an operation that is unknown here."""

    def __init__(self, function: ca.Function, arithmetic: Arithmetic, *, matrices: bool = False) -> None:
        self.arithmetic, self.matrices = arithmetic, matrices
        self._shapes = [function.size_out(k) for k in range(function.n_out())]
        self._places = [function.sparsity_out(k).find() for k in range(function.n_out())]  # column after column
        self._inputs = [function.sparsity_in(k).find() for k in range(function.n_in())]
        self._registers = function.sz_w()
        self._steps = list(map(self._step, *_instructions(function)))

    def _step(self, op: int, args: Sequence[int], out: Sequence[int], number: float) -> tuple[Any, ...]:
        known = self.arithmetic
        if op == ca.OP_INPUT:
            return "in", args[0], self._inputs[args[0]][args[1]], out[0]
        if op == ca.OP_OUTPUT:
            return "out", out[0], self._places[out[0]][out[1]], args[0]
        if op == ca.OP_CONST:
            held = float(known.precision.type(number)) == number or not np.isfinite(number)
            return "held" if held else "constant", known.format.type(number), 0, out[0]
        for table, noise in ((EXACT, None), (ROUNDED_ONCE, known.noise), (BY_LIBRARY, known.library)):
            if op in table:
                return table[op], tuple(args), noise, out[0]
        raise NotImplementedError(f"operation {op} is not known to extended_evaluation.py")

    def __call__(self, *values: Any, batch: int | None = None) -> list[Array]:
        """Outputs (columns, rows), or (columns, rows, columns of the output) where it is no vector."""
        known = self.arithmetic
        n, turn = known.columns, known.turn
        with np.errstate(all="ignore"):
            given = [self._columns(v) for v in values]
            found = [np.zeros((r * c, n), dtype=known.format) for r, c in self._shapes]
            register: list[Any] = [None] * self._registers
            for what, a, b, c in self._steps:
                turn = turn + 1 if turn < ROWS - 1 else 0
                if callable(what):
                    value = what(register[a[0]]) if len(a) == 1 else what(register[a[0]], register[a[1]])
                    register[c] = value if b is None else value * b[turn]
                elif what == "in":
                    register[c] = given[a][b] * known.noise[turn]
                elif what == "out":
                    found[a][b] = register[c]
                elif what == "held":
                    register[c] = np.full(n, a)
                else:
                    register[c] = a * known.noise[turn]
        known.turn = turn
        return [
            f.T if c == 1 and not self.matrices else f.T.reshape(n, c, r).transpose(0, 2, 1)
            for f, (r, c) in zip(found, self._shapes)
        ]

    def _columns(self, value: Any) -> Array:
        """An input as rows of columns."""
        array = np.asarray(value, dtype=self.arithmetic.format)
        rows = array.reshape(len(array), -1).T if array.ndim > 1 else array.reshape(-1, 1)
        return np.broadcast_to(rows, (len(rows), self.arithmetic.columns))


def _instructions(function: ca.Function) -> tuple[list[int], list[Any], list[Any], list[float]]:
    """Operation, arguments, results and constant of every instruction."""
    ops = [function.instruction_id(k) for k in range(function.n_instructions())]
    args = [function.instruction_input(k) for k in range(len(ops))]
    out = [function.instruction_output(k) for k in range(len(ops))]
    numbers = [float(function.instruction_constant(k)) if op == ca.OP_CONST else 0.0 for k, op in enumerate(ops)]
    return ops, args, out, numbers
