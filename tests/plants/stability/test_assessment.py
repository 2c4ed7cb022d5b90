"""Growth, certificates, slow variation and verdicts against closed forms and independent integration; their cost."""

import dataclasses
import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from pliant.plants import LTVModel, SingleLinkArm, TwoLinkArm
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.magnus import expm as stacked_expm
from pliant.plants.linear.magnus import product, steps
from pliant.plants.stability import METHODS, assess, floquet, frozen_time, growth, lyapunov, slow_variation
from pliant.plants.stability.floquet import periodic_path
from pliant.plants.stability.lyapunov_certificate import _verified
from pliant.plants.stability.periodicity import varying, why_not
from pliant.plants.stability.transition_growth import chain


def model_of(t, A):
    nt, n = len(t), A.shape[-1]
    none = np.zeros((nt, n, 0))
    rows = {k: np.zeros((nt, n if k in "cx" else 0)) for k in ("c", "x", "u", "y")}
    gone = {"C": np.zeros((nt, 0, n)), "D": np.zeros((nt, 0, 0)), "F": np.zeros((nt, 0, 0))}
    names = tuple(f"x{i + 1}" for i in range(n))
    return LTVModel(t, A, none, none, **gone, **rows, states=names, inputs=(), disturbances=(), outputs=())


def random_path(n=4, seed=2, duration=3.0, shift=1.0):
    """A smooth A(t) without a period, and its nodes."""
    M0, M1, M2 = np.random.default_rng(seed).standard_normal((3, n, n))

    def A(t):
        return M0 - shift * np.eye(n) + np.sin(t + 0.2 * t**2) * M1 + np.exp(-t) * M2

    t = np.linspace(0.0, duration, 601)
    return A, model_of(t, np.array([A(s) for s in t]))


def integrated(A, span, n):
    run = solve_ivp(
        lambda t, y: (A(t) @ y.reshape(n, n)).ravel(), span, np.eye(n).ravel(), method="DOP853", rtol=1e-12, atol=1e-13
    )
    return run.y[:, -1].reshape(n, n)


def linear(A, dt=None):
    A = np.asarray(A, dtype=float)
    return LinearModel.from_matrices(A, np.zeros((len(A), 0)), dt=dt)


def test_stacked_exponential_is_scipys():
    rng = np.random.default_rng(0)
    A = rng.standard_normal((7, 6, 6)) * np.logspace(-6, 1.5, 7)[:, None, None]
    for mine, its in zip(stacked_expm(A), expm(A)):
        np.testing.assert_allclose(mine, its, rtol=0, atol=1e-12 * np.abs(its).max())


def test_magnus_steps_are_of_order_six():
    rng = np.random.default_rng(1)
    M0, M1 = rng.standard_normal((2, 3, 3))

    def error(m):
        edges = np.linspace(0.0, 2.0, m + 1)
        gauss = edges[:-1, None] + np.diff(edges)[:, None] * (0.5 + np.sqrt(0.15) * np.array([-1, 0, 1]))
        A = M0 + np.cos(2 * gauss)[..., None, None] * M1
        return np.abs(product(steps(A, np.diff(edges))) - wanted).max()

    wanted = integrated(lambda t: M0 + np.cos(2 * t) * M1, (0.0, 2.0), 3)
    assert 5.5 < np.log2(error(16) / error(32)) < 7.5


# --- growth -------------------------------------------------------------------------------------------------------


def test_growth_is_the_singular_value_of_the_true_transition_matrix():
    A, model = random_path()
    found = growth(model, 0.6, scale=np.ones(4))
    Phi = integrated(A, (0.0, 3.0), 4)
    assert found.total == pytest.approx(np.linalg.norm(Phi, 2), rel=1e-8)
    assert found.curve[0] == 1.0 and found.window == pytest.approx(0.6)
    np.testing.assert_allclose(np.linalg.norm(Phi @ found.direction), found.total, rtol=1e-7)
    for k in (0, 200, len(found.windows) - 1):
        begin = found.window_start[k]
        assert found.windows[k] == pytest.approx(np.linalg.norm(integrated(A, (begin, begin + 0.6), 4), 2), rel=1e-7)
    assert found.exponents.sum() * 3.0 == pytest.approx(np.log(np.linalg.det(Phi)), abs=1e-7)


def test_exponents_of_a_diagonal_and_of_a_turning_model():
    t = np.linspace(0.0, 40.0, 2001)
    A = np.zeros((2001, 3, 3))
    A[:, [0, 1, 2], [0, 1, 2]] = np.stack([-0.3 + np.cos(t), 0.1 + np.sin(2 * t), -1.0 + 0 * t], axis=1)
    found = growth(model_of(t, A), scale=np.ones(3))
    exact = np.array([-0.3 + np.sin(40.0) / 40, 0.1 + np.sin(40.0) ** 2 / 40, -1.0])
    np.testing.assert_allclose(found.exponents, np.sort(exact)[::-1], atol=1e-9)
    rate = np.exp(0.1 * t + np.sin(t) ** 2)
    other = np.exp(-0.3 * t + np.sin(t))
    np.testing.assert_allclose(found.curve, np.maximum(rate, np.maximum(other, np.exp(-t))), rtol=1e-8)


def test_fewer_points_give_the_same_total_and_long_times_the_floquet_exponent():
    t = np.linspace(0.0, 60 * np.pi, 6001)
    A = np.zeros((6001, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -(1.0 - 0.6 * np.cos(2 * t)), -0.1
    model = model_of(t, A)
    every, few = growth(model), growth(model, points=50)
    assert few.total == pytest.approx(every.total, rel=1e-9) and len(few.t) < 60
    cycle = floquet(model, np.pi)
    assert every.exponents[0] == pytest.approx(cycle.growth, abs=0.02 * abs(cycle.growth) + 0.01)


@pytest.mark.parametrize("window", [0.01, 0.31, 1.0, 1.6, 2.9, 3.0])
def test_windows_of_any_length_are_products_of_their_steps(window):
    model = random_path()[1]
    found = growth(model, window)
    t, Phi, _ = chain(model)
    count = round(found.window / 3.0 * len(Phi))
    assert len(found.windows) == len(Phi) - count + 1
    for k in sorted({0, len(found.windows) // 3, len(found.windows) // 2, len(found.windows) - 1}):
        assert found.windows[k] == pytest.approx(np.linalg.norm(product(Phi[k : k + count]), 2), rel=1e-9)
        assert found.window_start[k] == t[k]


def test_windows_beyond_the_range_of_numbers():
    """Each grows by e^900; ten of them fit into a nominal, whose growth is kept as a logarithm."""
    t = np.linspace(0.0, 10.0, 1001)
    A = np.tile(np.diag([900.0, -1.0]), (1001, 1, 1))
    A[:, 0, 0] += 1e-3 * np.sin(t)
    found = growth(model_of(t, A), 0.5)
    assert found.logs[-1] == pytest.approx(9000.0 + 1e-3 * (1 - np.cos(10.0)), rel=1e-9)
    assert found.windows[0] == pytest.approx(np.exp(450.0 + 1e-3 * (1 - np.cos(0.5))), rel=1e-6)


def test_a_slow_period_of_a_fast_model():
    """An orbit's period and modes of some rad/s: 8,000 turns. Exponents and growth in closed form."""
    omega, period = np.array([0.01, 0.2, 5.0]), 2000.0
    t = np.linspace(0.0, period, 401)
    A = np.zeros((401, 6, 6))
    A[:, :3, 3:], A[:, 3:, :3] = np.eye(3), -np.diag(omega**2)
    damping = 0.005 * (1 + 0.5 * np.cos(2 * np.pi * t / period))
    A[:, 3:, 3:] = -damping[:, None, None] * 2 * np.diag(omega)
    found = assess(model_of(t, A), period=period)
    assert (found.verdict, found.method) == ("stable", "floquet")
    assert found.margin == pytest.approx(0.005 * 0.01, rel=1e-3)  # the mean of its damping
    assert found.evidence["floquet"].steps > 4096 > len(found.evidence["growth"].windows)
    shape = found.evidence["floquet"].mode(0)
    np.testing.assert_allclose(shape[-1], shape[0], atol=1e-6 * np.abs(shape).max())


def test_slow_coefficients_beside_fast_modes_are_seen_to_vary():
    """A mode at 1e4 rad/s does not hide that the slow one, at 1e-3 rad/s, is pumped: Mathieu's first tongue."""
    t = np.linspace(0.0, np.pi / 1e-3, 129)
    A = np.zeros((129, 4, 4))
    A[:, :2, 2:], A[:, 3, 1], A[:, 3, 3] = np.eye(2), -1e8, -100.0
    A[:, 2, 0] = -1e-6 * (1 + 0.4 * np.cos(2e-3 * t))
    moving, _ = varying(model_of(t, A))
    assert moving.shape == (129, 1)
    with pytest.raises(
        ValueError, match=r"floquet: a period of 3141\.59 s and modes of up to 1e\+04 1/s need 16,777,216"
    ):
        floquet(model_of(t, A), np.pi / 1e-3)
    whole = assess(model_of(t, A))
    assert whole.verdict == "undecided" and "leave out the fastest modes" in whole.reasons["growth"]
    assert json.loads(json.dumps(whole.to_json(), allow_nan=False))["margin"] is None
    slow = model_of(t, A[:, ::2, ::2])
    assert assess(slow).verdict == "unstable"
    assert not why_not(model_of(t, A), np.pi / 1e-3) and why_not(model_of(t, A), 2.0 / 1e-3)


def test_critical_times_of_growth_and_of_the_frozen_roots():
    t = np.linspace(0.0, 10.0, 501)
    A = np.zeros((501, 1, 1))
    A[:, 0, 0] = np.cos(t)
    model = model_of(t, A)
    np.testing.assert_allclose(frozen_time(model).critical_times, np.pi * np.array([0.5, 1.5, 2.5]), atol=1e-6)
    found = growth(model, 1.0)  # sin(s + 1) - sin(s) changes sign half a window before cos does
    np.testing.assert_allclose(found.critical_times, np.pi * np.array([0.5, 1.5, 2.5]) - 0.5, atol=1e-3)


# --- certificates -------------------------------------------------------------------------------------------------


def pulsating(damping=0.15, nodes=129):
    t = np.linspace(0.0, np.pi, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -(2.0 - 0.5 * np.cos(2 * t)), -2 * damping
    return model_of(t, A)


def falls(certificate, A, x0, start, stop):
    """Largest V(t) e^(2 alpha t) / V(0) along a true motion; 1 at most where the certificate holds."""
    c = certificate
    keep = (c.t >= start) & (c.t <= stop)
    run = solve_ivp(lambda t, x: A(t) @ x, (0.0, stop), x0, t_eval=c.t[keep], rtol=1e-11, atol=1e-13, method="DOP853")
    V = np.einsum("it,tij,jt->t", run.y, c.P[keep], run.y)
    return (V * np.exp(2 * c.alpha * c.t[keep]) / V[0]).max()


def test_periodic_certificate_holds_along_true_motions():
    model = pulsating()
    found = lyapunov(model)
    assert found.verified and found.periodic and found.slack > 0.5
    assert found.alpha == pytest.approx(-0.9 * floquet(model).growth, rel=1e-6)
    np.testing.assert_allclose(found.P[0], found.P[-1], rtol=1e-6)

    def A(t):
        return np.array([[0.0, 1.0], [-(2.0 - 0.5 * np.cos(2 * t)), -0.3]])

    for angle in np.linspace(0, np.pi, 7):
        assert falls(found, A, [np.cos(angle), np.sin(angle)], 0.0, np.pi) <= 1 + 1e-6


def test_a_certificate_that_does_not_close_is_none():
    """P of one period, a little larger throughout the more it is from its end: it falls, and jumps up at each end."""
    found = lyapunov(pulsating())
    path, _, _ = periodic_path(pulsating(), None, None)
    size = found.scale
    P = found.P * size * size[:, None]
    assert _verified(path, found.t, P, 0.8 * found.alpha, True).verified
    leaning = P * np.linspace(1.02, 1.0, len(found.t))[:, None, None]
    assert _verified(path, found.t, leaning, 0.8 * found.alpha, False).verified
    assert not _verified(path, found.t, leaning, 0.8 * found.alpha, True).verified


def test_certificate_of_a_nominal_without_period():
    A, model = random_path(shift=4.0)
    found = lyapunov(model)
    assert found.verified and not found.periodic
    for x0 in np.eye(4):
        assert falls(found, A, x0, 0.0, 3.0) <= 1 + 1e-6
    Phi = integrated(A, (0.0, 3.0), 4)
    scaled = Phi * found.scale / found.scale[:, None]
    assert np.linalg.norm(scaled, 2) <= found.contraction < 1


def test_no_certificate_beyond_the_decay_rate_and_too_few_steps_say_so():
    model = pulsating()
    too_fast = lyapunov(model, 0.2)  # the mean damping is 0.15
    assert not too_fast and "alpha must be below it" in too_fast.why
    assert not lyapunov(pulsating(damping=-0.05))
    short = lyapunov(model, most=20)
    assert not short and "more than 20 steps" in short.why
    with pytest.raises(ValueError, match=r"lyapunov.alpha = nan must be finite"):
        lyapunov(model, np.nan)


def test_certificate_of_a_constant_model():
    found = lyapunov(linear([[0.0, 1.0], [-4.0, -0.4]]))
    assert found and found.alpha == pytest.approx(0.18)
    shifted = np.array([[0.0, 1.0], [-4.0, -0.4]]) + 0.18 * np.eye(2)
    assert np.linalg.eigvalsh(shifted.T @ found.P[0] + found.P[0] @ shifted).max() < 0
    assert not lyapunov(linear([[0.0, 1.0], [-4.0, 0.0]]))


# --- slow variation -----------------------------------------------------------------------------------------------


def test_slow_variation_gives_a_rate_that_the_truth_keeps_and_scales_with_the_speed():
    def A(t, speed):
        k, d = 4.0 + np.sin(speed * t), 0.6 + 0.2 * np.cos(speed * t)
        return np.array([[0.0, 1.0], [-k, -d]])

    used = []
    for speed in (0.02, 0.04, 0.9):
        t = np.linspace(0.0, 1.5 / speed, 301)
        model = model_of(t, np.array([A(s, speed) for s in t]))
        slow = slow_variation(model)
        used.append(slow.used)
        if slow:
            duration = t[-1]
            true = -np.log(np.linalg.norm(integrated(lambda s, v=speed: A(s, v), (0.0, duration), 2), 2)) / duration
            assert 0 < slow.decay < true + np.log(10) / duration
    assert used[1] == pytest.approx(2 * used[0], rel=1e-2)  # P' is proportional to the speed
    assert used[0] < 1 < used[2] * 4


def test_slow_variation_in_closed_form():
    """x' = a(t) x: P = -1/(2a), P' = a'/(2 a^2)."""
    t = np.linspace(0.0, 2.0, 401)
    model = model_of(t, (-1.0 - 0.5 * np.sin(t))[:, None, None])
    slow = slow_variation(model)
    a, da = -1.0 - 0.5 * np.sin(t), -0.5 * np.cos(t)
    assert slow.used == pytest.approx(max(0.0, (da / (2 * a**2)).max()), abs=1e-6)
    assert slow.bound == pytest.approx(2 * (a**2).min(), rel=1e-6)
    assert slow and slow.inside == 1 - slow.used


# --- verdicts -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("A", "dt", "verdict", "margin"),
    [
        ([[0, 1], [-4, -0.4]], None, "stable", 0.2),
        ([[0, 1], [-4, 0.4]], None, "unstable", -0.2),
        ([[0, 1], [-4, 0]], None, "marginal", 0.0),
        ([[0, 1], [0, 0]], None, "marginal", 0.0),
        ([[0.5, 0], [0, -0.9]], 0.1, "stable", -np.log(0.9) / 0.1),
        ([[1.1, 0], [0, 0.2]], 0.1, "unstable", -np.log(1.1) / 0.1),
    ],
)
def test_constant_models(A, dt, verdict, margin):
    found = assess(linear(A, dt))
    assert (found.verdict, found.method) == (verdict, "eigenvalues")
    assert found.margin == pytest.approx(margin, abs=1e-12)
    assert set(found.reasons) == set(METHODS) - {"eigenvalues"}


def test_every_verdict_accounts_for_every_method_and_writes_itself():
    for model in (pulsating(), pulsating(-0.1), pulsating(0.0), random_path()[1], random_path(shift=4.0)[1]):
        found = assess(model)
        assert {name for name, _, text in found.rows() if text} == set(METHODS)
        assert [role for _, role, _ in found.rows()].count("decides") == (1 if found.method else 0)
        assert found.method != "frozen_time"
        again = json.loads(json.dumps(found.to_json(), allow_nan=False))
        assert again["verdict"] == found.verdict and found.verdict in str(found)
        quick = assess(model, thorough=False)
        assert (quick.verdict, quick.method) == (found.verdict, found.method)


def test_frozen_roots_say_their_coordinates_and_need_slow_variation():
    found = assess(pulsating(), coordinates="body axes")
    assert found.coordinates == "body axes" and "in body axes" in found.reasons["frozen_time"]
    assert assess(pulsating()).coordinates == "the model's own states x1, x2"


def test_false_growth_in_moving_coordinates():
    """A free mass in axes that spin up: frozen roots in body axes grow at sqrt(rate/2) or so, inertial ones do not."""
    rate = 0.3
    t = np.linspace(0.0, 2.0, 201)
    A = np.zeros((201, 4, 4))
    A[:, :2, 2:] = np.eye(2)
    spin = rate * t
    A[:, 2:, :2] = spin[:, None, None] ** 2 * np.eye(2) + rate * np.array([[0, 1], [-1, 0]])
    A[:, 2:, 2:] = 2 * spin[:, None, None] * np.array([[0, 1], [-1, 0]])
    body = frozen_time(model_of(t, A), coordinates="body axes")
    assert body.rightmost[0] == pytest.approx(np.sqrt(rate / 2), rel=1e-9) and body.suggests == "unstable"
    verdict = assess(model_of(t, A))
    assert verdict.method != "frozen_time" and verdict.verdict != "stable"


def test_states_that_others_do_not_feel_may_be_left_out():
    model = pulsating()
    A = np.zeros((129, 3, 3))
    A[:, 1:, 1:], A[:, 0, 1] = model.A, 1.0  # a drifting coordinate
    whole, part = assess(model_of(model.t, A)), assess(model_of(model.t, A), states=("x2", "x3"))
    assert (whole.verdict, part.verdict) == ("marginal", "stable")
    with pytest.raises(ValueError, match="state 'x9' must be one of x1, x2, x3"):
        assess(model_of(model.t, A), states=("x9",))
    for states in ((), ("x1", "x1")):
        with pytest.raises(ValueError, match=r"states = .* must name one state or more, each once"):
            assess(model_of(model.t, A), states=states)


def test_an_arm_along_its_own_motion():
    arm = TwoLinkArm.textbook()
    arm = dataclasses.replace(arm, joint_friction=(2.0, 1.0), modes=(1, 1))
    x0, u0 = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)
    model = arm.linearize(x0, u0)
    assert assess(model).verdict == "stable"
    x0, u0 = arm.equilibrium(theta1=np.pi / 2, theta2=0.0)
    assert assess(arm.linearize(x0, u0)).verdict == "unstable"
    motion = arm.simulate(arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)[0] + 0.01, None, np.linspace(0, 1, 201))
    found = assess(arm.linearize_along(motion))
    assert found.verdict in ("stable", "undecided") and "floquet" in found.reasons


@pytest.mark.parametrize("model", [3.0, "A", [1.0, 2.0], []])
def test_bad_models_are_refused(model):
    with pytest.raises(ValueError, match="must be an LTVModel, PiecewiseLTV or a list of LTVModel"):
        assess(model)


def test_bad_options_are_refused():
    model = pulsating()
    with pytest.raises(ValueError, match=r"growth.window = 9 must be > 0 and at most 3.14159 s"):
        growth(model, 9.0)
    with pytest.raises(ValueError, match=r"growth.scale = .* must be > 0"):
        growth(model, scale=[1.0, -1.0])
    with pytest.raises(ValueError, match=r"growth.duration = None must be > 0"):
        growth(linear([[0.0, 1.0], [-1.0, 0.0]]))
    assert growth(linear([[-1.0]]), duration=2.0).total == pytest.approx(np.exp(-2.0))


def test_a_nominal_at_rest_is_a_constant_model():
    A = np.broadcast_to(np.array([[0.0, 1.0], [-4.0, -0.4]]), (11, 2, 2))
    found = assess(model_of(np.linspace(0.0, 0.1, 11), A), periodic=False)
    assert (found.verdict, found.method) == ("stable", "eigenvalues") and found.margin == pytest.approx(0.2)


@pytest.mark.parametrize("method", [frozen_time, slow_variation])
def test_sampled_models_have_no_frozen_roots_in_the_s_plane(method):
    """|z| decides there, not the real part: assess knows, the methods for continuous time refuse."""
    arm = SingleLinkArm.textbook()
    sampled = arm.linearize(np.zeros(arm.nx)).discretize(0.01)
    with pytest.raises(ValueError, match=r"model\.dt = 0\.01 must be None"):
        method(sampled)
    assert assess(sampled).verdict in ("marginal", "unstable")
