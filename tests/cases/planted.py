"""Faults planted into generated C: one small change of one line, as a wrong generator or compiler would make it."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

Rng = np.random.Generator
NUMBER = re.compile(r"(?<![\w.\[])(\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+)(?![\w.])")
VALUE = re.compile(r"\bv\d+\b")
TERM = re.compile(r" [-+] (\(?\(?T?\)?[\w.\[\]()]+(?: \* [\w.\[\]()]+)*)(?=[; ])")
SIGN = re.compile(r"(?<= )[-+](?= )|\+=(?= )")
DIFFERENCE = re.compile(r"= ([\w.\[\]()]+) - ([\w.\[\]()]+);")
INDEX = re.compile(r"\b([iogkj]\w*|before|after)\[(\d+)(?=\]\[| \* PER\])")
LANE = re.compile(r"\[l\]")
LOOP = re.compile(r"(?<= < )\d+(?=;)|(?<=, )\d+(?=\);)")
ADDRESS = re.compile(
    r"\bBLOCK\(|memcpy|ROW\[|COLUMN\[|\bvoid "
)  # what would write where nothing is its own, and end the process
CALL = re.compile(r"\b(SIN|COS)\b")


def _put(line: str, match: re.Match[str], new: str) -> str:
    return line[: match.start()] + new + line[match.end() :]


def _constant(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, repr(float(m[0]) * (1 + float(rng.choice([-1, 1])) * 10.0 ** -rng.uniform(3.0, 5.0))))


def _drop(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, "")


def _sign(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, {"+": "-", "-": "+", "+=": "-="}[m[0]])


def _swap(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, f"= {m[2]} - {m[1]};")


def _index(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    """The element beside it, of those that the source names."""
    known = {int(k) for k in re.findall(rf"\b{m[1]}\[(\d+)(?:\]\[| \* PER\])", source)}
    beside = [k for k in (int(m[2]) - 1, int(m[2]) + 1) if k in known]
    return _put(line, m, f"{m[1]}[{beside[rng.integers(len(beside))]}") if beside else line


def _lane(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    count = "VL" if "VL" in line else "W"  # of a vector alone, or of a block
    new = str(rng.choice(["[0]", f"[(l + 1) % {count}]", "[l ^ 1]"]))
    return _put(line, m, new if "#define W 1\n" not in source else "[0]")


def _stale(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    """An operand that an earlier line of the same function computed, in place of the right one."""
    own = source[: source.index(line)].rsplit("\n}", 1)[-1]
    before = [v for v in re.findall(r"const [TV] (v\d+) =", own) if v != m[0]]
    if not before or "=" not in line[: m.start()]:
        return line
    return _put(line, m, before[-1 - int(rng.integers(min(5, len(before))))])


def _single(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, f"{m[0]}f")


def _shorter(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, str(max(0, int(m[0]) - 1)))


def _other(line: str, m: re.Match[str], rng: Rng, source: str) -> str:
    return _put(line, m, {"SIN": "COS", "COS": "SIN"}[m[0]])


FAULTS: dict[str, tuple[re.Pattern[str], Callable[[str, re.Match[str], Rng, str], str]]] = {
    "constant by 1e-3 or less": (NUMBER, _constant),
    "term dropped": (TERM, _drop),
    "sign": (SIGN, _sign),
    "operands swapped": (DIFFERENCE, _swap),
    "index": (INDEX, _index),
    "lane": (LANE, _lane),
    "stale value": (VALUE, _stale),
    "single for double": (NUMBER, _single),
    "loop too short": (LOOP, _shorter),
    "other function": (CALL, _other),
}


def plant(source: str, kind: str, rng: Rng) -> str | None:
    """The source with one fault of a kind, at a place by chance; None where it has no place for one."""
    pattern, change = FAULTS[kind]
    lines = source.split("\n")
    free = [i for i, line in enumerate(lines) if not line.startswith(("#", "typedef")) and not ADDRESS.search(line)]
    places = [(i, m) for i in free for m in pattern.finditer(lines[i])]
    for k in rng.permutation(len(places))[:20]:
        i, match = places[k]
        changed = change(lines[i], match, rng, source)
        if changed != lines[i]:
            return "\n".join([*lines[:i], changed, *lines[i + 1 :]])
    return None
