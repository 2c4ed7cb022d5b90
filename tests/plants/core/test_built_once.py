"""What is built for one plant serves all equal ones, in the same symbols; other plants and symbolic copies build theirs."""

import dataclasses
import pickle
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.core import built_once as module
from pliant.plants.core.built_once import built_once

ARM = SingleLinkArm.textbook()
X = np.array([0.3, 0.01, 0.002, 0.5, 0.1, 0.02])


@dataclass(frozen=True)
class Counted:
    """A stand-in for a plant, which says when it is asked to build."""

    value: Any
    built = 0

    @property
    def nominal(self):
        return self

    @built_once
    def symbols(self):
        type(self).built += 1
        return ca.SX.sym("x")

    @built_once
    def expression(self):
        return self.symbols * self.value


@pytest.fixture(autouse=True)
def emptied(monkeypatch):
    monkeypatch.setattr(built_once, "_kept", type(built_once._kept)())
    monkeypatch.setattr(Counted, "built", 0)


def test_equal_instances_share_what_was_built():
    first, again, other = Counted(2.0), Counted(2.0), Counted(3.0)
    assert again.expression is first.expression and Counted.built == 1
    assert other.expression is not first.expression and Counted.built == 2
    assert first.__dict__["expression"] is first.expression  # found without asking again


def test_all_that_an_instance_takes_is_in_the_same_symbols(monkeypatch):
    """Where its equals were forgotten and built anew in between."""
    monkeypatch.setattr(module, "KEPT", 1)
    early, late = Counted(2.0), Counted(2.0)
    symbols = early.symbols
    assert Counted(5.0).symbols is not symbols  # forgets the first
    assert late.symbols is not symbols and late.expression is not None
    assert float(ca.Function("f", [symbols], [early.expression])(4.0)) == pytest.approx(8.0)
    assert len(built_once._kept) == 1


def test_what_has_no_hash_builds_its_own():
    assert Counted([1.0]).symbols is not Counted([1.0]).symbols


def test_plants_made_anew_give_the_same_and_build_nothing():
    again = SingleLinkArm.textbook()
    assert again is not ARM and again.symbols is ARM.symbols
    np.testing.assert_array_equal(again.dynamics(X), ARM.dynamics(X))
    assert again._dynamics is ARM._dynamics
    assert pickle.loads(pickle.dumps(again)) == ARM


def test_a_varied_plant_builds_in_its_own_parameters():
    varied = ARM.vary("payload.mass") if ARM.payload else ARM.vary("length")
    assert varied.symbols is not ARM.symbols
    np.testing.assert_allclose(varied.dynamics(X), ARM.dynamics(X), rtol=1e-12)
    doubled = varied.dynamics(X, p=2 * varied.nominal_parameters)
    assert np.abs(doubled - ARM.dynamics(X)).max() > 1e-3
    assert dataclasses.replace(varied, varied=()).symbols is ARM.symbols


def test_a_compiled_plant_keeps_its_native_functions_to_itself():
    native = SingleLinkArm.textbook().compile()
    fresh = SingleLinkArm.textbook()
    np.testing.assert_allclose(native.dynamics(X), fresh.dynamics(X), rtol=1e-12)
    assert type(fresh._dynamics) is type(ARM._dynamics)
