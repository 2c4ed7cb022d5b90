"""Runs drawn by seed: the same whatever is asked beside them, resumed where they stopped, failures counted."""

import dataclasses

import numpy as np
import pytest
from data_sheet_craft import pointing, scene
from scipy.stats import binom

from pliant.controllers import LQG, LQR, MPC, NMPC, Filtered, notch, roll_off
from pliant.envs.scenes import get
from pliant.plants import Payload
from pliant.studies.monte_carlo import MonteCarlo, monte_carlo

NEAR = {"appendages.0.stiffness_factor": (0.95, 1.05)}
RANGES = {"appendages.0.stiffness_factor": (0.64, 1.44)}
SCENE = scene(duration=20.0)
LAW = Filtered(pointing(0.1, 0.25), (notch(0.8305, depth=0.1),))


@pytest.fixture(scope="module")
def found():
    return monte_carlo(SCENE, LAW, RANGES, runs=6, seed=3)


def test_a_run_depends_on_its_seed_and_number_alone(found) -> None:
    """Also among threads, which share the controller's memory."""
    again = monte_carlo(SCENE, lambda scene: LAW, RANGES, runs=3, seed=3, jobs=2, backend="threading")
    assert again.rows == found.rows[:3]
    factors = [row["parameters"]["appendages.0.stiffness_factor"] for row in found.rows]
    assert 0.64 <= min(factors) < max(factors) <= 1.44 and len(set(factors)) == 6


def test_it_goes_on_where_it_stopped(found, tmp_path) -> None:
    path, told = tmp_path / "runs.jsonl", []
    monte_carlo(SCENE, LAW, RANGES, runs=2, seed=3, kept=path)
    rest = monte_carlo(SCENE, LAW, RANGES, runs=4, seed=3, kept=path, progress=lambda share, words: told.append(words))
    assert rest.rows == found.rows[:4] and len(told) == 3 and told[0] == "2 done before"
    again = Filtered(pointing(0.1, 0.25), (notch(0.8305, depth=0.1),))  # the same, designed anew and not yet played
    assert monte_carlo(SCENE, again, RANGES, runs=4, seed=3, kept=path).rows == rest.rows
    with pytest.raises(ValueError, match="another study"):
        monte_carlo(SCENE, LAW, RANGES, runs=2, seed=4, kept=path)


@pytest.mark.parametrize(
    "other",
    [
        Filtered(pointing(0.2, 0.25), (notch(0.8305, depth=0.1),)),
        Filtered(pointing(np.nextafter(0.1, 1), 0.25), (notch(0.8305, depth=0.1),)),
        Filtered(pointing(0.1, 0.25), (notch(0.8306, depth=0.1),)),
        Filtered(pointing(0.1, 0.25), (notch(0.8305, depth=0.1), roll_off(0.6))),
    ],
)
def test_another_design_is_another_study(other, tmp_path) -> None:
    """Of the same class, reading the same signals: gains and filters within count."""
    path = tmp_path / "runs.jsonl"
    monte_carlo(SCENE, LAW, RANGES, runs=1, kept=path)
    with pytest.raises(ValueError, match="another study"):
        monte_carlo(SCENE, other, RANGES, runs=1, kept=path)


@pytest.mark.parametrize("kind", [LQR, LQG, MPC, NMPC])
def test_a_law_that_has_played_is_the_same_design(kind, tmp_path) -> None:
    reach, path = dataclasses.replace(get("two-link-reach"), duration=0.3), tmp_path / "runs.jsonl"
    law, near = kind.for_scene(reach), {"payload.mass": (0.9, 1.1)}
    one = monte_carlo(reach, law, near, runs=1, kept=path)
    assert monte_carlo(reach, law, near, runs=2, kept=path).rows[:1] == one.rows
    lighter = kind.for_scene(reach.with_plant(dataclasses.replace(reach.plant, payload=Payload(mass=0.4))))
    with pytest.raises(ValueError, match="another study"):
        monte_carlo(reach, lighter, near, runs=1, kept=path)


def test_what_does_not_pickle_is_told(tmp_path) -> None:
    law = pointing(0.1, 0.25)
    object.__setattr__(law, "note", lambda: None)
    with pytest.raises(ValueError, match=r"monte_carlo\.kept needs a law .* does not pickle"):
        monte_carlo(SCENE, law, RANGES, runs=1, kept=tmp_path / "runs.jsonl")


def test_quantiles_are_runs_that_occurred(found) -> None:
    low, middle, high = found.quantiles("cost")
    costs = sorted(row["cost"] for row in found.rows)
    assert low == costs[0] and high == costs[-1] and middle == costs[2]
    assert "6 runs, 0 failed" in str(found) and found.to_json()["failures"] == 0
    assert np.isnan(MonteCarlo(()).quantiles("cost")[0])


def test_the_share_that_may_fail() -> None:
    """The bound is the share at which so few failures have 5 % left: the binomial distribution's own."""
    rows = tuple({"failure": "diverged" if k < 3 else "", "growth": None} for k in range(200))
    share, most = MonteCarlo(rows).failing
    assert share == 3 / 200 and binom.cdf(3, 200, most) == pytest.approx(0.05, rel=1e-9)


def test_what_shakes_itself_up_is_counted() -> None:
    """A roll-off without a notch: the mode grows, which the linear loop tells of every run."""
    shaken = monte_carlo(SCENE, Filtered(pointing(0.2, 0.25), (roll_off(0.6),)), NEAR, runs=2)
    assert len(shaken.unstable) == 2 and "grows in 2" in str(shaken)


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"ranges": {}}, "at least one parameter"),
        ({"ranges": {"hub.mass": (2.0, 1.0)}}, "smallest <= largest"),
        ({"ranges": {"hub.mass": 1.0}}, "factor"),
        ({"runs": 0}, "runs"),
        ({"backend": "thread"}, "backend"),
        ({"law": 3.0}, r"monte_carlo\.law"),
        ({"delay": -1}, "delay"),
    ],
)
def test_bad_input_is_named(options, word) -> None:
    given = {"law": LAW, "ranges": RANGES} | options
    with pytest.raises(ValueError, match=word):
        monte_carlo(SCENE, given.pop("law"), given.pop("ranges"), **given)
