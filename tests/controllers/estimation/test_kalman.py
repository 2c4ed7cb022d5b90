"""The Kalman filter against closed forms, python-control and Monte Carlo; LQG's separation."""

import dataclasses

import control
import numpy as np
import pytest
from evidence import agrees
from scipy.stats import chi2

from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.process_noise import process_noise
from pliant.controllers.estimation.sensors import Sensor, sensors_of
from pliant.envs import scenes
from pliant.plants import LinearModel, LTVModel, SingleLinkArm, UncontrollableError

SCENE = scenes.get("single-link-slew")
ARM = dataclasses.replace(SCENE.plant, modes=1)
DOUBLE = LinearModel.from_matrices(
    [[0, 1], [0, 0]], [[0], [1]], [[1, 0]], E=[[0], [1]], states=["x", "v"], disturbances=["a"], outputs=["seen"]
)


def seen(noise, output="seen"):
    return (Sensor("other", output, "", noise=noise),)


def arm_model():
    return ARM.linearize(np.zeros(ARM.nx), np.zeros(1))


@pytest.mark.parametrize("index", [0.1, 1.0, 5.0])
def test_alpha_beta_filter(index):
    """Kalata 1984, "The tracking index": acceleration constant in each T, index = sigma_w T^2/sigma_v."""
    T, v = 0.25, 0.3
    w = index * v / T**2
    r = (4 + index - np.sqrt(8 * index + index**2)) / 4
    alpha = 1 - r**2
    beta = 2 * (2 - alpha) - 4 * np.sqrt(1 - alpha)
    found = Kalman.design(DOUBLE, seen(v), {"a": w**2 * T}, dt=T, noise="held")
    agrees(
        [*found.gains[-1].L[:, 0], found.covariance[0, 0]],
        [alpha, beta / T, alpha * v**2],
        within=1e-9,
        of="Kalman",
        what=f"gains and variance of the alpha-beta filter, tracking index {index:g}",
        source="Kalata (1984)",
        kind="closed form",
    )


def test_random_walk():
    """Local level model: P- = (q + sqrt(q^2 + 4 q r))/2 (Harvey 1989, Section 4.1)."""
    model = LinearModel.from_matrices([[0.0]], [[0.0]], [[1.0]], E=[[1.0]], outputs=["seen"])
    W, v, dt = 0.7, 0.2, 0.1
    q, r = W * dt, v**2
    before = (q + np.sqrt(q**2 + 4 * q * r)) / 2
    found = Kalman.design(model, seen(v), {"w1": W}, dt=dt)
    agrees(
        [found.gains[0].L[0, 0], found.innovation_covariance[0, 0]],
        [before / (before + r), before + r],
        within=1e-12,
        of="Kalman",
        what="gain and innovation of a random walk",
        source="Harvey (1989), section 4.1",
        kind="closed form",
    )


def test_python_control_agrees_without_feedthrough():
    model, dt = arm_model(), 0.02
    sensors = sensors_of(ARM)[:2]
    found = Kalman.design(model, sensors, {"tip_force_y": 1e-2, "hub_torque": 1e-3}, dt=dt)
    step = found.steps[0]
    _, P, _ = control.dlqe(step.A, step.G, step.C, step.W, step.V, method="scipy")
    gain = found.gains[0]
    np.testing.assert_allclose(gain.L, P @ step.C.T @ np.linalg.inv(step.C @ P @ step.C.T + step.V), rtol=1e-5)
    np.testing.assert_allclose(step.A @ gain.P @ step.A.T + step.G @ step.W @ step.G.T, P, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize("delay", [0, 2])
def test_steady_gain_is_the_limit_of_the_time_varying_one(delay):
    """With feedthrough of noise and input into the accelerometer."""
    model, dt, W = arm_model(), 0.02, {"tip_force_y": 1e-2, "hub_torque": 1e-3}
    sensors, P0 = sensors_of(ARM), np.diag([1e-2, 1e-4, 1.0, 1e-2])
    steady = Kalman.design(model, sensors, W, dt=dt, delay=delay)
    started = Kalman.design(model, sensors, W, dt=dt, delay=delay, P0=P0)
    t = dt * np.arange(400)
    many = {name: np.broadcast_to(getattr(model, name), (len(t), *getattr(model, name).shape)) for name in "ABECDF"}
    rest = {k: np.broadcast_to(getattr(model, f"{k}0"), (len(t), len(getattr(model, f"{k}0")))) for k in "xuy"}
    signals = {k: getattr(model, k) for k in ("states", "inputs", "disturbances", "outputs")}
    along = Kalman.along(
        LTVModel(t, **many, c=np.zeros((len(t), 4)), **rest, **signals), sensors, W, P0=P0, delay=delay
    )
    assert 10 < len(started.gains) < 400
    for other in (started, along):
        scale = np.sqrt(np.diag(steady.gains[0].P))
        np.testing.assert_allclose(
            other.gains[-1].P / scale / scale[:, None], steady.gains[0].P / scale / scale[:, None], atol=2e-9
        )
    np.testing.assert_allclose(along.gains[5].P, started.gains[5].P, rtol=1e-6, atol=1e-12)
    assert np.abs(steady.poles).max() < 1


def played(model, kalman, steps, rng, *, x0, P0, delay=0):
    """Errors (steps, nx) and innovations of the filter on its own model: noise held over each dt, known inputs."""
    wide = kalman.steps[0]
    nx, dt = len(model.states), kalman.dt
    held = model.discretize(dt)
    x = x0 + np.linalg.cholesky(P0) @ rng.normal(size=nx)
    kalman.reset(x0)
    at = [[s.name for s in model.outputs].index(name) for name in kalman.reads]
    C, D, F = model.C[at], model.D[at], model.F[at]
    u, w = np.zeros(1), np.zeros(2)
    errors, innovations, seen = [], [], []
    for k in range(steps):
        seen.append(C @ x + D @ u + F @ w)
        y = seen[max(k - delay, 0)] + rng.normal(size=len(at)) * np.sqrt(np.diag(wide.V))
        errors.append(kalman.step(y, u) - x)
        innovations.append(kalman.innovation)
        u = np.array([3 * np.sin(0.3 * k)])
        w = np.array([0.0, rng.normal() * np.sqrt(W["tip_force_y"] / dt)])
        x = held.A @ x + held.B @ u + held.E @ w
    return np.array(errors), np.array(innovations)


W = {"tip_force_y": 1e-2}
P0 = np.diag([1e-2, 1e-4, 1.0, 1e-2]) ** 2


@pytest.mark.every(2)
@pytest.mark.parametrize("delay", [0, 2])
def test_covariance_is_what_monte_carlo_sees(delay):
    """Normalised squared error, summed over runs, is chi-square with runs * nx degrees (99.9 % interval at each time).

    With the accelerometer: feedthrough of the known input and of the held noise count.
    """
    model = arm_model()
    kalman = Kalman.design(model, sensors_of(ARM), W, dt=0.02, delay=delay, P0=P0, noise="held")
    runs, steps, rng = 250, 40, np.random.default_rng(11)
    start = np.array([0.3, 0.0, -0.2, 0.0])
    all_errors = np.array([played(model, kalman, steps, rng, x0=start, P0=P0, delay=delay)[0] for _ in range(runs)])
    low, high = chi2.ppf([0.0005, 0.9995], runs * 4)
    for k in (3, 10, 20, 39):
        P = kalman.gains[min(k, len(kalman.gains) - 1)].P[:4, :4]
        total = np.einsum("ri,ij,rj->", all_errors[:, k], np.linalg.inv(P), all_errors[:, k])
        assert low < total < high, k
    each = all_errors[:, -1].std(axis=0) / np.sqrt(np.diag(kalman.gains[-1].P)[:4])
    np.testing.assert_allclose(each, 1, atol=3.3 / np.sqrt(2 * runs))


def test_innovations_are_white():
    """Autocorrelation at lags 1 to 20 within 1.96/sqrt(n) in 95 % of all (Mehra 1970); sum of squares chi-square."""
    model = arm_model()
    kalman = Kalman.design(model, sensors_of(ARM), W, dt=0.02, noise="held")
    n, rng = 4000, np.random.default_rng(3)
    _, innovations = played(model, kalman, n + 200, rng, x0=np.zeros(4), P0=P0)
    z = np.linalg.solve(np.linalg.cholesky(kalman.innovation_covariance), innovations[200:].T).T
    low, high = chi2.ppf([0.0005, 0.9995], z.size)
    assert low < (z**2).sum() < high
    outside = total = 0
    for lag in range(1, 21):
        correlation = z[lag:].T @ z[:-lag] / n
        outside += (np.abs(correlation) > 1.96 / np.sqrt(n)).sum()
        total += correlation.size
    assert outside < 0.1 * total
    careless = Kalman.design(model, sensors_of(ARM), {"tip_force_y": 1e-4}, dt=0.02, noise="held")
    _, innovations = played(model, careless, n + 200, np.random.default_rng(3), x0=np.zeros(4), P0=P0)
    assert (np.linalg.solve(np.linalg.cholesky(careless.innovation_covariance), innovations[200:].T) ** 2).sum() > high


@pytest.mark.campaign
@pytest.mark.every(2)
@pytest.mark.parametrize("delay", [0, 2])
def test_time_varying_filter_along_a_slew(delay):
    """Monte Carlo of the time-varying model about a motion that turns by a radian, with a push left over."""
    t = 0.02 * np.arange(61)
    arm = dataclasses.replace(ARM, gravity=9.81, kinematics="stiffened")
    x0, u0 = arm.equilibrium(hub_angle=-0.5)
    drive = np.array([u0 + 8 * np.sin(2 * np.pi * s / 1.2) for s in t])
    ltv = arm.linearize_along(arm.simulate(x0, drive, t))
    push = np.zeros_like(ltv.c)
    push[:, 2] = 0.5 * np.cos(3 * t)
    ltv = dataclasses.replace(ltv, c=ltv.c + push)
    kalman = Kalman.along(ltv, sensors_of(arm), W, P0=P0, delay=delay, noise="held")
    steps, rng, runs = ltv.discretize(), np.random.default_rng(5), 250
    at = [[s.name for s in arm.outputs].index(name) for name in kalman.reads]
    noise = np.sqrt(np.diag(kalman.steps[0].V))
    errors = []
    for _ in range(runs):
        x, w = np.linalg.cholesky(P0) @ rng.normal(size=4), np.zeros(2)
        kalman.reset()
        seen = []
        for k in range(len(t)):
            held = ltv.u[k - 1] if k else ltv.u[0]
            y = ltv.y[k] + ltv.C[k] @ x + ltv.D[k] @ (held - ltv.u[k]) + ltv.F[k] @ w
            seen.append(y[at])
            found = kalman.step(seen[max(k - delay, 0)] + noise * rng.normal(size=3), held) - ltv.x[k]
            if k == len(t) - 1:
                break
            w = np.array([0.0, rng.normal() * np.sqrt(W["tip_force_y"] / 0.02)])
            x = steps.A[k] @ x + steps.E[k] @ w + steps.c[k]
        errors.append(found - x)
    errors = np.array(errors)
    total = np.einsum("ri,ij,rj->", errors, np.linalg.inv(kalman.covariance), errors)
    low, high = chi2.ppf([0.0005, 0.9995], runs * 4)
    assert low < total < high


def test_a_late_sample_tells_less():
    model = arm_model()
    now, late = (Kalman.design(model, sensors_of(ARM), W, dt=0.02, delay=d) for d in (0, 2))
    assert (np.diag(late.covariance) > np.diag(now.covariance)).all()


def test_the_estimate_comes_to_the_true_state_of_the_nonlinear_plant():
    """Known inputs, no noise, from a wrong start; about an equilibrium under gravity, in absolute values."""
    arm = dataclasses.replace(ARM, gravity=9.81)
    x0, u0 = arm.equilibrium(hub_angle=0.2)
    kalman = Kalman.design(arm.linearize(x0, u0), sensors_of(arm), {"tip_force_y": 1e-2, "hub_torque": 1e-2}, dt=0.01)
    start = x0 + np.array([0.01, 0, 0, 0])
    t = 0.01 * np.arange(151)
    u = u0 + 0.2 * np.sin(3 * t)[:, None]
    motion = arm.simulate(start, u, t)
    at = [[s.name for s in arm.outputs].index(name) for name in kalman.reads]
    for k in range(len(t)):
        held = u[k - 1] if k else u0
        y = arm.measure(motion.x[k], held)[at]
        found = kalman.step(y, held)
    np.testing.assert_allclose(found, motion.x[-1], atol=2e-3)
    assert np.abs(found - motion.x[-1])[0] < 1e-4 < np.abs(motion.x[-1] - x0)[0]


def test_for_scene_takes_the_plants_sensors_limits_and_gusts():
    scene = dataclasses.replace(SCENE, gusts=(("tip_force_y", 3.0),))
    noise = process_noise(scene)
    assert noise == {"hub_torque": pytest.approx(0.4**2 * 0.02), "tip_force_y": pytest.approx(3.0 * 0.02)}
    craft = scenes.get("spacecraft-orbit")  # wheels of 0.02 N m
    torque = {name: value for name, value in process_noise(craft).items() if name.startswith("disturbance")}
    assert torque == dict.fromkeys((f"disturbance_{c}" for c in "xyz"), pytest.approx(2e-4**2 * craft.dt))
    found = Kalman.for_scene(scene)
    assert found.reads == ("hub_angle", "root_curvature", "tip_acceleration") and found.dt == scene.dt
    assert np.abs(found.poles).max() < 1


def test_modes_that_no_sensor_sees_are_named():
    with pytest.raises(UncontrollableError, match=r"mode 0\.00 Hz \(hub_angle\) cannot be seen by the sensors"):
        Kalman.design(arm_model(), sensors_of(ARM)[1:2], W, dt=0.02)
    quiet = dataclasses.replace(SingleLinkArm.textbook(), modes=1)
    with pytest.raises(UncontrollableError, match=r"is not driven by the noise W"):
        Kalman.design(quiet.linearize(np.zeros(4)), sensors_of(quiet), {"eta1": 1e-12}, dt=0.02)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"W": {}}, "W must name at least one"),
        ({"W": {"wind": 1.0}}, "'wind' must be one of tip_force_x, tip_force_y, hub_torque, hub_angle"),
        ({"W": {"tip_force_y": 0.0}}, r"W\['tip_force_y'\] = 0\.0 must be > 0"),
        ({"delay": -1}, "delay = -1"),
        ({"P0": -np.eye(4)}, r"P0 has eigenvalue -1"),
        ({"sensors": seen(1.0, "nose")}, "state or output 'nose' must be one of"),
        ({"model": arm_model().discretize(0.1)}, r"model\.dt = 0\.1 must be None"),
    ],
)
def test_bad_input(change, message):
    given = {"model": arm_model(), "sensors": sensors_of(ARM), "W": W, "dt": 0.02, **change}
    with pytest.raises(ValueError, match=message):
        Kalman.design(given.pop("model"), given.pop("sensors"), given.pop("W"), **given)


def test_bad_measurement_and_uneven_nodes():
    kalman = Kalman.design(arm_model(), sensors_of(ARM), W, dt=0.02)
    with pytest.raises(ValueError, match=r"Kalman\.y\[1\] = nan must be finite"):
        kalman.step(np.array([0.0, np.nan, 0.0]))
    motion = ARM.simulate(np.zeros(4), None, [0.0, 0.1, 0.3])
    with pytest.raises(ValueError, match="must be evenly spaced"):
        Kalman.along(ARM.linearize_along(motion), sensors_of(ARM), W, P0=P0)
