"""Pieces of HTML: tables, paragraphs, numbers and lengths as people read them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from html import escape
from typing import Any

SHORT = 20  # characters that a cell keeps on one line


def table(head: Sequence[str], rows: Sequence[Sequence[Any]], *, marked: Sequence[int] = ()) -> str:
    """An HTML table; numbers are set right, the `marked` rows stand out."""
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    lines = []
    for i, row in enumerate(rows):
        cells = "".join(_cell(value) for value in row)
        lines.append(f'<tr class="marked">{cells}</tr>' if i in marked else f"<tr>{cells}</tr>")
    body = "".join(lines)
    return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>\n'


def _cell(value: Any) -> str:
    if value is None or isinstance(value, (int, float)):
        return f'<td class="n">{number(value)}</td>'
    text = str(value)
    return f'<td class="s">{escape(text)}</td>' if len(text) <= SHORT else f"<td>{escape(text)}</td>"


def number(value: float | int | None) -> str:
    """Four digits, or a dash where there is none."""
    if value is None or not math.isfinite(value):
        return "–"
    return str(value) if isinstance(value, int) else f"{value:.4g}"


def counted(n: int, what: str) -> str:
    """How many of what: "1 input", "2 inputs"."""
    return f"{n} {what}" if n == 1 else f"{n} {what}s"


def paragraph(text: str, kind: str = "") -> str:
    """One escaped paragraph, of a css class where `kind` is given; `words` in backticks are code."""
    inner = re.sub(r"`([^`]*)`", r"<code>\1</code>", escape(text))
    return f'<p class="{kind}">{inner}</p>\n' if kind else f"<p>{inner}</p>\n"


def details(summary: str, body: str) -> str:
    """A part that opens on a click."""
    return f"<details><summary>{escape(summary)}</summary>{body}</details>\n"


def pictures(inlined: dict[str, str], *wanted: str) -> str:
    """The named svg pictures, those that there are."""
    return "".join(f'<figure class="{name}">{inlined[name]}</figure>\n' for name in wanted if name in inlined)


def duration(value: float) -> str:
    """A time in s as milliseconds or seconds."""
    return f"{value * 1e3:.3g} ms" if value < 1.0 else f"{value:.4g} s"


def measured(value: float, unit: str) -> str:
    """A value in its unit: lengths as `millimetres`, a bare number where the unit is 1."""
    if unit == "m":
        return millimetres(value)
    if not math.isfinite(value):
        return "no result"
    return f"{value:.3g}" if unit == "1" else f"{value:.3g} {unit}"


def millimetres(value: float) -> str:
    """A length in m as millimetres or micrometres (metres from one on) with two or three digits."""
    if not math.isfinite(value):
        return "no result"
    if value > 1e6:
        return "> 1000 km"
    if value >= 1.0:
        return f"{value:.3g} m"
    if value >= 1e-4:
        return f"{value * 1e3:.3g} mm"
    return f"{value * 1e6:.2g} µm" if value >= 1e-8 else "< 0.01 µm"
