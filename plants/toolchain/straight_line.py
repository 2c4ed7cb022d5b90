"""Straight-line code in C over vectors, a long one cut into parts, so that compilers take time by its length alone.

Each statement is one vector V of VL lanes, which the compiler need not find; a block of W lanes is PER of them, one
after another. Every part is a function of its own. A value that a later part needs goes into a row of a table, which
is free again after the last part that reads it; no part writes a row that it reads, so that both are `restrict`.
Inputs are read anew.

A source may be compiled in UNITS units, each of which is given all of it and its number UNIT: parts are in turn in one
of them, everything else is in unit 0, and has internal linkage in the others, where nothing of it is used.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

HEAD = """#ifdef UNIT
#define IN_UNIT(part) ((part) % UNITS == UNIT)
#define OF_A_UNIT __attribute__((noinline, visibility("hidden")))
#else
#define UNIT 0
#define IN_UNIT(part) 1
#define OF_A_UNIT __attribute__((noinline)) static
#endif
#if UNIT
#define EXPORTED __attribute__((unused)) static
#else
#define EXPORTED
#endif
"""
LENGTHENED = 700  # statements of a part: fits the first cache of instructions


@dataclass(frozen=True)
class Statement:
    """`name` = `value`, of the values it needs by their names; `given`: there is nothing to compute.

    Without a name the value is a statement of C that puts something out.
    """

    name: str
    value: str
    needs: tuple[str, ...] = ()
    given: bool = False

    @property
    def text(self) -> str:
        """In C."""
        return f"const V {self.name} = {self.value};" if self.name else self.value


def written(name: str, inputs: Sequence[str], outputs: Sequence[str], statements: Sequence[Statement]) -> str:
    """The C function `name` of blocks of lanes, T (*)[W]; statements know them by these names, as V *."""
    count = -(-len(statements) // LENGTHENED)
    ends = [round(k * len(statements) / max(1, count)) for k in range(count + 1)]
    parts = [statements[a:b] for a, b in pairwise(ends)]
    rows, total = _rows(parts)
    given = {s.name: s for s in statements if s.given}
    declared = [f"const V *restrict {i}" for i in inputs] + [f"V *restrict {o}" for o in outputs]
    passed = [f"(const V *){i} + h" for i in inputs] + [f"(V *){o} + h" for o in outputs]
    if count > 1:
        declared += ["const V *restrict before", "V *restrict after"]
        passed += ["(const V *)between + h", "(V *)between + h"]
    lines: list[str] = []
    for k, part in enumerate(parts):
        kind = f"{'OF_A_UNIT' if count > 1 else 'static'} void {name}_{k}({', '.join(declared)})"
        defined = [f"{kind} {{", *_body(part, rows, given), "}"]
        lines += [f"#if IN_UNIT({k})", *defined, "#else", f"{kind};", "#endif"] if count > 1 else defined
    blocks = [f"const T (*restrict {i})[W]" for i in inputs] + [f"T (*restrict {o})[W]" for o in outputs]
    lines += [f"static void {name}({', '.join(blocks)}) {{"]
    lines += [f"  T between[{max(1, total)}][W] ALIGNED;"] if count > 1 else []  # parts may share nothing
    lines += [f"  for (int h = 0; h < PER; h++) {name}_{k}({', '.join(passed)});" for k in range(count)]
    return "\n".join([*lines, "}", ""])


def of_unit(source: str, units: int, unit: int) -> str:
    """What one unit is to read: of parts that others compile only what they are called. To read all of a long source
    once in each unit took half of a compiler's time.
    """
    kept, own, inside = [], True, False
    for line in source.split("\n"):
        if line.startswith("#if IN_UNIT("):
            inside, own = True, int(line[len("#if IN_UNIT(") : -1]) % units == unit
        elif inside and line == "#else":
            own = not own
        elif inside and line == "#endif":
            inside, own = False, True
        elif own:
            kept.append(line)
    return "\n".join(kept)


def _body(part: Sequence[Statement], rows: dict[str, int], given: dict[str, Statement]) -> list[str]:
    """Its statements, each value read where it is first needed."""
    known: set[str] = set()
    lines: list[str] = []
    for statement in part:
        for need in statement.needs:
            if need not in known:
                known.add(need)
                read = given[need].text if need in given else f"const V {need} = before[{rows[need]} * PER];"
                lines.append(f"  {read}")
        if not statement.given:
            known.add(statement.name)
            lines.append(f"  {statement.text}")
        if statement.name in rows:
            lines.append(f"  after[{rows[statement.name]} * PER] = {statement.name};")
    return lines


def _rows(parts: Sequence[Sequence[Statement]]) -> tuple[dict[str, int], int]:
    """The row of every value that a later part needs, and how many rows there are."""
    made = {s.name: k for k, part in enumerate(parts) for s in part if s.name and not s.given}
    last: dict[str, int] = {}
    for k, part in enumerate(parts):
        for need in sorted({n for s in part for n in s.needs}):
            if made.get(need, k) < k:
                last[need] = k
    leaving: dict[int, list[str]] = defaultdict(list)
    for name, k in last.items():
        leaving[k].append(name)
    rows: dict[str, int] = {}
    free: list[int] = []
    total = 0
    for k, part in enumerate(parts):
        for statement in part:
            if statement.name in last:
                if not free:
                    free, total = [total], total + 1
                rows[statement.name] = free.pop()
        free += [rows[name] for name in leaving[k]]  # what this part reads is free after it
    return rows, total
