"""LinearModel against closed forms, python-control and SciPy's adaptive integration."""

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from pliant.plants.core.signals import Signal
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel


def chain(n=3, k=40.0, d=0.3, seed=1):
    """n masses joined by springs, the first to a wall; force on the last, disturbance on the first."""
    rng = np.random.default_rng(seed)
    m = rng.uniform(0.5, 2.0, n)
    K = k * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    K[-1, -1] = k
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K / m[:, None], -d / k * K / m[:, None]]])
    B, E = np.zeros((2 * n, 1)), np.zeros((2 * n, 1))
    B[-1], E[n] = 1 / m[-1], 1 / m[0]
    names = [f"q{i + 1}" for i in range(n)] + [f"v{i + 1}" for i in range(n)]
    C = np.zeros((2, 2 * n))
    C[0, n - 1], C[1] = 1.0, A[n]
    return LinearModel.from_matrices(
        A,
        B,
        C,
        [[0.0], [0.5]],
        E=E,
        F=[[0.0], [E[n, 0]]],
        states=names,
        inputs=["force"],
        outputs=["tip", "acc"],
    )


def with_rate(model, f0):
    fields = {name: getattr(model, name) for name in model.__dataclass_fields__}
    return LinearModel(**{**fields, "f0": f0})


def test_zero_order_hold_of_the_double_integrator():
    model = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [2.0]], E=[[1.0], [0]])
    model = with_rate(model, [0.0, 3.0])
    h = 0.3
    sampled = model.discretize(h)
    np.testing.assert_allclose(sampled.A, [[1, h], [0, 1]], rtol=1e-15)
    np.testing.assert_allclose(sampled.B, [[h**2], [2 * h]], rtol=1e-15)
    np.testing.assert_allclose(sampled.E, [[h], [0]], rtol=1e-15)
    np.testing.assert_allclose(sampled.f0, [1.5 * h**2, 3 * h], rtol=1e-15)
    assert sampled.dt == h


def test_discretize_agrees_with_python_control():
    model = chain()
    theirs = control.c2d(model.to_control(), 0.05, "zoh")
    np.testing.assert_allclose(model.discretize(0.05).A, theirs.A, atol=1e-13)
    np.testing.assert_allclose(model.discretize(0.05).B, theirs.B, atol=1e-13)


def test_simulation_of_held_inputs_is_exact_on_uneven_times():
    rng = np.random.default_rng(2)
    model = with_rate(chain(), rng.normal(size=6))
    t = np.sort(rng.uniform(0, 2, 12))
    du, dw, dx0 = rng.normal(size=(12, 1)), rng.normal(size=(12, 1)), rng.normal(size=6)
    x, y = model.simulate(dx0, du, t, dw)
    expected = dx0
    for k in range(11):

        def rate(s, z, k=k):
            return model.A @ z + model.B @ du[k] + model.E @ dw[k] + model.f0

        expected = solve_ivp(rate, (t[k], t[k + 1]), expected, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(x[-1], expected, atol=1e-10)
    np.testing.assert_allclose(y, x @ model.C.T + du @ model.D.T + dw @ model.F.T, atol=1e-14)


def test_sampled_and_continuous_simulation_agree():
    model = with_rate(chain(), np.arange(6.0))
    t = np.linspace(0, 3, 61)
    du, dw = np.sin(t)[:, None], np.array([0.7])
    fine = model.simulate(np.ones(6), du, t, dw)
    coarse = model.discretize(0.05).simulate(np.ones(6), du, t, dw)
    for a, b in zip(fine, coarse):
        np.testing.assert_allclose(a, b, atol=1e-12)
    with pytest.raises(ValueError, match=r"simulate\.t has steps up to 0\.1, must be 0\.05"):
        model.discretize(0.05).simulate(np.ones(6), None, np.linspace(0, 3, 31))


def test_function_input_is_exact_for_a_line_and_of_order_four():
    model = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [1.0]])
    x, _ = model.simulate(np.zeros(2), lambda t: [t], [0.0, 0.7, 2.0])
    np.testing.assert_allclose(x[:, 0], np.array([0, 0.7, 2.0]) ** 3 / 6, atol=1e-14)

    w, w0 = 3.0, 1.3  # x'' + w0^2 x = sin(w t) from rest
    model = LinearModel.from_matrices([[0, 1], [-(w0**2), 0]], [[0], [1.0]])
    closed = (np.sin(w * 2.0) - w / w0 * np.sin(w0 * 2.0)) / (w0**2 - w**2)
    errors = []
    for n in (20, 40, 80):
        x, _ = model.simulate(np.zeros(2), lambda t: np.sin(w * t), np.linspace(0, 2, n + 1))
        errors.append(abs(x[-1, 0] - closed))
    assert np.all(np.abs(np.log2(np.divide(errors[:-1], errors[1:])) - 4) < 0.15)


def test_modes_of_two_masses():
    # Two equal masses, three equal springs: omega^2 = k/m, 3 k/m; damping beta k: zeta = beta omega / 2.
    k, m, beta = 100.0, 1.0, 1e-3
    K = k * np.array([[2.0, -1], [-1, 2]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K / m, -beta * K / m]])
    model = LinearModel.from_matrices(A, np.eye(4)[:, 3:], states=["q1", "q2", "v1", "v2"])
    for modes in (model.modes(), model.discretize(0.01).modes()):
        omega = np.sqrt(np.array([1, 3]) * k / m)
        np.testing.assert_allclose([mode.frequency_hz for mode in modes], omega / (2 * np.pi), rtol=1e-9)
        np.testing.assert_allclose([mode.damping_ratio for mode in modes], beta * omega / 2, rtol=1e-8)
        np.testing.assert_allclose(
            [mode.damped_frequency_hz for mode in modes],
            omega / (2 * np.pi) * np.sqrt(1 - (beta * omega / 2) ** 2),
            rtol=1e-9,
        )
        assert [mode.dominant_state for mode in modes] == ["q1", "q1"]
        assert modes[1].name == "mode 2: 2.76 Hz, zeta 0.0087 (q1)"


def test_modes_name_the_state_that_takes_part():
    A = np.diag([-1.0, -5.0, 0.0])
    A[0, 2] = 0.1
    rows = LinearModel.from_matrices(A, np.ones((3, 1)), states=["slow", "fast", "still"]).modes()
    assert [(mode.dominant_state, mode.damping_ratio) for mode in rows] == [
        ("still", 0),
        ("slow", 1),
        ("fast", 1),
    ]
    free = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [1]], states=["theta", "omega"]).modes()
    assert {mode.name[8:] for mode in free} == {"0 Hz, zeta 0 (theta)"}


def test_round_trip_through_python_control():
    model = chain()
    for one in (model, model.discretize(0.02)):
        theirs = one.to_control()
        assert theirs.state_labels == list(model.state_names) and theirs.output_labels == ["tip", "acc"]
        back = LinearModel.from_control(theirs)
        assert back.dt == one.dt and back.input_names == ("force",)
        for name in "ABCD":
            np.testing.assert_array_equal(getattr(back, name), getattr(one, name))
    assert model.to_control(disturbances=True).input_labels == ["force", "w1"]
    with pytest.raises(ValueError, match=r"system\.dt = True"):
        LinearModel.from_control(control.ss([[0.5]], [[1]], [[1]], [[0]], True))


def gain_error(model, reduced):
    """Largest singular value of the difference of frequency responses."""
    worst = 0.0
    for w in np.logspace(-2, 3, 800):
        s = 1j * w if model.dt is None else np.exp(1j * np.pi * w / 1e3)
        one, two = (m.C @ np.linalg.solve(s * np.eye(len(m.A)) - m.A, np.hstack([m.B, m.E])) for m in (model, reduced))
        worst = max(worst, np.linalg.norm(one - two, 2))
    return worst


@pytest.mark.every(3)
@pytest.mark.parametrize("dt", [None, 0.05])
@pytest.mark.parametrize("method", ["balanced", "modal"])
@pytest.mark.parametrize("order", [2, 4])
def test_reduction_stays_within_its_bound(method, order, dt):
    model = chain(d=2.0)
    model = model if dt is None else model.discretize(dt)
    reduced = model.reduce(order, method)
    error = gain_error(model, reduced)
    assert len(reduced.states) == order
    assert 1e-6 < error <= reduced.error_bound * (1 + 1e-9)
    assert reduced.error_bound < 20 * error


def test_hankel_values_are_those_of_the_hankel_matrix():
    model = chain(d=6.0).discretize(0.1)
    B = np.hstack([model.B, model.E])
    response, power = [], B
    for _ in range(399):
        response.append(model.C @ power)
        power = model.A @ power
    hankel = np.block([[response[i + j] for j in range(200)] for i in range(200)])
    expected = np.linalg.svd(hankel, compute_uv=False)[:6]
    assert model.reduce(3).error_bound == pytest.approx(2 * expected[3:].sum(), rel=1e-6)
    assert model.reduce(5, "balanced").error_bound == pytest.approx(2 * expected[5], rel=1e-6)


def test_modal_reduction_of_two_poles():
    # 100 / ((s + 1) (s + 10)) = 100/9 (1/(s + 1) - 1/(s + 10)); the second part is largest at rest, 100/90
    model = LinearModel.from_matrices([[-1.0, 100.0], [0.0, -10.0]], [[0.0], [1.0]], [[1.0, 0.0]])
    reduced = model.reduce(1, "modal")
    assert (reduced.A[0, 0], (reduced.C @ reduced.B)[0, 0]) == pytest.approx((-1.0, 100 / 9))
    assert reduced.error_bound == pytest.approx(100 / 90)


def test_modal_reduction_keeps_free_motion():
    model = chain()
    A = np.array(model.A)
    A[3:, :3] = -40 * (2 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1) - np.diag([1, 0, 1]))
    A[3:, 3:] = 0.01 * A[3:, :3]
    free = LinearModel.from_matrices(A, model.B, model.C[:1])
    with pytest.raises(ValueError, match="take method='modal'"):
        free.reduce(2)
    with pytest.raises(ValueError, match="order = 3 must be one of 2, 4, 6"):
        free.reduce(3, "modal")
    reduced = free.reduce(2, "modal")
    np.testing.assert_allclose(reduced.eigenvalues, 0, atol=1e-6)
    t = np.linspace(0, 50, 11)
    full, small = (m.simulate(np.zeros(len(m.A)), [1.0], t)[1][-1, 0] for m in (free, reduced))
    assert small == pytest.approx(full, rel=1e-4)


@pytest.mark.parametrize("dt", [None, 0.01])
def test_modal_reduction_of_an_undamped_model_keeps_the_slow_modes(dt):
    model = chain(d=0.0)
    kept = sorted(mode.frequency_hz for mode in model.modes())[:2]
    reduced = (model if dt is None else model.discretize(dt)).reduce(4, "modal")
    np.testing.assert_allclose([mode.frequency_hz for mode in reduced.modes()], kept, rtol=1e-9)
    assert reduced.error_bound == np.inf


@pytest.mark.parametrize("dt", [None, 0.01])
def test_modal_reduction_keeps_a_fast_mode_that_grows(dt):
    model = LinearModel.from_matrices(np.diag([-1.0, -2.0, 9.0]), np.ones((3, 1)))
    reduced = (model if dt is None else model.discretize(dt)).reduce(1, "modal")
    assert reduced.modes()[0].eigenvalue == pytest.approx(9.0)


def test_reduced_model_keeps_the_nominal_rate():
    model = with_rate(chain(d=2.0), np.arange(6.0))
    reduced = model.reduce(6)
    t = np.linspace(0, 3, 20)
    _, y = model.simulate(np.zeros(6), None, t)
    _, z = reduced.simulate(np.zeros(6), None, t)
    np.testing.assert_allclose(y, z, atol=1e-8)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"A": np.zeros((2, 3))}, r"LinearModel\.A has shape \(2, 3\), must be \(6, 6\)"),
        ({"B": np.full((6, 1), np.nan)}, r"LinearModel\.B\[0, 0\] = nan must be finite"),
        ({"f0": np.zeros(5)}, r"LinearModel\.f0 has shape \(5,\), must be \(6,\)"),
        ({"dt": 0.0}, r"LinearModel\.dt = 0\.0 must be > 0"),
        ({"inputs": (Signal("a", ""), Signal("a", ""))}, r"LinearModel\."),
    ],
)
def test_bad_input(change, message):
    fields = {name: getattr(chain(), name) for name in LinearModel.__dataclass_fields__}
    with pytest.raises(ValueError, match=message):
        LinearModel(**{**fields, **change})


def test_bad_calls():
    model = chain()
    with pytest.raises(ValueError, match=r"discretize\.dt = -1 must be > 0"):
        model.discretize(-1)
    with pytest.raises(ValueError, match=r"LinearModel\.dt = 0\.1 must be None"):
        model.discretize(0.1).discretize(0.1)
    with pytest.raises(ValueError, match=r"order' = 7|order = 7 must be an integer from 1 to 6"):
        model.reduce(7)
    with pytest.raises(ValueError, match="one of 'balanced', 'modal'"):
        model.reduce(2, "magic")
    with pytest.raises(ValueError, match=r"simulate\.du has shape \(2,\)"):
        model.simulate(np.zeros(6), [1.0, 2.0], [0, 1])
    with pytest.raises(ValueError, match=r"simulate\.t\[1\] = 0 must be greater"):
        model.simulate(np.zeros(6), None, [0, 0])


def test_arrays_are_own_and_write_protected():
    A = np.zeros((2, 2))
    model = LinearModel.from_matrices(A, np.ones((2, 1)))
    A[0, 0] = 5.0
    assert model.A[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        model.A[0, 0] = 1.0
    assert LTVModel.__name__ == "LTVModel"
    np.testing.assert_allclose(expm(model.A), np.eye(2))
