"""A CasADi function on many rows at once, without compiling it: its instructions read by one small C program.

CasADi's virtual machine asks for every instruction anew at each point, which takes ten times as long as the arithmetic.
Here each instruction is done for a block of rows before the next one is looked at, in a loop over vectors. The C serves
every function, so that it is compiled once a machine; of each function only the list of instructions is read. These
are the virtual machine's own, in its order, on the same numbers: results are the same to the last bit.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.native import kernel_loader
from pliant.plants.native.compiler import CompileError
from pliant.plants.toolchain import shared_library

from .tape_programs import BINARY, BLOCK, NUMBER, UNARY, Program, source

Array = np.ndarray
READING = 250  # rows on the virtual machine that reading a function's instructions takes, however many
EACH = 4e-9  # [s] of an instruction on the virtual machine
_LONG = np.dtype(ctypes.c_long)
INSTRUCTION = np.dtype([("op", "<i4"), ("i0", "<i4"), ("i1", "<i4"), ("i2", "<i4")])  # i1 and i2 of a constant: it
EDGES = (0.0, -0.0, 0.5, -2.0, np.inf, -np.inf, np.nan)
TRIED = 8  # instructions by which the place of all is found, and as many by which it is tried


def instructions(function: ca.Function) -> Array:
    """Of an SX function, INSTRUCTION's fields each: the operation, where its result goes, and its two operands; of an
    input the argument and its entry; of an output, i0 and i2, the result and its entry.

    They are read from what CasADi writes to serialize the function, two letters a byte; where they are not found there,
    one after another, which takes twice as long.
    """
    count = function.n_instructions()
    text, few = function.serialize(), [_instruction(function, k) for k in range(min(count, TRIED))]
    start = text.rfind(_letters(np.array(few, dtype=INSTRUCTION))) if count else -1
    if start >= 0 and len(text) >= start + 32 * count:
        letters = np.frombuffer(text[start : start + 32 * count].encode(), dtype=np.uint8).reshape(-1, 2) - ord("a")
        found = (letters[:, 0] + 16 * letters[:, 1]).view(INSTRUCTION)
        tried = np.unique(np.linspace(0, count - 1, TRIED).astype(int))
        if all(found[k] == np.array(_instruction(function, k), dtype=INSTRUCTION) for k in tried):
            return found
    return np.array([_instruction(function, k) for k in range(count)], dtype=INSTRUCTION)


def _instruction(function: ca.Function, k: int) -> tuple[int, int, int, int]:
    op, to, of = function.instruction_id(k), function.instruction_output(k), function.instruction_input(k)
    if op == ca.OP_CONST:
        first, second = np.array([function.instruction_constant(k)]).view(np.int32)
        return op, to[0], int(first), int(second)
    return op, to[0], of[0], to[1] if op == ca.OP_OUTPUT else of[-1]


def _letters(found: Array) -> str:
    """Bytes as CasADi writes them."""
    data = np.frombuffer(found.tobytes(), dtype=np.uint8)
    return (np.column_stack([data % 16, data // 16]).ravel() + ord("a")).astype(np.uint8).tobytes().decode()


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
        found = instructions(function)
        op, constant = found["op"], found["op"] == ca.OP_CONST
        unknown = set(np.unique(op)) - set(NUMBER)
        if unknown:
            raise NotImplementedError(f"CasADi's operations {unknown}")
        known = np.zeros(max(NUMBER) + 1, dtype=np.intc)
        known[list(NUMBER)] = list(NUMBER.values())
        self.code = np.column_stack([known[op], found["i0"], found["i1"], found["i2"]]).astype(np.intc)
        self.constants = found.view(np.int32).reshape(-1, 4)[constant, 2:].copy().view(float).ravel()
        self.code[constant, 2:] = np.column_stack([np.arange(constant.sum()), np.zeros(constant.sum())])
        self.values = int(found["i0"].max(initial=0)) + 1  # that are kept at once
        self._outputs = np.array(self.sizes, dtype=_LONG)

    def __call__(self, values: Sequence[Any], count: int) -> list[Array]:
        """Results (count, size), a column after another, of values (count, width) or (width,) or numbers."""
        given = [_rows(value, count, width) for value, width in zip(values, self.widths, strict=True)]
        strides = np.array([a.strides[0] // a.itemsize for a in given], dtype=_LONG)
        found = [np.empty((count, size)) for size in self.sizes]
        work = np.empty(BLOCK * self.values)
        self._run(
            count,
            len(self.code),
            self.code.ctypes.data,
            self.constants.ctypes.data,
            _places(given),
            strides.ctypes.data,
            _places(found),
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
    if array.shape == (count, width) and array.flags.c_contiguous:
        return array
    if array.ndim < 2 or len(array) == 1 < count:
        array = np.ascontiguousarray(np.broadcast_to(array.reshape(-1) if array.size != 1 else array.ravel(), (width,)))
        return np.broadcast_to(array, (count, width))
    array = np.broadcast_to(array, (count, width))
    if (width > 1 and array.strides[1] != array.itemsize) or array.strides[0] % array.itemsize:
        array = np.ascontiguousarray(array)
    return array


def _load(path: Path) -> Any:
    (run,) = shared_library.functions(path, "rows")
    count, pointer = ctypes.c_long, ctypes.c_void_p
    run.argtypes, run.restype = [count, count, *[pointer] * 7], None
    return run


class _Mapped(NumericFunction):
    """One that stays on the virtual machine."""

    rows_read = None


def _check(run: Any) -> None:
    """That every operation gives the virtual machine's own bits; CompileError."""
    a, b = ca.SX.sym("a", 2), ca.SX.sym("b")
    each = [ca.SX.unary(getattr(ca, f"OP_{name}"), a[0]) for name in UNARY if name != "ASSIGN"]
    each += [ca.SX.binary(getattr(ca, f"OP_{name}"), a[1], b) for name in BINARY]
    function = ca.Function("each", [a, b], [ca.vertcat(*each), a * b + 1.5])
    rng = np.random.default_rng(0)
    points = [np.vstack([rng.uniform(-1.0, 1.0, (3 * BLOCK + 5, n)), _edges(n)]) for n in (2, 1)]
    expected = _Mapped(function)(*points, batch=len(points[0]))
    for found, known in zip(Tape(function, run)(points, len(points[0])), expected):
        known = known.reshape(found.shape)
        signs = (np.signbit(found) == np.signbit(known)) | np.isnan(known)
        if not np.array_equal(found, known, equal_nan=True) or not signs.all():
            raise CompileError("rows evaluated in C have other numbers than CasADi's virtual machine gives")


def _edges(n: int) -> Array:
    """(rows, n): zeros of both signs, infinities and NaN; of n = 2 and n = 1 each meets each."""
    values = np.array(EDGES)
    return (
        np.tile(values, len(values))[:, None] if n == 1 else np.repeat(values, len(values))[:, None].repeat(n, axis=1)
    )


library = Program("rows", source, _load, _check)


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
