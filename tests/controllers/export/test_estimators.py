"""A Kalman filter in C, in the loop with its law, whatever law that is."""

import pytest
from exported import needs_compiler, same_loop

from pliant.controllers import LQG, MPC, Kalman
from pliant.controllers.export import export_c

pytestmark = needs_compiler


def test_lqg(tmp_path, reach, near) -> None:
    same_loop(tmp_path, reach, LQG.for_scene(reach, delay=1), near)


@pytest.mark.parametrize("late", [(0, 1), pytest.param(2.0, marks=pytest.mark.campaign)])
def test_lqg_whose_inputs_act_late(tmp_path, reach, near_double, late) -> None:
    same_loop(tmp_path, reach, LQG.for_scene(reach, input_delay=late), near_double, count=20)


def test_a_predictive_law_that_acts_on_the_estimate(tmp_path, reach, near_double) -> None:
    law = LQG(MPC.for_scene(reach, rates=400.0), Kalman.for_scene(reach))
    same_loop(tmp_path, reach, law, near_double)
    assert law.law.record.limited > 2  # else this were an LQG with a gain


def test_a_filter_whose_gain_varies_is_told(tmp_path, reach) -> None:
    import dataclasses

    steady = Kalman.for_scene(reach)
    varying = dataclasses.replace(steady, gains=steady.gains * 2)
    with pytest.raises(ValueError, match="2 gains"):
        export_c(varying, tmp_path / "law.c")
