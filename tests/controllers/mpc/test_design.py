"""Designs that are refused, in words: options, readings, targets, periods and points."""

import dataclasses

import numpy as np
import pytest
from elastic_hub import DT, LINK, Q, R

from pliant.controllers import MPC
from pliant.plants.core.errors import InfeasibleError, UncontrollableError
from pliant.plants.linear.lti import LinearModel


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"dt": None}, "MPC.dt = None"),
        ({"horizon": 0}, "MPC.horizon = 0"),
        ({"blocks": (2, 3)}, "MPC.blocks"),
        ({"blocks": (20, 30)}, "MPC.blocks"),
        ({"blocks": (21, -1)}, "MPC.blocks"),
        ({"limits": (1.0, -1.0)}, "MPC.limits of torque"),
        ({"rates": -1.0}, "MPC.rates"),
        ({"rates": {"nothing": 1.0}}, "MPC.rates"),
        ({"bounds": {"nothing": (0, 1)}}, "state or output 'nothing'"),
        ({"bounds": {"bend": (1, 0)}}, "MPC.bounds"),
        ({"reads": ("theta",)}, "MPC.reads"),
        ({"disturbance": "inputs"}, "needs track"),
        ({"track": ("tip",), "disturbance": "winds"}, "MPC.disturbance = 'winds'"),
        ({"track": ("tip",), "disturbance": "inputs", "reads": ("tip",)}, "MPC.reads: 1 signals, must be 2"),
        ({"track": ("tip",), "time": 0.0}, "MPC.time"),
    ],
)
def test_bad_designs(options, message):
    with pytest.raises(ValueError, match=message):
        MPC.design(LINK, Q, R, **({"dt": DT} | options))


def test_bad_readings_targets_and_plants():
    controller = MPC.design(LINK, Q, R, dt=DT, track=("tip",))
    with pytest.raises(ValueError, match=r"MPC\.y\[1\] = nan"):
        controller.act(0.0, np.array([0.0, np.nan, 0.0, 0.0]))
    with pytest.raises(ValueError, match=r"MPC\.aim.*'bend'"):
        controller.aim({"bend": 0.1})
    with pytest.raises(InfeasibleError, match="no steady inputs"):
        MPC.design(LINK, Q, R, dt=DT, track=("tip", "omega"))
    apart = LinearModel.from_matrices(np.diag([1.0, -1.0]), [[0.0], [1.0]])
    with pytest.raises(UncontrollableError, match="x1"):
        MPC.design(apart, np.eye(2), np.eye(1), dt=DT)


def test_a_sampled_model_has_its_own_period():
    sampled = LINK.discretize(DT)
    MPC.design(sampled, Q, R, dt=DT * (1 + 1e-12))
    fast = LINK.discretize(1e-5)
    MPC.design(fast, Q, R, dt=1e-5)
    with pytest.raises(ValueError, match=r"MPC\.dt = 2e-05 must be 1e-05, the model's"):
        MPC.design(fast, Q, R, dt=2e-5)
    for other in (DT * (1 + 1e-6), DT * (1 - 1e-6)):
        with pytest.raises(ValueError, match=r"MPC\.dt = .* must be .*, the model's"):
            MPC.design(sampled, Q, R, dt=other)


def test_a_point_that_moves_is_refused_also_far_from_zero():
    """A state of 1e3 m, moved by less than a ten thousandth of itself in a step, and by more."""
    far = dataclasses.replace(LINK, x0=np.full(4, 1e3))
    still, moving = (dataclasses.replace(far, f0=np.full(4, rate)) for rate in (1e-3, 1e3))
    MPC.design(still, Q, R, dt=DT)
    with pytest.raises(ValueError, match="the model's point is no equilibrium"):
        MPC.design(moving, Q, R, dt=DT)
