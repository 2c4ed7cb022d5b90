"""Whether plans last: one state by hand, two masses by what is played."""

import numpy as np
import pytest
from two_masses import LIMIT, MODEL, play, tube

from pliant.controllers import DisturbanceSet, TubeMPC
from pliant.controllers.tube_mpc.lasting_plans import past_horizon
from pliant.plants import LinearModel, LTVModel

ONE = LinearModel.from_matrices([[1.0]], [[1.0]], states=["x"], inputs=["u"], dt=1.0)
CART = LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], states=["p", "v"], inputs=["a"])


@pytest.mark.parametrize(
    ("limit", "size", "last"), [(0.1, 0.07, True), (0.1, 0.1, False), (0.3, 0.1, True), (0.3, 0.2, False)]
)
def test_of_one_state_it_is_two_inequalities(limit, size, last):
    """x+ = x + u + w, N = 1 and two periods more under u = -f x, g = 1 - f; limits of |x| 1 and of |u| `limit`.

    A plan ends its horizon in |xi| <= min((limit - u1)/f, (1 - t2)/g, (limit - u2)/(f g), (1 - t3)/g^2); new are
    f g^2 xi <= limit - u3 and g^3 xi <= 1 - t4, with t and u the sums of what errors are then, of states and inputs.
    """
    given = {"horizon": 1, "terminal": 2, "limits": (-limit, limit), "bounds": {"x": (-1, 1)}}
    law = TubeMPC.design(ONE, [[1.0]], [[100.0]], DisturbanceSet.box([size]), **given)
    f, k = law.course.Kf[0, 0, 0], law.course.K[0, 0, 0]
    assert f == pytest.approx((np.sqrt(401) - 1) / 200)  # the Riccati equation of one state, P^2 - P - 100 = 0
    g, errors = 1 - f, size * np.array([1.0, 1 - k, (1 - k) * (1 - f), (1 - k) * (1 - f) ** 2])
    t = np.concatenate([[0.0], np.cumsum(errors)])
    u = np.concatenate([[0.0], np.cumsum(errors * [k, f, f, f])])
    xi = min((limit - u[1]) / f, (1 - t[2]) / g, (limit - u[2]) / (f * g), (1 - t[3]) / g**2)
    assert (f * g**2 * xi <= limit - u[3] and g**3 * xi <= 1 - t[4]) == last
    assert law.lasting() == last


def test_no_period_past_the_horizon_shows_nothing():
    assert not tube(horizon=20, terminal=0).lasting()


@pytest.mark.parametrize("delay", [0, 2])
def test_where_it_is_shown_the_next_plan_always_exists(delay):
    law = tube(horizon=20, terminal=20, delay=delay)
    assert law.lasting()
    for seed in range(6):
        speed, force, first = play(law, [0.4, 0.4, 0.0, 0.0], seed, late=delay)
        assert first and law.record.violations == 0
        assert speed <= LIMIT and force <= 1.0


def test_the_signals_of_the_model_are_its_states():
    assert tube(horizon=5).reads == MODEL.state_names


def test_past_the_horizon_the_law_is_that_of_the_plan_where_the_nominal_is_no_motion():
    """By the program's own rows: what they leave to each limit past the horizon is what `past_horizon` leaves."""
    nodes, nx = 6, 2
    drift = np.array([[0.0, 0.5]] * (nodes - 1) + [[0.0, 0.0]])  # what the nominal, a rest, lacks to be a motion
    many = [np.repeat(part[None], nodes, axis=0) for part in (CART.A, CART.B, CART.E, CART.C, CART.D, CART.F)]
    rest = {"x": np.zeros((nodes, nx)), "u": np.zeros((nodes, 1)), "y": np.zeros((nodes, nx)), "c": drift}
    names = {key: getattr(CART, key) for key in ("states", "inputs", "disturbances", "outputs")}
    ltv = LTVModel(0.1 * np.arange(nodes), *many, **rest, **names)
    given = {"horizon": 2, "terminal": 2, "limits": (-1.0, 1.0), "bounds": {"v": (-1.0, 1.0)}}
    law = TubeMPC.along(ltv, np.eye(nx), [[1.0]], DisturbanceSet.box([0.01, 0.01]), **given)
    x = np.array([0.2, -0.1])
    law.act(0.0, x)
    assert law.mpc.plan.z is None
    step, A, B = law.mpc.plan.step, law.course.A, law.course.B
    xi = x
    for k, u in enumerate(law.mpc.plan.inputs()):
        xi = A[k] @ xi + B[k] @ u + law.c[k]
    left = ((step.high - step.G[: len(step.high)] @ x) * step.scale).reshape(4, 2)[2:]
    rows, _, high = past_horizon(law.course, law.taken, law.mpc.limits, law.c, law.origin, 0, 3, 2)
    np.testing.assert_allclose([h - F @ xi for F, h in zip(rows, high)], left, atol=1e-12)


def test_what_inputs_on_their_way_do_is_no_plan_kept_where_it_leaves_its_limits():
    """v' = a, a period late: the next v is v + dt 0.5 whatever is planned, and the tightened limit is 1 - 0.01."""
    given = {"dt": 0.1, "horizon": 5, "limits": (-1.0, 1.0), "bounds": {"v": (-1.0, 1.0)}}
    law = TubeMPC.design(CART, np.eye(2), [[1.0]], DisturbanceSet.box([0.0, 0.01]), delay=1, before=[0.5], **given)
    for v, violations in ((0.93, 0), (0.95, 1)):
        law.reset()
        law.act(0.0, np.array([0.0, v]))
        assert law.record.violations == violations
    assert law.record.worst[0] == pytest.approx(0.95 + 0.05 + 0.01 - 1.0)


def test_a_signal_that_no_plan_moves_in_time_is_no_plan_kept():
    """p+ = p + v/10, v+ = v + u: p of the next period is where it is, and out of the limit of 1."""
    chain = LinearModel.from_matrices([[1.0, 0.1], [0.0, 1.0]], [[0.0], [1.0]], states=["p", "v"], inputs=["u"], dt=0.1)
    given = {"horizon": 5, "limits": (-3.0, 3.0), "bounds": {"p": (-1.0, 1.0)}}
    law = TubeMPC.design(chain, np.eye(2), [[1.0]], DisturbanceSet.box([0.001, 0.001]), **given)
    law.act(0.0, np.array([0.95, 0.4]))
    assert law.record.violations == 0
    law.reset()
    law.act(0.0, np.array([0.95, 0.6]))
    assert law.record.violations == 1
    assert law.record.worst[0] == pytest.approx(0.95 + 0.06 + 0.001 - 1.0)
