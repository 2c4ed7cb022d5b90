"""Certificates along true motions, and where there is none."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants.stability import floquet, lyapunov
from pliant.plants.stability.floquet import periodic_path
from pliant.plants.stability.lyapunov_certificate import _verified


def falls(certificate, A, x0, start, stop):
    """Largest V(t) e^(2 alpha t) / V(0) along a true motion; 1 at most where the certificate holds."""
    c = certificate
    keep = (c.t >= start) & (c.t <= stop)
    run = solve_ivp(lambda t, x: A(t) @ x, (0.0, stop), x0, t_eval=c.t[keep], rtol=1e-11, atol=1e-13, method="DOP853")
    V = np.einsum("it,tij,jt->t", run.y, c.P[keep], run.y)
    return (V * np.exp(2 * c.alpha * c.t[keep]) / V[0]).max()


def test_periodic_certificate_holds_along_true_motions(pulsating):
    model = pulsating()
    found = lyapunov(model)
    assert found.verified and found.periodic and found.slack > 0.5
    assert found.alpha == pytest.approx(-0.9 * floquet(model).growth, rel=1e-6)
    np.testing.assert_allclose(found.P[0], found.P[-1], rtol=1e-6)

    def A(t):
        return np.array([[0.0, 1.0], [-(2.0 - 0.5 * np.cos(2 * t)), -0.3]])

    for angle in np.linspace(0, np.pi, 7):
        assert falls(found, A, [np.cos(angle), np.sin(angle)], 0.0, np.pi) <= 1 + 1e-6


def test_a_certificate_that_does_not_close_is_none(pulsating):
    """P of one period, a little larger throughout the more it is from its end: it falls, and jumps up at each end."""
    found = lyapunov(pulsating())
    path, _, _ = periodic_path(pulsating(), None, None)
    size = found.scale
    P = found.P * size * size[:, None]
    assert _verified(path, found.t, P, 0.8 * found.alpha, True).verified
    leaning = P * np.linspace(1.02, 1.0, len(found.t))[:, None, None]
    assert _verified(path, found.t, leaning, 0.8 * found.alpha, False).verified
    assert not _verified(path, found.t, leaning, 0.8 * found.alpha, True).verified


def test_certificate_of_a_nominal_without_period(random_path, integrated):
    A, model = random_path(shift=4.0)
    found = lyapunov(model)
    assert found.verified and not found.periodic
    for x0 in np.eye(4):
        assert falls(found, A, x0, 0.0, 3.0) <= 1 + 1e-6
    Phi = integrated(A, (0.0, 3.0), 4)
    scaled = Phi * found.scale / found.scale[:, None]
    assert np.linalg.norm(scaled, 2) <= found.contraction < 1


def test_no_certificate_beyond_the_decay_rate_and_too_few_steps_say_so(pulsating):
    model = pulsating()
    too_fast = lyapunov(model, 0.2)  # the mean damping is 0.15
    assert not too_fast and "alpha must be below it" in too_fast.why
    assert not lyapunov(pulsating(damping=-0.05))
    short = lyapunov(model, most=20)
    assert not short and "more than 20 steps" in short.why
    with pytest.raises(ValueError, match=r"lyapunov.alpha = nan must be a finite number"):
        lyapunov(model, np.nan)


def test_certificate_of_a_constant_model(linear):
    found = lyapunov(linear([[0.0, 1.0], [-4.0, -0.4]]))
    assert found and found.alpha == pytest.approx(0.18)
    shifted = np.array([[0.0, 1.0], [-4.0, -0.4]]) + 0.18 * np.eye(2)
    assert np.linalg.eigvalsh(shifted.T @ found.P[0] + found.P[0] @ shifted).max() < 0
    assert not lyapunov(linear([[0.0, 1.0], [-4.0, 0.0]]))
