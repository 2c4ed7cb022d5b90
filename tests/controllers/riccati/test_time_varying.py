"""Finite-horizon regulators: costs rolled out, closed forms, an independent integration, definiteness."""

import numpy as np
import pytest
from evidence import agrees
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from varying_spring import END, N, Q, R, along, spring, varying

from pliant.controllers import riccati
from pliant.envs import scenes
from pliant.plants import PliantError


def constant(A, B, t):
    return along(t, len(t) * [(A, B, np.zeros(len(A)))])


def riccati_rate(s, y):
    """Of [[P, p], [p', r]] as a matrix equation, for solve_ivp."""
    W = y.reshape(3, 3)
    A, B, c = varying(s)
    Az, Bz, Nz, Qz = np.zeros((3, 3)), np.vstack([B, [[0]]]), np.vstack([N, [[0]]]), np.zeros((3, 3))
    Az[:2, :2], Az[:2, 2], Qz[:2, :2] = A, c, Q
    K = np.linalg.solve(R, Bz.T @ W + Nz.T)
    return -(Az.T @ W + W @ Az + Qz - K.T @ R @ K).ravel()


def test_against_an_adaptive_integration_of_fourth_order_in_the_nodes():
    # SciPy's DOP853 on the plain equations, rtol 1e-12
    last = np.zeros((3, 3))
    last[:2, :2] = END
    W = (
        solve_ivp(riccati_rate, (2.0, 0.0), last.ravel(), method="DOP853", rtol=1e-12, atol=1e-13)
        .y[:, -1]
        .reshape(3, 3)
    )
    errors = []
    for nodes in (21, 41, 81):
        found = riccati.tvlqr(spring(nodes), Q, R, N, end=END)
        S = found.root[0]
        errors.append(np.abs(S @ S.T - W).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-7 and np.all(orders > 3.8)
    np.testing.assert_allclose(found.P[0], W[:2, :2], atol=2e-7)
    np.testing.assert_allclose(found.p[0], W[:2, 2], atol=2e-7)
    assert found.r[0] == pytest.approx(W[2, 2], abs=2e-7)


def test_scalar_closed_form():
    # dx/dt = u, cost x^2 + u^2: P = tanh(T - t) (Anderson and Moore 1990, section 2.3)
    t = np.linspace(0.0, 3.0, 31)
    found = riccati.tvlqr(constant(np.zeros((1, 1)), np.ones((1, 1)), t), [[1.0]], [[1.0]])
    told = {"of": "riccati.tvlqr", "source": "Anderson and Moore (1990), section 2.3", "kind": "closed form"}
    told["absolute"] = True
    agrees(found.P[:, 0, 0], np.tanh(3.0 - t), within=1e-14, what="cost to go of an integrator over 3 s", **told)
    agrees(found.K[:, 0, 0], np.tanh(3.0 - t), within=1e-14, what="its gain", **told)


def test_rolled_cost_is_the_cost_to_go_with_affine_term():
    found = riccati.tvlqr(spring(641), Q, R, N, end=END)
    t = np.linspace(0.0, 2.0, 641)
    K, k = CubicSpline(t, found.K), CubicSpline(t, found.k)

    def rate(s, y):
        A, B, c = varying(s)
        x = y[:2]
        u = -K(s) @ x - k(s)
        return [*(A @ x + B @ u + c), x @ Q @ x + u @ R @ u + 2 * x @ N @ u]

    start = np.array([0.7, -1.1])
    for i in (0, 320):
        end = solve_ivp(rate, (t[i], 2.0), [*start, 0.0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        assert end[2] + end[:2] @ END @ end[:2] == pytest.approx(found.cost_to_go(i, start), rel=1e-8)


def random_steps(T=30, nx=5, nu=2):
    rng = np.random.default_rng(4)
    A, B = rng.normal(size=(T, nx, nx)) / 2, rng.normal(size=(T, nx, nu))
    W = rng.normal(size=(T, nx + nu + 1, nx + nu + 1))
    W = W @ W.transpose(0, 2, 1)  # of [x; u; 1]
    x, u = slice(0, nx), slice(nx, nx + nu)
    terms = {"N": W[:, x, u], "q": W[:, x, -1], "s": W[:, u, -1], "r": W[:, -1, -1], "c": rng.normal(size=(T, nx))}
    return A, B, W[:, x, x], W[:, u, u], {**terms, "end": np.diag(np.arange(1.0, nx + 1))}


def test_rolled_cost_is_the_cost_to_go_in_discrete_time_with_every_term():
    A, B, Qs, Rs, terms = random_steps()
    found = riccati.dtvlqr(A, B, Qs, Rs, **terms)
    for start in (0, 13, 29):
        x = first = np.random.default_rng(start).normal(size=5)
        cost = 0.0
        for i in range(start, 30):
            u = -found.K[i] @ x - found.k[i]
            cost += x @ Qs[i] @ x + u @ Rs[i] @ u + 2 * x @ terms["N"][i] @ u + terms["r"][i]
            cost += 2 * (terms["q"][i] @ x + terms["s"][i] @ u)
            x = A[i] @ x + B[i] @ u + terms["c"][i]
        assert cost + x @ terms["end"] @ x == pytest.approx(found.cost_to_go(start, first), rel=1e-12)
        quadratic = first @ found.P[start] @ first + 2 * found.p[start] @ first + found.r[start]
        assert quadratic == pytest.approx(found.cost_to_go(start, first), rel=1e-11)


def test_no_other_inputs_cost_less():
    A, B, Qs, Rs, terms = random_steps(T=6)
    found = riccati.dtvlqr(A, B, Qs, Rs, **terms)
    rng, x0 = np.random.default_rng(8), np.ones(5)
    for _ in range(50):
        x, cost = x0, 0.0
        for i in range(6):
            u = -found.K[i] @ x - found.k[i] + 1e-2 * rng.normal(size=2)
            z = np.concatenate([x, u, [1.0]])
            W = np.block(
                [[Qs[i], terms["N"][i], terms["q"][i][:, None]], [terms["N"][i].T, Rs[i], terms["s"][i][:, None]]]
            )
            W = np.vstack([W, [*terms["q"][i], *terms["s"][i], terms["r"][i]]])
            cost += z @ W @ z
            x = A[i] @ x + B[i] @ u + terms["c"][i]
        assert cost + x @ terms["end"] @ x > found.cost_to_go(0, x0)


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach"])
def test_long_horizon_tends_to_the_steady_regulator(name):
    scene = scenes.get(name)
    model, (Qs, Rs, _) = scene.plant.linearize(*scene.target), scene.quadratic()
    steady = riccati.lqr(model.A, model.B, Qs, Rs)
    found = riccati.tvlqr(constant(model.A, model.B, np.linspace(0.0, 40.0, 81)), Qs, Rs)
    np.testing.assert_allclose(found.K[0], steady.K, atol=1e-9 * np.abs(steady.K).max())
    np.testing.assert_allclose(found.P[0], steady.P, atol=1e-9 * np.abs(steady.P).max())
    sampled = riccati.sampled(model.A, model.B, Qs, Rs, dt=0.02)
    steady = riccati.dlqr(*sampled)
    T = 2000
    found = riccati.dtvlqr(*(np.tile(m, (T, 1, 1)) for m in sampled[:2]), *sampled[2:])
    np.testing.assert_allclose(found.K[0], steady.K, atol=1e-9 * np.abs(steady.K).max())
    np.testing.assert_allclose(found.P[0], steady.P, atol=1e-9 * np.abs(steady.P).max())


def test_definite_where_a_plain_integration_is_not():
    # The arm's second mode is at 270 1/s; the end weight makes the equation stiffer still.
    scene = scenes.get("single-link-slew")
    model, (Qs, Rs, _) = scene.plant.linearize(*scene.target), scene.quadratic()
    A, B, end, nodes = model.A, model.B, 1e4 * np.eye(6), 1201
    P, h, lowest = end, 0.3 / (nodes - 1), np.inf
    G = B @ np.linalg.solve(Rs, B.T)

    def rate(P):
        return A.T @ P + P @ A - P @ G @ P + Qs

    with np.errstate(all="ignore"):
        for _ in range(nodes - 1):
            k1 = rate(P)
            k2 = rate(P + h / 2 * k1)
            k3 = rate(P + h / 2 * k2)
            P = P + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(P + h * k3))
            if not np.isfinite(P).all():
                break
            lowest = min(lowest, np.linalg.eigvalsh((P + P.T) / 2)[0])
    assert lowest < -1e3  # RK4 every 0.25 ms: the cost to go of some states is negative, then overflows
    found = [riccati.tvlqr(constant(A, B, np.linspace(0.0, 0.3, n)), Qs, Rs, end=end) for n in (4, 61)]
    for each in found:
        assert np.linalg.eigvalsh(each.P).min() > 0
    np.testing.assert_allclose(found[0].P[0], found[1].P[0], rtol=1e-6, atol=1e-9 * found[1].P[0].max())


def test_definite_where_the_plain_recursion_is_not():
    # Cheap control of a triple integrator from a large end weight: in three steps P falls by twenty decades.
    wide = expm(0.1 * np.diag([1.0, 1.0, 1.0], 1))
    A, B = wide[:3, :3], wide[:3, 3:]
    cheap, end, P, lowest = np.array([[1e-12]]), 1e8 * np.eye(3), 1e8 * np.eye(3), np.inf
    for _ in range(20):
        G = B.T @ P @ A
        P = A.T @ P @ A - G.T @ np.linalg.solve(cheap + B.T @ P @ B, G)
        lowest = min(lowest, np.linalg.eigvalsh((P + P.T) / 2)[0] / np.abs(P).max())
    assert lowest < -0.1
    found = riccati.dtvlqr(np.tile(A, (20, 1, 1)), np.tile(B, (20, 1, 1)), np.zeros((3, 3)), cheap, end=end)
    lowest = np.linalg.eigvalsh(found.P)
    assert np.all(lowest[:, 0] >= -1e-15 * lowest[:, -1])
    # The exact cost is that of the least-norm inputs that bring x to zero.
    reach = np.hstack([np.linalg.matrix_power(A, 19 - i) @ B for i in range(20)])
    x = np.array([1.0, 0.0, 0.0])
    least = np.linalg.lstsq(reach, -np.linalg.matrix_power(A, 20) @ x, rcond=None)[0]
    assert found.cost_to_go(0, x) == pytest.approx(1e-12 * least @ least, rel=1e-6)


def test_nodes_too_far_apart_are_refused():
    rng, t = np.random.default_rng(0), np.linspace(0.0, 1.0, 9)
    parts = [(rng.normal(size=(4, 4)), rng.normal(size=(4, 1)), np.zeros(4)) for _ in t]
    with pytest.raises(PliantError, match=r"tvlqr: between the nodes at .* put the nodes of the nominal closer"):
        riccati.tvlqr(along(t, parts), np.diag([1.0, 0.0, 0.0, 0.0]), np.eye(1))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"Q": np.diag([1.0, -1.0])}, r"step 0: the cost .* has an eigenvalue < 0"),
        ({"R": [[0.0]], "B": np.zeros((3, 2, 1))}, r"step 2: R \+ B'P B is singular, must be > 0"),
        ({"A": np.zeros((3, 2, 3))}, r"A has shape \(3, 2, 3\), must be \(3, 2, 2\)"),
        ({"A": np.zeros((2, 2))}, r"A has shape \(2, 2\), must be"),
        ({"c": np.zeros((2, 2))}, r"c has shape \(2, 2\), must be \(3, 2\)"),
        ({"end": np.diag([-1.0, 1.0])}, r"end has eigenvalue -1, must be >= 0"),
        ({"N": [[5.0], [0.0]]}, r"step 0: the cost"),
    ],
)
def test_bad_input(change, message):
    given = {"A": np.tile(np.eye(2), (3, 1, 1)), "B": np.ones((3, 2, 1)), "Q": np.eye(2), "R": np.eye(1), **change}
    with pytest.raises(ValueError, match=message):
        riccati.dtvlqr(**given)
