"""Exponents and dichotomy intervals, held against spectra that are known in closed form."""

import long_run
import numpy as np
import pytest

from pliant.plants.exponents import spectrum


def test_constant_models_are_their_roots(still):
    S = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, 1.0]])
    A = S @ np.array([[-0.5, 3.0, 0.0], [-3.0, -0.5, 0.0], [0.0, 0.0, 0.25]]) @ np.linalg.inv(S)
    found = spectrum(still(A))
    assert found.exponents == pytest.approx([0.25, -0.5, -0.5], abs=1e-10)
    assert found.verdict == "unstable" and found.groups == ((0,), (1, 2))
    assert found.intervals == pytest.approx(np.array([[0.25, 0.25], [-0.5, -0.5]]), abs=1e-9)
    assert "A stays as it is" in found.why


def test_a_periodic_model_is_its_multipliers(along, turn):
    """A = R' A0 R, R turning at w: y = R x makes it constant, exponents are the real parts of A0 + w J."""
    A0, w = np.array([[-0.3, 2.0], [0.1, -1.0]]), 1.7
    t = np.linspace(0, 2 * np.pi / w, 201)
    model = along(t, lambda t: turn(w * t).T @ A0 @ turn(w * t))
    found = spectrum(model, beyond="periodic", period=2 * np.pi / w)
    wanted = np.sort(np.linalg.eigvals(A0 + w * np.array([[0.0, -1.0], [1.0, 0.0]])).real)[::-1]
    assert found.exponents == pytest.approx(wanted, abs=1e-6)
    assert (found.intervals[:, 0] <= wanted.max() + 1e-9).all() and found.verdict == "unstable"


def test_a_triangular_model_in_closed_form(along):
    """b_i = a_i + c_i cos(w_i t): averages over a window of H are a_i + c_i (sin(w(t + H)) - sin(w t))/(w H)."""
    a, c, w, H, T = np.array([0.2, -0.8]), np.array([0.7, 0.3]), np.array([1.0, np.sqrt(2)]), 20.0, 60.0

    def A(t):
        b = a + c * np.cos(w * t)
        return np.array([[b[0], 2 * np.sin(t)], [0.0, b[1]]])

    t = np.linspace(0, T, 3001)
    found = spectrum(along(t, A), window=H)
    assert found.exponents == pytest.approx(a + c * np.sin(w * T) / (w * T), abs=1e-6)
    starts = np.linspace(0, T - H, 200_001)[:, None]
    closed = a + c * (np.sin(w * (starts + H)) - np.sin(w * starts)) / (w * H)
    wanted = np.column_stack([closed.min(axis=0), closed.max(axis=0)])
    assert found.intervals == pytest.approx(wanted, abs=1e-5)  # starts at nodes 0.02 s apart
    assert found.gaps == pytest.approx((closed[:, 0] - closed[:, 1]).min(), abs=1e-4)
    assert found.verdict == "unstable" and "averages over 20 s" in found.assumption


def test_perron(along):
    """x2' = (sin ln t + cos ln t - 2a) x2: averages t sin(ln t)/t - 2a swing between -1 - 2a and 1 - 2a for ever; with
    a = 0.6 the exponents are below zero, while averages over windows reach sqrt(2) - 2a > 0: no dichotomy at 0, and
    a perturbation that decays makes it grow (Perron 1930).
    """
    a = 0.6
    logs = np.linspace(-4 * np.pi, 2.5 * np.pi, 1301)
    t = np.exp(logs)
    model = along(t, lambda s: np.diag([-a, np.sin(np.log(s)) + np.cos(np.log(s)) - 2 * a]))
    found = spectrum(model, settle=50.0, window=30.0)
    assert not found.regular and "no limit is shown" in found.why
    assert found.averages[1] == pytest.approx([-1 - 2 * a, 1 - 2 * a], abs=1e-6)
    assert found.verdict == "drift" and found.drift[0].high == pytest.approx(np.sqrt(2) - 2 * a, abs=2e-3)
    assert found.exponents.max() < 0


def test_sums_of_oscillations_are_regular(along):
    t = np.linspace(0, 200, 2001)
    found = spectrum(along(t, lambda t: np.array([[-0.05 + 0.5 * np.cos(1.3 * t) + 0.5 * np.cos(np.sqrt(5) * t)]])))
    assert found.regular and found.verdict == "stable"


def test_drift_is_named_by_its_states(still, along):
    """A position and its rate that nothing holds, beside an oscillator that decays."""
    A = np.zeros((4, 4))
    A[0, 1], A[2, 3], A[3, 2], A[3, 3] = 1.0, 1.0, -4.0, -0.6
    found = spectrum(still(A))
    assert found.verdict == "drift" and set(found.drift[0].states) == {"x1", "x2"}
    swinging = along(np.linspace(0, 60, 601), lambda t: A + 0.2 * np.sin(t) * np.outer([0, 0, 0, 1], [0, 0, 1, 0]))
    found = spectrum(swinging)
    assert found.verdict == "drift" and set(found.drift[0].states) == {"x0", "x1"}
    assert found.drift[0].low < 0 < found.drift[0].high < 0.2  # ln(t)/t: no finite record shows less
    assert found.intervals[1, 1] < -0.2 and found.gaps[0] > 0


def test_a_perturbation_that_decays_leaves_the_limit(along):
    A = np.array([[0.05, 1.0], [0.0, -1.0]])
    model = along(np.linspace(0, 5, 101), lambda t: A + np.exp(-t) * np.array([[-3.0, 0.0], [1.0, 0.0]]))
    found = spectrum(model, beyond="tends", limit=A)
    assert found.exponents == pytest.approx([0.05, -1.0], abs=1e-9) and found.verdict == "unstable"
    near = spectrum(model, beyond="tends", limit=A, within=0.1)
    assert near.verdict == "drift" and "stays so near" in near.why
    low, high = near.intervals[0]
    assert low == pytest.approx(
        0.05 - 0.1 * np.linalg.cond([[1.0, -1.0], [0.0, 1.05]] / np.array([1.0, 1.45])), abs=1e-9
    )
    assert high - 0.05 == pytest.approx(0.05 - low, abs=1e-9)
    assert spectrum(model, beyond="constant").assumption == "A stays what it is at the end of the record"


def test_a_million_before_the_decay(still):
    found = spectrum(still([[-1.0, 4e6], [0.0, -2.0]]))
    assert found.verdict == "stable" and found.transient.factor == pytest.approx(1e6, rel=1e-3)
    assert "1e+06-fold" in found.why


def test_a_sampled_model_and_options_of_other_answers_are_refused(still, along):
    model = along(np.linspace(0, 5, 11), lambda t: -np.eye(2))
    for options in (
        {"beyond": "for ever"},
        {"beyond": "tends", "window": 1.0},
        {"beyond": "persists", "period": 1.0},
        {"beyond": "persists", "within": 0.1},
        {"beyond": "tends", "within": -0.1},
        {"beyond": "tends", "limit": np.eye(3)},
        {"window": 6.0},
        {"settle": 0.0},
    ):
        with pytest.raises(ValueError, match=r"spectrum\."):
            spectrum(model, **options)


def test_a_sample_of_the_campaign():
    """Whose whole is tests/campaigns/long_run.py: kinds that a record alone leaves undecided."""
    rows = [long_run.run(seed) for seed in (100_000, 100_001, 100_003, 100_005, 100_008, 100_011)]
    assert not [row for row in rows if row["wrong"]]
    assert sum(row["decided"] for row in rows) >= 5
