"""Monodromy matrices against independent integration and closed forms, and the error that is told of them."""

import numpy as np
import pytest
import scipy.linalg as sla
from periodic_models import integrated, model_of

from pliant.plants.linear.lti import LinearModel
from pliant.plants.stability import floquet
from pliant.plants.stability.floquet import monodromy, periodic_path


def test_monodromy_is_that_of_tight_integration():
    rng = np.random.default_rng(4)
    M0, M1, M2 = (rng.standard_normal((5, 5)) for _ in range(3))
    period = 2.3

    def A(t):
        return M0 + np.cos(2 * np.pi * t / period) * M1 + np.sin(6 * np.pi * t / period) * M2

    t = np.linspace(0.0, period, 65)
    found = floquet(model_of(t, np.array([A(s) for s in t])))
    wanted = integrated(A, period, 5)
    np.testing.assert_allclose(found.monodromy, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())
    np.testing.assert_allclose(
        np.sort_complex(found.multipliers), np.sort_complex(np.linalg.eigvals(wanted)), rtol=1e-8
    )
    trace = np.trace(M0) * period  # Liouville: the product of the multipliers
    assert np.prod(found.multipliers).real == pytest.approx(np.exp(trace), rel=1e-8)


def test_uneven_nodes_converge_at_order_four():
    def error(nodes):
        s = np.linspace(0.0, 1.0, nodes)
        t = np.pi * (s + 0.05 * np.sin(2 * np.pi * s))
        A = np.zeros((nodes, 2, 2))
        A[:, 0, 1], A[:, 1, 0] = 1.0, -(1.3 - np.cos(2 * t))
        wanted = integrated(lambda t: np.array([[0.0, 1.0], [-(1.3 - np.cos(2 * t)), 0.0]]), np.pi, 2)
        return np.abs(floquet(model_of(t, A)).monodromy - wanted).max()

    coarse, fine = error(33), error(129)
    assert fine < 1e-6 and np.log(coarse / fine) / np.log(4) > 3.7


# --- errors and thresholds ------------------------------------------------------------------------------------------


def mathieu_rates(t, damping=0.0):
    """A (.., 2, 2) of x'' + 2 d x' + (1.3 - cos 2t) x = 0: of period pi, inside the first tongue."""
    A = np.zeros((*np.shape(t), 2, 2))
    A[..., 0, 1], A[..., 1, 0], A[..., 1, 1] = 1.0, -(1.3 - np.cos(2 * np.asarray(t))), -2 * damping
    return A


@pytest.mark.parametrize("nodes", (17, 33, 65, 129, 257))
@pytest.mark.parametrize("damping", (0.0, 0.05))
def test_error_estimate_is_above_the_true_error_and_near_it(nodes, damping):
    """Between nodes A(t) is not known: on uneven ones the error is that of a spline, 1e-4 to 2e-9 here."""
    s = np.linspace(0.0, 1.0, nodes)
    t = np.pi * (s + 0.05 * np.sin(2 * np.pi * s))
    found = floquet(model_of(t, mathieu_rates(t, damping)), np.pi, undamped=False)
    wanted = np.linalg.eigvals(integrated(lambda s: mathieu_rates(s, damping), np.pi, 2))
    wanted = wanted[np.argsort(-np.abs(wanted))]
    true = np.abs(found.multipliers - wanted).max()
    assert true < found.error.max() < 50 * true
    # The same motion a hundred times slower: multipliers and their errors know no unit of time.
    slow = floquet(model_of(100 * t, mathieu_rates(t, damping) / 100), 100 * np.pi, undamped=False)
    np.testing.assert_allclose(slow.error, found.error, rtol=1e-6)


@pytest.mark.parametrize("tolerance", (1e-4, 1e-6, 1e-8, 1e-11))
def test_monodromy_keeps_its_tolerance_and_knows_its_error(tolerance):
    """With A(t) known to rounding what is left is the error of the steps, which the estimate should hit."""
    t = np.linspace(0.0, np.pi, 129)
    path, length, _ = periodic_path(model_of(t, mathieu_rates(t)), np.pi, None)
    steps, M, error = monodromy(path, length, tolerance)
    wanted = integrated(mathieu_rates, np.pi, 2)
    own = M * path.scale[:, None] / path.scale
    true = np.linalg.norm(own - wanted) / np.linalg.norm(wanted)
    assert error <= tolerance and 0.5 * true < error < 2 * true + 1e-14
    assert steps == (128 if tolerance < 1e-10 else 64) and length == np.pi


def test_monodromy_of_a_constant_model_is_its_exponential_in_one_step():
    A = np.array([[0.0, 1.0, 0.0], [-400.0, -0.3, 2.0], [0.0, 0.1, -1e-3]])
    path, length, _ = periodic_path(LinearModel.from_matrices(A, np.zeros((3, 0))), 0.5, None)
    steps, M, error = monodromy(path, length, 1e-11)
    own = M * path.scale[:, None] / path.scale
    assert steps == 1 and np.finfo(float).eps < error < 1e-14 and (path.scale != 1).any()
    np.testing.assert_allclose(own, sla.expm(0.5 * A), rtol=0, atol=1e-13 * np.abs(own).max())
    whole = floquet(LinearModel.from_matrices(A, np.zeros((3, 0))), 0.5)
    np.testing.assert_allclose(whole.monodromy, own, rtol=0, atol=1e-13 * np.abs(own).max())


def test_monodromy_of_a_scalar_is_the_exponential_of_its_mean():
    """x' = (a + b cos wt) x: Phi = e^(a T), whatever b."""
    t = np.linspace(0.0, 2.0, 33)
    rate = -0.7 + 1.9 * np.cos(np.pi * t)
    found = floquet(model_of(t, rate[:, None, None]))
    assert found.monodromy[0, 0] == pytest.approx(np.exp(-1.4), rel=1e-11)
    assert found.multipliers[0] == pytest.approx(np.exp(-1.4), rel=1e-11)
    assert found.error[0] < 1e-10 and found.verdict == "stable" and found.growth == pytest.approx(-0.7, rel=1e-10)
