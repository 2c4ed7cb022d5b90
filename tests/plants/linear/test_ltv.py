"""LTVModel: order four against closed forms, Floquet multipliers of Mathieu's equation, speed."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants.core.signals import Signal
from pliant.plants.linear.ltv import LTVModel


def build(t, A, B=None, c=None, E=None, **replaced):
    """An LTVModel from functions of time, the states as outputs."""
    t = np.asarray(t, dtype=float)
    n = len(A(t[0]))

    def stack(f, shape):
        return np.array([np.zeros(shape) if f is None else f(s) for s in t])

    def named(prefix, count):
        return tuple(Signal(f"{prefix}{i + 1}", "") for i in range(count))

    m = 0 if B is None else np.shape(B(t[0]))[1]
    k = 0 if E is None else np.shape(E(t[0]))[1]
    fields = {
        "A": stack(A, 0), "B": stack(B, (n, 0)), "E": stack(E, (n, 0)), "c": stack(c, n),
        "C": np.tile(np.eye(n), (len(t), 1, 1)), "D": np.ones((len(t), n, m)), "F": np.zeros((len(t), n, k)),
        "x": np.zeros((len(t), n)), "u": np.zeros((len(t), m)), "y": np.zeros((len(t), n)),
        "states": named("x", n), "inputs": named("u", m), "disturbances": named("w", k),
        "outputs": named("x", n),
    }  # fmt: skip
    return LTVModel(t, **{**fields, **replaced})


def turning(t):
    """A(t) of Markus and Yamabe (1960): its eigenvalues are (-1 +- i sqrt 7)/4 at every time."""
    return np.array([[-1 + 1.5 * np.cos(t) ** 2, 1 - 1.5 * np.sin(t) * np.cos(t)],
                     [-1 - 1.5 * np.sin(t) * np.cos(t), -1 + 1.5 * np.sin(t) ** 2]])  # fmt: skip


def turning_solution(t):
    """Their growing solution."""
    return np.exp(t / 2) * np.array([np.cos(t), -np.sin(t)])


def slopes(errors):
    return np.log2(np.divide(errors[:-1], errors[1:]))


def test_free_motion_is_of_order_four():
    errors = []
    for n in (20, 40, 80, 160):
        dx, _ = build(np.linspace(0, 4, n + 1), turning).simulate([1.0, 0.0])
        errors.append(np.abs(dx[-1] - turning_solution(4.0)).max())
    assert np.all(np.abs(slopes(errors)[-2:] - 4) < 0.3) and errors[-1] < 1e-5


def test_affine_term_and_function_input_are_of_order_four():
    # x = [sin t, cos t] is made to be a solution: its defect enters half through c, half through the input.
    def defect(t):
        return np.array([np.cos(t), -np.sin(t)]) - turning(t) @ [np.sin(t), np.cos(t)]

    mixing = lambda t: np.array([[2 + np.sin(t), 0.3], [0.0, 1.0]])  # noqa: E731
    errors = []
    for n in (20, 40, 80, 160):
        model = build(np.linspace(0, 4, n + 1), turning, mixing, c=lambda t: 0.5 * defect(t))
        dx, dy = model.simulate([0.0, 1.0], lambda t: 0.5 * np.linalg.solve(mixing(t), defect(t)))
        errors.append(np.abs(dx[-1] - [np.sin(4), np.cos(4)]).max())
    assert np.all(np.abs(slopes(errors)[-2:] - 4) < 0.3) and errors[-1] < 1e-5
    np.testing.assert_allclose(
        dy[-1], dx[-1] + np.ones((2, 2)) @ (0.5 * np.linalg.solve(mixing(4.0), defect(4.0))), atol=1e-12
    )


def test_held_input_is_of_order_four_between_nodes():
    B, E = (lambda t: np.array([[np.cos(t)], [1.0]])), (lambda t: np.array([[0.2], [t]]))
    errors = []
    for n in (10, 20, 40, 80):
        model = build(np.linspace(0, 4, n + 1), turning, B, E=E)
        du = np.repeat([[1.0], [-2.0]], n // 2, axis=0)  # two long holds
        du = np.vstack([du, du[-1:]])
        dx, _ = model.simulate([1.0, 0.0], du, [0.5])
        state = np.array([1.0, 0.0])
        for a, b, u in ((0, 2, 1.0), (2, 4, -2.0)):
            rate = lambda t, x, u=u: turning(t) @ x + B(t)[:, 0] * u + E(t)[:, 0] * 0.5  # noqa: E731
            state = solve_ivp(rate, (a, b), state, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        errors.append(np.abs(dx[-1] - state).max())
    assert np.all(np.abs(slopes(errors)[-2:] - 4) < 0.4)


def test_transition_is_what_simulate_rolls():
    rng = np.random.default_rng(3)
    model = build(np.linspace(0, 1, 9), turning, lambda t: [[t], [1.0]], c=lambda t: [t, 1.0])
    Phi, Gamma, gamma = model.transition()
    assert (Phi.shape, Gamma.shape, gamma.shape) == ((8, 2, 2), (8, 2, 1), (8, 2))
    du, x = rng.normal(size=(9, 1)), np.array([0.3, -1.0])
    dx, _ = model.simulate(x, du)
    for k in range(8):
        x = Phi[k] @ x + Gamma[k] @ du[k] + gamma[k]
    np.testing.assert_allclose(dx[-1], x, atol=1e-14)
    discrete = model.discretize()
    np.testing.assert_array_equal(discrete.A, Phi)
    np.testing.assert_array_equal(discrete.C, model.C)


def test_constant_matrices_give_the_zero_order_hold():
    A, B = np.array([[0.0, 1.0], [-4.0, -0.1]]), np.array([[0.0], [2.0]])
    model = build([0, 0.1, 0.5, 0.6], lambda t: A, lambda t: B, c=lambda t: [0.0, 3.0])
    Phi, Gamma, gamma = model.transition()
    sampled = model.at(1).discretize(0.4)
    np.testing.assert_allclose(Phi[1], sampled.A, atol=1e-14)
    np.testing.assert_allclose(Gamma[1], sampled.B, atol=1e-14)
    np.testing.assert_allclose(gamma[1], sampled.f0, atol=1e-14)


@pytest.mark.parametrize(("delta", "epsilon"), [(1.0, 0.5), (2.5, 0.8), (0.25, 0.2)])
def test_floquet_multipliers_of_mathieu(delta, epsilon):
    def mathieu(t):
        return np.array([[0.0, 1.0], [-(delta + epsilon * np.cos(t)), 0.0]])

    Phi = build(np.linspace(0, 2 * np.pi, 401), mathieu).transition()[0]
    monodromy = np.eye(2)
    for step in Phi:
        monodromy = step @ monodromy
    columns = [
        solve_ivp(lambda t, x: mathieu(t) @ x, (0, 2 * np.pi), e, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
        for e in np.eye(2)
    ]
    expected = np.sort_complex(np.linalg.eigvals(np.array(columns).T))
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(monodromy)), expected, atol=2e-7)
    assert np.linalg.det(monodromy) == pytest.approx(1.0, abs=1e-12)  # Liouville: the trace of A is zero


def test_frozen_model():
    model = build(np.linspace(0, 1, 5), turning, c=lambda t: [t, 2 * t], x=np.arange(10.0).reshape(5, 2))
    frozen = model.at(2)
    np.testing.assert_array_equal(frozen.A, turning(0.5))
    np.testing.assert_array_equal(frozen.x0, [4, 5])
    np.testing.assert_array_equal(frozen.f0, [0.5, 1.0])
    with pytest.raises(ValueError, match="k = 5 must be an integer"):
        model.at(5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"C": np.zeros((5, 3, 2))}, r"LTVModel\.C has shape \(5, 3, 2\), must be \(5, 2, 2\)"),
        ({"x": np.full((5, 2), np.inf)}, r"LTVModel\.x\[0, 0\] = inf must be finite"),
        ({"w": np.zeros((5, 1))}, r"LTVModel\.w has shape"),
    ],
)
def test_bad_input(change, message):
    with pytest.raises(ValueError, match=message):
        build(np.linspace(0, 1, 5), turning, **change)


def test_bad_times_and_inputs():
    with pytest.raises(ValueError, match=r"LTVModel\.t\[2\] = 0\.5 must be greater than LTVModel\.t\[1\] = 0\.5"):
        build([0, 0.5, 0.5, 1], turning)
    model = build([0, 0.5, 1], turning, lambda t: [[0.0], [1.0]])
    with pytest.raises(ValueError, match=r"simulate\.dx0 has shape \(3,\)"):
        model.simulate(np.zeros(3))
    with pytest.raises(ValueError, match=r"simulate\.du has shape \(4, 1\), must be \(3, 1\)"):
        model.simulate(np.zeros(2), np.zeros((4, 1)))
    with pytest.raises(ValueError, match=r"simulate\.du\(.*\) has shape \(2,\)"):
        model.simulate(np.zeros(2), lambda t: [1.0, 2.0])
