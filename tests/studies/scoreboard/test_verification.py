"""Runs played again: the same pass, a cost that is off does not, a failure must be one again."""

import dataclasses

import numpy as np
import pytest

from pliant.studies.scoreboard.scoreboard import scoreboard
from pliant.studies.scoreboard.verification import verify


@pytest.fixture(scope="module")
def raw():
    return scoreboard(["single-link-slew"], ["LQR"], seeds=2, bounds=0, jobs=1).raw


def changed(raw, name, by):
    columns = {**raw.columns, name: by(raw.columns[name])}
    return dataclasses.replace(raw, columns=columns)


def test_the_same_machine_passes_and_a_seeded_part_is_the_same_part(raw):
    found = verify(raw, cells=3, seed=1)
    assert found.passed and len(found.replays) == 3 and str(found) == "3 same, 0 undecided, 0 differs"
    assert [one.again for one in found.replays] == [one.kept for one in found.replays]
    assert [(one.case, one.number) for one in verify(raw, cells=3, seed=1).replays] == [
        (one.case, one.number) for one in found.replays
    ]
    assert max(one.tolerance / one.kept for one in found.replays) < 1e-5  # a loop that damps what shakes it


def test_a_cost_that_is_off_and_a_failure_that_is_none_differ(raw):
    found = verify(changed(raw, "cost", lambda cost: cost * (1 + 1e-4)), cells=5)
    assert not found.passed and all(one.verdict == "differs" for one in found.replays)
    found = verify(changed(raw, "failure", lambda failure: np.zeros_like(failure)), cells=5)
    assert not found.passed and "failed True then, False now" in str(found)


def test_controllers_that_are_not_known_are_named(raw):
    found = verify(dataclasses.replace(raw, controllers=("mine",)), cells=5)
    assert not found.passed and found.skipped == {"mine": "its maker was not given"}
