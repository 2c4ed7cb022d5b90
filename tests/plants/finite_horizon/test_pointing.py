"""Pointing errors over windows against closed forms of a first-order lag and a Monte Carlo."""

import numpy as np
import pytest
from horizon_models import constant, random_ltv

from pliant.plants.finite_horizon import pointing_budget

A, Q = 0.8, 0.3  # dx/dt = -A x + w, w of intensity Q: R(tau) = Q^2/(2 A) e^(-A |tau|) once it is steady
STEADY = Q / np.sqrt(2 * A)


@pytest.mark.parametrize("window", [0.5, 2.5])
def test_a_first_order_lag_under_white_noise(window):
    """MPE^2 = (2/D) of the integral of (1 - tau/D) R(tau) over the window D; RPE^2 = R(0) - MPE^2."""
    span = 10 * window
    told = pointing_budget(
        constant([[-A]], [[1.0]], [[1.0]], span, nodes=401), ["z1"], window, noise={"w1": Q}, start={"x1": STEADY}
    )
    d = A * window
    mean = STEADY**2 * 2 / d**2 * (d - 1 + np.exp(-d))
    assert len(told.windows) == 10 and told.windows[-1, 1] == pytest.approx(span)
    np.testing.assert_allclose(told.ape_sigma[:, 0], STEADY, rtol=1e-8)
    np.testing.assert_allclose(told.mpe_sigma[:, 0], np.sqrt(mean), rtol=1e-8)
    np.testing.assert_allclose(told.rpe_sigma[:, 0], np.sqrt(STEADY**2 - mean), rtol=1e-7)
    assert told.factor == pytest.approx(3.0, abs=1e-3) and not told.ape_most.any()
    np.testing.assert_allclose(told.rpe, told.factor * told.rpe_sigma)
    assert "APE" in told.words and "99.7" in told.words


def test_bounded_pushes_on_an_integrator():
    """dx/dt = w, |w| <= 2: x reaches 2 t; its mean over the first D: D; x(D) less that mean: at most D."""
    told = pointing_budget(constant([[0.0]], [[1.0]], [[1.0]], 3.0, nodes=301), ["z1"], 1.0, limits={"w1": 2.0})
    np.testing.assert_allclose(told.ape_most[:, 0], [2.0, 4.0, 6.0], rtol=1e-9)
    np.testing.assert_allclose(told.mpe_most[:, 0], [1.0, 3.0, 5.0], rtol=1e-4)
    np.testing.assert_allclose(told.rpe_most[:, 0], [1.0, 1.0, 1.0], rtol=1e-2)
    assert (told.rpe == told.rpe_most).all()


def test_it_is_what_a_monte_carlo_sees():
    """Of 4,000 runs of a random LTV model: white noise held over its steps, the RPE pooled over a window."""
    model, rng, runs = random_ltv(0, nodes=481), np.random.default_rng(1), 4000
    t, h, span = model.t, np.diff(model.t), model.t[-1] - model.t[0]
    names = model.disturbance_names
    told = pointing_budget(model, ["x1", "x2"], span / 2, noise=dict.fromkeys(names, 0.2))
    x, seen = np.zeros((runs, model.A.shape[1])), np.zeros((len(t), runs, 2))
    for k in range(len(h)):  # the midpoint rule
        w = 0.2 * rng.normal(size=(runs, len(names))) / np.sqrt(h[k])
        middle, E = (model.A[k] + model.A[k + 1]) / 2, (model.E[k] + model.E[k + 1]) / 2
        half = x + h[k] / 2 * (x @ middle.T + w @ E.T)
        x = x + h[k] * (half @ middle.T + w @ E.T)
        seen[k + 1] = x[:, :2]
    for w, part in enumerate((slice(0, 241), slice(240, 481))):
        e, mean = seen[part], np.trapezoid(seen[part], t[part], axis=0) / (span / 2)
        relative = np.sqrt(np.trapezoid(np.square(e - mean), t[part], axis=0).mean(axis=0) / (span / 2))
        np.testing.assert_allclose(told.mpe_sigma[w], mean.std(axis=0), rtol=0.06)
        np.testing.assert_allclose(told.rpe_sigma[w], relative, rtol=0.06)
        np.testing.assert_allclose(told.ape_sigma[w], e.std(axis=1).max(axis=0), rtol=0.06)


def test_what_is_refused():
    model = constant([[-1.0]], [[1.0]], [[1.0]], 2.0, F=[[1.0]])
    for match, options in (
        ("window = 3", {"window": 3.0}),
        ("name nothing", {}),
        ("its variance is not finite", {"noise": {"w1": 1.0}}),
        (r"limits\['w1'\] = -1", {"limits": {"w1": -1.0}}),
        ("'wind'", {"limits": {"wind": 1.0}}),
        ("confidence = 1 must", {"limits": {"w1": 1.0}, "confidence": 1.0}),
    ):
        with pytest.raises(ValueError, match=match):
            pointing_budget(model, ["z1"], **{"window": 1.0, **options})
