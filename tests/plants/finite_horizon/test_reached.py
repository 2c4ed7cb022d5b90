"""How far outputs are pushed, against closed forms and the model's own simulation."""

import numpy as np
import pytest
from horizon_models import constant, random_ltv

from pliant.plants.finite_horizon import finite_horizon

DOUBLE = ([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0], [0.0, 1.0]])


def test_a_mass_that_is_pushed():
    """x'' = w, over T: position sqrt(T^3/3) and speed sqrt(T) by unit energy; T^2/2 and T by |w| <= 1."""
    span = 2.0
    found = finite_horizon(constant(*DOUBLE, span))
    for push, wanted in (
        (found.furthest, (span**1.5 / 3**0.5, span**0.5)),
        (found.furthest_bounded, (span**2 / 2, span)),
    ):
        for one, value in zip(push, wanted, strict=True):
            assert one.lower == pytest.approx(value, rel=1e-4) and value <= one.upper * (1 + 1e-9) <= 1.01 * value
            assert one.time == span
    np.testing.assert_allclose(found.by_energy[:, 0], found.t**1.5 / 3**0.5, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.from_start[:, 0], np.hypot(1.0, found.t), rtol=1e-9)


def test_an_oscillator_under_bounded_force():
    """x'' + x = w, |w| <= 1: each half swing adds 2, so that 2 k at t = k pi."""
    found = finite_horizon(constant([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], 4 * np.pi, nodes=801))
    (push,) = found.furthest_bounded
    assert push.lower == pytest.approx(8.0, rel=1e-4) and 8.0 <= push.upper * (1 + 1e-9) < 8.01


def test_noise_spreads_as_a_random_walk():
    """x'' = noise: speed sqrt(t), position sqrt(t^3/3); a start that is uncertain by s adds s^2."""
    found = finite_horizon(constant(*DOUBLE, 2.0)).deviation({"w1": 0.3}, {"x1": 0.1, "x2": 0.2})
    wanted = np.hypot(0.3 * 2.0**1.5 / 3**0.5, np.hypot(0.1, 0.4)), np.hypot(0.3 * 2**0.5, 0.2)
    np.testing.assert_allclose(found[-1], wanted, rtol=1e-9)
    with pytest.raises(ValueError, match=r"deviation.intensity\['w1'\] = -1"):
        finite_horizon(constant(*DOUBLE, 2.0)).deviation({"w1": -1.0})


@pytest.mark.parametrize("seed", range(4))
def test_the_disturbances_push_as_far_as_told(seed):
    model = random_ltv(seed)
    found = finite_horizon(model, scale={"w1": 2.0, "z1": 0.1})
    for push in (*found.furthest, *found.furthest_bounded):
        w, row = push.disturbance, [s.name for s in model.outputs].index(push.output.name)
        z = model.simulate(np.zeros(model.A.shape[1]), None, w)[1]
        at = int(np.flatnonzero(model.t == push.time)[0])
        assert z[at, row] == pytest.approx(push.lower, rel=1e-6)
        through = np.abs(model.F[:, row]).max() > 0 and push in found.furthest
        assert push.upper == np.inf if through else push.lower <= push.upper * (1 + 1e-9) <= 1.01 * push.lower
    assert np.abs(found.furthest_bounded[0].disturbance[:, 0]).max() == 2.0


def test_units_of_disturbances_and_outputs_only_scale():
    one, other = finite_horizon(random_ltv(1)), finite_horizon(random_ltv(1), scale={"z1": 0.5})
    assert other.furthest[0].lower == pytest.approx(one.furthest[0].lower, rel=1e-12)
