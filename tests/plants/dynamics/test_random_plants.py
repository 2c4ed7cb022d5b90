"""A sample of tests/campaigns/physics.py: mechanics on random plants; the whole is run by `make campaign`."""

import dataclasses

import mechanics
import numpy as np
import physics
import pytest
from mechanics import Case
from random_plants import draw, rescaled, undamped

from pliant.plants import SingleLinkArm


def test_a_sample_violates_nothing():
    rows = [physics.run(seed) for seed in range(100_000, 100_010)]
    assert not [row for row in rows if row["wrong"]], rows
    assert sum(len(row["shares"]) for row in rows) > 70


@pytest.mark.parametrize("field", ["hub_friction", "gravity"])
def test_a_plant_that_says_less_than_it_does_is_found(field):
    """Its power, or what turns with it, leave out what one field does."""
    drawn = next(d for d in map(draw, range(0, 500, 5)) if field in d.changed and "drive" not in d.changed)
    case = Case(drawn, np.random.default_rng(1))
    check = {"hub_friction": mechanics.power, "gravity": mechanics.mirror}[field]
    assert check(case, np.random.default_rng(2)) < 1
    silent = dataclasses.replace(drawn.plant, **{field: 0.0})
    case.plant = silent  # answers for what moved with the field
    case.dynamics = lambda x, u, w, plant=None: drawn.plant.dynamics(x, u, w=w)
    case.dx = case.dynamics(case.x, case.u, case.w)
    assert check(case, np.random.default_rng(2)) > 100


def test_units():
    arm = SingleLinkArm.textbook()
    other = rescaled(arm, np.array([1e3, 1e3, 1e3]))  # mm, g, ms
    assert other.link.length == pytest.approx(1e3 * arm.link.length)
    assert pytest.approx(1e3 / 1e3 / 1e6 * arm.link.E) == other.link.E
    assert other.link.density == pytest.approx(1e3 / 1e9 * arm.link.density)
    damped = dataclasses.replace(arm, hub_friction=0.2, link=dataclasses.replace(arm.link, damping=1e-4))
    assert undamped(damped) == arm
