"""What a simulation takes and refuses before it begins: where it starts, how many steps, which times are none."""

import numpy as np
import pytest

from pliant.plants import IntegrationError, LargeDeflectionBeam, SingleLinkArm
from pliant.plants.core.errors import NotFiniteWarning
from pliant.plants.integration import dormand_prince
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
    monkeypatch.setattr(dormand_prince, "MOST_STEPS", 5)
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
