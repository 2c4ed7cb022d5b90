"""Tongues that a raster steps over, held against the averaged theory and against a scan's own edges."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import SliderCrank
from pliant.plants.slider_crank.steady_cycles import speed_scan
from pliant.plants.slider_crank.tongues import tongues

PLANT = SliderCrank.textbook()
ROD = PLANT.rod
FIRST = (np.pi / ROD.length) ** 2 * np.sqrt(ROD.EI / ROD.linear_density)


def short_crank(ratio):
    """A short crank, a light slider and light damping: (plant, half the relative width of the tongue).

    The axial force is -(m_s + rho A (L - x)) r W^2 cos(W t); on the first mode it makes the stiffness
    omega1^2 (1 + eps cos W t) with eps = (m_s + m_rod/2) r W^2/P, P = pi^2 E I/l^2, and at W = 2 omega1
    eps = 4 pi^2 (r/l)(m_s/m_rod + 1/2). Mathieu's equation with damping zeta is unstable where
    |W/(2 omega1) - 1| < sqrt((eps/4)^2 - zeta^2) to first order (Nayfeh and Mook, "Nonlinear Oscillations", 5.3).
    """
    zeta = 0.5 * ratio
    plant = dataclasses.replace(
        PLANT,
        crank_radius=ratio * ROD.length,
        slider_mass=0.1 * ROD.mass,
        force=0.0,
        modes=1,
        rod=dataclasses.replace(ROD, damping=2 * zeta / FIRST),
    )
    eps = 4 * np.pi**2 * ratio * 0.6
    return plant, np.sqrt((eps / 4) ** 2 - zeta**2), eps, zeta


@pytest.fixture(scope="module")
def found():
    plant, half, eps, _ = short_crank(0.004)
    return plant, half, eps, tongues(plant, 1.8 * FIRST, 2.3 * FIRST, raster=3, orders=1, points=91)


def test_what_a_raster_of_three_steps_over_is_found(found):
    """Mathieu's first tongue: |W/(2 omega) - 1| < sqrt((eps/4)^2 - zeta^2), to second order in eps."""
    _, half, eps, (tongue,) = found
    edges = np.array([tongue.low, tongue.high]) / (2 * FIRST) - 1
    np.testing.assert_allclose(edges, [-half, half], rtol=0, atol=0.15 * eps**2)
    assert tongue.low < tongue.peak < tongue.high and tongue.growth > 0


@pytest.mark.campaign
def test_edges_are_known_to_the_tolerance(found):
    """Against the bisection of `speed_scan` to a hundredth of it."""
    plant, half, _, (tongue,) = found
    speeds = 2 * FIRST * (1 + half * np.array([-2.0, 0.0, 2.0]))
    ((low, high),) = speed_scan(plant, speeds, points=91, edge=1e-6 / (2 * FIRST)).tongues
    assert tongue.low == pytest.approx(low, abs=1e-4) and tongue.high == pytest.approx(high, abs=1e-4)


def test_bad_input(found):
    plant = found[0]
    for given, words in (
        ({"slowest": -1.0}, "slowest"),
        ({"fastest": 1.0}, "fastest"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"raster": 1}, "raster"),
        ({"orders": 0}, "orders"),
        ({"plant": None}, "plant"),
        ({"plant": dataclasses.replace(plant, kinematics="rigid")}, "no deviations"),
    ):
        with pytest.raises(ValueError, match=words):
            tongues(**({"plant": plant, "slowest": 10.0, "fastest": 20.0} | given))
