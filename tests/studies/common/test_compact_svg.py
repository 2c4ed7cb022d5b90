"""What is drawn stays where it was; what coincides, and what is said again and again, goes."""

import re

import numpy as np
from matplotlib.figure import Figure

from pliant.studies.common.compact_svg import DOTS, compact
from pliant.studies.figures.style import inline

CURVE = np.linspace(0, 6, 200)


def drawn(*styles):
    figure = Figure(figsize=(4, 2))
    ax = figure.subplots()
    for style in styles:
        ax.plot(CURVE, np.sin(CURVE), style, ms=4)
    return inline(figure)


def places(path):
    return np.array(re.findall(r"M?(-?[\d.]+) (-?[\d.]+)", path), dtype=float)


def test_a_line_keeps_its_points_to_a_tenth():
    said = '<svg><path d="M 1.234567 -0.04 \nL 3.5 4\nL 1000000.06 7 \nz\n" style="a: 1"/></svg>'
    assert compact(said) == '<svg><path d="M1.2 -0 3.5 4 1000000.1 7z" style="a: 1"/></svg>'
    bent = '<svg><path d="M 0 0.55 C 1 1 2 2 3 3 L 4 4"/></svg>'
    assert compact(bent) == '<svg><path d="M 0 0.6 C 1 1 2 2 3 3 L 4 4"/></svg>'.replace("0.6", f"{0.55:.1f}")
    scaled = '<svg><g transform="translate(1 2) scale(0.015625)"/></svg>'
    assert compact(scaled) == scaled


def test_dots_are_one_path_as_wide_as_the_marker_and_as_many_as_are_apart():
    (path,) = re.findall(r'<path d="(M[^"]*h0)"', drawn("."))
    assert len(places(path)) == len(CURVE)
    twice = drawn(".", ".")  # in two colours
    assert len(re.findall(r'<path d="M[^"]*h0"', twice)) == 2
    assert re.search(r"stroke-width: 3; stroke-linecap: round", drawn("."))  # "." is half of ms 4, and an edge of 1
    few = Figure()
    few.subplots().plot(np.arange(DOTS - 1), ".")
    assert len(re.findall("<use", inline(few))) > DOTS - 2 and "h0" not in inline(few)
    coincide = Figure()
    coincide.subplots().plot(np.zeros(3 * DOTS), ".")
    (path,) = re.findall(r'<path d="(M[^"]*h0)"', inline(coincide))
    assert 1 < len(places(path)) <= 3 * DOTS


def test_crosses_stay_crosses():
    assert len(re.findall("<use", drawn("x"))) >= len(CURVE)


def test_a_style_said_often_has_one_class_wherever_it_is():
    text = drawn("-")
    classes = set(re.findall(r'class="(s\w{8})"', text))
    assert classes and all(f".{name}{{" in text for name in classes)
    assert classes & set(re.findall(r'class="(s\w{8})"', drawn("x")))
