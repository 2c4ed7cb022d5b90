"""The picture of a Campbell diagram shows its curves, orders and crossings."""

import numpy as np
import pytest

from pliant.plants.periodic import Campbell, Crossing
from pliant.studies.stability import campbell_diagram

SPEEDS = np.linspace(0.0, 10.0, 6)
FOUND = Campbell(
    SPEEDS,
    np.column_stack([5 + 0.1 * SPEEDS, 12 + 0 * SPEEDS]),
    np.zeros((6, 2)),
    (Crossing(1, 0, 50 / 9, 50 / 9), Crossing(2, 1, 6.0, 12.0)),
    0.99,
)


def test_what_is_drawn():
    ax = campbell_diagram(FOUND, "a beam").axes[0]
    lines = [line for line in ax.lines if line.get_linestyle() == "-"]
    assert len(lines) == 2 and lines[0].get_ydata() == pytest.approx(FOUND.frequencies[:, 0] / (2 * np.pi))
    assert {text.get_text() for text in ax.texts} == {"1x", "2x"}
    dots = [line for line in ax.lines if line.get_marker() == "o"]
    assert dots[1].get_xdata() == pytest.approx([180 / np.pi]) and dots[1].get_ydata() == pytest.approx([6 / np.pi])
    assert ax.get_title(loc="left") == "a beam"


def test_nothing_else_is_drawn():
    with pytest.raises(ValueError, match="found"):
        campbell_diagram(None)
