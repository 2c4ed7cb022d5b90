"""The pictures of linear models."""

import numpy as np

from pliant.envs import scenes
from pliant.studies.figures.linear_models import eigenvalues, frozen, plain_labels


def test_eigenvalues_of_the_upper_half_plane_each_set_once():
    """One real and a pair: two points a set; the axes hold all of them."""
    values = np.array([-0.5, -1 + 20j, -1 - 20j])
    (ax,) = eigenvalues([("open", values), ("closed", 2 * values)]).axes
    points = [line for line in ax.lines if line.get_label() in ("open", "closed")]
    assert [len(line.get_xdata()) for line in points] == [2, 2]
    assert ax.get_xlim()[0] <= -2 and ax.get_ylim()[1] >= 40


def test_labels_without_powers_of_ten():
    (ax,) = eigenvalues([("", np.array([-1.0 + 1j]))]).axes
    form = plain_labels()
    form.set_axis(ax.yaxis)
    form.set_locs([0.6, 20.0])
    assert form(20.0) in ("20", "") and "10^" not in form(0.6)


def test_frozen_roots_against_time():
    scene = scenes.get("single-link-slew", duration=0.2)
    model = scene.plant.linearize_along(scene.open_loop(rtol=1e-6, atol=1e-8))
    frequency, real = frozen(model).axes
    assert frequency.get_ylabel() == "damped frequency [Hz]" and real.get_xlabel() == "time [s]"
    rightmost = next(line for line in real.lines if line.get_label() == "rightmost")
    np.testing.assert_allclose(rightmost.get_ydata(), np.linalg.eigvals(model.A).real.max(axis=1), atol=1e-12)
