"""Margins against closed forms, textbook values and python-control; H-infinity norms against closed forms."""

import control
import numpy as np
import pytest
from evidence import agrees

from pliant.controllers import LQR, Feedback
from pliant.controllers.analysis.loops import Loop, law_of, loop
from pliant.controllers.analysis.margins import disk_gain, disk_phase_deg, margins, scaled_peak
from pliant.controllers.estimation.sensors import Sensor
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.solvers import hinf_norm
from pliant.controllers.solvers.hinf_norm import peak
from pliant.envs import scenes
from pliant.plants import LinearModel, PliantError

DOUBLE = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [1]], states=["x", "v"], inputs=["u"])
s = control.tf("s")


def of(system):
    """A Loop from a python-control system."""
    found = control.ss(system)
    return Loop(found.A, found.B, found.C, found.D, found.dt or None, tuple(f"u{i}" for i in range(found.ninputs)))


@pytest.mark.parametrize("zeta", [0.2, 0.7, 1.5])
def test_double_integrator_under_pd(zeta):
    """L = (2 zeta w s + w^2)/s^2: crossover w sqrt(2 z^2 + sqrt(4 z^4 + 1)), phase margin atan(2 zeta crossover/w)."""
    w = 3.0
    law = Feedback([[w**2, 2 * zeta * w]], ("x", "v"))
    crossover = w * np.sqrt(2 * zeta**2 + np.sqrt(4 * zeta**4 + 1))
    phase = np.arctan(2 * zeta * crossover / w)
    found = margins(loop(DOUBLE, law))
    [c] = found.channels
    assert c.crossover_hz == pytest.approx(crossover / (2 * np.pi), rel=1e-9)
    assert c.phase_deg == pytest.approx(np.rad2deg(phase), rel=1e-9)
    assert c.delay == pytest.approx(phase / crossover, rel=1e-9)
    assert c.gain[0] < 1e-6 and c.gain[1] == np.inf
    assert found.disk == c.disk and found.bandwidth_hz == c.crossover_hz


def test_peak_of_a_resonance():
    """1/(s^2 + 2 z s + 1) peaks with 1/(2 z sqrt(1 - z^2)) at sqrt(1 - 2 z^2), however narrow."""
    for zeta in (0.3, 1e-2, 1e-5):
        A, B, C = np.array([[0, 1], [-1, -2 * zeta]]), np.array([[0.0], [1]]), np.array([[1.0, 0]])
        value, omega = peak(A, B, C, np.zeros((1, 1)))
        assert value == pytest.approx(1 / (2 * zeta * np.sqrt(1 - zeta**2)), rel=1e-6)
        assert omega == pytest.approx(np.sqrt(1 - 2 * zeta**2), rel=1e-3)


def test_peaks_of_sampled_systems_and_of_matrices():
    # 1/(z - a) peaks at z = 1 for a > 0, at z = -1 for a < 0.
    for a, omega in ((0.6, 0.0), (-0.6, np.pi / 0.1)):
        found = peak(np.array([[a]]), np.eye(1), np.eye(1), np.zeros((1, 1)), 0.1)
        assert found.value == pytest.approx(1 / (1 - abs(a)), rel=1e-6)
        assert found.omega == pytest.approx(omega, abs=1e-4)
    rng = np.random.default_rng(0)
    for _ in range(20):
        A = rng.normal(size=(6, 6)) - 4 * np.eye(6)
        B, C, D = rng.normal(size=(6, 3)), rng.normal(size=(2, 6)), rng.normal(size=(2, 3))
        if np.linalg.eigvals(A).real.max() >= -1e-2:
            continue
        grid = np.concatenate([[0], np.geomspace(1e-3, 1e4, 4000)])
        G = C @ np.linalg.solve(1j * grid[:, None, None] * np.eye(6) - A, B.astype(complex)[None]) + D
        largest = np.linalg.svd(G, compute_uv=False).max()
        assert largest * (1 - 3e-7) <= peak(A, B, C, D).value <= largest * (1 + 1e-4)
    assert peak(-np.eye(1), np.eye(1), np.eye(1), 5 * np.eye(1)).value == pytest.approx(6.0)
    assert peak(-np.eye(1), np.eye(1), -np.eye(1), 5 * np.eye(1)) == (pytest.approx(5.0), np.inf)
    with pytest.raises(PliantError, match="does not decay"):
        peak(np.eye(1), np.eye(1), np.eye(1), np.zeros((1, 1)))


@pytest.mark.parametrize("seed", range(4))
def test_continuous_lqr_has_its_guaranteed_margins(seed):
    """Peak of S 1 (Kalman 1964), phase 60 deg, gain 1/2 to infinity (Safonov and Athans 1977), in every loop."""
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(5, 5)), rng.normal(size=(5, 2))
    model = LinearModel.from_matrices(A, B)
    found = margins(loop(model, LQR.design(model, np.eye(5), np.eye(2))))
    assert found.S.value == pytest.approx(1.0, abs=1e-6)
    assert found.disk >= 2 / 3 - 1e-6  # |S| <= 1 gives |S - 1/2| <= 3/2
    for c in found.channels:
        assert c.phase_deg >= 60 - 1e-6 and c.gain[0] <= 0.5 + 1e-6 and c.gain[1] == np.inf


def test_textbook_loop():
    """Skogestad and Postlethwaite (2005), Section 2.4.3: 3 (1 - 2 s)/((5 s + 1)(10 s + 1)), PI 1.14 (1 + 1/(12.7 s)):
    GM 1.63, PM 19.4 deg = 0.34 rad, delay 1.44 s, M_S 3.92, M_T 3.35.
    """
    found = margins(of(3 * (1 - 2 * s) / ((5 * s + 1) * (10 * s + 1)) * 1.136 * (1 + 1 / (12.7 * s))))
    [c] = found.channels
    told = {"of": "margins", "source": "Skogestad and Postlethwaite (2005), section 2.4.3", "kind": "table"}
    told["absolute"] = True
    agrees(c.gain[1], 1.63, within=0.01, what="gain margin of a PI loop", **told)
    agrees(c.phase_deg, 19.4, within=0.05, what="its phase margin [deg]", **told)
    agrees(c.delay, 1.44, within=0.01, what="its delay margin [s]", **told)
    agrees(c.crossover_hz * 2 * np.pi, 0.236, within=1e-3, what="its crossover [rad/s]", **told)
    agrees([found.S.value, found.T.value], [3.92, 3.35], within=0.015, what="its peaks of S and T", **told)


def test_disk_margin_of_the_tutorial():
    """Seiler, Packard and Gahinet 2020: L = 25/(s^3 + 10 s^2 + 10 s + 10): disk 0.46, gain 0.63 to 1.59, 26 deg."""
    [c] = margins(of(25 / (s**3 + 10 * s**2 + 10 * s + 10))).channels
    told = {"of": "margins", "source": "Seiler, Packard and Gahinet (2020)", "kind": "table", "absolute": True}
    agrees([c.disk, *c.disk_gain], [0.46, 0.63, 1.59], within=0.005, what="disk margin and its gains", **told)
    agrees(c.disk_phase_deg, 26.0, within=0.3, what="its phase [deg]", **told)
    agrees([c.gain[1], c.phase_deg], [3.6, 29.1], within=0.05, what="the loop's gain and phase margins", **told)
    assert c.gain[1] == pytest.approx(3.6)  # s^3 + 10 s^2 + 10 s + 10 + 25 k is on the axis at 10 * 10 = 10 + 25 k


SISO = {
    "stable": 4 / ((s + 1) * (0.3 * s + 1) * (0.1 * s + 1)),
    "resonant": 0.5 * (s**2 + 0.01 * s + 0.6) / (s * (s**2 + 0.01 * s + 1) * (0.1 * s + 1)),
    "unstable plant": 8 * (s + 1) / ((s - 1) * (s + 2) * (0.05 * s + 1)),
    "sampled": control.c2d(control.ss(2 / (s * (s + 1))), 0.2),
}


@pytest.mark.every(2)
@pytest.mark.filterwarnings("ignore:.*encountered in divide:RuntimeWarning")  # theirs, at a pole
@pytest.mark.parametrize("name", list(SISO))
def test_python_control_agrees(name):
    system = control.ss(SISO[name])
    [c] = margins(of(system)).channels
    gm, pm, _, _, wp, _ = control.stability_margins(system, returnall=True)
    below, above = [g for g in gm if g < 1], [g for g in gm if 1 < g < 1e9]
    assert c.gain[0] == pytest.approx(max(below, default=0.0), abs=1e-6)
    assert c.gain[1] == pytest.approx(min(above, default=np.inf), rel=1e-6)
    assert c.phase_deg == pytest.approx(np.abs(pm).min(), rel=1e-6)
    assert c.crossover_hz == pytest.approx(wp.max() / (2 * np.pi), rel=1e-6)
    if not system.dt:
        disk, _, phase = control.disk_margins(system, np.geomspace(1e-2, 1e3, 40_000 if name == "resonant" else 4000))
        assert c.disk == pytest.approx(disk, rel=1e-4) and disk_phase_deg(c.disk) == pytest.approx(phase, rel=1e-4)


def test_spinning_satellite_has_margins_in_each_loop_and_none_in_both():
    """Skogestad and Postlethwaite (2005), Section 3.7.1: a = 10, K = I. Alone: infinite gain margin, 90 deg; gains 1.1
    and 0.9 together end stability. S - 1/2 = [[s - 1, -2 a], [2 a, s - 1]]/(2 s + 2) has the singular values
    |s - 1 +- 2 a i|/|2 s + 2|, the largest of which is (a + sqrt(1 + a^2))/2.
    """
    a = 10.0
    A, C = np.array([[0, a], [-a, 0]]), np.array([[1, a], [-a, 1.0]])
    found = margins(Loop(A, np.eye(2), C, np.zeros((2, 2)), None, ("u1", "u2")))
    for c in found.channels:
        assert c.gain == (0.0, np.inf) and c.phase_deg == pytest.approx(90, rel=1e-6) and c.disk == pytest.approx(2.0)
    agrees(
        found.disk,
        2 / (a + np.sqrt(1 + a**2)),
        within=1e-6,
        of="margins",
        what="disk margin of the spinning satellite, all loops at once",
        source="the satellite of Skogestad and Postlethwaite, solved in the test",
        kind="closed form",
    )
    low, high = disk_gain(found.disk)
    assert low > 0.9 and high < 1.106
    for factors, stable in (((low, high), True), ((1.101, 0.899), False)):
        assert (np.linalg.eigvals(A - np.diag(factors) @ C).real.max() < 0) == stable


def test_scaling_lets_unlike_channels_be():
    """A loop triangular in its channels has the structured peak of its diagonal, however large the coupling."""
    A, B = -np.eye(2), np.eye(2)
    C, D = np.array([[1.0, 1e3], [0.0, 1.0]]), np.zeros((2, 2))
    system = Loop(A, B, C, D, None, ("a", "b"))
    assert peak(A, B, C, D).value > 1e3
    assert scaled_peak(system, np.geomspace(1e-3, 1e3, 50)) == pytest.approx(1.0, rel=1e-2)


@pytest.mark.parametrize("dt", [None, 0.02])
def test_factors_and_delays_at_the_margin_are_where_stability_ends(dt):
    """Poles of the arm's loops with one input scaled, or read late by whole periods; the disk's gains hold in all."""
    scene = scenes.get("two-link-reach")
    model = scene.plant.linearize(*scene.target)
    law = LQR.design(model, dict(scene.weights), dict(scene.effort), dt=dt)
    whole = loop(model, law)
    found = margins(whole)

    def radius(factors):
        scaled = whole._replace(C=np.diag(factors) @ whole.C, D=np.diag(factors) @ whole.D)
        poles = np.linalg.eigvals(scaled.closed())
        return poles.real.max() if dt is None else np.abs(poles).max() - 1

    for i, c in enumerate(found.channels):
        for k in c.gain:
            if 1e-9 < k < np.inf:
                factors = np.ones(2)
                factors[i] = 1 + 0.999 * (k - 1)
                assert radius(factors) < 0
                factors[i] = 1 + 1.001 * (k - 1)
                assert radius(factors) > 0
        assert c.disk_gain[0] >= c.gain[0] and c.disk_gain[1] <= c.gain[1]
    low, high = disk_gain(found.disk)
    assert radius([low, high]) < 0 and radius([high, low]) < 0 and radius([high, high]) < 0
    assert found.disk <= min(c.disk for c in found.channels) + 1e-9
    if dt is None:
        assert found.S.value == pytest.approx(1, abs=1e-5)


def test_gain_margins_at_the_ends_of_the_axis():
    """0.4/(z - 0.5) has its pole at -1 with (1 + 0.5)/0.4 times the gain; -0.5 + 0.1/(s + 1) reaches -1 at infinity."""
    one = np.eye(1)
    [c] = margins(Loop(0.5 * one, one, 0.4 * one, 0 * one, 0.1, ("u",))).channels
    assert c.gain == (0.0, pytest.approx(1.5 / 0.4, rel=1e-9))
    [c] = margins(Loop(-one, one, 0.1 * one, -0.5 * one, None, ("u",))).channels
    assert c.gain == (0.0, pytest.approx(2.0, rel=1e-9))


def test_loop_broken_at_two_readings():
    """det(I + L) is the same wherever the loop is broken (Sylvester)."""
    law = Feedback([[9.0, 4.0]], ("x", "v"))
    one, two = loop(DOUBLE, law), loop(DOUBLE, law, at="output")
    omega = np.array([0.3, 2.0, 11.0])
    assert two.at(omega).shape == (3, 2, 2) and two.channels == ("x", "v")
    np.testing.assert_allclose(np.linalg.det(np.eye(2) + two.at(omega)), 1 + one.at(omega)[:, 0, 0], rtol=1e-12)
    assert margins(two).disk <= margins(one).disk + 1e-9


def test_delay_margin_of_a_sampled_loop():
    """Slow sampling of the double integrator; whole periods of delay are poles at zero."""
    law = LQR.design(DOUBLE, np.diag([1.0, 0.1]), np.array([[0.01]]), dt=0.02)
    whole = loop(DOUBLE, law)
    [c] = margins(whole).channels
    periods = c.delay / 0.02
    assert periods > 2

    def late(d):
        A = np.eye(d, k=-1)
        first, last = np.eye(d)[:, :1], np.eye(d)[-1:]
        wide = np.block([[whole.A, np.zeros((2, d))], [first @ whole.C, A]])
        return np.abs(
            np.linalg.eigvals(wide - np.vstack([whole.B, 0 * first]) @ np.hstack([np.zeros((1, 2)), last]))
        ).max()

    assert late(int(np.floor(periods))) < 1 < late(int(np.ceil(periods)))


def test_lqg_broken_at_the_output_and_integral_action():
    model = LinearModel.from_matrices(
        [[0, 1], [-1, -0.1]], [[0], [1]], [[1.0, 0]], E=[[0], [1]], states=["x", "v"], outputs=["y"]
    )
    sensor = (Sensor("other", "y", "", noise=0.01),)
    lqg = LQG.design(model, np.eye(2), np.eye(1), sensor, {"w1": 1.0}, dt=0.05)
    one, other = margins(loop(model, lqg)), margins(loop(model, lqg, at="output"))
    assert one.channels[0].phase_deg == pytest.approx(other.channels[0].phase_deg, rel=1e-6)  # one input, one output
    assert other.channels[0].name == "y"
    lqi = LQR.design(model, np.eye(2), np.eye(1), integral={"y": 1.0}, dt=0.05)
    assert len(law_of(lqi).A) == 1
    assert np.sort_complex(np.linalg.eigvals(loop(model, lqi).closed())) == pytest.approx(np.sort_complex(lqi.poles))


def test_no_margins_of_what_is_not_stable_or_has_no_linear_form():
    with pytest.raises(PliantError, match=r"closed loop is not stable, a pole is 0\.5"):
        margins(loop(DOUBLE, Feedback([[1.0, -1.0]], ("x", "v"))))
    with pytest.raises(PliantError, match="has no linear form"):
        loop(DOUBLE, object())
    with pytest.raises(ValueError, match="state or output 'z' must be one of x, v"):
        loop(DOUBLE, Feedback([[1.0]], ("z",)))
    assert "phase" in str(margins(loop(DOUBLE, Feedback([[1.0, 1.0]], ("x", "v")))))


def test_a_norm_that_is_not_found_is_not_told(monkeypatch):
    A, B = np.array([[0.0, 1.0], [-1.0, -1e-3]]), np.array([[0.0], [1.0]])
    C, D = np.array([[1.0, 0.0]]), np.zeros((1, 1))
    assert peak(A, B, C, D).value == pytest.approx(1e3, rel=1e-5)  # 1 / (2 zeta) at the resonance, zeta = 5e-4
    monkeypatch.setattr(hinf_norm, "MOST_ROUNDS", 0)
    with pytest.raises(PliantError, match="the norm is not found"):
        peak(A, B, C, D)


@pytest.mark.parametrize(("gain", "bears"), [(2.0, False), (1.0, False), (0.5, True), (-0.5, True)])
def test_feedthrough_of_one_and_more_bears_no_delay(gain, bears):
    """x'' = -x - 0.2 x' + u with u = -gain x'': read tau late, poles come near exp(-s tau) = -1 / gain, whose real part
    is log(gain) / tau: right of the axis however short tau, where the gain is more than one.
    """
    plant = LinearModel.from_matrices([[0, 1], [-1, -0.2]], [[0], [1.0]], [[-1, -0.2]], [[1.0]], outputs=["a"])
    [c] = margins(loop(plant, Feedback(np.array([[gain]]), ("a",)))).channels
    assert (c.delay > 0) == bears
    if gain == 2.0:
        for tau in (1.0, 1e-3):  # a root of s^2 + 0.2 s + 1 + 2 s^2 exp(-s tau), by Newton from its asymptote
            s = complex(np.log(gain), 101 * np.pi) / tau
            for _ in range(50):
                late = np.exp(-s * tau)
                s -= (s**2 + 0.2 * s + 1 + gain * s**2 * late) / (2 * s + 0.2 + gain * (2 * s - s**2 * tau) * late)
            assert abs(s**2 + 0.2 * s + 1 + gain * s**2 * np.exp(-s * tau)) < 1e-6 * abs(s) ** 2 and s.real > 0
