"""A control period and its derivatives: against the plant's own simulation and its differences."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.gradients.period_slopes import PeriodSlopes

SLEW = scenes.get("single-link-slew")


def test_values_and_slopes_against_differences_of_fourth_order() -> None:
    period, rng = PeriodSlopes(SLEW, 3), np.random.default_rng(0)
    x, p = period.starts(2)
    given = [x, rng.standard_normal((3, 1)), p]
    for function in (period.stepped, period.observed):
        _, slopes = function(0, *given)
        for place, (slope, h) in enumerate(zip(slopes, (1e-5, 1e-3, 1e-4))):
            along = rng.standard_normal(given[place].shape)

            def moved(s, place=place, along=along, function=function):
                return function(0, *[a + s * along if k == place else a for k, a in enumerate(given)])[0]

            near, far = (moved(s * h) - moved(-s * h) for s in (1, 2))
            want = (8 * near - far) / (12 * h)
            np.testing.assert_allclose(np.einsum("bij,bj->bi", slope, along), want, rtol=1e-6, atol=1e-8)


def test_bad_lanes_are_refused() -> None:
    with pytest.raises(ValueError, match="lanes = 0"):
        PeriodSlopes(SLEW, 0)
