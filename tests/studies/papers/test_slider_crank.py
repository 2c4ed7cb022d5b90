"""The filter of the slider-crank's figures, and that they draw."""

import dataclasses

import numpy as np
import pytest

from pliant.studies.papers import slider_crank as figures


def test_filter_keeps_the_slow_and_drops_the_fast_without_lag():
    t = np.linspace(0, 1, 4001)
    slow, fast = np.sin(2 * np.pi * 3 * t), np.sin(2 * np.pi * 200 * t)
    found = figures.low_pass(t, slow + fast, 40.0)
    inner = slice(400, -400)
    np.testing.assert_allclose(found[inner], slow[inner], atol=1e-4)
    with pytest.raises(ValueError, match=r"low_pass.cutoff = 3000.0 must be > 0 and < 2000"):
        figures.low_pass(t, slow, 3000.0)


@pytest.mark.campaign
def test_figures_draw_and_the_motion_ends_on_the_steady_cycle():
    plant = dataclasses.replace(figures.textbook(), modes=1)
    drawn = figures.figures(plant, cycles=2)
    assert [name[-2:] for name in drawn] == ["06", "07", "08", "09", "10"]
    late = drawn["slider-crank-figure-07"].axes[0].lines[0].get_ydata()
    assert np.abs(late).max() == pytest.approx(14.3, abs=0.2)  # [um]
    with pytest.raises(ValueError, match="crank_speed = None"):
        figures.response(dataclasses.replace(plant, crank_speed=None))


@pytest.mark.campaign
def test_theory_stands_in_the_picture_of_the_tongue():
    plant = figures.resonant()
    low, high = figures.first_tongue(plant)
    first = (low + high) / 4
    figure = figures.tongues(plant, first * np.array([1.5, 2.0, 2.5]))
    assert len(figure.axes) == 2 and 1.8 * first < low < 2 * first < high < 2.2 * first
    heavy = dataclasses.replace(plant, rod=dataclasses.replace(plant.rod, damping=1e-2))
    assert np.isnan(figures.first_tongue(heavy)).all()
