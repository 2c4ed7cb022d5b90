"""Limits are kept under every disturbance of the set that is tried; where plans end, the ancillary law goes on."""

import copy
import pickle

import numpy as np
import pytest
from two_masses import DT, GIVEN, HELD, LIMIT, MODEL, PUSH, Q, R, play, tube

from pliant.controllers import MPC, DisturbanceSet, TubeMPC, export_c
from pliant.controllers.linear_quadratic.delay import delayed
from pliant.controllers.tube_mpc.error_bounds import tightening
from pliant.controllers.tube_mpc.tube_designs import about_point
from pliant.envs import scenes
from pliant.plants import LinearModel, LTVModel


@pytest.fixture(scope="module")
def law():
    return tube(horizon=20)


@pytest.mark.parametrize("count", [12, pytest.param(3000, marks=pytest.mark.campaign)])
def test_no_run_leaves_its_limits_where_those_of_plain_mpc_do(law, count):
    plain = MPC.design(MODEL, Q, R, horizon=20, **GIVEN)
    broken = 0
    for seed in range(count):
        start = np.random.default_rng([seed, 1]).uniform(0.8, 2.0) * np.array([1.0, 1.0, 0.0, 0.0])
        speed, force, first = play(law, start, seed)
        assert first and law.record.violations == 0
        assert speed <= LIMIT * (1 + 1e-6) and force <= 1.0
        broken += play(plain, start, seed)[0] > LIMIT
    assert broken > count // 3


@pytest.mark.parametrize(
    ("delay", "count"), [(1, 8), (3, 8), *(pytest.param(d, 1500, marks=pytest.mark.campaign) for d in (1, 2, 3))]
)
def test_told_of_a_delay_it_leaves_no_limit_and_untold_or_without_tubes_it_does(law, delay, count):
    told, plain = tube(horizon=20, delay=delay), MPC.design(MODEL, Q, R, horizon=20, delay=delay, **GIVEN)
    broken = np.zeros(2, dtype=int)
    for seed in range(count):
        start = np.random.default_rng([seed, 1]).uniform(0.8, 2.0) * np.array([1.0, 1.0, 0.0, 0.0])
        speed, force, first = play(told, start, seed, late=delay)
        assert first and told.record.violations == 0
        assert speed <= LIMIT * (1 + 1e-6) and force <= 1.0
        broken += [play(other, start, seed, late=delay)[0] > LIMIT for other in (law, plain)]
    assert (broken > count // 2).all()


def test_what_goes_on_under_the_ancillary_law_is_on_its_way():
    """u = v - K (zeta - z) of the inputs on their way too, and that u, not what was refused, is the newest of them."""
    law, start = tube(horizon=20, delay=2), np.array([1.5, 1.5, 0.0, 0.0])
    given = [law.act(0.0, start)]
    planned = law.mpc.plan.inputs().copy()
    held = delayed(HELD, 2)
    plan = held.A @ np.concatenate([start, [0.0, 0.0]]) + held.B @ planned[0]
    off = np.array([0.0, 0.0, -0.3, 0.5])  # faster than allowed
    for k in (1, 2):
        way = np.concatenate([np.zeros(2), *given])[-2:]
        zeta = np.concatenate([plan[:4] + off, way])
        given.append(law.act(k * DT, zeta[:4]))
        assert law.record.violations + law.record.failures == k
        np.testing.assert_allclose(given[k], planned[k] - law.course.K[0] @ (zeta - plan), atol=1e-9)
        plan = held.A @ plan + held.B @ planned[k]


def test_where_no_limit_is_near_it_is_mpc(law):
    x = np.array([0.01, 0.01, 0.0, 0.0])
    law.reset()
    np.testing.assert_allclose(law.act(0.0, x), MPC.design(MODEL, Q, R, horizon=20, **GIVEN).act(0.0, x), atol=1e-12)
    late = {"horizon": 20, "delay": 2, "before": [0.05]}
    told, plain = tube(**late), MPC.design(MODEL, Q, R, **late, **GIVEN)
    for k in range(3):
        np.testing.assert_allclose(told.act(k * DT, x), plain.act(k * DT, x), atol=1e-12)
    assert told.record.limited == 0


def test_where_no_plan_is_found_the_last_one_goes_on_under_its_ancillary_law(law):
    """From a state that no disturbance of the set leads to: u = v - K (x - z), v and z the former plan's."""
    law.reset()
    x = np.array([1.5, 1.5, 0.0, 0.0])
    law.act(0.0, x)
    planned = law.mpc.plan.inputs().copy()
    off = np.array([0.0, 0.0, 0.2, 0.6])  # faster than allowed
    z = HELD.A @ x + HELD.B @ planned[0]
    given = law.act(DT, z + off)
    assert law.record.violations == 1
    np.testing.assert_allclose(given, np.clip(planned[1] - law.course.K[0] @ off, -1, 1), atol=1e-9)
    z = HELD.A @ z + HELD.B @ planned[1]
    given = law.act(2 * DT, z + off)
    np.testing.assert_allclose(given, np.clip(planned[2] - law.course.K[0] @ off, -1, 1), atol=1e-9)
    law.reset()
    lost = law.act(0.0, z + off)  # without a plan before it is what MPC gives
    np.testing.assert_allclose(lost, law.mpc.act(0.0, z + off), atol=1e-9)


def test_along_a_nominal_the_tubes_go_with_it():
    """The two masses swinging freely as nominal: of deviations the same model, so that tubes are the same."""
    t = DT * np.arange(31)
    x = np.array([np.linalg.matrix_power(HELD.A, k) @ [0.05, -0.05, 0.0, 0.0] for k in range(31)])
    many = [np.repeat(part[None], 31, axis=0) for part in (MODEL.A, MODEL.B, MODEL.E, MODEL.C, MODEL.D, MODEL.F)]
    rest = {"c": np.zeros((31, 4)), "x": x, "u": np.zeros((31, 1)), "y": np.zeros((31, len(MODEL.outputs)))}
    names = {key: getattr(MODEL, key) for key in ("states", "inputs", "disturbances", "outputs")}
    ltv = LTVModel(t, *many, **rest, **names)
    made = TubeMPC.along(ltv, Q, R, PUSH, horizon=8, limits=(-1.0, 1.0), bounds=GIVEN["bounds"])
    assert made.dt == pytest.approx(DT)
    still = about_point(MODEL, Q, R, 8, DT, (GIVEN["limits"], None, GIVEN["bounds"], 0, None), None)
    same = tightening(still.courses[made.price], still.rows(made.price, 1), PUSH, 1)
    for along, point in zip(made.taken, same):  # of a cost summed over nodes, not integrated over steps
        np.testing.assert_allclose(along, np.broadcast_to(point, along.shape), rtol=0.2, atol=1e-3)
    speeds = []
    state = x[0] + [0.3, 0.3, 0.0, 0.0]
    for k in range(30):
        u = made.act(k * DT, state)
        state = HELD.A @ state + HELD.B @ u + PUSH.points[0][-1 if state[3] > 0 else 0]
        speeds.append(abs(state[3]))
    assert made.record.violations == 0 and max(speeds) <= LIMIT
    assert np.abs(state - x[30])[:2].max() < 0.1  # from 0.3, though pushed the wrong way all the time


def test_copies_go_on_as_the_original_and_apart(law):
    law.reset()
    law.act(0.0, np.array([1.5, 1.5, 0.0, 0.0]))
    off = np.array([1.4, 1.4, 0.2, 0.8])
    others = [copy.deepcopy(law), pickle.loads(pickle.dumps(law))]
    wanted = law.act(DT, off)
    for other in others:
        np.testing.assert_array_equal(other.act(DT, off), wanted)
    law.reset()
    assert others[0].record.calls == 2 and law.record.calls == 0


def test_it_has_no_c_form_and_says_what_has(law, tmp_path):
    with pytest.raises(ValueError, match=r"TubeMPC has no C form, .* its `mpc`"):
        export_c(law, tmp_path / "tube.c")


def test_bad_input(law):
    with pytest.raises(ValueError, match=r"disturbances are of 2 states, must be of 4"):
        TubeMPC.design(MODEL, Q, R, DisturbanceSet.box([0.1, 0.1]), **GIVEN)
    with pytest.raises(ValueError, match=r"TubeMPC\.design: disturbances"):
        TubeMPC.design(MODEL, Q, R, 0.1, **GIVEN)
    with pytest.raises(ValueError, match=r"TubeMPC\.rounds"):
        TubeMPC.for_scene(scenes.get("single-link-slew"), rounds=0)
    with pytest.raises(ValueError, match=r"TubeMPC\.y"):
        law.act(0.0, np.zeros(3))


def test_feedthrough_that_is_none_at_a_node_is_looked_at_there_too():
    """y = x + 2 u, but x at node 3: a bound of 0.2 on y is kept there from any start whose plan keeps it."""
    nodes, one = 8, np.ones((8, 1, 1))
    D = 2 * one
    D[3] = 0.0
    model = LinearModel.from_matrices([[0.0]], [[10.0]], states=["x"], inputs=["u"], outputs=["y"])
    rest = {key: np.zeros((nodes, 1)) for key in ("c", "x", "u", "y")}
    names = {key: getattr(model, key) for key in ("states", "inputs", "disturbances", "outputs")}
    none = np.zeros((nodes, 1, 0))
    ltv = LTVModel(DT * np.arange(nodes), 0 * one, 10 * one, none, one, D, none, **rest, **names)
    given = {"horizon": 5, "limits": (-0.4, 0.4), "bounds": {"y": (-0.2, 0.2)}}
    made = TubeMPC.along(ltv, [[1.0]], [[100.0]], DisturbanceSet.box([0.001]), **given)
    for start in (0.5, 0.8, 0.95):
        made.reset()
        x = np.array([start])
        for k in range(4):
            u = made.act(k * DT, x)
            assert made.record.violations == 0
            assert abs(x[0] + D[k, 0, 0] * u[0]) <= 0.2 + 1e-6
            x = x + u + 0.001
