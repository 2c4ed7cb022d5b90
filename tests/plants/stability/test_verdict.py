"""What a verdict accounts for and writes."""

import json

import numpy as np
import pytest

from pliant.plants import LinearModel
from pliant.plants.core.signals import Signal
from pliant.plants.stability import METHODS, assess


def test_every_verdict_accounts_for_every_method_and_writes_itself(random_path, pulsating):
    for model in (pulsating(), pulsating(-0.1), pulsating(0.0), random_path()[1], random_path(shift=4.0)[1]):
        found = assess(model)
        assert {name for name, _, text in found.rows() if text} == set(METHODS)
        assert [role for _, role, _ in found.rows()].count("decides") == (1 if found.method else 0)
        assert found.method != "frozen_time"
        again = json.loads(json.dumps(found.to_json(), allow_nan=False))
        assert again["verdict"] == found.verdict and found.verdict in str(found)
        quick = assess(model, thorough=False)
        assert (quick.verdict, quick.method) == (found.verdict, found.method)


def with_stiffness(own):
    """Of two joints, of which one is free but for `own`, what is left of a stiffness [1/s^2] whose terms cancel."""
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [own, 40.0, -1.0, 0], [0, -300.0, 0, -2.0]])
    states = [Signal(name, unit) for name, unit in zip("abcd", ("rad", "rad", "rad/s", "rad/s"), strict=True)]
    return LinearModel.from_matrices(A, np.zeros((4, 1)), states=states)


@pytest.mark.parametrize(("own", "verdict"), [(1e-14, "marginal"), (1e-9, "unstable"), (0.0, "marginal")])
def test_what_terms_leave_that_cancel_is_no_growth(own, verdict):
    """1e-14 is rounding of a term of 40; 1e-9 is not, and grows at 1e-9 1/s."""
    assert assess(with_stiffness(own)).verdict == verdict
