"""What controllers do with readings, times and options that nobody should give: a clear error, never a made-up input.

Every controller of the single arm's slew is driven with the same bad readings; copies in threads act as they do alone.
"""

import copy
import dataclasses
import pickle
import threading

import control
import numpy as np
import pytest

from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    NMPC,
    PD,
    TVLQR,
    ComputedTorque,
    Feedback,
    Kalman,
    Sensor,
    loop,
    margins,
    optimal,
    plan,
)
from pliant.controllers.base.joint_reference import Follow, RestToRest
from pliant.controllers.base.objective import Objective
from pliant.controllers.joint_control.input_shaping import shaper_for
from pliant.envs import scenes
from pliant.plants import LargeDeflectionBeam, LinearModel, Trajectory
from pliant.plants.core.errors import EquilibriumError, PliantError

SLEW = scenes.get("single-link-slew")
MODEL = SLEW.plant.linearize(*SLEW.target)
Q, R = {"hub_angle": 10.0}, {"hub_torque": 0.01}
ALL = [LQR, TVLQR, MPC, NMPC, LQG, PD, ComputedTorque]
HIGH = SLEW.limits[0]


@pytest.fixture(scope="module", params=ALL, ids=lambda c: c.__name__)
def law(request):
    return request.param.for_scene(SLEW)


@pytest.mark.filterwarnings("ignore:overflow encountered in dot")
def test_readings_are_acted_on_within_the_limits_or_refused(law):
    n, signs = len(law.reads), (-1.0) ** np.arange(len(law.reads))
    law.reset()
    for size in (0.0, 1.0, 1e6, 1e20, 1e140):
        u = law.act(0.0, size * signs)
        assert u.shape == (1,) and np.abs(u).max() <= HIGH
    owner = type(law).__name__
    for bad, said in (
        (np.full(n, np.nan), r"y\[0\] = nan must be finite"),
        (np.full(n, np.inf), r"y\[0\] = inf must be finite"),
        (np.full(n, 1e200), r"y\[0\] = 1e\+200 must be at most 1e\+150 in size"),
        (np.zeros(n + 1), "y has shape"),
        (None, "y = None must be an array of real numbers"),
    ):
        with pytest.raises(ValueError, match=rf"{owner}\.{said}"):
            law.act(0.0, bad)
    law.reset()
    assert np.isfinite(law.act(0.0, list(np.zeros(n)))).all()  # a refused reading leaves nothing behind


@pytest.mark.parametrize("kind", [TVLQR, PD, ComputedTorque])
@pytest.mark.parametrize("t", [np.nan, np.inf])
def test_times_that_are_none_are_refused(kind, t):
    found = kind.for_scene(SLEW)
    with pytest.raises(ValueError, match=r"\.t = (nan|inf) must be a finite number"):
        found.act(t, np.zeros(len(found.reads)))


def test_copies_share_nothing(law):
    ys = 0.3 * np.random.default_rng(0).standard_normal((60, len(law.reads)))

    def acts(one):
        one.reset()
        return np.array([one.act(k * law.dt, y).copy() for k, y in enumerate(ys)])

    alone, found = acts(law), {}
    copies = [law, copy.copy(law), copy.deepcopy(law), pickle.loads(pickle.dumps(law))]
    threads = [
        threading.Thread(target=lambda i, c: found.update({i: acts(c)}), args=pair) for pair in enumerate(copies)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for i in range(len(copies)):
        np.testing.assert_array_equal(found[i], alone)


@pytest.mark.parametrize(
    "limits, said",
    [
        (5.0, r"limits = 5.0 must be a pair"),
        ((1, 2, 3), "must be a pair"),
        ("ab", "must be a pair"),
        ((5.0, -5.0), r"limits of hub_torque = \(5, -5\) must be lowest < highest"),
        ((5.0, 5.0), "must be lowest < highest"),
        ((np.nan, 5.0), "limits = nan must be numbers"),
        ((np.zeros(3), 5.0), r"limits has shape \(3,\), must be a number or \(1,\)"),
        ({"hub_torque": 5.0}, r"limits\['hub_torque'\] = 5.0 must be a pair"),
        ({"torque": (-1, 1)}, "'torque' must be one of hub_torque"),
    ],
)
@pytest.mark.parametrize("design", [LQR.design, MPC.design])
def test_wrong_limits_are_named(design, limits, said):
    with pytest.raises(ValueError, match=said):
        design(MODEL, Q, R, dt=0.02, limits=limits)


EYE = np.eye(6)


@pytest.mark.parametrize(
    "wrong, said",
    [
        ({"bounds": {"tip_deflection": 0.1}}, r"MPC.bounds\['tip_deflection'\] = 0.1 must be a pair"),
        ({"bounds": {"tip": (0, 1)}}, "MPC.bounds: state or output 'tip' must be one of"),
        ({"rates": [1, 2, 3]}, r"MPC.rates has shape \(3,\)"),
        ({"penalty": -1.0}, "MPC.penalty = -1.0 must be > 0"),
        ({"penalty": np.nan}, "MPC.penalty = nan must be > 0"),
        ({"P": -EYE}, "MPC.P has eigenvalue -1, must be >= 0"),
        ({"P": np.triu(np.ones((6, 6)))}, r"MPC.P\[0, 1\] = 1 must equal"),
        ({"Q": -EYE, "P": EYE}, r"MPC: \[\[Q, N\], \[N', R\]\] has eigenvalue"),
        ({"R": {"hub_torque": -1.0}}, r"MPC.R\['hub_torque'\] = -1 must be > 0"),
        ({"Q": {"hub_angle": np.nan}}, r"MPC.Q\['hub_angle'\] = nan must be >= 0"),
        ({"horizon": 0}, "MPC.horizon = 0"),
    ],
)
def test_wrong_options_of_mpc_are_named(wrong, said):
    with pytest.raises(ValueError, match=said):
        MPC.design(MODEL, **{"Q": Q, "R": R, "dt": 0.02, **wrong})


def test_mpc_aims_at_numbers():
    law = MPC.design(MODEL, Q, R, dt=0.02, track=("hub_angle",))
    with pytest.raises(ValueError, match=r"MPC.aim.*\['hub_angle'\] = nan must be a finite number"):
        law.aim({"hub_angle": np.nan})


def test_a_rate_limit_does_not_lead_out_of_the_limits():
    law = MPC.design(MODEL, Q, R, dt=0.02, limits=(1.0, 2.0), rates=1.0)  # u0 = 0 is outside
    acts = [law.act(0.02 * k, MODEL.x0 + 0.1 * np.eye(6)[0])[0] for k in range(5)]
    assert min(acts) >= 1.0 and np.abs(np.diff(acts)).max() <= 0.02 + 1e-12
    law.reset()
    far = [law.act(0.02 * k, MODEL.x0 - np.eye(6)[0])[0] for k in range(80)]
    assert far[0] == pytest.approx(1.02) and max(far) <= 2.0 and far[-1] == pytest.approx(2.0)


def test_integrals_do_not_run_backward():
    law = LQR.design(MODEL, Q, R, integral={"hub_angle": 1.0})
    y = MODEL.x0 + 0.1 * np.eye(6)[0]
    law.act(1.0, y)
    law.act(1.5, y)
    assert law.xi[0] == pytest.approx(0.05)
    for t in (1.2, np.nan):
        with pytest.raises(ValueError, match=r"LQR.t = .* must be (>= 1.5|a finite number)"):
            law.act(t, y)
    assert law.xi[0] == pytest.approx(0.05)
    law.reset()
    law.act(0.0, y)


def test_no_regulator_about_a_point_that_is_left():
    x, u = SLEW.target
    with pytest.raises(EquilibriumError, match=r"no equilibrium: .* changes by"):
        LQR.for_plant(SLEW.plant, x, u + 1.0, Q, R)


def test_nominals_may_begin_at_any_time():
    motion = SLEW.open_loop()
    later = Trajectory.from_arrays(motion.t + 5.0, motion.x, motion.u, plant=SLEW.plant)
    same = Trajectory.from_arrays(motion.t, motion.x, motion.u, plant=SLEW.plant)
    weights = np.eye(6), 0.01 * np.eye(1)
    for make in (
        lambda m: TVLQR.along(SLEW.plant, m, *weights, dt=SLEW.dt),
        lambda m: TVLQR.design(SLEW.plant.linearize_along(m), *weights),
        lambda m: MPC.along(SLEW.plant.linearize_along(m), *weights, horizon=5),
    ):
        now, then = make(same), make(later)
        for k in (0, 7, 30):
            x = motion.x[k] + 1e-3
            u = now.act(motion.t[k], x)
            np.testing.assert_allclose(then.act(later.t[k], x), u, rtol=1e-6, atol=1e-6)
            if k:
                assert np.abs(now.act(0.0, x) - u).max() > 1e-3
    law = TVLQR.along(SLEW.plant, later, *weights, dt=SLEW.dt, limits=(-60.0, 60.0))
    assert law.funnel.t[0] == 5.0 and law.funnel.use(later.t[9], law.x[9] + 1e-4) > 0
    with pytest.raises(ValueError, match=r"TVLQR.hold\[0\] has shape \(2, 2\), must be \(1, 6\)"):
        TVLQR.along(SLEW.plant, same, *weights, dt=SLEW.dt, hold=(np.eye(2), np.zeros(6), np.zeros(1)))
    with pytest.raises(ValueError, match=r"TVLQR\.dt = 0\.0 must be > 0"):
        TVLQR.along(SLEW.plant, same, *weights, dt=0.0)


def test_lqg_reads_its_law_by_name():
    """Swapped states are put in order; names that the model does not know stand for its states in their order."""
    A, B = np.array([[0.0, 1.0], [-4.0, -0.1]]), np.array([[0.0], [1.0]])
    model = LinearModel.from_matrices(A, B, np.eye(2), np.zeros((2, 1)), states=["a", "b"], inputs=["u"])
    swapped = model.state_names[::-1]
    turned = LinearModel.from_matrices(
        A[::-1, ::-1], B[::-1], np.eye(2), np.zeros((2, 1)), states=list(swapped), inputs=["u"]
    )
    filters = [Kalman.design(model, [Sensor("other", "a", "", noise=0.1)], {"u": 1.0}, dt=0.1) for _ in range(3)]
    weight = np.diag([3.0, 1.0])
    plain = LQG(LQR.design(model, weight, [[1.0]], dt=0.1), filters[0])
    other = LQG(LQR.design(turned, weight[::-1, ::-1], [[1.0]], dt=0.1), filters[1])
    named = LQG(LQR.design(model, weight, [[1.0]], dt=0.1, reads=("p", "q")), filters[2])
    for k, y in enumerate(([1.0], [0.7], [-0.2])):
        u = plain.act(0.1 * k, np.array(y))
        np.testing.assert_allclose(other.act(0.1 * k, np.array(y)), u, rtol=1e-9)
        np.testing.assert_allclose(named.act(0.1 * k, np.array(y)), u, rtol=1e-9)
        u += 100.0  # the caller's array is its own
    with pytest.raises(ValueError, match=r"Kalman.u has shape \(3,\)"):
        filters[0].step(np.zeros(1), np.zeros(3))
    k = filters[0].k
    with pytest.raises(ValueError, match=r"Kalman.u\[0\] = nan"):
        filters[0].step(np.zeros(1), np.array([np.nan]))
    assert filters[0].k == k and np.isfinite(filters[0].estimate).all()


def test_models_of_python_control_are_controlled():
    system = control.ss([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]])
    model = LinearModel.from_control(system)
    sampled = LinearModel.from_control(control.c2d(system, 0.1))
    law = LQR.design(model, np.eye(2), np.eye(1), dt=0.1, limits=(-1, 1))
    mpc = MPC.design(model, np.eye(2), np.eye(1), dt=0.1, limits=(-1, 1))
    for x in (np.array([0.1, 0.0]), np.array([5.0, 1.0])):
        np.testing.assert_allclose(mpc.act(0.0, x), law.act(0.0, x), atol=1e-9)
    K, _, _ = control.dlqr(sampled.to_control(), np.eye(2), np.eye(1))  # weights of a step, as MPC takes them there
    given = MPC.design(sampled, np.eye(2), np.eye(1))
    np.testing.assert_allclose(given.act(0.0, np.array([0.3, -0.2])), -K @ [0.3, -0.2], atol=1e-9)


def test_margins_of_a_loop_that_integrates_twice_and_a_filter_know_no_least_gain_but_zero():
    """A double integrator under LQG: S is zero at rest, which rounding must not turn into a gain margin of 1e-16."""
    model = LinearModel.from_control(control.ss([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]]))
    law = LQG.design(model, np.eye(2), np.eye(1), [Sensor("other", "y[0]", "", noise=0.1)], {"u[0]": 1.0}, dt=0.1)
    assert margins(loop(model, law)).channels[0].gain[0] == 0.0


def test_forces_at_a_tip_are_no_joints():
    beam = dataclasses.replace(LargeDeflectionBeam.textbook(), planar=False)
    with pytest.raises(PliantError, match="no joint for each input"):
        ComputedTorque.design(beam, RestToRest(np.zeros(3), np.ones(3), 1.0), bandwidth=1.0)


@pytest.mark.parametrize("kind", [TVLQR, MPC, NMPC])
def test_laws_without_one_gain_have_no_linear_loop(kind):
    with pytest.raises(PliantError, match=f"{kind.__name__}: this controller has no linear form"):
        loop(MODEL, kind.for_scene(SLEW))


@pytest.mark.parametrize(
    "make, said",
    [
        (lambda: Follow(0.0, *np.zeros((3, 2, 1))), "Follow.dt = 0.0 must be > 0"),
        (lambda: Follow(0.1, np.zeros((3, 1)), np.zeros((2, 1)), np.zeros((3, 1))), "Follow.rates has shape"),
        (lambda: Follow(0.1, *np.zeros((3, 0, 1))), "Follow.positions are empty"),
        (lambda: shaper_for(3.0), "shaper_for.modes = 3.0 must be a linear model"),
        (lambda: shaper_for([3.0], most=-1), "shaper_for.most = -1"),
        (lambda: Feedback(np.eye(1), ("a",), limits=3), "Feedback.limits = 3 must be a pair"),
        (lambda: plan(SLEW, bounds={"tip_deflection": -1.0}), r"plan.bounds\['tip_deflection'\]"),
        (lambda: TVLQR.for_scene(SLEW, reserve=1.5, nominal="optimal"), "reserve = 1.5 must be >= 0 and < 1"),
        (lambda: TVLQR.for_scene(SLEW, effort=-1.0), "effort = -1.0 must be > 0"),
    ],
)
def test_other_wrong_options_are_named(make, said):
    with pytest.raises(ValueError, match=said):
        make()


@pytest.mark.parametrize(
    "wrong, said",
    [
        ({"tolerance": -1.0}, "optimal.tolerance = -1.0 must be > 0"),
        ({"iterations": 0}, "optimal.iterations = 0"),
        ({"at": {5: {"hub_angle": np.nan}}}, r"optimal.at\[5\]\['hub_angle'\] = nan must be a finite number"),
        ({"terminal": -EYE}, "optimal.terminal has eigenvalue -1"),
    ],
)
def test_wrong_options_of_optimal_are_named(wrong, said):
    with pytest.raises(ValueError, match=said):
        optimal(Objective.of(SLEW), SLEW.initial[0], 10, **wrong)
