"""One scene, and its cycle, for all tests of this room."""

import pytest

from pliant.controllers import PeriodicLQR
from pliant.controllers.cycles.cycle import Cycle
from pliant.envs import scenes


@pytest.fixture(scope="session")
def scene():
    return scenes.get("slider-crank-run")


@pytest.fixture(scope="session")
def cycle(scene):
    return Cycle.find(scene)


@pytest.fixture(scope="session")
def law(cycle):
    return PeriodicLQR.about(cycle, 1.0, (0.0, 0.0))
