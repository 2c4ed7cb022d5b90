"""LQR in closed loop: cost to go, sampled design, integral action, limits, names; Feedback."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.controllers import LQR, Controller, Feedback, riccati
from pliant.envs import scenes
from pliant.plants import SingleLinkArm
from pliant.plants.core.errors import EquilibriumError, UncontrollableError
from pliant.plants.core.signals import Signal
from pliant.plants.linear.lti import LinearModel

STATES = ("theta", "q", "omega", "v")


def arm(x0=(0.3, 0.0, 0.0, 0.0), u0=(2.0,)):
    """A driven hub with one elastic mode, 2 Hz, lightly damped; outputs tip and torque balance."""
    K, D = np.diag([0.0, 158.0]), np.diag([0.1, 0.25])
    M = np.array([[2.0, 0.6], [0.6, 1.0]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    B = np.concatenate([np.zeros(2), np.linalg.solve(M, [1.0, 0.0])])[:, None]
    C = np.array([[1.0, 0.8, 0, 0], [0, 0, 0, 1.0]])
    signals = [tuple(Signal(n, "") for n in names) for names in (STATES, ("torque",), ("load",), ("tip", "acc"))]
    return LinearModel(
        A, B, B, C, np.array([[0.0], [0.5]]), np.zeros((2, 1)), *signals,
        x0=np.array(x0), u0=np.array(u0), w0=np.zeros(1), y0=np.array([0.24, 0.0]), f0=np.zeros(4),
    )  # fmt: skip


def roll(model, controller, x, steps, dt, load=0.0):
    """Closed loop of the linear model with a held input: x (steps+1, nx), u (steps, nu)."""
    sampled = model.discretize(dt)
    controller.reset()
    xs, us = [np.asarray(x, dtype=float)], []
    for k in range(steps):
        x = xs[-1]
        y = dict(zip(model.state_names, x)) | {"tip": float(model.y0[0] + model.C[0] @ (x - model.x0))}
        us.append(controller.act(k * dt, np.array([y[name] for name in controller.reads])))
        dx = sampled.A @ (x - model.x0) + sampled.B @ (us[-1] - model.u0) + sampled.E @ [load]
        xs.append(model.x0 + dx)
    return np.array(xs), np.array(us)


def test_is_a_controller():
    controller = LQR.design(arm(), np.eye(4), np.eye(1))
    assert isinstance(controller, Controller) and isinstance(Feedback([[1.0]], ("x",)), Controller)
    assert controller.reads == STATES and controller.dt is None
    np.testing.assert_array_equal(controller.act(0.0, arm().x0), arm().u0)


def test_gain_of_the_double_integrator():
    model = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [1]], states=["x", "v"], inputs=["f"])
    controller = LQR.design(model, {"x": 1.0, "v": 1.0}, {"f": 1.0})
    np.testing.assert_allclose(controller.K, [[1, np.sqrt(3)]], rtol=1e-12)


@pytest.mark.campaign
def test_continuous_cost_to_go_is_the_integrated_cost():
    model = arm()
    Q, R = {"theta": 50.0, "tip": 10.0, "acc": 0.3}, {"torque": 0.4}
    controller = LQR.design(model, Q, R)
    start = np.array([0.5, 0.01, 0.1, -0.2])

    def rate(t, z):
        dx = z[:4]
        u = controller.act(t, model.x0 + dx) - model.u0
        y = model.C @ dx + model.D @ u
        cost = 50 * dx[0] ** 2 + 10 * y[0] ** 2 + 0.3 * y[1] ** 2 + 0.4 * u[0] ** 2
        return np.append(model.A @ dx + model.B @ u, cost)

    rolled = solve_ivp(rate, (0, 120), np.append(start - model.x0, 0), "DOP853", rtol=1e-11, atol=1e-13).y
    assert controller.cost_to_go(start) == pytest.approx(rolled[-1, -1], rel=1e-8)


@pytest.mark.campaign
def test_sampled_cost_to_go_is_the_integrated_cost():
    model, dt = arm(), 0.1
    controller = LQR.design(model, {"theta": 50.0, "tip": 10.0, "acc": 0.3}, {"torque": 0.4}, dt=dt)
    start = np.array([0.5, 0.01, 0.1, -0.2])
    controller.reset()
    z = np.append(start - model.x0, 0.0)
    for k in range(1000):
        u = controller.act(k * dt, model.x0 + z[:4]) - model.u0

        def rate(t, z, u=u):
            y = model.C @ z[:4] + model.D @ u
            cost = 50 * z[0] ** 2 + 10 * y[0] ** 2 + 0.3 * y[1] ** 2 + 0.4 * u[0] ** 2
            return np.append(model.A @ z[:4] + model.B @ u, cost)

        z = solve_ivp(rate, (0, dt), z, "DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    assert controller.cost_to_go(start) == pytest.approx(z[-1], rel=1e-8)
    assert controller.cost_to_go(start) > LQR.design(
        model, {"theta": 50.0, "tip": 10.0, "acc": 0.3}, {"torque": 0.4}
    ).cost_to_go(start)


def test_sampled_design_tends_to_the_continuous_one_at_first_order():
    model = arm()
    limit = LQR.design(model, np.eye(4), np.eye(1))
    errors = [np.abs(LQR.design(model, np.eye(4), np.eye(1), dt=h).K - limit.K).max() for h in (1e-2, 1e-3, 1e-4)]
    assert np.all(np.abs(np.log10(np.divide(errors[:-1], errors[1:])) - 1) < 0.05)
    costs = [np.abs(LQR.design(model, np.eye(4), np.eye(1), dt=h).P - limit.P).max() for h in (1e-2, 1e-3)]
    assert abs(np.log10(costs[0] / costs[1]) - 2) < 0.2  # the held input costs more only in second order


@pytest.mark.parametrize("dt", [None, 0.02])
def test_integral_action_removes_a_constant_load(dt):
    model = arm()
    plain = LQR.design(model, np.eye(4), np.eye(1), dt=dt)
    controller = LQR.design(model, np.eye(4), np.eye(1), dt=dt, integral={"tip": 5.0})
    assert controller.reads == (*STATES, "tip") and controller.K.shape == (1, 5)
    x, u = roll(model, controller, model.x0, 2000, 0.02, load=1.5)
    tip = (x - model.x0) @ model.C[0]
    assert abs(tip[-1]) < 1e-6 and u[-1, 0] == pytest.approx(2.0 - 1.5, abs=1e-6)
    x, _ = roll(model, plain, model.x0, 2000, 0.02, load=1.5)
    assert abs((x[-1] - model.x0) @ model.C[0]) > 0.5


def test_rolled_cost_with_integral_is_the_cost_to_go():
    model, dt = arm(), 0.05
    controller = LQR.design(model, np.eye(4), np.eye(1), dt=dt, integral={"theta": 5.0})
    assert controller.reads == STATES
    start = model.x0 + np.array([0.2, 0.01, 0.0, 0.1])
    expected = controller.cost_to_go(start)
    x, u = roll(model, controller, start, 1500, dt)
    one = riccati.sampled(model.A, model.B, np.eye(4), np.eye(1), dt=dt)
    dx, du = x[:-1] - model.x0, u - model.u0
    xi = dt * np.concatenate([[0.0], np.cumsum(dx[:-1, 0])])
    cost = np.einsum("ki,ij,kj", dx, one.Q, dx) + np.einsum("ki,ij,kj", du, one.R, du)
    cost += 2 * np.einsum("ki,ij,kj", dx, one.N, du) + 5.0 * dt * np.sum(xi**2)
    assert expected == pytest.approx(cost, rel=1e-9)


def test_limits_hold_and_the_integral_does_not_wind_up():
    model, dt = arm(), 0.02
    design = lambda **more: LQR.design(model, np.eye(4), np.eye(1), dt=dt, integral={"tip": 5.0}, **more)  # noqa: E731
    start = model.x0 + np.array([-6.0, 0, 0, 0])
    bound, free = design(limits=(0.0, 4.0)), design()
    x, u = roll(model, bound, start, 2500, dt)
    assert u.max() == 4.0 and u.min() == 0.0
    assert abs((x[-1] - model.x0) @ model.C[0]) < 1e-3

    wound = design(limits=(0.0, 4.0))
    wound._integrate = lambda y, change: setattr(wound, "xi", wound.xi + change)
    z, _ = roll(model, wound, start, 2500, dt)
    overshoot = lambda rows: ((rows - model.x0) @ model.C[0]).max()  # noqa: E731
    assert overshoot(x) < 0.8 * overshoot(z)
    roll(model, free, start, 3, dt)
    assert free.xi[0] != 0
    free.reset()
    assert free.xi[0] == 0


def test_weights_by_name():
    model = arm()
    c, d = model.C[1], model.D[1]
    by_name = LQR.design(model, {"q": 3.0, "tip": 2.0, "acc": 0.5}, {"torque": 0.1})
    Q = np.diag([0, 3.0, 0, 0]) + 2 * np.outer(model.C[0], model.C[0]) + 0.5 * np.outer(c, c)
    expected = riccati.lqr(model.A, model.B, Q, 0.1 + 0.5 * np.outer(d, d), 0.5 * np.outer(c, d))
    np.testing.assert_allclose(by_name.K, expected.K, rtol=1e-12)
    np.testing.assert_array_equal(model.B, arm().B)


def test_reads_may_be_the_plants_own_names():
    controller = LQR.design(arm(), np.eye(4), np.eye(1), reads=("a", "b", "c", "d"))
    assert controller.reads == ("a", "b", "c", "d")
    with pytest.raises(ValueError, match="must be 4 names"):
        LQR.design(arm(), np.eye(4), np.eye(1), reads=("a",))


def test_for_plant_uses_the_plants_own_linear_model():
    class Linear(SingleLinkArm):
        def linearize(self, x0, u0=None, *, w=None, p=None, t=0.0):
            return arm(x0, u0)

    controller = LQR.for_plant(
        Linear(link=SingleLinkArm.textbook().link, kinematics="linear", modes=1),
        np.ones(4),
        np.ones(1),
        np.eye(4),
        np.eye(1),
        dt=0.1,
        limits=(-3, 3),
    )
    np.testing.assert_array_equal(controller.x0, np.ones(4))
    np.testing.assert_array_equal(controller.K, LQR.design(arm(), np.eye(4), np.eye(1), dt=0.1).K)


def test_modes_are_named():
    with pytest.raises(UncontrollableError, match=r"mode 0\.00 Hz \(theta\) cannot be seen by the cost"):
        LQR.design(arm(), {"q": 1.0}, {"torque": 1.0})
    with pytest.raises(UncontrollableError, match=r"\(theta\) cannot be seen by the cost"):
        LQR.design(arm(), {"q": 1.0}, {"torque": 1.0}, dt=0.01)
    with pytest.raises(UncontrollableError, match="integral of"):
        LQR.design(arm(), np.eye(4), np.eye(1), integral={"theta": 1.0, "tip": 1.0})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"Q": {"tip_z": 1.0}}, "state or output 'tip_z' must be one of theta, q, omega, v, tip, acc"),
        ({"Q": {"tip": -1.0}}, r"LQR\.Q\['tip'\] = -1\.0 must be >= 0"),
        ({"Q": np.eye(3)}, r"LQR\.Q has shape \(3, 3\), must be \(4, 4\)"),
        ({"R": {}}, r"LQR\.R\['torque'\] = 0 must be > 0"),
        ({"R": {"force": 1.0}}, "input 'force' must be one of torque"),
        ({"dt": -0.1}, r"dt = -0\.1 must be > 0"),
        ({"integral": {"tip": 0.0}}, r"LQR\.integral\['tip'\] = 0\.0 must be > 0"),
        ({"integral": {"nose": 1.0}}, "output 'nose' must be one of"),
        ({"limits": (0.0, 0.0)}, r"LQR\.limits of torque = \(0, 0\) must be lowest < highest"),
        ({"limits": {"torque": (1.0, -1.0)}}, r"LQR\.limits of torque = \(1, -1\)"),
        ({"model": arm().discretize(0.1)}, r"model\.dt = 0\.1 must be None"),
    ],
)
def test_bad_input(change, message):
    with pytest.raises(ValueError, match=message):
        LQR.design(**{"model": arm(), "Q": np.eye(4), "R": np.eye(1), **change})


def test_bad_measurement():
    controller = LQR.design(arm(), np.eye(4), np.eye(1))
    with pytest.raises(ValueError, match=r"LQR\.y\[1\] = nan must be finite"):
        controller.act(0.0, np.array([0, np.nan, 0, 0]))


def test_feedback():
    law = Feedback([[2.0, 1.0]], ("x", "v"), y_ref=[1.0, 0.0], u_ref=[0.5], limits=(-1.0, 1.0))
    np.testing.assert_allclose(law.act(0.0, np.array([1.1, 0.2])), [0.1])
    np.testing.assert_allclose(law.act(0.0, np.array([9.0, 0.0])), [-1.0])
    law.reset()
    with pytest.raises(ValueError, match=r"Feedback\.K has shape"):
        Feedback([[1.0]], ("x", "v"))
    with pytest.raises(ValueError, match=r"Feedback\.dt = 0 must be > 0"):
        Feedback([[1.0]], ("x",), dt=0)


def test_for_scene_is_the_sampled_design_about_the_goal():
    scene = scenes.get("single-link-slew")
    law = LQR.for_scene(scene)
    Q, R, _ = scene.quadratic()
    other = LQR.for_plant(scene.plant, *scene.target, Q, R, dt=scene.dt, limits=(-40.0, 40.0))
    x = scene.initial[0] + 0.1
    np.testing.assert_allclose(law.act(0.0, x), other.act(0.0, x), rtol=1e-12)
    assert law.act(0.0, x - 9.0) == pytest.approx([40.0])
    assert np.abs(LQR.for_scene(scene, effort=10.0).K).max() < np.abs(law.K).max()
    with pytest.raises(ValueError, match=r"LQR.for_scene.effort = 0 must be > 0"):
        LQR.for_scene(scene, effort=0)


def test_for_scene_leaves_out_an_angle_that_nothing_depends_on():
    law = LQR.for_scene(scenes.get("spin-up"))
    assert "hub_angle" not in law.reads and "hub_angle_rate" in law.reads
    assert np.abs(law.poles).max() < 1
    with pytest.raises(EquilibriumError, match=r"crank_angle changes by 15\.1 rad/s there"):
        LQR.for_scene(scenes.get("slider-crank-run"))


def test_a_goal_that_moves_steadily_is_followed():
    scene = scenes.get("single-link-slew")
    law = LQR.for_scene(scene)
    law.drift = np.array([0.5, 0, 0, 0, 0, 0])
    moved = scene.target[0] + 2.0 * law.drift
    np.testing.assert_allclose(law.act(2.0, moved), scene.target[1], atol=1e-9)
    assert np.abs(law.act(0.0, moved)).max() > 1.0
