"""Floquet multipliers against closed forms, independent integration, Mathieu characteristic values, the reference."""

import dataclasses

import numpy as np
import pytest
from periodic_models import integrated, model_of, oscillator
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from pliant.plants import Trajectory
from pliant.plants.linear.lti import LinearModel
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.stability import assess, floquet


@pytest.mark.parametrize(
    ("rate", "verdict"),
    [(2e-9, "unstable"), (5e-10, "marginal"), (0.0, "marginal"), (-5e-10, "marginal"), (-2e-9, "stable")],
)
def test_a_multiplier_within_1e_9_of_the_unit_circle_is_on_it(rate, verdict):
    """Known to rounding: e^rate over a second."""
    found = floquet(LinearModel.from_matrices([[rate]], np.zeros((1, 0))), 1.0)
    assert found.verdict == verdict
    assert found.outside[0] == (verdict == "unstable") and found.on_circle[0] == (verdict == "marginal")


@pytest.mark.parametrize(
    ("size", "error", "verdict"),
    [
        (1.0, 9e-5, "marginal"),
        (1.0, 1.1e-4, "undecided"),
        (1 + 8e-5, 9e-5, "marginal"),
        (1 + 1e-4, 9e-5, "unstable"),
        (1 - 8e-5, 9e-5, "marginal"),
        (1 - 1e-4, 9e-5, "stable"),
        (1 + 8e-3, 9e-3, "undecided"),
        (1 + 1e-2, 9e-3, "unstable"),
        (1 - 1e-2, 9e-3, "stable"),
    ],
)
def test_the_error_decides_what_can_be_told(size, error, verdict):
    found = floquet(LinearModel.from_matrices([[-1.0]], np.zeros((1, 0))), 1.0)
    found = dataclasses.replace(found, multipliers=np.array([size + 0j]), error=np.array([error]))
    assert found.verdict == verdict


def test_the_worst_known_multiplier_on_the_circle_decides():
    found = floquet(LinearModel.from_matrices(-np.eye(3), np.zeros((3, 0))), 1.0)
    known = dataclasses.replace(found, multipliers=np.array([1.0, 1.0, 0.5 + 0j]), error=np.array([1e-6, 1e-6, 1e-2]))
    unsure = dataclasses.replace(known, error=np.array([1e-6, 1e-3, 1e-2]))
    assert known.verdict == "marginal" and unsure.verdict == "undecided"


def test_a_double_multiplier_is_known_to_half_the_digits():
    """A free mass in coordinates of its own: x'' = 0 beside a mode that decays; the double one comes out 1 +- 1e-8.

    Where rounding lets the two coincide more of the error is told, so that nine coordinates are judged together.
    """
    told = []
    for seed in range(3, 12):
        turn = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))[0]
        A = turn @ np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -0.5]]) @ turn.T
        found = floquet(LinearModel.from_matrices(A, np.zeros((3, 0))), 1.0, undamped=False)
        np.testing.assert_allclose(found.multipliers, [1.0, 1.0, np.exp(-0.5)], atol=1e-7)
        assert found.verdict == "marginal" and found.on_circle.tolist() == [True, True, False]
        assert (found.error[:2] > np.abs(np.abs(found.multipliers[:2]) - 1)).all()
        assert (found.error[:2] > 1e-9).all() and (found.error[:2] < 1e-4).all() and found.error[2] < 1e-10
        told.append(found.error[0])
    assert np.median(told) < 1e-6  # sqrt of 9e-16, times |Phi|
    free = floquet(LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], np.zeros((2, 0))), 1.0, undamped=False)
    assert free.verdict == "marginal" and (free.error < 1e-6).all()  # one eigenvector for two: still half the digits


@pytest.mark.parametrize("q", (0.3, 1.7, 4.0))
@pytest.mark.parametrize("away", (1e-5, 1e-7))
def test_both_sides_of_a_tongues_edge(q, away):
    """About b_1 and a_1 the trace goes through -2: just inside the tongue the growth is of the order of sqrt(away)."""
    edge = mathieu_b(1, q)  # the tongue reaches from b_1 to a_1
    outer = mathieu_a(1, q)
    for a, verdict in (
        (edge - away, "marginal"),
        (edge + away, "unstable"),
        (outer - away, "unstable"),
        (outer + away, "marginal"),
    ):
        found = floquet(oscillator(lambda t, a=a: a - 2 * q * np.cos(2 * t), np.pi, nodes=129))
        assert found.undamped and found.verdict == verdict, (a - edge, found.multipliers, found.error)
        assert np.prod(found.multipliers) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("q", (0.3, 1.7, 4.0))
def test_undamped_multipliers_stay_on_the_unit_circle(q):
    middle = (mathieu_a(1, q) + mathieu_b(2, q)) / 2  # inside a stable region
    found = floquet(oscillator(lambda t: middle - 2 * q * np.cos(2 * t), np.pi))
    assert found.undamped and found.verdict == "marginal"
    np.testing.assert_allclose(np.abs(found.multipliers), 1.0, atol=1e-9)
    plain = floquet(oscillator(lambda t: middle - 2 * q * np.cos(2 * t), np.pi), undamped=False)
    assert not plain.undamped
    np.testing.assert_allclose(np.abs(np.angle(plain.multipliers)), np.abs(np.angle(found.multipliers)), atol=1e-9)


def gyroscopic(pairs, seed=7, size=0.05, drift=False):
    """Undamped with gyroscopic coupling, stiffness pulsating a little, in coordinates that are not canonical."""
    rng = np.random.default_rng(seed)
    M = rng.standard_normal((pairs, pairs))
    M = M @ M.T + pairs * np.eye(pairs)
    K = np.diag(np.linspace(1.0, 4.0, pairs) ** 2)
    if drift:
        K[0, 0] = 0.0
    G, K1 = rng.standard_normal((2, pairs, pairs))
    G, K1 = (G - G.T) / 2, size * (K1 + K1.T)
    if drift:
        G[0], G[:, 0], K1[0], K1[:, 0], M[0, 1:], M[1:, 0] = 0, 0, 0, 0, 0, 0
    t = np.linspace(0.0, 1.1, 65)
    A = np.zeros((65, 2 * pairs, 2 * pairs))
    A[:, :pairs, pairs:] = np.eye(pairs)
    A[:, pairs:, :pairs] = -np.linalg.solve(M, K + np.cos(2 * np.pi * t / 1.1)[:, None, None] * K1)
    A[:, pairs:, pairs:] = -np.linalg.solve(M, G)
    return model_of(t, A)


@pytest.mark.parametrize("drift", (False, True))
def test_gyroscopic_model_with_and_without_a_rigid_mode_stays_on_the_unit_circle(drift):
    found = floquet(gyroscopic(6, drift=drift))
    assert found.undamped and found.verdict == "marginal"
    np.testing.assert_allclose(np.abs(found.multipliers), 1.0, atol=1e-9)
    assert (np.abs(found.multipliers - 1.0) < 1e-9).sum() == (2 if drift else 0)


def test_a_little_damping_is_not_taken_for_none():
    def k(t):
        return 1.3 - 0.2 * np.cos(2 * t)

    found = floquet(oscillator(k, np.pi, damping=1e-6))
    assert not found.undamped and found.verdict == "stable"
    assert found.growth == pytest.approx(-1e-6, rel=1e-3)


def test_modes_are_periodic_and_solve_the_equation():
    model = oscillator(lambda t: 2.2 + 0.9 * np.cos(2 * t), np.pi, damping=0.1)
    found = floquet(model)
    for k in range(2):
        shape = found.mode(k)
        np.testing.assert_allclose(shape[-1], shape[0], atol=1e-9)
        np.testing.assert_allclose(found.monodromy @ shape[0], found.multipliers[k] * shape[0], atol=1e-9)


def test_constant_model_has_the_exponents_of_its_eigenvalues():
    A = np.array([[0.0, 1.0], [-4.0, -0.3]])
    model = LinearModel.from_matrices(A, np.zeros((2, 0)))
    found = floquet(model, 0.5)
    np.testing.assert_allclose(np.sort_complex(found.exponents), np.sort_complex(model.eigenvalues), atol=1e-12)
    with pytest.raises(ValueError, match=r"floquet.period = None must be > 0 for a LinearModel"):
        floquet(model)


@pytest.mark.parametrize("share", (0.31, 0.5))
def test_the_period_is_found_in_a_longer_nominal(share):
    period = 1.7
    t = np.linspace(0.0, period / share, 400)
    A = np.zeros((400, 2, 2))
    A[:, 0, 1], A[:, 1, 0] = 1.0, -(3.0 + 0.4 * np.cos(2 * np.pi * t / period) + 0.1 * np.sin(4 * np.pi * t / period))
    found = floquet(model_of(t, A))
    assert found.period == pytest.approx(period, rel=1e-7)
    assert "repeats every 1.7 s" in found.source
    w = 2 * np.pi / period
    wanted = integrated(
        lambda s: np.array([[0.0, 1.0], [-(3.0 + 0.4 * np.cos(w * s) + 0.1 * np.sin(2 * w * s)), 0.0]]), period, 2
    )
    angle = np.arccos(np.trace(wanted) / 2)  # undamped and stable: multipliers e^(+-i angle)
    np.testing.assert_allclose(np.abs(np.angle(found.multipliers)), angle, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.monodromy, wanted, rtol=0, atol=1e-5)
    # In a nominal shorter than two periods nothing is seen to repeat but what is asked for.
    short = t < 0.97 * period
    with pytest.raises(ValueError, match="not periodic"):
        floquet(model_of(t[short], A[short]))


# --- the reference spacecraft with hinges of modulated stiffness ---------------------------------------------------


def modulated(depth, nu, nodes=129):
    """The textbook spacecraft with its booms on hinges, whose springs are parameters that vary along a rest."""
    hinge = Hinge(axes=((0.0, 1.0, 0.0),), stiffness=100.0, damping=2.0)
    craft = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear", translation=False)
    parts = tuple(dataclasses.replace(a, hinge=hinge, damping=0.005) for a in craft.appendages)
    craft = dataclasses.replace(craft, appendages=parts)
    craft = craft.vary("appendages.0.hinge.stiffness.0", "appendages.1.hinge.stiffness.0")
    t = np.linspace(0.0, 2 * np.pi / nu, nodes)
    x = np.tile(craft.state(), (nodes, 1))
    nominal = Trajectory.from_arrays(t, x, np.zeros((nodes, craft.nu)), plant=craft, dx=np.zeros_like(x))
    k = 100.0 * (1 + depth * np.cos(nu * t))
    return craft.linearize_along(nominal, p=np.column_stack([k, k]))


@pytest.mark.campaign
def test_modulated_hinge_of_the_reference(reference):
    table = reference("spacecraft")["hinge_stiffness_modulated"]
    for row in table["floquet"]:
        model = modulated(row["eps"], row["nu"])
        found = floquet(model)
        assert found.growth == pytest.approx(row["exponent"], abs=1e-9)
        assert np.abs(found.multipliers[0]) == pytest.approx(row["max_mult"], abs=1e-9)
        verdict = assess(model)
        assert verdict.verdict == "unstable" and verdict.method == "floquet"
        assert verdict.evidence["frozen_time"].suggests in ("stable", "marginal")

    def largest(depth):
        """Of the multipliers about -1, where a spring that pulsates at twice a frequency drives them; drift is at 1."""
        multipliers = floquet(modulated(depth, row["nu"])).multipliers
        return np.abs(multipliers[multipliers.real < -0.5]).max() - 1

    critical = brentq(largest, 0.04, 0.06, xtol=1e-7)
    assert critical == pytest.approx(table["critical_eps_symmetric"], abs=1e-5)


def test_a_fast_mode_in_coordinates_that_hide_it():
    """A slow pair whose stiffness pulses beside a fast one, in skew states. Bounded entry by entry the fast one's
    oscillation counts as growth, and the multipliers are told to be known to 8.4 and 2.6; in the modes' coordinates to
    4e-6. They are those of Dormand and Prince's method of order 8 at 1e-12.
    """
    rng = np.random.default_rng(5)
    first, second = (np.linalg.qr(rng.standard_normal((4, 4)))[0] for _ in range(2))
    S = first @ np.diag([1.0, 1.0, 0.03, 0.03]) @ second
    back = np.linalg.inv(S)
    mean = np.array([[0, 1, 0, 0], [-0.6, -0.02, 0, 0], [0, 0, 0, 20.0], [0, 0, -20.0, -0.2]])
    pump = np.array([[0, 0, 0, 0], [-0.3, 0, 0.3, 0], [0, 0, 0, 0], [0.3, 0, 0, 0]])
    mean, pump = S @ mean @ back, S @ pump @ back
    wanted = np.linalg.eigvals(integrated(lambda s: mean + np.cos(s) * pump, 2 * np.pi, 4))
    for nodes in (60, 120):
        t = np.linspace(0.0, 2 * np.pi, nodes) ** 1.1 / (2 * np.pi) ** 0.1
        found = floquet(model_of(t, mean + np.cos(t)[:, None, None] * pump), 2 * np.pi)
        assert found.verdict == "stable" and found.error.max() < 1e-4
        for value in wanted:
            k = np.abs(found.multipliers - value).argmin()
            assert abs(found.multipliers[k] - value) <= found.error[k]
        sizes = np.abs(np.linalg.eigvals(found.monodromy))
        np.testing.assert_allclose(np.sort(sizes), np.sort(np.abs(found.multipliers)), rtol=1e-8)
