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


@pytest.mark.parametrize(("kind", "tracked"), [("states", 1), ("outputs", 2)])
def test_goals_beyond_the_limits(tmp_path, kind, tracked) -> None:
    """Two inputs; with one signal to track they are redundant, so that cost decides. The goal moves out of reach."""
    rng = np.random.default_rng(tracked)
    A = rng.standard_normal((3, 3))
    A -= (np.linalg.eigvals(A).real.max() + 0.5) * np.eye(3)
    model = LinearModel.from_matrices(A, rng.standard_normal((3, 2)))
    names = model.state_names[:tracked]
    law = MPC.design(
        model, np.eye(3), np.eye(2), dt=0.1, horizon=6, limits=(-1.0, 1.0), track=names, disturbance=kind,
        reads=None if kind == "states" else model.state_names[:2],
    )  # fmt: skip
    law.aim(dict.fromkeys(names, 4.0))
    readings = 0.3 * rng.standard_normal((40, len(law.reads)))
    law.reset()
    wanted = np.array([law.act(0.1 * k, y).copy() for k, y in enumerate(readings)])
    assert law.record.unreached > 5
    files = [export_c(law, tmp_path / "law.c")[0], answers_over_time(tmp_path, law, 0.1 * np.arange(40), readings, 2)]
    found = run(compiled(files, tmp_path / "answers"))
    assert np.abs(found - wanted).max() < 1e-8


def test_a_goal_is_set_in_the_state(tmp_path, reach) -> None:
    _, header = export_c(MPC.for_scene(reach, track=("tip_x",), horizon=3), tmp_path / "law.c")
    assert "law_real aim[1]; /* values to bring to: tip_x */" in header.read_text()
