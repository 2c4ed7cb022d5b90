"""Steady cycles and their Floquet multipliers."""

import dataclasses

import numpy as np
import pytest

from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.steady_cycles import floquet_multipliers, speed_scan, steady_cycle

PLANT = SliderCrank.textbook()
ROD = PLANT.rod
FIRST = (np.pi / ROD.length) ** 2 * np.sqrt(ROD.EI / ROD.linear_density)


def changed(**changes):
    return dataclasses.replace(PLANT, **changes)


FULL = {
    "crank_friction": 0.01,
    "slider_friction": 2.0,
    "dry_friction": 0.5,
    "gravity": 9.81,
}


def test_prescribed_speed_and_its_torque_give_the_same_cycle():
    free = changed(**(FULL | {"dry_friction": 0.0}), crank_speed=None, axial_modes=1)
    driven = dataclasses.replace(free, crank_speed=20.0)
    a, b = steady_cycle(free, speed=20.0), steady_cycle(driven)
    np.testing.assert_array_equal(a.x, b.x)
    n = free.nx // 2
    assert np.abs(a.dx[:, n]).max() < 1e-8  # the torque keeps the speed
    np.testing.assert_allclose(a.dx, b.dx, rtol=0, atol=1e-7 * np.abs(b.dx).max())
    power = [free.power(x, u, w=np.zeros(2)) for x, u in zip(a.x[:-1], a.u[:-1])]
    balance = np.array(power).sum(axis=0)
    assert balance[0] == pytest.approx(balance[1], rel=1e-6)  # over a cycle all the work is lost


def test_steady_cycle_closes_under_the_nonlinear_equations():
    cycle = steady_cycle(PLANT, points=91)
    motion = PLANT.simulate(cycle.x[0], None, cycle.t)
    np.testing.assert_allclose(motion.x[:, 1:3], cycle.x[:, 1:3], rtol=0, atol=1e-15)
    assert motion.x[-1, 0] == pytest.approx(2 * np.pi, rel=1e-12)
    assert np.abs(PLANT.linearize_along(cycle).c).max() < 1e-6 * np.abs(cycle.dx).max()


def test_floquet_multipliers_are_those_of_the_nonlinear_motion():
    plant = changed(modes=1, rod=dataclasses.replace(ROD, damping=0.05 * ROD.damping))
    cycle = steady_cycle(plant, speed=150.0, points=181)
    model = plant.linearize_along(cycle)
    found = floquet_multipliers(model, ("eta1", "eta1_rate"))
    kept, h = [1, 3], 1e-7
    columns = []
    for i in kept:
        ends = []
        for sign in (1, -1):
            start = cycle.x[0].copy()
            start[i] += sign * h * (1 if i == 1 else FIRST)
            ends.append(plant.simulate(start, None, cycle.t[[0, -1]], rtol=1e-12, atol=1e-15).x[-1, kept])
        columns.append((ends[0] - ends[1]) / (2 * h * (1 if i == 1 else FIRST)))
    expected = np.linalg.eigvals(np.transpose(columns))
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(expected), atol=1e-6)
    every = floquet_multipliers(model)
    assert np.sort(np.abs(every))[-2:] == pytest.approx([1.0, 1.0], abs=1e-6)  # the crank's angle and speed


def short_crank(ratio):
    """A short crank, a light slider and light damping: (plant, half the relative width of the tongue).

    The axial force is -(m_s + rho A (L - x)) r W^2 cos(W t); on the first mode it makes the stiffness
    omega1^2 (1 + eps cos W t) with eps = (m_s + m_rod/2) r W^2/P, P = pi^2 E I/l^2, and at W = 2 omega1
    eps = 4 pi^2 (r/l)(m_s/m_rod + 1/2). Mathieu's equation with damping zeta is unstable where
    |W/(2 omega1) - 1| < sqrt((eps/4)^2 - zeta^2) to first order (Nayfeh and Mook, "Nonlinear Oscillations", 5.3).
    """
    zeta = 0.5 * ratio
    plant = changed(
        crank_radius=ratio * ROD.length,
        slider_mass=0.1 * ROD.mass,
        force=0.0,
        modes=1,
        rod=dataclasses.replace(ROD, damping=2 * zeta / FIRST),
    )
    eps = 4 * np.pi**2 * ratio * 0.6
    return plant, np.sqrt((eps / 4) ** 2 - zeta**2), eps, zeta


@pytest.mark.campaign
def test_first_tongue_is_where_theory_puts_it():
    misses = []
    for ratio in (0.004, 0.002):
        plant, half, eps, zeta = short_crank(ratio)
        speeds = 2 * FIRST * (1 + half * np.array([-2.0, 0.0, 2.0]))
        scan = speed_scan(plant, speeds, points=91, edge=1e-6)
        ((low, high),) = scan.tongues
        edges = np.array([low, high]) / (2 * FIRST) - 1
        np.testing.assert_allclose(edges, [-half, half], rtol=0, atol=0.15 * eps**2)
        assert scan.growth[1] == pytest.approx((eps / 4 - zeta) * FIRST, rel=eps**2)
        assert scan.multipliers[1, 0].real < -1 and abs(scan.multipliers[1, 0].imag) < 1e-9  # half the frequency
        assert scan.growth[0] == pytest.approx(-zeta * FIRST, rel=0.02)
        misses.append(np.abs(edges - [-half, half]).max())
    assert misses[0] / misses[1] == pytest.approx(4.0, rel=0.1)  # what is missing is of second order


def test_damping_past_the_threshold_closes_the_tongue():
    plant, _, eps, _ = short_crank(0.004)
    heavy = dataclasses.replace(plant, rod=dataclasses.replace(plant.rod, damping=2 * 1.1 * (eps / 4) / FIRST))
    assert speed_scan(heavy, 2 * FIRST * np.array([0.99, 1.0, 1.01]), points=91).tongues == ()
    light = dataclasses.replace(plant, rod=dataclasses.replace(plant.rod, damping=2 * 0.9 * (eps / 4) / FIRST))
    assert speed_scan(light, 2 * FIRST * np.array([1.0]), points=91).tongues != ()


def test_bad_cycles_are_named():
    with pytest.raises(ValueError, match=r"steady_cycle.speed = None"):
        steady_cycle(changed(crank_speed=None))
    with pytest.raises(ValueError, match=r"steady_cycle.speed = -3.0 must be > 0"):
        steady_cycle(PLANT, speed=-3.0)
    for words, make in (
        ("steady_cycle.speed = 'fast' must be a number > 0", lambda: steady_cycle(PLANT, speed="fast")),
        ("steady_cycle.plant = None must be a SliderCrank", lambda: steady_cycle(None, speed=10.0)),
        ("steady_cycle.tolerance = -1 must be > 0", lambda: steady_cycle(PLANT, tolerance=-1)),
        ("steady_cycle.guess = 3 must be a Trajectory", lambda: steady_cycle(PLANT, guess=3)),
        ("speed_scan.edge = 'fine' must be a number > 0", lambda: speed_scan(PLANT, [1.0], edge="fine")),
        ("speed_scan.progress = 1 must be a function", lambda: speed_scan(PLANT, [1.0], progress=1)),
        ("floquet_multipliers.model = 3 must be a LTVModel", lambda: floquet_multipliers(3)),
    ):
        with pytest.raises(ValueError, match=words):
            make()
    with pytest.raises(ValueError, match=r"speed_scan.speeds"):
        speed_scan(PLANT, [2.0, 1.0])
    with pytest.raises(ValueError, match="no deviations"):
        speed_scan(changed(kinematics="rigid"), [1.0])
