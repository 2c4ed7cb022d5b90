"""How far outputs are pushed, against closed forms and the model's own simulation."""

import dataclasses

import numpy as np
import pytest
from horizon_models import constant, made, random_ltv

from pliant.plants.finite_horizon import finite_horizon

DOUBLE = ([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0], [0.0, 1.0]])


def test_a_mass_that_is_pushed():
    """x'' = w, over T: position sqrt(T^3/3) and speed sqrt(T) by unit energy; T^2/2 and T by |w| <= 1."""
    span = 2.0
    found = finite_horizon(constant(*DOUBLE, span))
    wanted = {"peak": (span**1.5 / 3**0.5, span**0.5), "bounded": (span**2 / 2, span)}
    for kind, values in wanted.items():
        for one, value in zip(getattr(found, kind).values(), values, strict=True):
            assert one.lower == pytest.approx(value, rel=1e-4) and value <= one.upper * (1 + 1e-9) <= 1.01 * value
            assert one.time == span
    assert found.end["z1"].lower == found.peak["z1"].lower
    low, high = found.tube["z1"].T
    np.testing.assert_array_equal(low, -high)
    assert (high >= found.t**2 / 2 * (1 - 1e-12)).all() and (high - found.t**2 / 2).max() < 1e-5 * span**2
    np.testing.assert_allclose(found.from_start["z1"], np.hypot(1.0, found.t), rtol=1e-9)


def test_an_oscillator_under_bounded_force():
    """x'' + x = w, |w| <= 1: each half swing adds 2, so that 2 k at t = k pi."""
    found = finite_horizon(constant([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], 4 * np.pi, nodes=801))
    push = found.bounded["z1"]
    assert push.lower == pytest.approx(8.0, rel=1e-3) and push.lower < 8.0 <= push.upper < 8.08


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
    found = finite_horizon(model, scale={"w1": 2.0, "z1": 0.1}, limits={"w1": 3.0})
    for kind in ("end", "peak", "bounded"):
        for name, push in getattr(found, kind).items():
            row, at = model.output_names.index(name), int(np.flatnonzero(model.t == push.time)[0])
            z = model.simulate(np.zeros(model.A.shape[1]), None, push.disturbance)[1]
            assert z[at, row] == pytest.approx(push.lower, rel=1e-6)
            through = np.abs(model.F[:, row]).max() > 0 and kind != "bounded"
            assert push.upper == np.inf if through else push.lower <= push.upper <= 1.01 * push.lower
    assert np.abs(found.bounded["z1"].disturbance[:, 0]).max() == 3.0
    assert found.end["z1"].time == model.t[-1]


def test_sizes_of_outputs_only_scale():
    one, other = finite_horizon(random_ltv(1)), finite_horizon(random_ltv(1), scale={"z1": 0.5})
    assert other.peak["z1"].lower == pytest.approx(one.peak["z1"].lower, rel=1e-12)


def test_a_fast_swing_stays_below_its_bound():
    """An oscillator of 100 rad/s under |w| <= 1 for 1 s: held disturbances lose where the effect changes its sign."""
    found = finite_horizon(constant([[0.0, 1.0], [-1e4, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], 1.0)).bounded["z1"]
    s = np.linspace(0.0, 1.0, 2_000_001)
    true = np.trapezoid(np.abs(np.sin(100 * s)) / 100, s)
    assert found.lower < true <= found.upper < 1.01 * true


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_units_of_states_change_nothing(unit):
    model = random_ltv(2)
    scale = np.ones(model.A.shape[1])
    scale[0] = unit
    other = dataclasses.replace(
        model, A=model.A * scale / scale[:, None], E=model.E / scale[:, None], C=model.C * scale, x=model.x / scale
    )
    one, two = finite_horizon(model), finite_horizon(other)
    assert two.l2.lower == pytest.approx(one.l2.lower, rel=1e-6) and two.l2.upper == pytest.approx(
        one.l2.upper, rel=1e-6
    )
    for kind in ("peak", "bounded"):
        for a, b in zip(getattr(one, kind).values(), getattr(two, kind).values(), strict=True):
            assert b.lower == pytest.approx(a.lower, rel=1e-9) and b.upper == pytest.approx(a.upper, rel=1e-6)


@pytest.mark.parametrize("nodes", [3, 12])
def test_an_output_that_is_sensitive_for_a_moment(nodes):
    """dx/dt = -x + w, z = C x, C five times as large for a few nodes: at their peak, between two of them."""
    t = np.linspace(0.0, 4.0, 481)
    one = np.ones((481, 1, 1))

    def sensitivity(at):
        return 1 + 4 * np.exp(-(((at - 2.0049) / (nodes * t[1])) ** 2))

    fine = np.linspace(1.9, 2.1, 20001)
    found = finite_horizon(made(t, -one, one, sensitivity(t)[:, None, None], 0 * one))
    bounded = (sensitivity(fine) * (1 - np.exp(-fine))).max()
    by_energy = (sensitivity(fine) * np.sqrt((1 - np.exp(-2 * fine)) / 2)).max()
    assert bounded * (1 - 1e-3) < found.bounded["z1"].upper < 1.02 * bounded
    assert by_energy * (1 - 1e-6) < found.peak["z1"].upper < 1.01 * by_energy
    passed = finite_horizon(made(t, -one, one, 0 * one, sensitivity(t)[:, None, None]))
    assert passed.bounded["z1"].upper > 4.99 and passed.l2.upper > 4.99
