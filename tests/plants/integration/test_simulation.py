"""Simulations: where they start, which steps and times are none, what comes with a motion and where it stops."""

import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import IntegrationError, LargeDeflectionBeam, SingleLinkArm, TwoLinkArm
from pliant.plants.core.errors import NotFiniteWarning
from pliant.plants.motions import adaptive_steps
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

ARM, CRAFT = SingleLinkArm.textbook(), FlexibleSpacecraft.textbook()
TIMES = np.linspace(0.0, 0.1, 3)


@pytest.mark.parametrize("plant", [ARM, LargeDeflectionBeam.textbook(), CRAFT], ids=["arm", "beam", "craft"])
def test_without_a_state_it_starts_at_rest(plant):
    motion = plant.simulate(None, None, TIMES)
    np.testing.assert_array_equal(motion.x[0], plant.rest_state)
    plant.check_state(plant.rest_state)
    assert np.isfinite(motion.x).all()


def test_the_rest_of_a_craft_is_a_turn_by_nothing():
    names = [s.name for s in CRAFT.states]
    assert CRAFT.rest_state[names.index("quaternion_0")] == 1.0 and np.abs(CRAFT.rest_state).sum() == 1.0


@pytest.mark.parametrize(
    ("step", "message"),
    [
        (1e-300, r"step = 1e-300 s makes 1e\+299 steps of the 0\.1 s of t, at most 100,000,000 are taken"),
        (5e-324, r"step = 4\.94066e-324 s makes inf steps"),
        (float("nan"), r"step = nan must be > 0 \[s\]"),
        (-1.0, r"step = -1\.0 must be > 0 \[s\]"),
        (True, r"step = True must be > 0 \[s\]"),
    ],
)
def test_absurd_steps_are_refused_with_their_number(step, message):
    with pytest.raises(ValueError, match=message):
        ARM.simulate(None, None, TIMES, method="rk4", step=step)


def test_an_adaptive_motion_that_takes_too_many_steps_stops(monkeypatch):
    monkeypatch.setattr(adaptive_steps, "MOST_STEPS", 5)
    with pytest.raises(IntegrationError, match=r"dop853 stopped at t = .* s after 5 steps, the last of") as stopped:
        ARM.simulate(np.full(ARM.nx, 0.1), None, [0.0, 5.0])
    assert 0 < stopped.value.time < 5.0 and stopped.value.state.shape == (ARM.nx,)


class Still:
    """A controller that does nothing, often."""

    def __init__(self, dt):
        self.dt = dt

    def act(self, t, y):
        return np.zeros(1)


@pytest.mark.parametrize("dt", [1e-300, 1e-9])
def test_a_controller_that_samples_too_often_is_refused(dt):
    with pytest.raises(ValueError, match=r"controller dt = 1e-\d+ s makes .* samples of the 0\.1 s of t, at"):
        ARM.simulate(None, Still(dt), TIMES)


@pytest.mark.parametrize(
    ("plant", "call"),
    [
        (CRAFT, "dynamics"),
        *((plant, call) for plant in (ARM, CRAFT) for call in ("jacobians", "energy", "mass_matrix")),
    ],
    ids=lambda value: value if isinstance(value, str) else type(value).__name__,
)
def test_what_is_not_finite_is_said(plant, call):
    x = np.tile(plant.rest_state, (2, 1))
    x[1] += 1e200  # its square overflows
    with pytest.warns(NotFiniteWarning, match=rf"\.{call}: \d+ of \d+ entries are not finite, first .*\[1"):
        getattr(plant, call)(x)


@pytest.mark.parametrize("method", ["dop853", "rodas5p", "radau", "cvodes"])
def test_a_plant_that_turns_into_nan_stops_with_time_and_state(method):
    with pytest.raises(IntegrationError) as caught:
        Scalar(ends=True).simulate([0.0], None, np.linspace(0, 2, 5), method=method)
    assert 0 <= caught.value.time <= 0.5 and np.all(np.isfinite(caught.value.state))


def test_exact_rate_comes_with_the_motion():
    motion = Oscillator().simulate([1.0, 0.0], None, np.linspace(0, 1, 5), w=[3.0])
    t = motion.t
    np.testing.assert_allclose(motion.x[:, 0], 0.03 + 0.97 * np.cos(10 * t), atol=1e-8)
    np.testing.assert_allclose(motion.dx[:, 1], -97 * np.cos(10 * t), atol=1e-6)
    np.testing.assert_array_equal(motion.w, np.full((5, 1), 3.0))


def test_start_at_an_exact_equilibrium_does_not_run_away():
    """Every error estimate is zero there, and a first step as long as the run would overlook what comes."""
    arm = TwoLinkArm.textbook()
    x0, u0 = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)

    def push(t):
        return u0 + np.array([1.0, 0.0]) if 1.0 <= t < 1.02 else u0

    rtol, atol = 1e-10, 1e-12
    rest = arm.simulate(x0, u0, [0, 2], rtol=rtol, atol=atol)
    # Rounding of the gravity moments (1e-16 N m, not 0) sets the arm in motion, and what it does then is up to the
    # integrator: each step may err by its tolerance (a root mean square: sqrt(nx) in one state), and without damping
    # the steps' errors add up; a rate's are those of its coordinate times the highest angular frequency.
    allowed = rest.stats["steps"] * np.sqrt(arm.nx) * (atol + rtol * np.abs(x0).max())
    assert allowed < 1e-6
    np.testing.assert_allclose(rest.x[-1, :6], x0[:6], rtol=0, atol=allowed)
    fastest = arm.natural_frequencies(x0).max()
    np.testing.assert_allclose(rest.x[-1, 6:], 0, rtol=0, atol=allowed * fastest)
    moved = arm.simulate(x0, push, [0, 2], rtol=rtol, atol=atol)
    assert np.abs(moved.x[-1, :6] - x0[:6]).max() > 1e3 * allowed


def test_progress_is_told_of_the_time_reached():
    seen = []
    SingleLinkArm.textbook().simulate(np.zeros(6), [1.0], np.linspace(0, 0.1, 5), progress=seen.append)
    np.testing.assert_allclose(seen, np.linspace(0, 0.1, 5)[1:])
