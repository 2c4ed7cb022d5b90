"""Every public callable with nonsense, and with valid values in every guise: refused in words, or taken.

    python tests/campaigns/bad_input.py [--calls 10000] [--first 0] [--only WORD]

Each call of argument_calls.py is made with its valid arguments, of which one is replaced. A refusal is right where it
is a ValueError (or a PliantError) that names the argument, or another one that it must fit to; everything else is a
fault:

raw      another exception, or words that do not name the argument: what NumPy or Python says from deep inside
taken    nonsense that gave a result
refused  a valid value that was refused, or gave another result
slow     longer than LONGEST
"""

from __future__ import annotations

import argparse
import collections
import re
import sys
import time
import traceback
import warnings
from typing import Any

import numpy as np
from argument_calls import calls
from argument_kinds import Call

from pliant.plants import PliantError

LONGEST = 60.0  # [s]
FAULTS = ("raw", "taken", "refused", "slow")
RAW = re.compile(
    r"could not convert|could not be broadcast|not supported between|unsupported operand|has no attribute|not subscript"
    r"|cannot reshape|shapes? .* not aligned|ambiguous|inhomogeneous|setting an array|not iterable|Dimension mismatch"
    r"|object is not|must be real number, not|cannot convert|invalid literal|No matching function"
)


def cases(found: list[Call]) -> list[tuple[Call, str, str, Any, bool]]:
    """Every (call, argument, what it is, value, whether it is valid)."""
    out = []
    for call in found:
        for argument, kind in call.kinds.items():
            out += [(call, argument, what, value, False) for what, value in kind.bad()]
            out += [(call, argument, what, value, True) for what, value in kind.good() if not call.long]
    return out


def made(call: Call, argument: str, value: Any) -> Any:
    """The result of a call with one argument replaced."""
    given = {name: kind.value for name, kind in call.kinds.items()} | call.fixed | {argument: value}
    first = [given.pop(name) for name in call.positional]
    return call.function(*first, **given)


def judged(call: Call, argument: str, value: Any, valid: bool, expected: Any) -> tuple[str, str]:
    """(fault or "", the words of it)."""
    began = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = made(call, argument, value)
    except (ValueError, PliantError) as error:
        words = str(error)
        if valid:
            return "refused", f"{type(error).__name__}: {words}"
        names = [*call.kinds, *call.fixed, *call.name.split(".")[1:], "nonsense"]  # or another that it must fit to
        if not any(told(name, words) for name in names) or RAW.search(words):
            return "raw", f"{type(error).__name__}: {words} {place(error)}"
    except Exception as error:
        return ("refused" if valid else "raw"), f"{type(error).__name__}: {error} {place(error)}"
    else:
        if not valid:
            return "taken", f"gave a {type(result).__name__}"
        if expected is not None and call.compare and not alike(result, expected):
            return "refused", "gave another result"
    return ("slow", "") if time.perf_counter() - began > LONGEST else ("", "")


def told(name: str, words: str) -> bool:
    """Whether a message names an argument; x0 may be told as x. A matrix A is not named by the article."""
    plain = re.split(r"[\[(. 0-9]", name)[0]
    if len(plain) == 1:
        return bool(re.search(rf"(?<![A-Za-z]){plain}(?![A-Za-z])", words))
    plain = plain.lower().replace("_", " ")
    return bool(re.search(rf"(?<![a-z]){re.escape(plain)}(?![a-z])", words.lower().replace("_", " ")))


def place(error: BaseException) -> str:
    """The file and line where it was raised, the last of Pliant's own beside it."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if "/site-packages/" not in f.filename and "/tests/" not in f.filename]
    last = own[-1] if own else frames[-1]
    return f"[{'/'.join(last.filename.split('/')[-3:])}:{last.lineno}]"


def alike(a: Any, b: Any) -> bool:
    """Whether two results hold the same numbers, to rounding."""
    numbers = (int, float, np.ndarray, np.number)
    if (
        isinstance(a, numbers)
        and isinstance(b, numbers)
        and "O" not in (np.asarray(a).dtype.kind, np.asarray(b).dtype.kind)
    ):
        return np.shape(a) == np.shape(b) and bool(np.allclose(a, b, rtol=1e-9, atol=1e-12, equal_nan=True))
    if isinstance(a, (tuple, list)) and isinstance(b, (tuple, list)):
        return len(a) == len(b) and all(alike(x, y) for x, y in zip(a, b))
    fields = [n for n in ("A", "B", "C", "x", "y", "u", "K", "P", "t") if isinstance(getattr(a, n, None), np.ndarray)]
    return type(a) is type(b) and all(alike(getattr(a, n), getattr(b, n)) for n in fields)


def run(found: list[Call], pick: np.ndarray | None) -> list[dict[str, Any]]:
    """Rows of the faults of all cases, or of those picked."""
    every, rows, expected = cases(found), [], {}
    for k in range(len(every)) if pick is None else pick:
        call, argument, what, value, valid = every[k]
        if valid and call.name not in expected:
            first = next(iter(call.kinds))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    expected[call.name] = made(call, first, call.kinds[first].value)
                except Exception as error:
                    print(f"the valid call of {call.name} fails: {error}", file=sys.stderr)
                    raise
        fault, words = judged(call, argument, value, valid, expected.get(call.name))
        rows.append({"call": call.name, "argument": argument, "what": what, "fault": fault, "words": words})
    return rows


def table(rows: list[dict[str, Any]]) -> str:
    """Calls and faults by what the value was."""
    by = collections.defaultdict(collections.Counter)
    for row in rows:
        by[row["what"]][row["fault"] or "right"] += 1
    lines = ["| value | calls | raw | taken | refused | slow |", "|---|---|---|---|---|---|"]
    total = collections.Counter()
    for what, count in sorted(by.items()):
        total.update(count)
        lines.append(f"| {what} | {sum(count.values())} | " + " | ".join(str(count[f]) for f in FAULTS) + " |")
    lines.append(f"| all | {sum(total.values())} | " + " | ".join(str(total[f]) for f in FAULTS) + " |")
    return "\n".join(lines)


def main() -> None:
    """Run the campaign; exit with 1 where anything is at fault."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--calls", type=int, default=0, help="how many, drawn by seed; 0: every one")
    ask.add_argument("--first", type=int, default=0, help="the seed")
    ask.add_argument("--only", default="", help="of calls whose name holds this")
    given = ask.parse_args()
    found = [c for c in calls() if given.only in c.name]
    rng, count = np.random.default_rng(given.first), len(cases(found))
    pick = rng.choice(count, size=min(given.calls, count), replace=False) if given.calls else None
    rows = run(found, pick)
    for row in rows:
        if row["fault"]:
            print(f"{row['fault']:8s} {row['call']}({row['argument']} = {row['what']}): {row['words'][:230]}")
    print(table(rows))
    print(f"{len(found)} callables, {len(rows)} calls, {sum(bool(r['fault']) for r in rows)} faults")
    sys.exit(any(r["fault"] for r in rows))


if __name__ == "__main__":
    main()
