"""MPC from where no input keeps the limits: a link that already turns too fast may not bend enough to brake in time.

Whether any inputs within the limits keep the bounds is a linear program, solved by HiGHS: no part of the controller.
"""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import linprog

from pliant.controllers import MPC
from pliant.envs import scenes
from pliant.plants import LinearModel

HORIZON = 20
BOUNDS = {"hub_angle_rate": (-1.0, 1.0), "tip_deflection": (-0.008, 0.008)}
SCENE = dataclasses.replace(scenes.get("single-link-slew"), bounds=())
MODEL = SCENE.plant.linearize(*SCENE.target).discretize(SCENE.dt)


def feasible(x) -> bool:
    """Whether inputs within the limits keep the bounds over the horizon, from the state x (6,)."""
    n, nu = len(MODEL.A), MODEL.B.shape[1]
    rows = np.vstack([np.eye(n), MODEL.C])
    names = [*MODEL.state_names, *MODEL.output_names]
    y0 = np.concatenate([MODEL.x0, MODEL.y0])
    G, g = np.zeros((n, HORIZON * nu)), np.asarray(x) - MODEL.x0
    left, right = [], []
    for j in range(HORIZON):
        G, g = MODEL.A @ G, MODEL.A @ g
        G[:, j * nu : (j + 1) * nu] += MODEL.B
        for name, (low, high) in BOUNDS.items():
            i = names.index(name)
            left += [rows[i] @ G, -rows[i] @ G]
            right += [high - y0[i] - rows[i] @ g, -low + y0[i] + rows[i] @ g]
    limits = [(-high, high) for high in SCENE.limits] * HORIZON
    found = linprog(np.zeros(HORIZON * nu), A_ub=np.array(left), b_ub=np.array(right), bounds=limits)
    assert found.status in (0, 2)
    return found.status == 0


def spinning(rate):
    """Held at the start, but for the hub's rate [rad/s]."""
    x = SCENE.initial[0].copy()
    x[MODEL.state_names.index("hub_angle_rate")] = rate
    return x


def run(controller, x, steps=250):
    """States (steps+1, 6), inputs (steps, 1), and whether the plant's state was feasible at each step."""
    step = SCENE.plant.stepper(SCENE.dt, substeps=SCENE.substeps)
    xs, us, could = [np.array(x)], [], []
    for k in range(steps):
        could.append(feasible(xs[-1]))
        us.append(controller(k * SCENE.dt, xs[-1], could[-1]))
        xs.append(step(xs[-1][None], us[-1][None])[0].copy())
    return np.array(xs), np.array(us), np.array(could)


@pytest.fixture(scope="module")
def mpc():
    return MPC.for_scene(SCENE, horizon=HORIZON, bounds=BOUNDS)


def test_hard_bounds_have_no_solution_and_giving_up_lets_the_link_run_away(mpc) -> None:
    start = spinning(2.0)
    assert not feasible(start)

    def naive(t, x, could):
        return mpc.act(t, x) if could else np.zeros(1)

    xs, _, could = run(naive, start, 120)
    assert not could.any()  # it coasts on at two radians a second and never gets back
    assert xs[-1, 0] > 4.0


def test_the_soft_bounds_always_have_one_say_so_and_recover(mpc) -> None:
    start = spinning(2.0)
    mpc.reset()
    violations = []

    def soft(t, x, could):
        before = mpc.record.violations
        u = mpc.act(t, x)
        violations.append(mpc.record.violations > before)
        return u

    xs, us, could = run(soft, start)
    assert mpc.record.failures == 0 and mpc.record.calls == 250
    assert np.abs(us).max() <= SCENE.limits[0]
    assert violations[0] and not could[0]
    assert dict(zip(mpc.record.names, mpc.record.worst))["hub_angle_rate"] > 0.5
    first = int(np.argmax(could))
    assert 0 < first < 25  # half a second
    assert could[first:].all() and not any(violations[first + 1 :])  # and inside it stays
    rate, bend = (
        np.abs(signal[first + 1 :]).max() for signal in (xs[:, 3], SCENE.plant.measure(xs, np.zeros(1))[:, 1])
    )
    assert rate < 1.0 + 1e-3 and bend < 0.008 + 5e-4  # the model is linear, the plant is not
    assert np.abs(xs[-1] - SCENE.target[0]).max() < 1e-2


def test_where_the_bounds_can_be_kept_they_are(mpc) -> None:
    start = spinning(0.5)
    mpc.reset()
    xs, _, could = run(lambda t, x, could: mpc.act(t, x), start)
    assert could.all() and mpc.record.violations == 0 and mpc.record.limited > 0
    assert np.abs(xs[:, 3]).max() < 1.0 + 1e-3


def test_the_price_found_from_samples_alone_exceeds_a_bound_that_can_be_kept():
    """A cart-pole within its bounds: u = -4.146 by the hard program of another solver (qpOASES)."""
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [0, 9.81, 0, 0], [0, 65.4, 0, 0]])
    names = ["p", "th", "v", "w"]
    cart = LinearModel.from_matrices(A, [[0], [0], [2], [1 / 0.15]], states=names, inputs=["F"])
    bounds = {"p": (-3, 10), "th": (-2, 9), "v": (-2.1, 8), "w": (-2.5, 7)}
    x = np.array([-0.15178016, 0.18706709, -1.77295158, -0.0791845])
    options = {"dt": 0.05, "limits": ([-12], [10]), "bounds": bounds}
    law = MPC.design(cart, np.diag([100.0, 10, 1, 1]), [[0.1]], **options)
    naive = MPC.design(cart, np.diag([100.0, 10, 1, 1]), [[0.1]], penalty=law.penalty, **options)
    naive.act(0.0, x)
    assert naive.record.worst[2] > 0.2
    assert abs(law.act(0.0, x)[0] + 4.146) < 2e-3 and law.record.worst.max() < 1e-6
