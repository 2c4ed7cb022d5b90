"""Mean cost of LQG over models: on one model, without noise, what the loop costs when it is run."""

import numpy as np
import pytest

from pliant.controllers import LQG
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.robust_design.lqg_over_box import loops_over
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")
MODEL = SCENE.plant.feedback_model(*SCENE.target)


@pytest.mark.parametrize("delay", [0, 1])
def test_cost_and_radius_of_one_model(delay):
    law = LQG.for_scene(SCENE, input_delay=delay)
    sensors = Kalman.for_scene(SCENE).sensors
    loops = loops_over(SCENE, sensors, [MODEL], (delay,))
    quiet = type(loops)(loops.step, loops.cost, loops.seen, loops.start, 0 * loops.push, 0 * loops.noise)
    found = quiet.value(law)
    law.law.limits = (-np.inf, np.inf)
    law.law.before, law.filter.before = law.law.u0, law.filter.u0[0]
    law.law.reset()
    law.reset()
    z, cost = loops.start[0], 0.0
    for k in range(600):
        u = law.act(k * SCENE.dt, law.filter.y0[0] + loops.seen[0] @ z) - law.law.u0
        both = np.concatenate([z, u])
        cost += both @ loops.cost[0] @ both
        z = loops.step[0] @ both
    assert found.cost == pytest.approx(cost, rel=1e-6) and found.radius < 1
    assert quiet.value(law).score == pytest.approx(np.log(found.cost))


def test_an_unstable_loop_is_told_by_its_radius():
    loops = loops_over(SCENE, Kalman.for_scene(SCENE).sensors, [MODEL], (3,))
    found = loops.value(LQG.for_scene(SCENE))
    assert found.cost == np.inf and found.radius > 1 and found.score > 50
