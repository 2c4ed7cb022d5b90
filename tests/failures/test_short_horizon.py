"""NMPC whose horizon ends before its inputs have paid: a link that is pushed costs now, and is worth it later."""

import warnings

import numpy as np
import pytest

from pliant.controllers import NMPC, Objective
from pliant.controllers.nmpc.terminal_cost import HorizonWarning
from pliant.envs import scenes

SCENES = [scenes.get("two-link-reach"), scenes.get("single-link-slew")]
SHORT = 8  # control periods, 0.16 s; the slowest motion about the goals takes 1.0 and 0.6 s
each_scene = pytest.mark.parametrize("scene", SCENES, ids=lambda s: s.name)


def played(scene, nmpc) -> tuple[float, float]:
    """Cost of an episode without model error, and how far [rad] the first joint is from its goal at the end."""
    step = scene.plant.stepper(scene.dt, substeps=scene.substeps)
    x, u = [scene.initial[0]], []
    for k in range(scene.steps):
        u.append(nmpc.act(k * scene.dt, x[-1]))
        x.append(step(x[-1][None], u[-1][None])[0].copy())
    return Objective.of(scene).cost(x, u), abs(x[-1][0] - scene.target[0][0])


def without_warning(scene, **options) -> NMPC:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return NMPC.for_scene(scene, **options)


@each_scene
def test_the_naive_short_horizon_does_not_arrive(scene) -> None:
    with pytest.warns(HorizonWarning):
        nmpc = NMPC.for_scene(scene, horizon=SHORT, terminal=None)
    cost, left = played(scene, nmpc)
    assert left > 0.1
    assert cost > 1.8 * played(scene, NMPC.for_scene(scene))[0]
    assert nmpc.record.failures == 0  # every program was solved: it is the question that is wrong


@each_scene
def test_it_is_noticed_at_design_with_the_horizon_that_would_do(scene) -> None:
    with pytest.warns(
        HorizonWarning, match=r"over 0\.16 s is short: .* takes [\d.]+ s; take terminal='riccati'"
    ) as told:
        NMPC.for_scene(scene, horizon=SHORT, terminal=None)
    wanted = int(str(told[0].message).split("horizon of ")[1].split(" periods")[0])
    least = played(scene, without_warning(scene))[0]
    long = without_warning(scene, horizon=wanted, terminal=None)
    assert played(scene, long)[0] < 1.005 * least
    with pytest.warns(HorizonWarning):
        NMPC.for_scene(scene, horizon=wanted - 1, terminal=None)


@each_scene
def test_the_same_horizon_with_the_cost_to_go_arrives(scene) -> None:
    cost, left = played(scene, without_warning(scene, horizon=SHORT))
    assert left < 5e-3
    assert cost < 1.005 * played(scene, without_warning(scene))[0]


def test_even_one_period_is_enough_where_the_end_is_the_whole_cost_to_go() -> None:
    slew = SCENES[1]
    cost, _ = played(slew, without_warning(slew, horizon=1))
    assert np.isclose(cost, played(slew, without_warning(slew))[0], rtol=1e-3)
