"""A law that is led along a nominal: on a linear plant it is the law about a moving point; bounds, gates."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import Led, MultiModelLQR
from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.rollout import nominal, rollout

GENTLE = scenes.get("single-link-slew-gentle")


@pytest.fixture(scope="module", params=["states", "sensors"])
def law(request):
    return Led.for_scene(GENTLE, MultiModelLQR.for_scene(GENTLE, reads=request.param))


def test_it_lasts_where_softer_links_and_late_inputs_undo_the_law_alone(law):
    """The softest, lightest corner of +-30 %, on time and late, within 10 mm; the law alone is out at once."""
    played = play(GENTLE)
    p = 0.7 * played.varied_plant.nominal_parameters
    for delay in (0, 1):
        given = dataclasses.replace(nominal(played), p=p, delay=delay)
        run = rollout(played, law, given)
        assert run.failure == "" and np.abs(run["tip_deflection"]).max() < 0.01
        assert "tip_deflection beyond its bound" in rollout(played, law.law, given).failure


def test_on_the_nominal_it_gives_the_nominal_inputs(law):
    law.reset()
    law._ahead = 0.0
    for k in range(len(law.u)):
        np.testing.assert_allclose(law.act(k * law.dt, law.law.y0 + law.y[k]), law.law.u0 + law.u[k], atol=1e-9)
    law.reset()


def test_another_start_scales_the_reference(law):
    law.reset()
    law._ahead = 0.0
    for k in range(5):
        u = law.act(k * law.dt, law.law.y0 + 1.2 * law.y[k])
        np.testing.assert_allclose(u, law.law.u0 + 1.2 * law.u[k], atol=1e-8)
    law.reset()


@pytest.mark.campaign
def test_the_nominal_leaves_its_reserve_of_the_bound():
    made = Led.for_scene(GENTLE, MultiModelLQR.for_scene(GENTLE), reserve=0.5)
    place = made.reads.index("eta1") if "eta1" in made.reads else 1
    half, less = np.abs(made.y[:, place]).max(), np.abs(Led.for_scene(GENTLE, made.law).y[:, place]).max()
    assert half < 0.75 * less and len(made.u) > 50


def test_bad_input():
    with pytest.raises(ValueError, match=r"Led\.for_scene\.reserve"):
        Led.for_scene(GENTLE, reserve=1.0)
    with pytest.raises(ValueError, match=r"Led\.law"):
        Led("law", np.zeros((2, 1)), np.zeros((1, 1)), 0.1)
    with pytest.raises(PliantError, match="rest"):
        Led.for_scene(scenes.get("spin-up"), MultiModelLQR.for_scene(GENTLE))
