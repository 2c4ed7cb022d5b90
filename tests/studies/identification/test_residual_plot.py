"""The picture of residuals: every sensor, every motion, the bands of white noise."""

import numpy as np
import pytest
from springs import NOISE, VARIED, pushed

from pliant.plants import Experiment, identify
from pliant.studies.identification.residual_plot import residual_plot


def test_a_row_a_sensor_and_a_colour_a_motion():
    one = pushed(1.0)
    bare = Experiment(t=one.t, u=one.u, measured={"place": one.measured["place"]}, name="bare")
    found = identify(VARIED, [one, bare], noise=NOISE)
    axes = residual_plot(found).axes
    assert [ax.get_title(loc="left") for ax in axes[::2]] == [
        "place: residuals in 0.0002 m",
        "felt: residuals in 0.01 m/s^2",
    ]
    dots = [line for line in axes[0].lines if line.get_linestyle() == "None"]
    assert len(dots) == 2 and np.abs(dots[0].get_ydata()).max() < 5
    assert len([line for line in axes[2].lines if line.get_linestyle() == "None"]) == 1
    band = [line.get_ydata()[0] for line in axes[1].lines if line.get_linestyle() == "--"]
    assert band == pytest.approx([-1.96 / np.sqrt(50), 1.96 / np.sqrt(50)])


def test_refused():
    with pytest.raises(ValueError, match=r"residual_plot\.found = 3 must be an Identification"):
        residual_plot(3)
