"""Pieces of C99: numbers, constant arrays, and one law or step as the structs, constants and functions it needs.

In all text the word REAL stands for the file's type of numbers, `double` or `float`; the words SIN, COS .. for its
functions, ADD_PRODUCT for its product of a matrix and a vector. Names begin with the prefix of what they belong to, so
that several files link into one program.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isinf

import numpy as np

from pliant.plants.core.argument_gates import require_text, shown

PRECISIONS = {"double": ("double", ""), "single": ("float", "f")}
MOST = 2_000_000  # numbers of constants, or of a state: 16 MB in double precision, about 50 MB of text
FUNCTIONS = ("sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "fabs", "pow", "atan2")
RESERVED = (
    *(
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
    ),
    *("for", "goto", "if", "inline", "int", "long", "main", "register", "restrict", "return", "short", "signed"),
    *("sizeof", "static", "struct", "switch", "typedef", "union", "unsigned", "void", "volatile", "while"),
)
PRODUCT = """/* y += scale A x, A (rows, cols) row by row */
static void ADD_PRODUCT(int rows, int cols, REAL scale, const REAL *A, const REAL *x, REAL *y)
{
    int i, j;
    for (i = 0; i < rows; i++) {
        REAL sum = 0;
        for (j = 0; j < cols; j++) sum += A[i * cols + j] * x[j];
        y[i] += scale * sum;
    }
}
"""


@dataclass(frozen=True)
class Law:
    """One law in C: `reset` and `act` are bodies of functions of `s`, a pointer to its struct.

    `act` has t (double), y (REAL [reads]) and fills u (REAL [inputs]). `structs` are those of laws inside.
    """

    prefix: str
    what: str
    reads: tuple[str, ...]
    inputs: int
    fields: tuple[str, ...]
    constants: str
    functions: str
    reset: str
    act: str
    structs: str = ""

    @property
    def struct(self) -> str:
        """All structs, innermost first."""
        fields = "".join(f"    {line}\n" for line in (*self.fields, "long acts; /* since reset */"))
        return f"{self.structs}typedef struct {{\n{fields}}} {self.prefix}_state;\n"

    def code(self, linkage: str) -> str:
        """Constants and functions; `linkage`: "" or "static "."""
        p, n, m = self.prefix, len(self.reads), self.inputs
        return (
            f"{self.constants}{self.functions}"
            f"{linkage}void {p}_reset({p}_state *s)\n{{\n{indented(self.reset)}    s->acts = 0;\n}}\n\n"
            f"{linkage}void {p}_act({p}_state *s, double t, const REAL y[{n}], REAL u[{m}])\n"
            f"{{\n{indented(self.act)}    s->acts++;\n    (void)t;\n}}\n\n"
        )


def c_name(owner: str, name: str) -> str:
    """`name` where it can be one in C; ValueError else."""
    require_text(owner, name)
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or name in RESERVED or len(name) > 40:
        raise ValueError(f"{owner} = {shown(name)} must be a C name: a letter, then letters, digits or _, at most 40")
    return name


def number(value: float) -> str:
    """A constant of type REAL, to the last digit."""
    value = float(value)
    if isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return f"(REAL){value!r}" if value >= 0 else f"((REAL){value!r})"


def require_room(what: str, constants: int, state: int, single: bool) -> None:
    """ValueError, with the size that a file would have, where that is more than MOST numbers."""
    if max(constants, state) > MOST:
        size = 4 if single else 8
        raise ValueError(
            f"export_c: {what} would take {constants:,} numbers of constants ({constants * size / 1e6:,.1f} MB) and a "
            f"state of {state:,} ({state * size / 1e6:,.1f} MB), at most {MOST:,} of either are written: shorten the "
            "horizon or the motion, or give `blocks`"
        )


def array(name: str, values: np.ndarray | Sequence[float]) -> str:
    """A constant array, row by row."""
    flat = np.asarray(values, dtype=float).ravel()
    require_room(name, len(flat), 0, False)
    lines = [", ".join(map(number, flat[k : k + 4])) for k in range(0, len(flat), 4)]
    return f"static const REAL {name}[{len(flat)}] = {{\n    " + ",\n    ".join(lines) + "\n};\n"


def indented(text: str) -> str:
    """One level further in."""
    return "".join(f"    {line}\n" if line else "\n" for line in text.splitlines())


def added(rows: int, cols: int, scale: str, A: str, x: str, y: str) -> str:
    """The statement y += scale A x; none where there is nothing to add."""
    return f"ADD_PRODUCT({rows}, {cols}, {scale}, {A}, {x}, {y});\n" if rows and cols else ""


def each(index: str, count: int, body: str) -> str:
    """A loop over `count` entries."""
    return f"for ({index} = 0; {index} < {count}; {index}++) {body}\n" if count else ""


def clipped(p: str, count: int, low: np.ndarray, high: np.ndarray) -> tuple[str, str]:
    """(constants, statements) that keep u within its limits; nothing where there are none."""
    if not np.isfinite([low, high]).any():
        return "", ""
    constants = array(f"{p}_low", low) + array(f"{p}_high", high)
    body = f"{{\n    if (u[i] > {p}_high[i]) u[i] = {p}_high[i];\n    if (u[i] < {p}_low[i]) u[i] = {p}_low[i];\n}}"
    return constants, each("i", count, body)


def pushed(field: str, count: int, width: int, newest: str) -> str:
    """Statements that let the oldest `width` of `count` inputs on their way go, and put `newest`, of index i, last."""
    moved = each("i", count - width, f"s->{field}[i] = s->{field}[i + {width}];")
    return moved + each("i", width, f"s->{field}[{count - width} + i] = {newest};")


def files(name: str, head: str, struct: str, declared: str, code: str, precision: str) -> tuple[str, str]:
    """(header, source) of a part in `precision`; `head` is the comment that says what it is."""
    kind, suffix = PRECISIONS[precision]
    comment = "/* " + _printable(head.strip()).replace("\n", "\n * ") + "\n */\n"
    guard = f"{name.upper()}_H"
    header = f"#ifndef {guard}\n#define {guard}\n\ntypedef {kind} {name}_real;\n\n{struct}{declared}\n#endif\n"
    header = comment + re.sub(r"\bREAL\b", f"{name}_real", header)
    calls = "".join(f"#define {f.upper()} {f}{suffix}\n" for f in FUNCTIONS if re.search(rf"\b{f.upper()}\(", code))
    if "ADD_PRODUCT(" in code:
        code = re.sub(r"\bADD_PRODUCT\b", f"{name}_add_product", PRODUCT + "\n" + code)
    maths = "#include <math.h>\n" if calls or "INFINITY" in code else ""
    if re.search(r"\(T\)", code):
        code = re.sub(r"\(T\)", "(REAL)", code)
    code = re.sub(r"\bREAL\b", f"{name}_real", code)
    if precision == "single":
        code = re.sub(rf"\({name}_real\)(-?[0-9.]+(?:e[+-]?[0-9]+)?)", _single, code)
    return header, f'{comment}#include "{name}.h"\n{maths}{calls}\n{code}'


def _printable(text: str) -> str:
    """What may stand in a comment: no end or start of one, no sign that compilers refuse or people cannot see."""
    text = text.replace("*/", "* /").replace("/*", "/ *").replace("??/", "? ?/")
    return "".join(c if c == "\n" or c.isprintable() else repr(c)[1:-1] for c in text)


def _single(found: re.Match[str]) -> str:
    """A constant rounded to single precision."""
    value = float(np.float32(found.group(1)))
    return "INFINITY" if isinf(value) else f"{value!r}f"
