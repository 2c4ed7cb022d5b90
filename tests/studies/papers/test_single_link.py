""" "On the dynamic modelling of flexible manipulators": Figure 3 and the spin-up."""

import numpy as np

from pliant.studies.papers.single_link import CHI, MASS, MU, OFFSET, PRODUCT, first_frequency, first_root


def test_figure_3_shows_the_root_squared():
    drawn = first_frequency(points=4)
    right = drawn.axes[1]
    curve = next(line for line in right.lines if "0.5" in line.get_label())
    i = len(curve.get_xdata()) // 2
    assert curve.get_ydata()[i] == first_root(curve.get_xdata()[i], 0.5) ** 2
    assert (MASS, OFFSET, PRODUCT, CHI, MU) == (1.0, (0.05, 0.05, 0.05), 0.005, 1.1, 0.05)


def test_more_inertia_lowers_the_frequency():
    """Rayleigh's principle: adding inertia to the payload raises no frequency."""
    roots = [first_root(x, 0.5) for x in np.geomspace(0.005, 5.0, 6)]
    assert (np.diff(roots) <= 1e-12).all() and roots[-1] < 0.9 * roots[0]
