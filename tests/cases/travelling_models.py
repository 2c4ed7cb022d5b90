"""Linear models and motions that travel, and verdicts on them."""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

import numpy as np
from travelling import RIGID, SLEW, Roll, fields, nominal

from pliant.plants import (
    SliderCrank,
    stability,
)  # fmt: skip
from pliant.plants.linear import second_order
from pliant.plants.linear.piecewise_ltv import linearize_pieces
from pliant.plants.slider_crank.steady_cycles import speed_scan, steady_cycle

ROLL = Roll()
traveller, record = ROLL.traveller, ROLL.record


def model_goes(m: Any) -> Any:
    start, push = np.full(len(m.states), 0.01), np.full(len(m.inputs), 0.1)
    return fields(m), m.simulate(start, push) if hasattr(m, "t") else m.simulate(start, push, [0.0, 0.1])


@traveller("linear model", model_goes)
def at_the_goal() -> Any:
    return SLEW.plant.linearize(*SLEW.target)


@traveller("model along a motion", model_goes)
def along_the_slew() -> Any:
    return SLEW.plant.linearize_along(nominal())


@traveller("sampled along a motion", fields)
def _sampled() -> Any:
    return along_the_slew().discretize()


@traveller("motion", lambda m: (fields(m), m.resample(np.linspace(0, 0.1, 7)).x, m["hub_angle"]))
def _motion() -> Any:
    return nominal()


def rigid_model() -> Any:
    return RIGID.linearize(RIGID.rest_state)


CRANK = dataclasses.replace(SliderCrank.textbook(), modes=1)


@cache
def crank_cycle() -> Any:
    return steady_cycle(CRANK, points=181)


def cycle_model() -> Any:
    return CRANK.linearize_along(crank_cycle())


@traveller("pieces", lambda m: (fields(m), m.transition()))
def _pieces() -> Any:
    t = np.linspace(0, 0.2, 21)
    plant = SLEW.plant
    before = plant.simulate(plant.rest_state, [1.0], t)
    after = plant.simulate(before.x[-1], [0.0], t + 0.2)
    return linearize_pieces(plant, (before, after), [[0.0]])


record("steady cycle")(crank_cycle)
record("verdict")(lambda: stability.assess(rigid_model()))
record("verdict of a cycle")(lambda: stability.assess(cycle_model()))
record("Floquet")(lambda: stability.floquet(cycle_model()))
record("frozen time")(lambda: stability.frozen_time(cycle_model()))
record("speed scan")(lambda: speed_scan(CRANK, [20.0, 30.0], points=91))
record("modes")(lambda: at_the_goal().modes())
record("second-order form")(lambda: second_order.from_ltv(cycle_model()))
