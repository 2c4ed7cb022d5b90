"""Linear MPC against LQR, against quadratic programs stated and solved otherwise, and in closed loop.

The reference program keeps states and inputs as variables and is solved by qpOASES: another formulation, another
method. Exceeding a bound by s half ranges costs penalty * (s + 0.0005 s^2) there, as daqp_model.py says.
"""

import copy
import dataclasses
import functools
import pickle
import types

import casadi as ca
import numpy as np
import pytest

from pliant.controllers import LQR, MPC, Controller, riccati
from pliant.controllers.mpc.condensed_prediction import laws
from pliant.envs import scenes
from pliant.plants.core.errors import InfeasibleError, UncontrollableError
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

DT = 0.05
M2, K2, D2 = np.array([[2.0, 0.6], [0.6, 1.0]]), np.diag([0.0, 158.0]), np.diag([0.1, 0.25])
A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M2, K2), -np.linalg.solve(M2, D2)]])
B = np.vstack([np.zeros((2, 2)), np.linalg.solve(M2, [[1.0, 0.2], [0.0, 0.5]])])
C = np.array([[1.0, 0.8, 0, 0], [0, 1.0, 0, 0]])  # tip, bend
LINK = LinearModel.from_matrices(
    A, B, C, states=["theta", "q", "omega", "v"], inputs=["torque", "piezo"], outputs=["tip", "bend"]
)  # a driven hub with one elastic mode, 2 Hz
Q, R = {"tip": 40.0, "theta": 5.0, "omega": 0.5}, {"torque": 0.02, "piezo": 0.05}
STATES = np.random.default_rng(3).uniform(-1, 1, (40, 4)) * [0.6, 0.05, 0.5, 0.5]


def sampled_problem(model=LINK, Q=Q, R=R):
    """A, B, Q, R, N of a step and the cost to go."""
    rows = np.vstack([np.eye(4), model.C])
    names = [*model.state_names, *model.output_names]
    weight = sum(w * np.outer(rows[names.index(n)], rows[names.index(n)]) for n, w in Q.items())
    step = riccati.sampled(model.A, model.B, weight, np.diag(list(R.values())), dt=DT)
    return *step, riccati.dlqr(*step).P


def reference(x, N, *, low=-np.inf, high=np.inf, last=(0.0, 0.0), soft=None, **options):
    """First inputs (N, 2) of the program in states, inputs and excesses of |bend| <= bound, or None."""
    solver, lbg, ubg = program(N, *map(tuple, np.broadcast_arrays(low, high, [0, 0])[:2]), soft is not None, **options)
    found = solver(lbg=lbg, ubg=ubg, p=[*x, *last, soft or 0.0])
    if not solver.stats()["success"]:
        return None
    return np.array(found["x"])[4 * (N + 1) :][: 2 * N].reshape(N, 2)


@functools.cache
def program(N, low, high, softened, *, change=np.inf, bound=np.inf, blocks=()):
    """The solver, a function of the state, the last inputs and the price of an excess, and its rows' limits."""
    Ad, Bd, Qd, Rd, Nd, P = sampled_problem()
    xs, us, s = ca.MX.sym("x", 4, N + 1), ca.MX.sym("u", 2, N), ca.MX.sym("s", N)
    x, last, price = ca.MX.sym("x0", 4), ca.MX.sym("last", 2), ca.MX.sym("price")
    cost = ca.bilin(P, xs[:, N])
    g, lbg, ubg = [xs[:, 0] - x], [0.0] * 4, [0.0] * 4

    def hold(expression, lowest, highest):
        g.append(expression)
        size = expression.numel()
        lbg.extend(np.broadcast_to(lowest, size))
        ubg.extend(np.broadcast_to(highest, size))

    for j in range(N):
        cost += ca.bilin(Qd, xs[:, j]) + ca.bilin(Rd, us[:, j]) + 2 * ca.bilin(Nd, xs[:, j], us[:, j])
        hold(xs[:, j + 1] - Ad @ xs[:, j] - Bd @ us[:, j], 0, 0)
        hold(us[:, j], low, high)
        if np.isfinite(change):
            before = last if j == 0 else us[:, j - 1]
            hold(us[:, j] - before, -change, change)
        if np.isfinite(bound):
            bend = xs[1, j + 1]
            hold(bend - bound * s[j], -np.inf, bound)
            hold(bend + bound * s[j], -bound, np.inf)
            hold(s[j], 0.0, np.inf if softened else 0.0)
            cost += price * (s[j] + 0.0005 * s[j] ** 2) if softened else 0
    for end, length in zip(np.cumsum(blocks), blocks):
        for j in range(end - length, end - 1):
            hold(us[:, j + 1] - us[:, j], 0, 0)
    if not np.isfinite(bound) or not softened:
        cost += ca.sumsqr(s)  # unused
    stated = {
        "x": ca.vertcat(ca.vec(xs), ca.vec(us), s),
        "p": ca.vertcat(x, last, price),
        "f": cost,
        "g": ca.vertcat(*g),
    }
    options = {"printLevel": "none", "error_on_fail": False, "nWSR": 20_000}
    return ca.qpsol("reference", "qpoases", stated, options), lbg, ubg


def plan(controller):
    """Inputs that the controller plans, (N, nu)."""
    return controller.plan.inputs()


def roll(controller, x, steps, *, disturbance=0.0, model=LINK, read=None):
    """States (steps+1, 4) and inputs (steps, 2) of the linear model with a constant force on each input."""
    sampled = model.discretize(DT)
    controller.reset()
    xs, us = [np.array(x, dtype=float)], []
    for k in range(steps):
        us.append(controller.act(k * DT, xs[-1] if read is None else read @ xs[-1]))
        xs.append(sampled.A @ xs[-1] + sampled.B @ (us[-1] + disturbance))
    return np.array(xs), np.array(us)


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


def test_hessian_before_and_after_prestabilisation():
    """The arm of two-link-reach over 40 steps: in the inputs u, and in v = u + K x, where it is block diagonal."""
    scene = scenes.get("two-link-reach")
    model = scene.plant.linearize(*scene.target).discretize(scene.dt)
    weight, effort, _ = (scene.dt * M for M in scene.quadratic())
    P = riccati.dlqr(model.A, model.B, weight, effort).P
    nx, nu, N = 12, 2, 40
    reach, square = np.zeros((nx, N * nu)), np.kron(np.eye(N), effort)
    for j in range(N):
        reach = model.A @ reach
        reach[:, j * nu : (j + 1) * nu] = model.B
        square += reach.T @ (P if j == N - 1 else weight) @ reach
    many = [np.broadcast_to(M, (N, *M.shape)) for M in (model.A, model.B, np.zeros(nx), weight, effort)]
    roots = laws(*many, np.zeros((N, nx, nu)), P).root
    assert np.linalg.cond(square) > 500
    assert np.linalg.cond(roots[0].T @ roots[0]) < 30
    np.testing.assert_allclose(roots, np.broadcast_to(roots[0], roots.shape), rtol=1e-8, atol=1e-10)


def test_input_limits_hold_exactly_and_the_plan_is_the_references():
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=12, limits={"torque": (-0.8, 0.5), "piezo": (-0.3, 0.3)})
    low, high = np.array([-0.8, -0.3]), np.array([0.5, 0.3])
    bound = 0
    for x in STATES:
        u = controller.act(0.0, x)
        assert (low <= u).all() and (u <= high).all()
        bound += (u == low).any() or (u == high).any()
        expected = reference(x, 12, low=low, high=high)
        np.testing.assert_allclose(plan(controller), expected, atol=2e-6)
        np.testing.assert_allclose(u, expected[0], atol=2e-6)
    assert bound > 20 and controller.record.limited >= bound and not controller.record.failures


def test_rate_limits():
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=10, limits=(-1.0, 1.0), rates=4.0)
    xs, us = roll(controller, [0.6, 0.0, 0.0, 0.0], 400)
    steps = np.diff(np.vstack([np.zeros(2), us]), axis=0)
    assert np.abs(steps).max() <= 4.0 * DT + 1e-15 and np.abs(steps).max() > 4.0 * DT - 1e-9
    assert np.abs(xs[-1]).max() < 1e-3
    controller.reset()
    for x, u in zip(xs[:15], us):
        before = controller._knowledge.last.copy()
        np.testing.assert_allclose(controller.act(0.0, x), u, atol=1e-8)
        expected = reference(x, 10, low=-1.0, high=1.0, change=0.2, last=before)
        np.testing.assert_allclose(plan(controller), expected, atol=2e-6)


def test_soft_bounds_are_as_good_as_hard_ones_where_those_can_be_kept():
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=12, limits=(-3.0, 3.0), bounds={"bend": (-0.012, 0.012)})
    kept = beyond = 0
    for x in STATES * [1.0, 0.3, 0.5, 0.6]:
        controller.reset()
        u = controller.act(0.0, x)
        np.testing.assert_allclose(u, plan(controller)[0], atol=1e-9)
        hard = reference(x, 12, low=-3.0, high=3.0, bound=0.012)
        if hard is None:
            beyond += 1
            assert controller.record.violations == 1 and controller.record.worst[0] > 0
            price = controller._steps[0].solver.penalty
            soft = reference(x, 12, low=-3.0, high=3.0, bound=0.012, soft=price)
            np.testing.assert_allclose(plan(controller), soft, atol=1e-4)
        elif controller.record.limited:
            kept += 1
            assert controller.record.violations == 0
            np.testing.assert_allclose(plan(controller), hard, atol=5e-6)
    assert kept >= 10 and beyond >= 5


def test_a_low_penalty_is_not_exact():
    """The naive price, of the order of the other weights, exceeds bounds that could be kept."""
    x = [0.6, 0.0, 0.0, 0.0]
    options = {"dt": DT, "horizon": 12, "limits": (-3.0, 3.0), "bounds": {"bend": (-0.004, 0.004)}}
    cheap, dear = MPC.design(LINK, Q, R, penalty=1e-2, **options), MPC.design(LINK, Q, R, **options)
    cheap.act(0.0, np.array(x)), dear.act(0.0, np.array(x))
    assert reference(x, 12, low=-3.0, high=3.0, bound=0.004) is not None
    assert cheap.record.violations == 1 and dear.record.violations == 0 and dear.record.limited == 1


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


def test_steps_past_the_horizon_see_a_limit_that_a_short_one_does_not():
    options = {"dt": DT, "horizon": 2, "limits": (-3.0, 3.0), "bounds": {"theta": (-0.6, 0.05)}}
    x = [-0.5, 0.0, 1.0, 0.0]
    worst = [roll(MPC.design(LINK, Q, R, terminal=n, **options), x, 80)[0][:, 0].max() for n in (0, 25)]
    assert worst[0] > 0.05 + 1e-3 and worst[1] < 0.05 + 1e-6


def lq_plan(As, Bs, cs, Q, R, P, x):
    """Inputs (n, nu) of the affine time-varying problem, by one dense least-squares solve."""
    n, nx, nu = len(As), len(x), Bs.shape[2]
    rows, rest = [], []
    L, r, p = np.linalg.cholesky(Q).T, np.linalg.cholesky(R).T, np.linalg.cholesky(P).T
    G, g = np.zeros((nx, n * nu)), np.array(x, dtype=float)
    for j in range(n):
        one = np.zeros((nu, n * nu))
        one[:, j * nu : (j + 1) * nu] = np.eye(nu)
        rows += [L @ G, r @ one]
        rest += [L @ g, np.zeros(nu)]
        G, g = As[j] @ G + Bs[j] @ one, As[j] @ g + cs[j]
    rows.append(p @ G)
    rest.append(p @ g)
    return np.linalg.lstsq(np.vstack(rows), -np.concatenate(rest), rcond=None)[0].reshape(n, nu)


def swinging(nodes=61):
    """An LTV model whose stiffness changes along the way, about a nominal that is no motion of it, ending at rest."""
    t = DT * np.arange(nodes)
    s = np.minimum(t / 2.0, 1.0)
    As = np.array([A + np.array([[0] * 4, [0] * 4, [-k, 0, 0, 0], [0.5 * k, 0, 0, 0]]) for k in 3 * np.sin(np.pi * s)])
    c = np.outer(np.sin(np.pi * s) ** 2, [0.0, 0.0, 0.3, -0.2])
    x = np.outer(s - 1, [0.4, 0, 0, 0])
    zeros = np.zeros((nodes, 4, 0)), np.zeros((nodes, 2, 0))
    own = {k: getattr(LINK, k) for k in ("states", "inputs", "disturbances", "outputs")}
    repeat = [np.broadcast_to(M, (nodes, *M.shape)) for M in (B, C, np.zeros((2, 2)))]
    return LTVModel(
        t,
        As,
        repeat[0],
        zeros[0],
        repeat[1],
        repeat[2],
        zeros[1],
        c,
        x,
        np.outer(np.cos(t), [0.3, 0.1]),
        x @ C.T,
        **own,
    )


def test_along_a_nominal_without_limits_it_is_the_time_varying_regulator():
    ltv, N = swinging(), 30
    weight, effort = np.diag([40.0, 5.0, 1.0, 1.0]), np.diag([0.02, 0.05])
    controller = MPC.along(ltv, weight, effort, horizon=10)
    last = ltv.at(-1).discretize(DT)
    P = riccati.dlqr(last.A, last.B, DT * weight, DT * effort).P
    As, Bs, cs = ltv.transition()
    for k in (0, 17, 59):
        # the rest of the nominal, then N more steps at its end: what the controller's terminal weight stands for
        ends = (np.repeat(M[None], N, axis=0) for M in (last.A, last.B, np.zeros(4)))
        parts = [np.concatenate([own[k:], end]) for own, end in zip((As, Bs, cs), ends)]
        xi = STATES[k % 7]
        expected = lq_plan(*parts, DT * weight, DT * effort, P, xi)[0]
        np.testing.assert_allclose(controller.act(k * DT, ltv.x[k] + xi) - ltv.u[k], expected, atol=1e-8)


def test_along_a_nominal_limits_hold_and_warm_starts_do_not_matter():
    ltv = swinging()
    weight, effort = np.diag([40.0, 5.0, 1.0, 1.0]), np.diag([0.02, 0.05])
    options = {"horizon": 10, "limits": (-1.0, 1.0), "bounds": {"bend": (-0.004, 0.004)}}
    warm, cold = MPC.along(ltv, weight, effort, **options), MPC.along(ltv, weight, effort, **options)
    As, Bs, cs = ltv.transition()
    xi = np.array([-0.4, 0.0, 0.0, 0.0])
    for k in range(60):
        cold.reset()
        u = warm.act(k * DT, ltv.x[k] + xi)
        np.testing.assert_allclose(cold.act(k * DT, ltv.x[k] + xi), u, atol=1e-7)
        assert np.abs(u).max() <= 1.0
        xi = As[k] @ xi + Bs[k] @ (u - ltv.u[k]) + cs[k]
    assert warm.record.limited > 20 and not warm.record.failures
    assert np.abs(xi).max() < 0.02


@pytest.mark.parametrize(
    ("kind", "reads", "read"),
    [("states", None, np.eye(4)), ("inputs", ("theta", "bend"), np.eye(4)[:2]), ("inputs", ("tip", "theta"), None)],
)
def test_a_constant_unknown_force_leaves_no_steady_error(kind, reads, read):
    read = np.vstack([C[0], np.eye(4)[0]]) if read is None else read
    force = np.array([0.4, -0.2])
    options = {"dt": DT, "limits": (-1.5, 1.5)}
    plain = MPC.design(LINK, Q, R, **options)
    assert abs(C[0] @ roll(plain, np.zeros(4), 200, disturbance=force)[0][-1]) > 5e-3
    free = MPC.design(LINK, Q, R, **options, track=("tip", "bend"), disturbance=kind, reads=reads)
    free.aim({"tip": 0.3, "bend": 0.001})
    xs, us = roll(free, np.zeros(4), 800, disturbance=force, read=read)
    np.testing.assert_allclose(C @ xs[-1], [0.3, 0.001], atol=1e-8)
    assert free.record.limited and np.abs(us).max() <= 1.5


def test_output_disturbances_on_a_plant_whose_modes_decay():
    held = LinearModel.from_matrices(
        A - np.outer([0, 0, 1, -0.6], [9.0, 0, 1, 0]),
        B,
        C,
        states=LINK.states,
        inputs=LINK.inputs,
        outputs=LINK.outputs,
    )
    free = MPC.design(held, Q, R, dt=DT, track=("tip", "bend"), disturbance="outputs", reads=("tip", "bend"))
    free.aim({"tip": 0.1})
    xs, _ = roll(free, np.zeros(4), 600, disturbance=np.array([0.3, 0.1]), model=held, read=C)
    np.testing.assert_allclose(C @ xs[-1], [0.1, 0.0], atol=1e-6)
    free = MPC.design(
        held,
        Q,
        R,
        dt=DT,
        track=("tip", "bend"),
        disturbance="outputs",
        reads=("tip", "bend"),
        bounds={"tip": (-1, 0.08)},
    )
    free.aim({"tip": 0.1})
    xs, _ = roll(free, np.zeros(4), 600, disturbance=np.array([0.3, 0.1]), model=held, read=C)
    assert 0.079 < C[0] @ xs[-1] < 0.08 + 1e-6  # the bound is one on the tip as it is measured
    with pytest.raises(ValueError, match="do not tell such a disturbance from a state"):
        MPC.design(LINK, Q, R, dt=DT, track=("tip",), disturbance="outputs", reads=("tip", "bend"))


def test_a_target_past_the_limits_is_met_as_nearly_as_they_allow():
    """The piezo alone bends the link at rest: half the wanted bend is what its limit of 1 allows."""
    most = -np.linalg.solve(K2[1:, 1:], [[-0.5]])[0, 0]
    free = MPC.design(LINK, Q, R, dt=DT, limits=(-1.0, 1.0), track=("theta", "bend"))
    free.aim({"theta": 0.0, "bend": 2 * most})
    xs, _ = roll(free, np.zeros(4), 400)
    np.testing.assert_allclose(xs[-1][:2], [0.0, most], atol=1e-5)
    assert free.record.unreached == 400


def test_payload_error_on_the_nonlinear_arm_leaves_no_steady_error():
    """The design model carries 0.5 kg, the plant 0.6 kg: gravity has changed, and the links bend differently.

    The third controller reads the joint encoders alone.
    """
    scene = scenes.get("two-link-reach")
    x0, _ = scene.target
    heavier = scene.plant.vary("payload.mass").stepper(scene.dt, substeps=scene.substeps)
    finals, free = [], {"track": ("theta1", "theta2")}
    for options in ({}, free, free | {"disturbance": "inputs", "reads": ("theta1", "theta2")}):
        controller = MPC.for_scene(scene, **options)
        x, picks = x0.copy(), scene.positions(controller.reads)
        for k in range(600):
            u = controller.act(k * scene.dt, x[picks])
            x = heavier(x[None], u[None], np.array([[0.6]]))[0].copy()
        finals.append(np.abs(x[:2] - x0[:2]).max())
    assert finals[0] > 1e-3 and max(finals[1:]) < 1e-7


def test_a_failed_solve_goes_on_with_the_plan_and_says_so(monkeypatch):
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=6, limits=(-0.5, 0.5))
    x = np.array([0.6, 0.0, 0.3, 0.0])
    controller.act(0.0, x)
    planned = plan(controller)
    solver = controller._steps[0].solver
    monkeypatch.setattr(type(solver), "solve", lambda *_: None)
    for k in range(1, 6):
        np.testing.assert_array_equal(controller.act(k * DT, x), np.clip(planned[k], -0.5, 0.5))
        assert controller.record.failures == k
    Ad, Bd, Qd, Rd, Nd, _ = sampled_problem()
    lqr = -riccati.dlqr(Ad, Bd, Qd, Rd, Nd).K @ x
    np.testing.assert_allclose(controller.act(0.3, x), np.clip(lqr, -0.5, 0.5), atol=1e-9)  # the plan has ended
    controller.reset()
    assert controller.record.failures == controller.record.calls == 0


def test_after_reset_it_acts_bit_for_bit_as_a_new_one():
    options = {"limits": (-0.7, 0.7), "rates": 5.0, "bounds": {"bend": (-0.004, 0.004)}}
    controller = MPC.design(LINK, Q, R, dt=DT, **options)
    for x, former in zip(STATES[::4], STATES[::-4]):
        controller.act(0.0, former)
        controller.reset()
        np.testing.assert_array_equal(controller.act(0.0, x), MPC.design(LINK, Q, R, dt=DT, **options).act(0.0, x))


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
    )


POINT, HELD = np.array([0.7, 0.0, 0.0, 0.0]), np.array([0.3, -0.2])


def moved(model):
    """The same machine about another point, where inputs hold it."""
    return dataclasses.replace(model, x0=POINT, u0=HELD, y0=C @ POINT)


def test_rate_limits_about_a_point_that_is_not_zero():
    """Deviations from the point do as they do about zero: the first change is counted from the input that holds."""
    options = {"dt": DT, "horizon": 10, "rates": 4.0}
    here = MPC.design(LINK, Q, R, limits=(-1.0, 1.0), **options)
    there = MPC.design(moved(LINK), Q, R, limits=(HELD - 1.0, HELD + 1.0), **options)
    x, sampled = np.array([0.6, 0.0, 0.0, 0.0]), LINK.discretize(DT)
    for k in range(30):
        u = here.act(k * DT, x)
        np.testing.assert_allclose(there.act(k * DT, POINT + x), HELD + u, atol=1e-9)
        x = sampled.A @ x + sampled.B @ u
    here.reset(), there.reset()
    far = np.array([-0.6, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(there.act(0.0, POINT + far), HELD + here.act(0.0, far), atol=1e-9)
    tight = MPC.design(moved(LINK), Q, R, limits=(0.5, 1.0), **options)  # u0 is below: 0.5 counts as the last input
    assert tight.act(0.0, POINT + far) == pytest.approx([0.7, 0.7], abs=1e-9)


def test_aim_is_a_value_of_the_signal_also_about_a_point_that_is_not_zero():
    options = {"dt": DT, "horizon": 10, "track": ("tip",)}
    there = MPC.design(moved(LINK), Q, R, limits=(HELD - 3.0, HELD + 3.0), **options)
    assert there.tracked == {"tip": pytest.approx(0.7)}
    there.aim({"tip": 1.1})
    sampled, x = LINK.discretize(DT), np.zeros(4)
    for k in range(600):
        x = sampled.A @ x + sampled.B @ (there.act(k * DT, POINT + x) - HELD)
    assert C[0] @ (POINT + x) == pytest.approx(1.1, abs=1e-6)


@pytest.mark.parametrize("one", [(-0.004, 0.05), (-0.004, np.inf)])
def test_lower_ends_hold_as_upper_ones_do(one):
    """The model is linear: what is limited from below acts as the mirror image of what is limited from above."""
    options = {"dt": DT, "horizon": 12, "limits": (-3.0, 3.0)}
    below = MPC.design(LINK, Q, R, bounds={"bend": one}, **options)
    above = MPC.design(LINK, Q, R, bounds={"bend": (-one[1], -one[0])}, **options)
    free, changed = MPC.design(LINK, Q, R, **options), 0
    for x in STATES * [1.0, 0.05, 0.5, 0.1]:
        for law in (below, above, free):
            law.reset()
        u = below.act(0.0, x)
        np.testing.assert_allclose(above.act(0.0, -x), -u, atol=1e-8)
        changed += np.abs(u - free.act(0.0, x)).max() > 1e-3
    assert changed > 5


def test_bounds_and_limits_of_a_scene_are_on_both_sides():
    scene = scenes.get("single-link-slew")
    found = MPC.for_scene(scene).limits
    bounds = dict(scene.bounds)
    assert dict(zip(found.bounded, found.floor)) == {name: -value for name, value in bounds.items()}
    assert dict(zip(found.bounded, found.ceiling)) == bounds
    np.testing.assert_array_equal(found.low, [-value for value in scene.limits])
    np.testing.assert_array_equal(found.high, scene.limits)


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


def test_an_input_price_that_is_no_price_is_refused_at_the_end_of_the_way_too():
    ltv = swinging()
    with pytest.raises(ValueError, match=r"MPC\.R"):
        MPC.along(ltv, np.eye(4), np.zeros((2, 2)), horizon=10, P=np.eye(4))


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
