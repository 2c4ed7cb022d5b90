"""Linear MPC against LQR and against programs stated and solved otherwise; copies, resets, blocks and moving goals."""

import copy
import pickle
import types

import numpy as np
import pytest
from elastic_hub import DT, LINK, STATES, Q, R, plan
from predictive_programs import reference, sampled_problem

from pliant.controllers import LQR, MPC, Controller, riccati
from pliant.envs import scenes
from pliant.plants.linear.lti import LinearModel


def test_is_a_controller_that_can_be_copied():
    controller = MPC.design(LINK, Q, R, dt=DT, limits=(-1.0, 1.0), bounds={"bend": (-0.01, 0.01)})
    assert isinstance(controller, Controller) and controller.reads == LINK.state_names and controller.dt == DT
    for twin in (copy.deepcopy(controller), pickle.loads(pickle.dumps(controller))):
        for x in STATES[:10]:
            np.testing.assert_allclose(twin.act(0.0, x), controller.act(0.0, x), atol=1e-9)


@pytest.mark.parametrize("horizon", [1, 7, 40])
def test_without_limits_it_is_lqr_at_every_state(horizon):
    Ad, Bd, Qd, Rd, Nd, _ = sampled_problem()
    K = riccati.dlqr(Ad, Bd, Qd, Rd, Nd).K
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=horizon)
    for x in 10 * STATES:
        np.testing.assert_allclose(controller.act(0.0, x), -K @ x, atol=1e-9, rtol=1e-9)


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach", "spin-up", "spacecraft-slew"])
def test_without_limits_it_is_the_lqr_of_a_scene_whose_goal_may_move(name):
    scene = scenes.get(name)
    lqr, mpc = LQR.for_scene(scene), MPC.for_scene(scene, limits=None, bounds={})
    lqr.limits = (-np.inf, np.inf)
    assert mpc.reads == lqr.reads
    for x in np.random.default_rng(0).uniform(-0.2, 0.2, (20, len(lqr.x0))):
        expected = lqr.act(0.4, lqr.x0 + x)
        np.testing.assert_allclose(mpc.act(0.4, lqr.x0 + x), expected, rtol=1e-9, atol=1e-9 * np.abs(lqr.K).max())


def test_move_blocking():
    blocks = (1, 1, 2, 3, 5)
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=12, limits=(-0.6, 0.6), blocks=blocks)
    assert controller._steps[0].solver.M.shape[1] == 2 * len(blocks)
    limited = 0
    for x in STATES:
        controller.act(0.0, x)
        limited += bool(controller.plan.z is not None)
        found = plan(controller)
        np.testing.assert_allclose(found, np.repeat(found[[0, 1, 2, 4, 7]], blocks, axis=0), atol=1e-9)
        np.testing.assert_allclose(found, reference(x, 12, low=-0.6, high=0.6, blocks=blocks), atol=2e-6)
    assert limited > 10
    free = MPC.design(LINK, Q, R, dt=DT, horizon=12, blocks=blocks)
    for x in STATES[:5]:
        free.act(0.0, x)
        np.testing.assert_allclose(plan(free), reference(x, 12, blocks=blocks), atol=1e-7)


def test_after_reset_it_acts_bit_for_bit_as_a_new_one():
    options = {"limits": (-0.7, 0.7), "rates": 5.0, "bounds": {"bend": (-0.004, 0.004)}}
    controller = MPC.design(LINK, Q, R, dt=DT, **options)
    for x, former in zip(STATES[::4], STATES[::-4]):
        controller.act(0.0, former)
        controller.reset()
        np.testing.assert_array_equal(controller.act(0.0, x), MPC.design(LINK, Q, R, dt=DT, **options).act(0.0, x))


@pytest.mark.parametrize("speed", [0.5, -0.2])
def test_about_a_goal_that_moves_it_is_the_regulator_about_where_the_goal_then_is(cart, speed):
    """A cart that is to roll on: in coordinates that move with it that is the regulator about rest."""
    scene = moving_scene(cart(weights={"s": 5.0, "q": 1.0, "s_rate": 0.3}), speed)
    law = MPC.for_scene(scene, 8, limits=None, bounds={})
    rest = LQR.for_plant(scene.plant, np.zeros(4), [0.0], dict(scene.weights), dict(scene.effort), dt=scene.dt)
    away = np.array([0.2, -0.03, 0.1, 0.05])
    for t in (0.0, 3.7, 40.0):
        goal = np.array([speed * t, 0.0, speed, 0.0])
        np.testing.assert_allclose(law.act(t, goal + away), -rest.K @ away, rtol=1e-9, atol=1e-9)
    copied = pickle.loads(pickle.dumps(law))
    np.testing.assert_array_equal(copied.act(40.0, goal + away), law.act(40.0, goal + away))


def moving_scene(objective, speed):
    """What MPC asks of a scene, of a cart whose goal rolls at `speed` [m/s]."""
    x = np.array([0.0, 0.0, speed, 0.0])
    return types.SimpleNamespace(
        name="rolling",
        plant=objective.plant,
        weights=tuple(objective.weights.items()),
        effort=tuple(objective.effort.items()),
        bounds=(),
        limits=(1.0,),
        dt=objective.dt,
        goal_rates=(("s", speed),),
        target=(x, np.zeros(1)),
        initial=(x, np.zeros(1)),
    )


@pytest.mark.parametrize(("B", "price", "grows"), [((1.0, -0.4), 1.0, 7.0), ((1.0, -0.9), 0.1, 7.0)])
def test_a_plant_that_grows_a_million_times_over_the_horizon_is_pushed_back_with_all_there_is(B, price, grows):
    """From a state that no input holds, every input of the least cost is at the limit that pushes back. The rows of
    nine steps are nearly parallel: DAQP alone passed the limits by percents and gave another first move.
    """
    model = LinearModel.from_matrices([[grows]], [list(B)], dt=1.0)
    law = MPC.design(model, [[1.0]], price * np.eye(2), horizon=9, limits=(-1.0, 1.0))
    move = law.act(0.0, np.array([3.0]))
    np.testing.assert_allclose(move, -np.sign(B), atol=1e-6)
    np.testing.assert_allclose(law.plan.inputs(), np.tile(-np.sign(B), (9, 1)), atol=1e-5)
    assert law.record.failures == 0


@pytest.mark.parametrize("delay", [1, 1.5, (0, 1)], ids=str)
def test_without_active_limits_a_late_mpc_is_the_late_lqr(delay):
    """Input for input over a motion in which none of them saturates, whole and part periods and a range."""
    scene = scenes.get("single-link-slew")
    laws = [kind.for_scene(scene, delay=delay) for kind in (MPC, LQR)]
    rng = np.random.default_rng(2)
    for k in range(12):
        x = scene.target[0] + 1e-3 * rng.normal(size=6)
        first, second = (law.act(k * scene.dt, x) for law in laws)
        np.testing.assert_allclose(first, second, rtol=1e-8, atol=1e-9)
    assert laws[0].record.limited == 0


def test_a_late_mpc_keeps_its_limits_and_goes_on_as_its_copy():
    scene = scenes.get("single-link-slew")
    law = MPC.for_scene(scene, delay=1.5)
    u = [law.act(0.0, scene.initial[0])]
    again = copy.deepcopy(law)
    for k in range(1, 6):
        u.append(law.act(k * scene.dt, scene.initial[0]))
        np.testing.assert_array_equal(again.act(k * scene.dt, scene.initial[0]), u[-1])
    assert np.abs(u).max() == pytest.approx(scene.limits[0]) and law.record.failures == 0
    law.reset()
    np.testing.assert_array_equal(law.act(0.0, scene.initial[0]), u[0])


def test_a_delay_needs_a_continuous_model_and_no_target():
    model = scenes.get("single-link-slew").plant.linearize(*scenes.get("single-link-slew").target)
    Q, R = {"hub_angle": 1.0}, {"hub_torque": 1.0}
    for extra in ({"track": ("hub_angle",)}, {"P": np.eye(6)}):
        with pytest.raises(ValueError, match=r"MPC\.delay"):
            MPC.design(model, Q, R, dt=0.02, delay=1, **extra)
    with pytest.raises(ValueError, match=r"MPC\.before"):
        MPC.design(model, Q, R, dt=0.02, delay=1, before=[0.0, 1.0])
