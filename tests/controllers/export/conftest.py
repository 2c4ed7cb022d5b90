"""The scene whose laws are written out, and how near a motion in C is to that in Python."""

import pytest

from pliant.envs import scenes


@pytest.fixture(scope="session")
def reach():
    return scenes.get("two-link-reach")


@pytest.fixture(scope="session")
def near():
    """Of each signal's largest value, by precision."""
    return {"double": 1e-6, "single": 5e-4}


@pytest.fixture(scope="session")
def near_double():
    """The same in double precision alone."""
    return {"double": 1e-6}
