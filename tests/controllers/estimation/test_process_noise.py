"""Densities by hand: an actuator off by 1 % of its limit in each period; a uniform gust has deviation g/sqrt(3)."""

import types

import pytest

from pliant.controllers.estimation.process_noise import process_noise
from pliant.plants import Signal


def test_by_hand():
    plant = types.SimpleNamespace(
        inputs=(Signal("motor", "N m"),),
        disturbances=(Signal("push", "N"), Signal("twist", "N m"), Signal("ignored", "K")),
    )
    scene = types.SimpleNamespace(plant=plant, limits=(20.0,), dt=0.01, gusts=(("push", 3.0),))
    found = process_noise(scene)
    assert found == {"motor": pytest.approx(4e-4), "push": pytest.approx(0.03), "twist": pytest.approx(4e-4)}
