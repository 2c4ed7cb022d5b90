"""Shapers against their closed forms, published fits, and exact responses of an elastic arm."""

import dataclasses

import numpy as np
import pytest
from evidence import agrees

from pliant.controllers.joint_control.input_shaping import Shaper, light, shape, shaper, shaper_for, switches
from pliant.plants import LinearModel, Payload, SingleLinkArm

RATIOS = np.linspace(0.4, 1.6, 25)


@pytest.mark.parametrize(("kind", "power"), [("zv", 1), ("zvd", 2), ("zvdd", 3)])
def test_undamped_sensitivity_curve(kind: str, power: int) -> None:
    """V = |cos(pi/2 w/w0)|^n, Singer and Seering (1990)."""
    found = shaper(7.0, kind=kind).residual(7.0 * RATIOS)
    agrees(
        found,
        np.abs(np.cos(np.pi / 2 * RATIOS)) ** power,
        within=1e-14,
        absolute=True,
        of="shape",
        what=f"what {kind} leaves of a mode at 0.4 to 1.6 times its frequency",
        source="Singer and Seering (1990)",
        kind="closed form",
    )


@pytest.mark.parametrize("kind", ["zv", "zvd", "zvdd"])
@pytest.mark.parametrize("damping", [0.01, 0.1, 0.5])
def test_damped_mode_is_left_at_rest(kind: str, damping: float) -> None:
    assert shaper(3.0, damping, kind).residual(3.0, damping) < 1e-15


@pytest.mark.parametrize("damping", [0.0, 0.01, 0.05, 0.1, 0.2, 0.3])
def test_extra_insensitive_matches_published_fit(damping: float) -> None:
    """Singhose, Seering and Singer (1994): polynomial fits, V = 0.05; they hold to about 0.5 % up to 0.2."""
    V, z = 0.05, damping
    found = shaper(1.0, z, "ei", tolerance=V)
    t2 = 0.499899 + 0.461586 * V * z + 4.26169 * V * z**2 + 1.75601 * V * z**3
    t2 += 8.57843 * V**2 * z - 108.644 * V**2 * z**2 + 336.989 * V**2 * z**3
    A1 = 0.249684 + 0.249623 * V + 0.800081 * z + 1.23328 * V * z + 0.495987 * z**2 + 3.17316 * V * z**2
    A3 = 0.251489 + 0.21474 * V - 0.832493 * z + 1.41498 * V * z + 0.851806 * z**2 - 4.90094 * V * z**2
    period = 2 * np.pi / np.sqrt(1 - z**2)
    near = 2.5e-3 if z <= 0.1 else 1.5e-2
    told = {"of": "shape", "source": "Singhose, Seering and Singer (1994), fits", "kind": "table", "absolute": True}
    what = f"extra-insensitive shaper at damping {z:g}"
    agrees(found.times[1] / period, t2, within=near, what=f"time of the second impulse, {what}", **told)
    agrees(found.amplitudes[[0, 2]], [A1, A3], within=2e-3, what=f"impulses, {what}", **told)
    assert found.residual(1.0, z) == pytest.approx(V, abs=1e-12)
    curve = found.residual(np.linspace(0.7, 1.3, 6001), z)
    assert curve[:3000].min() < 1e-3 and curve[3001:].min() < 1e-3  # a zero on either side ..
    wide = np.ptp(np.linspace(0.7, 1.3, 6001)[curve <= V + 1e-9])
    narrow = np.ptp(np.linspace(0.7, 1.3, 6001)[shaper(1.0, z, "zvd").residual(np.linspace(0.7, 1.3, 6001), z) <= V])
    assert wide > 1.1 * narrow  # .. and wider than ZVD; undamped 0.398 against 0.286


def arm(E: float = 1.0) -> SingleLinkArm:
    own = SingleLinkArm.textbook()
    link = dataclasses.replace(own.link, damping=0.0, E=own.link.E * E)
    return dataclasses.replace(own, link=link, kinematics="linear", modes=2, payload=Payload(mass=0.5))


def vibration(plant: SingleLinkArm, command: list) -> np.ndarray:
    """Amplitude of each elastic mode after a torque of steps, over that after one step of 1 N m: exact linear steps."""
    model = plant.linearize(np.zeros(plant.nx))
    t = np.array([time for time, _ in command] + [command[-1][0] + 1.0])
    du = np.array([value for _, value in command] + [command[-1][1]])
    values, left = np.linalg.eig(model.A.T)
    x = np.zeros(plant.nx)
    for k in range(len(command)):
        step = model.discretize(t[k + 1] - t[k])
        x = step.A @ x + step.B @ du[k]
    chosen = [int(np.argmin(np.abs(values - s))) for s in light(model.eigenvalues)]
    return np.abs(left[:, chosen].T @ x * values[chosen] / (left[:, chosen].T @ model.B[:, 0]))


def rest_to_rest(torque: float = 2.0, time: float = 0.8) -> list:
    return [(0.0, np.array([torque])), (time, np.array([-torque])), (2 * time, np.array([0.0]))]


def from_rest(command: list) -> list:
    """The same command with the step at its start, as `switches` wants it."""
    return [(0.0, np.zeros(1)), *((t + 1e-9, v) for t, v in command)]


@pytest.mark.parametrize("kind", ["zv", "zvd"])
def test_rest_to_rest_leaves_no_vibration_at_the_modelled_frequency(kind: str) -> None:
    plant = arm()
    found = shaper_for(plant.linearize(np.zeros(plant.nx)), kind)
    before = vibration(plant, from_rest(rest_to_rest()))
    after = vibration(plant, switches(from_rest(rest_to_rest()), found))
    assert before.min() > 0.05
    assert (after / before).max() < 1e-10


@pytest.mark.parametrize("E", [0.8, 0.95, 1.1, 1.3])
def test_off_the_modelled_frequency_it_follows_the_zvd_curve(E: float) -> None:
    plant, real = arm(), arm(E)
    modelled = light(plant.linearize(np.zeros(plant.nx)).eigenvalues)[0]
    actual = abs(light(real.linearize(np.zeros(real.nx)).eigenvalues)[0])
    command = from_rest(rest_to_rest())
    share = (vibration(real, switches(command, shaper_for([modelled]))) / vibration(real, command))[0]
    assert share == pytest.approx(np.cos(np.pi / 2 * actual / abs(modelled)) ** 2, rel=1e-7)


def test_several_modes_are_one_after_the_other() -> None:
    both = shaper_for([5.0, 13.0], "zv")
    assert both.duration == pytest.approx(np.pi / 5 + np.pi / 13)
    assert both.residual(np.array([5.0, 13.0])).max() < 1e-15
    merged = Shaper(np.array([0.0, 1.0]), np.array([0.5, 0.5])) * Shaper(np.array([0.0, 1.0]), np.array([0.5, 0.5]))
    np.testing.assert_allclose(merged.times, [0, 1, 2])
    np.testing.assert_allclose(merged.amplitudes, [0.25, 0.5, 0.25])


def test_shaped_function_and_steps_agree() -> None:
    steps = from_rest(rest_to_rest())
    by = shaper(20.0, 0.03)
    smooth = by(lambda t: next((v for s, v in reversed(steps) if t >= s), np.zeros(1)))
    for t, value in switches(steps, by)[1:]:
        np.testing.assert_allclose(smooth(t + 1e-12), value, atol=1e-12)


def test_shape_is_the_command_through_the_shaper() -> None:
    shaped = shape(lambda t: np.sin(t), [20.0 + 0.0], "zv")
    assert shaped(1.0) == pytest.approx((np.sin(1.0) + np.sin(1.0 - np.pi / 20)) / 2)


def test_modes_of_a_model_with_damping_are_read() -> None:
    own = SingleLinkArm.textbook()
    damped = dataclasses.replace(own, link=dataclasses.replace(own.link, damping=2e-4))
    model = damped.linearize(np.zeros(damped.nx))
    found = shaper_for(model, "zvd", most=1)
    mode = next(m for m in model.modes() if m.frequency_hz > 0.1)
    assert found.residual(2 * np.pi * mode.frequency_hz, mode.damping_ratio) < 1e-12


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: shaper(0.0), "frequency = 0.0 must be > 0"),
        (lambda: shaper(1.0, 1.0), "damping = 1.0 must be >= 0 and < 1"),
        (lambda: shaper(1.0, kind="zvx"), "kind = 'zvx'"),
        (lambda: shaper(1.0, kind="ei", tolerance=0.0), "tolerance = 0.0 must be > 0 and < 1"),
        (lambda: shaper_for([]), "at least one mode"),
        (lambda: shaper_for([1.0 + 2.0j]), "grows at 1 1/s"),
        (lambda: Shaper(np.array([0.1]), np.array([1.0])), "must start at 0"),
        (lambda: Shaper(np.array([0.0]), np.array([0.9])), "must sum to 1"),
    ],
)
def test_bad_input(call, words: str) -> None:
    with pytest.raises(ValueError, match=words.replace("(", r"\(")):
        call()


@pytest.mark.parametrize("dt", [0.82, 0.1, 1e-3])
@pytest.mark.parametrize("kind", ["zv", "zvd"])
def test_a_sampled_model_is_shaped_as_the_continuous_one(dt, kind):
    """Two modes, 2 rad/s and 3 rad/s, slower than half the sampling rate; closed form of sampling: z = exp(s dt)."""
    A = np.zeros((4, 4))
    A[:2, :2], A[2:, 2:] = [[0, 1], [-4, -0.04]], [[0, 1], [-9, -0.06]]
    model = LinearModel.from_matrices(A, [[0], [1.0], [0], [1.0]])
    expected = shaper_for([complex(-0.02, np.sqrt(4 - 4e-4)), complex(-0.03, np.sqrt(9 - 9e-4))], kind)
    found = shaper_for(model.discretize(dt), kind)
    np.testing.assert_allclose(found.times, expected.times, rtol=1e-9)
    np.testing.assert_allclose(found.amplitudes, expected.amplitudes, rtol=1e-9)


def test_what_only_alternates_from_sample_to_sample_has_no_frequency():
    """z = -0.99: no continuous pair gives it."""
    model = LinearModel.from_matrices([[-0.99]], [[1.0]], dt=0.1)
    with pytest.raises(ValueError, match="at least one mode that oscillates"):
        shaper_for(model)


@pytest.mark.parametrize("dt", [None, 0.01])
def test_a_model_that_oscillates_with_much_damping_is_told_so_and_its_modes_are_shaped(dt):
    """x'' + 2 z w x' + w^2 x = u with w = 50 rad/s, z = 0.3; ZV's closed form: half a damped period."""
    w, z = 50.0, 0.3
    model = LinearModel.from_matrices([[0, 1], [-(w**2), -2 * z * w]], [[0], [1.0]])
    model = model if dt is None else model.discretize(dt)
    with pytest.raises(ValueError, match=r"shaper_for\.modes .* ratio below 0\.2; the least of this model is 0\.3:"):
        shaper_for(model)
    times = shaper_for([complex(-z * w, w * np.sqrt(1 - z**2))], "zv").times
    np.testing.assert_allclose(times, [0.0, np.pi / (w * np.sqrt(1 - z**2))], rtol=1e-12)


def test_a_model_without_oscillation_is_told_of_no_ratio():
    model = LinearModel.from_matrices([[0, 1.0], [0, -3.0]], [[0], [1.0]])
    with pytest.raises(ValueError, match=r"at least one mode that oscillates$"):
        shaper_for(model)


@pytest.mark.parametrize("value", ["1.0", "", [None], float("nan"), 1j])
def test_a_command_that_gives_no_number_is_refused_when_called(value):
    with pytest.raises(ValueError, match=r"Shaper\.command\(t\)"):
        shape(lambda t: value, [4.0])(0.5)
