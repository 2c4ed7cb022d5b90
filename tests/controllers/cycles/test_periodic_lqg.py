"""LQG about a cycle: separation, and what it costs beside the law that reads states."""

import numpy as np
import pytest

from pliant.controllers import PeriodicLQG, PeriodicLQR
from pliant.controllers.cycles.periodic_kalman import PeriodicKalman
from pliant.studies.closed_loop.rollout import nominal, rollout


@pytest.fixture(scope="module")
def lqg(cycle, law):
    return PeriodicLQG(law, PeriodicKalman.about(cycle, None, None, 0.0))


def test_without_noise_it_is_the_law_of_states(scene, law, lqg):
    read, told = (rollout(scene, one, nominal(scene)) for one in (lqg, law))
    assert read.failure == "" and read.cost == pytest.approx(told.cost, rel=1e-9)


def test_the_loops_multipliers_are_those_of_law_and_filter(cycle, law, lqg):
    """Of the linear loop of plant, filter and law over all turns, computed whole (separation)."""
    kalman, nx = lqg.filter, 6
    A, _, B = cycle.late_slopes(0.0)
    flow = np.roll(cycle.flow, 1, axis=0)
    across = np.tile(np.eye(nx), (cycle.steps, 1, 1))
    across[:, :, 0] -= flow / flow[:, :1]
    K = np.zeros((cycle.steps, 1, nx))
    K[:, :, 1:] = law.regulator.K
    K = K @ across
    model = [cycle.scene.plant.jacobians(x, cycle.u) for x in cycle.x[:-1]]
    picks = [kalman.plant.outputs[0].name == "crank_angle", kalman._picks[1] - nx]
    assert picks[0]
    L = np.empty((cycle.steps, nx, 2))
    L[kalman.nodes.order] = kalman.L[1:-1]
    around = np.eye(2 * nx)
    for k in range(cycle.steps):
        C = np.array([np.eye(nx)[0], model[(k + 1) % cycle.steps][3][picks[1]]])
        D = np.array([np.zeros(1), model[(k + 1) % cycle.steps][4][picks[1]]])
        after = L[(k + 1) % cycle.steps]
        # x+ = A x - B K z;  z+ = A z - B K z + L (C x+ + D u - C (A z - B K z) - D u)
        BK = B[k] @ K[k]
        step = np.block([[A[k], -BK], [after @ C @ A[k], A[k] - BK - after @ C @ A[k]]])
        assert D.shape == (2, 1)  # the feedthrough of the same input on both sides goes out
        around = step @ around
    sizes = np.sort(np.abs(np.linalg.eigvals(around)))[::-1] ** (1 / 3)
    assert sizes[0] == pytest.approx(1.0, abs=1e-6)  # along the cycle: nobody brings that back
    assert sizes[1:3] == pytest.approx(lqg.multipliers[:2], rel=1e-4)


def test_the_law_and_the_filter_keep_one_period(cycle, law, lqg):
    with pytest.raises(ValueError, match="must be the filter's"):
        PeriodicLQG(PeriodicLQR(**{**{f: getattr(law, f) for f in law.__dataclass_fields__}, "dt": 0.01}), lqg.filter)
