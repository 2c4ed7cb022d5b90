"""MPC without steady error in C: in closed loop, with goals that the limits keep it from, and its steady states."""

import numpy as np
import pytest
from exported import answers_over_time, compiled, needs_compiler, run, same_loop

from pliant.controllers import MPC
from pliant.controllers.export import export_c
from pliant.plants.linear.lti import LinearModel

pytestmark = needs_compiler


def test_in_closed_loop(tmp_path, reach, near_double) -> None:
    """The disturbance of the inputs is what the linear model lacks of gravity."""
    law = MPC.for_scene(
        reach, track=("theta1", "theta2"), disturbance="inputs", reads=("theta1", "theta2"), rates=400.0
    )
    same_loop(tmp_path, reach, law, near_double)
    assert law.record.limited > 2 and law.record.failures == 0


COUPLED = (np.array([[-1.0, 0.4, 0], [0.2, -0.7, 0.5], [0, 0.3, -1.5]]), np.array([[1.0, 0.5], [0.3, 1.0], [0.2, 0]]))
APART = (np.array([[-1.0, 0, 0], [0, -0.7, 0.5], [0, 0.3, -1.5]]), np.array([[1.0, 0], [0, 1.0], [0, 0.3]]))


@pytest.mark.parametrize(
    ("kind", "matrices", "tracked", "reached"),
    [
        ("states", COUPLED, 1, True),  # the other input helps, at least cost
        ("outputs", COUPLED, 2, False),  # the least tracking error that one limited input leaves to the other
        ("states", APART, 1, False),  # the other input has no part in the error: cost alone decides on it
    ],
)
def test_goals_for_which_an_input_is_too_weak(tmp_path, kind, matrices, tracked, reached) -> None:
    """The first input is limited to a tenth of what the goal takes, the second never meets its limit."""
    rng = np.random.default_rng(1)
    model = LinearModel.from_matrices(*matrices)
    names = model.state_names[:tracked]
    limits = {model.input_names[0]: (-0.1, 0.1), model.input_names[1]: (-50.0, 50.0)}
    options = {"track": names, "disturbance": kind, "reads": None if kind == "states" else model.state_names[:2]}
    law = MPC.design(model, np.eye(3), np.diag([1.0, 2.0]), dt=0.1, horizon=6, limits=limits, **options)
    law.aim(dict.fromkeys(names, 1.0))
    readings = 0.3 * rng.standard_normal((40, len(law.reads)))
    law.reset()
    wanted = np.array([law.act(0.1 * k, y).copy() for k, y in enumerate(readings)])
    assert (law.record.unreached == 0) == reached and np.abs(wanted[:, 1]).max() < 50
    files = [export_c(law, tmp_path / "law.c")[0], answers_over_time(tmp_path, law, 0.1 * np.arange(40), readings, 2)]
    found = run(compiled(files, tmp_path / "answers"))
    assert np.abs(found - wanted).max() < 1e-8


def test_a_goal_is_set_in_the_state(tmp_path, reach) -> None:
    _, header = export_c(MPC.for_scene(reach, track=("tip_x",), horizon=3), tmp_path / "law.c")
    assert "law_real aim[1]; /* values to bring to: tip_x */" in header.read_text()
