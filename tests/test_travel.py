"""A sample of tests/campaigns/travel.py: what travels goes on as the original would, apart from it; and its teeth."""

import pickle

import numpy as np
import pytest
import travel
import travellers

from pliant.plants import PliantError, SingleLinkArm
from pliant.plants.core.signals import OwnsArrays, owned, sealed

QUICK = (
    *("LQR that integrates", "MPC that estimates", "policy", "Kalman", "rest to rest", "nominal input", "linear model"),
    *("casadi function", "errors", "verdict", "left ranges"),
)


@pytest.mark.parametrize("name", QUICK)
def test_it_goes_on_as_the_original_would_by_every_way(name):
    assert travel.sent(name, travel.ROUTES) == {}


def test_environments_come_through_read_only_buffers_in_mid_episode():
    assert travel.sent("vector environment", {"read-only buffers": travel.by_buffers}) == {}


class Plain:
    """What travels as Python has it."""

    def __init__(self):
        self.x, self.K = np.zeros(3), np.eye(2)
        self.K.setflags(write=False)


class Owning(Plain, OwnsArrays):
    pass


class Count:
    """Each call adds to an array."""

    def __init__(self):
        self.x = np.zeros(2)

    def __call__(self):
        self.x += 1
        return self.x.copy()


def test_what_does_not_own_its_arrays_is_found(monkeypatch):
    """The naive way: a copy by protocol 5 cannot be written to, one by pickle loses its write protection, and copy
    shares what changes."""
    found = {way: travel.unlike(Plain(), send(Plain())) for way, send in travel.ROUTES.items()}
    assert "x may not be written to" in found["read-only buffers"] and "x may not" in found["memory map"]
    assert "K may be written to" in found["pickle 4"] and "K may be written to" in found["deepcopy"]
    thing = Plain()
    assert "shared" in travel.unlike(thing, travel.ROUTES["copy"](thing))
    own = Owning()
    assert [travel.unlike(own, send(own)) for send in travel.ROUTES.values()] == [""] * len(travel.ROUTES)
    monkeypatch.setitem(travellers.MAKERS, "count", Count)
    monkeypatch.setitem(travellers.GOING, "count", lambda c: c())
    faults = travel.sent("count", travel.ROUTES)
    assert {"copy", "read-only buffers", "memory map"} <= set(faults)  # and who was copied is driven by its copy


def test_owned_copies_arrays_in_containers_and_leaves_the_rest():
    array = np.arange(3.0)
    array.setflags(write=False)
    given = {"a": (array, [np.ones(2)]), "b": "name", "c": (1, 2)}
    found = owned(pickle.loads(pickle.dumps(sealed(given))))
    assert not found["a"][0].flags.writeable and found["a"][1][0].flags.writeable
    np.testing.assert_array_equal(found["a"][0], array)
    assert found["b"] == "name" and found["c"] == (1, 2)


def test_an_error_comes_back_with_what_it_carries():
    from pliant.plants import StabilityLimitError

    error = pickle.loads(pickle.dumps(StabilityLimitError("too far", 0.1, 2j, 0.05)))
    assert (str(error), error.step, error.mode, error.largest_step) == ("too far", 0.1, 2j, 0.05)
    assert type(error) is StabilityLimitError and isinstance(error, PliantError)


def test_a_compiled_plant_stays_compiled():
    plant = SingleLinkArm.textbook().compile()
    for way, send in travel.ROUTES.items():
        assert type(send(plant)._dynamics) is type(plant._dynamics), way
    assert type(SingleLinkArm.textbook()._dynamics) is not type(plant._dynamics)
