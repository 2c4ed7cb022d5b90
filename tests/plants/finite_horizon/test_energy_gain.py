"""Gains of energy against closed forms, the H-infinity norm and the model's own simulation."""

import numpy as np
import pytest
from horizon_models import constant, made, random_ltv
from scipy.optimize import brentq

from pliant.plants.finite_horizon import finite_horizon
from pliant.plants.finite_horizon.energy_gain import bounds, energy_gain
from pliant.plants.finite_horizon.stretches import Stretches


@pytest.mark.parametrize(("a", "span"), [(0.5, 1.0), (2.0, 3.0), (-0.4, 2.0)])
def test_a_first_order_lag_has_its_closed_form(a, span):
    """dx/dt = -a x + w, z = x: the worst w makes x = sin(omega t), tan(omega T) = -omega/a, g^-2 = a^2 + omega^2."""
    omega = brentq(lambda o: o * np.cos(o * span) + a * np.sin(o * span), 1e-6, np.pi / span)
    wanted = (a**2 + omega**2) ** -0.5
    found = finite_horizon(constant([[-a]], [[1.0]], [[1.0]], span)).l2
    assert found.lower <= wanted * (1 + 1e-9) <= found.upper * (1 + 1e-9)
    assert found.lower == pytest.approx(wanted, rel=1e-4) and found.gap < 0.01


def test_over_a_long_time_it_is_the_h_infinity_norm():
    """Of an oscillator with damping ratio d: 1/(2 d sqrt(1 - d^2)) of the static gain."""
    d, omega = 0.2, 3.0
    A, E, C = [[0.0, 1.0], [-(omega**2), -2 * d * omega]], [[0.0], [omega**2]], [[1.0, 0.0]]
    wanted = 1 / (2 * d * np.sqrt(1 - d**2))
    found = [finite_horizon(constant(A, E, C, span)).l2 for span in (4.0, 16.0, 64.0)]
    assert found[0].lower < found[1].lower < found[2].lower < wanted
    assert found[2].lower > 0.98 * wanted and found[2].gap < 0.01


def test_what_passes_through_counts():
    """z = w: the gain is one, and a static gain of two with it is three at most."""
    model = constant([[-1.0]], [[2.0]], [[1.0]], 50.0, F=[[1.0]])
    found = finite_horizon(model).l2
    assert 2.99 < found.lower <= 3.0 + 1e-9 and found.gap < 0.01


@pytest.mark.parametrize("seed", range(6))
def test_bounds_meet_and_the_disturbance_attains_the_lower(seed):
    model = random_ltv(seed)
    found = finite_horizon(model)
    w = found.l2.disturbance[:-1]
    assert found.l2.gap < 0.01
    np.testing.assert_array_equal(found.t, model.t)
    h = np.diff(model.t)
    assert (np.square(w) * h[:, None]).sum() == pytest.approx(1.0, rel=1e-9)
    fine = model.simulate(np.zeros(model.A.shape[1]), None, np.vstack([w, w[-1:]]))[1]
    # Of the outputs at the nodes: |z|^2 by the trapezoidal rule with both one-sided values where w passes through.
    jumps = np.einsum("kij,kj->ki", model.F[1:], w - np.vstack([w[1:], w[-1:]]))
    after, before = fine[:-1], fine[1:] + jumps
    energy = (h / 2 * (np.square(after).sum(axis=1) + np.square(before).sum(axis=1))).sum()
    assert np.sqrt(energy) == pytest.approx(found.l2.lower, rel=2e-4)


def test_no_gain_below_the_lower_is_shown():
    """The Riccati equation runs away before the start where the gain is larger."""
    model = random_ltv(3)
    on = Stretches(model, model.E, model.C, model.F)
    lower = energy_gain(on).lower
    assert bounds(on, 1.01 * lower)
    assert not any(bounds(on, part * lower) for part in (0.99, 0.9, 0.5, 0.1))


def test_an_output_that_nothing_moves():
    found = finite_horizon(constant([[0.0, 0.0], [0.0, -1.0]], [[1.0], [0.0]], [[0.0, 1.0]], 1.0)).l2
    assert found.lower == 0.0


@pytest.mark.parametrize("seed", [27, 28])
def test_mixed_units_change_nothing(seed):
    """States, disturbances and outputs in units that are twelve orders apart."""
    model, rng = random_ltv(seed % 10), np.random.default_rng(seed)
    d, dw, dz = (10.0 ** rng.uniform(-6, 6, n) for n in (model.A.shape[1], model.E.shape[2], model.C.shape[1]))
    E, C, F = model.E / dw, model.C * dz[:, None], model.F * dz[:, None] / dw
    plain = finite_horizon(made(model.t, model.A, E, C, F)).l2
    mixed = finite_horizon(made(model.t, model.A * d[:, None] / d, E * d[:, None], C / d, F)).l2
    assert mixed.lower == pytest.approx(plain.lower, rel=1e-3) and mixed.gap < 0.01 and plain.gap < 0.01


def test_sizes_at_the_ends_of_numbers():
    for size in (1e-80, 1e80):
        found = finite_horizon(constant([[-1.0]], [[size]], [[1.0]], 3.0)).l2
        assert found.lower / size == pytest.approx(finite_horizon(constant([[-1.0]], [[1.0]], [[1.0]], 3.0)).l2.lower)


@pytest.mark.parametrize("damping", (0.0, 0.003))
def test_the_upper_bound_is_shown_for_modes_that_hardly_decay(damping):
    """Three modes whose stiffness varies, seen by all: the Riccati matrix has parts far below the error of its step."""
    t, rng = np.linspace(0.0, 5.0, 301), np.random.default_rng(25)
    A = np.zeros((301, 6, 6))
    for k, omega in ((0, 8.0), (2, 13.0), (4, 17.0)):
        now = omega * (1 + 0.2 * np.sin(0.6 * t + k))
        A[:, k, k + 1], A[:, k + 1, k], A[:, k + 1, k + 1] = 1.0, -(now**2), -2 * damping * now
    E, C = (np.broadcast_to(rng.normal(size=shape), (301, *shape)) for shape in ((6, 2), (2, 6)))
    model = made(t, A, E, C, np.zeros((301, 2, 2)))
    found = finite_horizon(model).l2
    assert 0 < found.gap < 0.01
    on = Stretches(model, model.E, model.C, model.F)
    assert not bounds(on, 0.999 * found.lower) and bounds(on, 1.002 * found.lower)
