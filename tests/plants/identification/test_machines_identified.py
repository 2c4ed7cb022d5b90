"""Trees and the arm of two links, played by SciPy and not by any integrator of ours: truth inside, pairs named."""

from functools import lru_cache

import casadi as ca
import machines_identified as campaign
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete
from scipy.stats import chi2

from pliant.plants import Beam, Experiment, FlexibleTree, Joint, TreeBody, identify


def wave(nu: int, sizes, seed: int, n: int = 121) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.cumprod(np.where(rng.uniform(size=(n, nu)) < 0.1, -1.0, 1.0), axis=0) * sizes


def by_scipy(plant, p, u, t) -> dict[str, np.ndarray]:
    """Outputs of the motion from rest, the input held, each interval by SciPy's LSODA to 1e-10."""
    f = ca.Function("f", list(plant.symbols), list(plant.expressions))
    w, x = np.zeros(plant.nw), [plant.rest_state]
    for a, b, held in zip(t[:-1], t[1:], u):
        rate = lambda s, y, held=held: np.array(f(s, y, held, w, p)[0]).ravel()  # noqa: E731
        x.append(solve_ivp(rate, (a, b), x[-1], method="LSODA", rtol=1e-10, atol=1e-12).y[:, -1])
    y = np.array([np.array(f(*row, w, p)[1]).ravel() for row in zip(t, x, u)])
    return {s.name: column for s, column in zip(plant.outputs, y.T)}


def identified(machine, true, outputs, u, t, seed):
    rng = np.random.default_rng(seed)
    read = {s: outputs[s] + level * rng.standard_normal(len(t)) for s, level in machine.noise.items()}
    start = {n: v * (1 + rng.choice([-1, 1]) * 0.2) for n, v in zip(machine.plant.varied, true)}
    found = identify(machine.plant, Experiment(t=t, u=u, measured=read), start=start)
    assert found.trusted, found.remarks
    for name, v in zip(machine.plant.varied, true):
        low, high = found.intervals[name]
        assert low < v < high, (name, v, low, high)
    error = np.array(list(found.standard_errors.values()))
    off = (np.array(list(found.values.values())) - true) / error
    assert off @ np.linalg.solve(found.correlation, off) < chi2.ppf(0.99, len(true))
    return found


def test_an_elastic_joint_against_its_exact_motion():
    """Spong 1987: J th'' = tau - b th' - (k e + d e')/r, I q'' = k e + d e', e = th/r - q; linear, so exact by the
    exponential of its matrix (zero-order hold). I: a bar's 5 kg (1 m)^2/3, the payload's m (1 m)^2 + 0.005 kg m^2.
    """
    machine, t = campaign.joint(), np.arange(301) / 300
    true = np.array([2300.0, 2.4, 1.7, 1.3e-4])
    (k, d, m, b), J, r = true, 2e-5, 100.0
    inertia = 5 / 3 + m + 0.005
    e, rate = np.array([-1.0, 1 / r, 0, 0]), np.array([0, 0, -1.0, 1 / r])
    twist = k * e + d * rate
    A = np.vstack([np.eye(4)[2:], twist / inertia, (-b * np.eye(4)[3] - twist / r) / J])
    Ad, Bd = cont2discrete((A, np.array([[0], [0], [0], [1 / J]]), np.eye(4), np.zeros((4, 1))), t[1])[:2]
    u, x = wave(1, machine.torques, 1, len(t)), np.zeros((len(t), 4))
    for i in range(len(t) - 1):
        x[i + 1] = Ad @ x[i] + Bd @ u[i]
    identified(machine, true, {"joint": x[:, 0], "joint_motor": x[:, 1]}, u, t, 2)


@pytest.mark.parametrize("name", ["boom", "two-link"])
def test_machines_that_scipy_plays(name):
    machine, t = campaign.MACHINES[name](), np.arange(121) / 200
    p = machine.plant.nominal_parameters * np.array([1.1, 0.9, 1.2, 0.8])[: len(machine.plant.varied)]
    u = wave(machine.plant.nu, machine.torques, 3)
    identified(machine, p, by_scipy(machine.plant, p, u, t), u, t, 4)


@lru_cache
def freed() -> FlexibleTree:
    """A strip on a free joint, nothing at its end."""
    strip = Beam.rectangular(0.8, 0.05, 0.006, campaign.ALUMINIUM)
    return FlexibleTree.serial([TreeBody(name="boom", joint=Joint(name="j1"), beam=strip, modes=(2, 0, 0, 0))])


def test_modulus_and_density_of_a_free_link_show_as_a_ratio_alone():
    """M(rho) x'' + K(E) (x + eta x') = 0: all multiples of (E, rho) move alike; a torque weighs the density."""
    plant = freed().vary("bodies.0.beam.E", "bodies.0.beam.density")
    t, x0 = np.arange(201) / 500, np.zeros(plant.nx)
    x0[1] = 0.01
    noise = {"boom_deflection_y": 1e-5}
    for torque, told in ((0.0, False), (0.5, True)):
        u = np.full((len(t), 1), torque)
        motion = Experiment.of(plant.simulate(x0, u, t), signals=tuple(noise), noise=noise)
        found = identify(plant, motion, noise=noise)
        assert bool(found.unidentifiable) != told
        if told:
            assert all(a < v < b for v, (a, b) in zip(plant.nominal_parameters, found.intervals.values()))
            continue
        (group,) = found.unidentifiable
        assert set(group.names) == set(plant.varied) and group.direction == pytest.approx((1.0, 1.0), abs=1e-3)
        assert set(found.intervals.values()) == {(-np.inf, np.inf)}


@pytest.mark.campaign
@pytest.mark.parametrize("name", list(campaign.MACHINES))
def test_a_sample_of_the_campaign_of_coverage(name):
    """tests/campaigns/machines_identified.py: squared distances add up to chi-squared."""
    found = list(campaign.runs(campaign.MACHINES[name](), 2, 5, seed=11))
    n = len(found[0][0]) * len(found)
    assert not any(one.doubts for _, _, one in found)
    assert chi2.ppf(1e-4, n) < sum(d for _, d, _ in found) < chi2.ppf(1 - 1e-4, n)
