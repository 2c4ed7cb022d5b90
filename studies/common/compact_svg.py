"""The same svg in fewer bytes: no more digits than a screen shows, styles said once, dots that coincide drawn once.

matplotlib writes six digits, and for each dot of a curve of dots an element of a hundred characters.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter

DIGITS = 1  # after the point, of lengths of 1/72 in
DOTS = 40  # of one curve, from which on they are drawn as one path
NEAR = 2  # dots of one colour within 1/NEAR of 1/72 in are one
OFTEN = 4  # times that a style is said, from which on it has a class

NUMBER = re.compile(rf"-?\d+\.\d{{{DIGITS + 1},}}")
PLACES = re.compile(r'( (?:d|x|y|transform|points)=")([^"]*)(")')
USE = r'<use href="#(m\w+)" x="([-\d.]+)" y="([-\d.]+)" style="([^"]*)"/>'
CURVE = re.compile(rf"(?:{USE}\s*){{{DOTS},}}")
CIRCLE = r'<path id="%s" d="M 0 ([\d.]+)\s+C [^"]*"'
STYLE = re.compile(r' style="([^"]*)"')
LINES = re.compile(r"[MLz\d.\s-]+")


def compact(text: str) -> str:
    """An svg element as short as it looks the same. Classes are named by what they say, so that pages may hold many.

    Markers that are no circles, and fewer than DOTS of them, stay elements of their own.

    >>> compact('<svg>\\n  <path d="M 1.234567 2.000000 L 3.5 4"/>\\n</svg>')
    '<svg><path d="M1.2 2 3.5 4"/></svg>'
    """
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    drawn: set[tuple[str, int, int]] = set()
    text = CURVE.sub(lambda run: _dotted(run[0], text, drawn), text)
    text = PLACES.sub(lambda found: found[1] + _placed(found[2]) + found[3], text)
    often = {style for style, times in Counter(STYLE.findall(text)).items() if times >= OFTEN}
    text = STYLE.sub(lambda found: f' class="{_named(found[1])}"' if found[1] in often else found[0], text)
    rules = "".join(f".{_named(style)}{{{style}}}" for style in sorted(often))
    text = re.sub(r">\s+<", "><", text)
    return re.sub(r"(<svg[^>]*>)", lambda found: f"{found[1]}<style>{rules}</style>", text, count=1) if rules else text


def _named(style: str) -> str:
    """The class of a style."""
    return "s" + hashlib.blake2b(style.encode(), digest_size=4).hexdigest()


def _placed(numbers: str) -> str:
    """Lengths to DIGITS; factors, of scales and matrices, as they are; lines without the letter L."""
    if "scale" in numbers or "matrix" in numbers:
        return numbers
    text = " ".join(_short(numbers).split())
    return re.sub(r" ?([Mz]) ?", r"\1", text.replace(" L ", " ")) if LINES.fullmatch(text) else text


def _short(numbers: str) -> str:
    return NUMBER.sub(lambda found: f"{float(found[0]):.{DIGITS}f}".rstrip("0").rstrip("."), numbers)


def _dotted(run: str, text: str, drawn: set[tuple[str, int, int]]) -> str:
    """Circles of one kind as one path of points with round ends, without those drawn; anything else as it was."""
    dots = re.findall(USE, run)
    (name, *_, style), kinds = dots[0], {(name, style) for name, _, _, style in dots}
    circle = re.search(CIRCLE % name, text)
    colour = re.search(r"fill: ([^;]+)", style)
    if len(kinds) > 1 or circle is None or colour is None or "opacity" in style:
        return run
    edge = re.search(r"stroke-width: ([\d.]+)", style)
    width = 2 * float(circle[1]) + (float(edge[1]) if edge else 1.0) * ("stroke:" in style)
    paint = f"fill: none; stroke: {colour[1]}; stroke-width: {width:g}; stroke-linecap: round"
    path = ""
    for _, x, y, _ in dots:
        place = (paint, round(NEAR * float(x)), round(NEAR * float(y)))
        if place not in drawn:
            drawn.add(place)
            path += f"M{_short(x)} {_short(y)}h0"
    return f'<path d="{path}" style="{paint}"/>' if path else ""
