"""Riccati designs against closed forms, python-control and rolled costs."""

import control
import numpy as np
import pytest
from evidence import agrees
from scipy.integrate import quad_vec
from scipy.linalg import expm, solve_continuous_are

from pliant.controllers import riccati
from pliant.controllers.riccati import algebraic
from pliant.plants.core.errors import UncontrollableError
from pliant.plants.linear.lti import LinearModel

DOUBLE = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])


def random_problem(seed, n=5, m=2):
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(n + m, n + m))
    M = roots @ roots.T + np.eye(n + m)
    return rng.normal(size=(n, n)), rng.normal(size=(n, m)), M[:n, :n], M[n:, n:], M[:n, n:]


def test_double_integrator():
    K, P, poles = riccati.lqr(*DOUBLE, np.diag([1.0, 1.0]), np.eye(1))
    np.testing.assert_allclose(K, [[1, np.sqrt(3)]], rtol=1e-13)
    np.testing.assert_allclose(P, [[np.sqrt(3), 1], [1, np.sqrt(3)]], rtol=1e-13)
    np.testing.assert_allclose(np.sort_complex(poles), (-np.sqrt(3) + np.array([-1j, 1j])) / 2, rtol=1e-12)


@pytest.mark.parametrize("a", [-2.0, 0.0, 0.7, 3.0])
@pytest.mark.parametrize("q", [0.1, 4.0])
def test_scalar(a, q):
    b, r = 2.0, 0.5
    p = r / b**2 * (a + np.sqrt(a**2 + b**2 * q / r))
    found = riccati.lqr([[a]], [[b]], [[q]], [[r]])
    assert found.P[0, 0] == pytest.approx(p, rel=1e-12)
    assert found.poles[0] == pytest.approx(-np.sqrt(a**2 + b**2 * q / r), rel=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_python_control_agrees(seed):
    A, B, Q, R, N = random_problem(seed)
    K, P, poles = control.lqr(A, B, Q, R, N, method="scipy")
    found = riccati.lqr(A, B, Q, R, N)
    np.testing.assert_allclose(found.K, K, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found.P, P, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(np.sort_complex(found.poles), np.sort_complex(poles), rtol=1e-7)
    K, P, _ = control.dlqr(A, B, Q, R, N, method="scipy")
    found = riccati.dlqr(A, B, Q, R, N)
    np.testing.assert_allclose(found.K, K, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found.P, P, rtol=1e-7, atol=1e-9)


def test_rolled_discrete_cost_is_the_cost_to_go():
    A, B, Q, R, N = random_problem(7)
    K, P, _ = riccati.dlqr(A, B, Q, R, N)
    start = x = np.arange(1.0, 6.0)
    cost = 0.0
    for _ in range(400):
        u = -K @ x
        cost += x @ Q @ x + u @ R @ u + 2 * x @ N @ u
        x = A @ x + B @ u
    assert cost == pytest.approx(start @ P @ start, rel=1e-10)


@pytest.mark.parametrize("scale", [1.0, 300.0])  # the second one is stiff: |A| dt = 60
def test_sampled_cost_is_the_integrated_one(scale):
    rng = np.random.default_rng(5)
    A, B = np.array([[0.0, 1.0], [-scale, -0.2 * scale]]), np.array([[0.0], [scale]])
    Q, R, N, dt = np.diag([3.0, 0.5]), np.array([[2.0]]), np.array([[0.1], [0.2]]), 0.2
    found = riccati.sampled(A, B, Q, R, N, dt=dt)
    x, u = rng.normal(size=2), rng.normal(size=1)
    wide = np.vstack([np.hstack([A, B]), np.zeros((1, 3))])
    M = np.block([[Q, N], [N.T, R]])

    def rate(s):
        z = expm(wide * s) @ np.concatenate([x, u])
        return z @ M @ z

    cost = x @ found.Q @ x + u @ found.R @ u + 2 * x @ found.N @ u
    assert cost == pytest.approx(quad_vec(rate, 0, dt, epsrel=1e-12)[0], rel=1e-10)
    np.testing.assert_allclose(found.A, expm(A * dt), atol=1e-12)


def test_sampled_cost_of_the_integrator():
    # x' = u, cost q x^2 + r u^2: int (x + u s)^2 = x^2 h + x u h^2 + u^2 h^3/3.
    h, q, r = 0.3, 2.0, 5.0
    found = riccati.sampled([[0.0]], [[1.0]], [[q]], [[r]], dt=h)
    values = [m[0, 0] for m in found]
    np.testing.assert_allclose(values, [1, h, q * h, r * h + q * h**3 / 3, q * h**2 / 2], rtol=1e-14)


def test_integral_action_removes_a_constant_load():
    A, B = np.array([[0.0, 1.0], [-2.0, -0.1]]), np.array([[0.0], [1.0]])
    K, P, poles = riccati.lqi(A, B, [[1.0, 0.0]], np.diag([1.0, 1.0, 4.0]), [[1.0]])
    wide = np.block([[A, np.zeros((2, 1))], [np.array([[1.0, 0, 0]])]]) - np.vstack([B, [[0]]]) @ K
    rest = np.linalg.solve(wide, -np.array([0, 0.7, 0]))
    assert poles.real.max() < 0 and P.shape == (3, 3)
    np.testing.assert_allclose(rest[:2], 0, atol=1e-14)
    assert abs(rest[2]) > 0.1


HALVES = np.array([[4.0, 3.0], [-4.5, -3.5]]), np.array([[1.0], [-1.0]]), np.array([[9.0, 6.0], [6.0, 4.0]])


def test_benchmarks_with_known_solutions():
    """Examples 1 and 2 of CAREX, 2 of DAREX: (A, B) of the second is stabilizable, not controllable."""
    told = {"of": "riccati.lqr", "source": "Benner, Laub and Mehrmann (1995), CAREX", "kind": "closed form"}
    found = riccati.lqr(*DOUBLE, np.diag([1.0, 2.0]), np.eye(1))
    agrees(found.P, [[2.0, 1.0], [1.0, 2.0]], within=1e-12, what="solution of example 1", **told)
    A, B, Q = HALVES
    agrees(riccati.lqr(A, B, Q, np.eye(1)).P, (1 + np.sqrt(2)) * Q, within=1e-10, what="solution of example 2", **told)
    told |= {"of": "riccati.dlqr", "source": "Benner, Laub and Mehrmann (1995), DAREX"}
    found = riccati.dlqr(A, B, Q, np.eye(1)).P
    agrees(found, (1 + np.sqrt(5)) / 2 * Q, within=1e-10, what="solution of example 2", **told)


def test_the_tutorials_pendulum():
    """Control Tutorials for MATLAB and Simulink, inverted pendulum: M = 0.5, m = 0.2, b = 0.1, I = 0.006, l = 0.3."""
    M, m, b, inertia, g, long = 0.5, 0.2, 0.1, 0.006, 9.8, 0.3
    p = inertia * (M + m) + M * m * long**2
    A = np.zeros((4, 4))
    A[0, 1] = A[2, 3] = 1.0
    A[1, 1:3] = -(inertia + m * long**2) * b / p, m**2 * g * long**2 / p
    A[3, 1:3] = -m * long * b / p, m * g * long * (M + m) / p
    B = np.array([[0], [inertia + m * long**2], [0], [m * long]]) / p
    K = riccati.lqr(A, B, np.diag([5000.0, 0, 100, 0]), np.eye(1)).K
    agrees(
        K[0],
        [-70.7107, -37.8345, 105.5298, 20.9238],
        within=5e-5,
        absolute=True,
        of="riccati.lqr",
        what="gain of an inverted pendulum",
        source="MATLAB's lqr, as the Control Tutorials for MATLAB and Simulink print it",
        kind="other program",
    )


def test_kalman_scalar():
    # a x + e w seen with v: p = (a + sqrt(a^2 + e^2 W/V)) V (Kalman and Bucy 1961)
    a, e, W, V = -0.4, 2.0, 0.3, 0.05
    L, P = riccati.kalman([[a]], [[e]], [[1.0]], [[W]], [[V]])
    p = (a + np.sqrt(a**2 + e**2 * W / V)) * V
    told = {"of": "riccati.kalman", "source": "Kalman and Bucy (1961)", "kind": "closed form"}
    agrees([P[0, 0], L[0, 0]], [p, p / V], within=1e-12, what="variance and gain of one state", **told)


def test_kalman_double_integrator_and_python_control():
    # White acceleration of density q seen with r: L = [sqrt 2 w, w^2], w = (q/r)^(1/4)
    q, r = 3.0, 0.02
    w = (q / r) ** 0.25
    L, _ = riccati.kalman(DOUBLE[0], DOUBLE[1], [[1.0, 0.0]], [[q]], [[r]])
    np.testing.assert_allclose(L[:, 0], [np.sqrt(2) * w, w**2], rtol=1e-12)
    A, B, *_ = random_problem(3)
    L, P = riccati.kalman(A, B, np.eye(5)[:2], np.eye(2), np.diag([0.1, 0.2]))
    theirs = control.lqe(A, B, np.eye(5)[:2], np.eye(2), np.diag([0.1, 0.2]), method="scipy")
    np.testing.assert_allclose(L, theirs[0], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(P, theirs[1], rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"Q": [[1, 2], [0, 1]]}, r"Q\[0, 1\] = 2 must equal Q\[1, 0\], 0"),
        ({"Q": np.diag([1.0, -1.0])}, r"Q has eigenvalue -1, must be >= 0"),
        ({"Q": np.diag([1e12, -1.0])}, r"Q has eigenvalue -1, must be >= 0"),
        ({"R": [[0.0]]}, r"R has eigenvalue 0, must be > 0"),
        ({"N": [[9.0], [0.0]]}, r"\[\[Q, N\], \[N', R\]\] has eigenvalue -8, must be >= 0"),
        ({"A": np.eye(3)}, r"B has shape \(2, 1\), must be \(3, -1\)"),
        ({"B": [[np.nan], [0]]}, r"B\[0, 0\] = nan must be finite"),
        ({"names": ("a",)}, r"names = \('a',\) must be 2 names"),
    ],
)
def test_bad_input(change, message):
    with pytest.raises(ValueError, match=message):
        riccati.lqr(**{"A": DOUBLE[0], "B": DOUBLE[1], "Q": np.eye(2), "R": np.eye(1), **change})
    with pytest.raises(ValueError, match=r"dt = 0 must be > 0"):
        riccati.sampled(*DOUBLE, np.eye(2), np.eye(1), dt=0)


def test_integral_action_with_feedthrough():
    """x' = u, y = x + u/2: of the wide model written by hand, K = B'P with P of SciPy's own Riccati solver."""
    wide, B = np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[1.0], [0.5]])
    P = solve_continuous_are(wide, B, np.diag([1.0, 4.0]), np.eye(1))
    made = riccati.lqi([[0.0]], [[1.0]], [[1.0]], np.diag([1.0, 4.0]), np.eye(1), D=[[0.5]])
    np.testing.assert_allclose(made.K, B.T @ P, rtol=1e-9)
    without = riccati.lqi([[0.0]], [[1.0]], [[1.0]], np.diag([1.0, 4.0]), np.eye(1))
    assert np.abs(made.K - without.K).max() > 0.1


def test_integrals_of_a_sampled_model():
    """[x; sum dt y] with y = 3 x + 2 u: the sum grows by dt (3 x + 2 u) a step."""
    A, B = algebraic.with_integrals(np.array([[0.5]]), np.array([[1.0]]), np.array([[3.0]]), np.array([[2.0]]), 0.1)
    np.testing.assert_allclose(A, [[0.5, 0.0], [0.3, 1.0]])
    np.testing.assert_allclose(B, [[1.0], [0.2]])


def test_sampled_cost_of_a_model_that_is_stiff_for_its_step():
    """x' = -a x + u, a dt = 2000, in closed form: without doubling, exp(+2000) is in the way."""
    a, dt = 2000.0, 1.0
    step = riccati.sampled([[-a]], [[1.0]], [[1.0]], [[3.0]], dt=dt)
    tail = -np.expm1(-a * dt)
    np.testing.assert_allclose(step.Q, [[-np.expm1(-2 * a * dt) / (2 * a)]], rtol=1e-12)
    np.testing.assert_allclose(step.B, [[tail / a]], rtol=1e-12)
    # z = x e^-as + u (1 - e^-as)/a: the integral of the square, in x u and u^2
    cross = (tail / a - -np.expm1(-2 * a * dt) / (2 * a)) / a
    np.testing.assert_allclose(step.N, [[cross]], rtol=1e-12)
    squared = (dt - 2 * tail / a + -np.expm1(-2 * a * dt) / (2 * a)) / a**2
    np.testing.assert_allclose(step.R, [[3.0 * dt + squared]], rtol=1e-12)


@pytest.mark.parametrize("dt", [None, 1.0])
def test_what_the_cross_weight_hides_from_the_cost(dt):
    """x' = u with (x + u)^2: u = -x costs nothing and decays, though Q alone sees x and Q - N N' does not.

    x' = x + u with (x - u)^2: u = x costs nothing and grows, unseen, where Q alone would see x.
    """
    design = riccati.lqr if dt is None else riccati.dlqr
    one = np.ones((1, 1))
    made = design(0 * one if dt is None else one, one, one, one, one)
    np.testing.assert_allclose(made.K, one, atol=1e-9)
    np.testing.assert_allclose(made.P, 0 * one, atol=1e-9)
    with pytest.raises(UncontrollableError, match="cannot be seen by the cost"):
        design(one, one, one, one, -one)


def test_filter_of_noise_that_is_also_in_the_reading():
    """x+ = x/2 + w, y = x + w + v, variances 1 and 3: P = P/4 + 1 - (P/2 + 1) L, L = (P/2 + 1)/(P + 4)."""
    one = np.ones((1, 1))
    L, found = algebraic.filter_gain(one / 2, one, one, 4 * one, one, one, ("x",), 1.0, ("unseen", "undriven"))
    p = float(found[0, 0])
    assert p == pytest.approx(p / 4 + 1 - (p / 2 + 1) ** 2 / (p + 4), rel=1e-12) and p > 0
    assert L[0, 0] == pytest.approx((p / 2 + 1) / (p + 4), rel=1e-12)


def test_discrete_kalman_scalar_and_duality():
    # p = a^2 p v/(p + v) + e^2 w (Anderson and Moore 1979, section 4.4); solved as a quadratic
    a, e, w, v = 0.9, 0.5, 2.0, 0.3
    b = v * (1 - a**2) - e**2 * w
    p = (-b + np.sqrt(b**2 + 4 * v * e**2 * w)) / 2
    L, P = riccati.dkalman([[a]], [[e]], [[1.0]], [[w]], [[v]])
    told = {"of": "riccati.dkalman", "source": "Anderson and Moore (1979), section 4.4", "kind": "closed form"}
    agrees([P[0, 0], L[0, 0]], [p, a * p / (p + v)], within=1e-12, what="variance and gain of one state", **told)
    rng = np.random.default_rng(2)
    A, C, W, V = rng.normal(size=(4, 4)) / 2, rng.normal(size=(2, 4)), np.diag([1.0, 2, 3, 4]), np.diag([0.1, 0.2])
    L, P = riccati.dkalman(A, np.eye(4), C, W, V)
    dual = riccati.dlqr(A.T, C.T, W, V)
    np.testing.assert_allclose(L, dual.K.T, rtol=1e-12)
    np.testing.assert_allclose(A @ P @ A.T + W - L @ (C @ P @ C.T + V) @ L.T, P, rtol=1e-10, atol=1e-12)
    with pytest.raises(Exception, match="cannot be seen by the output"):
        riccati.dkalman(np.diag([1.0, 0.5]), np.eye(2), [[0.0, 1.0]], np.eye(2), np.eye(1))


def test_cost_to_go_of_the_steady_regulator():
    model = LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]])
    found = riccati.lqr(model.A, model.B, np.eye(2), np.eye(1))
    assert found.cost_to_go([1.0, -2.0]) == pytest.approx(np.sqrt(3) * (1 + 4) - 4.0, rel=1e-12)
