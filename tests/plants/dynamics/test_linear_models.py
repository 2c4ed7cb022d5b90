"""Linear models along a nominal: that the plant's own deviations follow them, and what a nominal leaves over.

Nominals are motions of the plant, motions of the rigid one, and no motions at all.
"""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from convergence import slope

from pliant.plants import Payload, SingleLinkArm, Trajectory, TwoLinkArm

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()


def moving(arm, times):
    """A smooth motion of the arm from rest, with its torques."""

    def drive(t):
        return (np.array([4.0, 1.5]) if arm.nu == 2 else np.array([30.0])) * np.sin(np.pi * t) ** 2

    x0, _ = arm.equilibrium({s.name: -np.pi / 2 if i == 0 else 0.0 for i, s in enumerate(arm.states[: arm.nu])})
    return x0, drive, arm.simulate(x0, drive, times, rtol=1e-12, atol=1e-14)


LTV_ARMS = {
    "two": dataclasses.replace(ARM, hub_inertia=(0.1, 0.02)),
    "two stiffened": dataclasses.replace(
        ARM, basis="polynomial", kinematics="stiffened", hub_inertia=(0.1, 0.02), modes=(1, 1)
    ),
    "one": LINK,
}
SIZES = np.array([1 / 32, 1 / 64, 1 / 128])


@pytest.mark.every(4)
@pytest.mark.parametrize("name", list(LTV_ARMS))
def test_nonlinear_minus_ltv_error_falls_quadratically(name):
    arm, times = LTV_ARMS[name], np.linspace(0, 1, 1001)
    x0, drive, nominal = moving(arm, times)
    ltv = arm.linearize_along(nominal)
    assert np.abs(ltv.c).max() < 1e-9 * np.abs(nominal.dx).max()
    n = arm.nx // 2
    start, extra = np.zeros(arm.nx), 0.2 * np.ones(arm.nu)
    start[: arm.nu], start[arm.nu : n], start[n : n + arm.nu] = 0.1, 1e-3, 0.3
    errors = []
    for size in SIZES:
        true = arm.simulate(x0 + size * start, lambda t, s=size: drive(t) + s * extra, times, rtol=1e-12, atol=1e-14)
        dx, dy = ltv.simulate(size * start, size * extra)
        errors.append([np.abs(true.x - nominal.x - dx).max(), np.abs(true.y - nominal.y - dy).max()])
    for column in np.transpose(errors):
        assert slope(SIZES, column) == pytest.approx(2, abs=0.1)


OFFSET_LINK = dataclasses.replace(
    LINK, payload=Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0)), hub_friction=0.1, modes=1
)
RIGID_NOMINALS = {**LTV_ARMS, "one offset": OFFSET_LINK, "one driven": dataclasses.replace(LINK, drive="motion")}
FEWER = {
    "two": 20,
    "two stiffened": 40,
    "one": 8,
    "one offset": 15,
    "one driven": 0.99,
}  # errors, at sizes 1/8 and below


def at_its_own_accelerations(arm, ltv):
    """The model with the Jacobians of M^-1 r in place of those at the nominal's accelerations."""
    A, B, E, *_ = arm.jacobians(ltv.x, ltv.u, w=ltv.w, t=ltv.t)
    return dataclasses.replace(ltv, A=A, B=B, E=E)


@pytest.mark.every(6)
@pytest.mark.parametrize("name", list(RIGID_NOMINALS))
def test_nominal_of_the_rigid_arm_is_corrected_by_its_residual(name):
    """The nominal goes from the elastic arm's own motion (size 0) to the rigid arm's (size 1).

    Linearised at the nominal's accelerations the error is smaller than at those that the arm would have on it.
    """
    arm, times = RIGID_NOMINALS[name], np.linspace(0, 1, 1001)
    _, _, elastic = moving(arm, times)
    _, _, rigid = moving(arm.ladder()[0], times)
    n, k = arm.nx // 2, arm.nu
    x, dx = np.zeros_like(elastic.x), np.zeros_like(elastic.x)
    for full, small in ((x, rigid.x), (dx, rigid.dx)):
        full[:, :k], full[:, n : n + k] = small[:, :k], small[:, k:]
    errors = []
    for size in 4 * SIZES:
        nominal = Trajectory.from_arrays(
            times,
            (1 - size) * elastic.x + size * x,
            elastic.u,
            plant=arm,
            dx=(1 - size) * elastic.dx + size * dx,
        )
        ltv = arm.linearize_along(nominal)
        missed = []
        for model in (ltv, at_its_own_accelerations(arm, ltv)):
            deviation, _ = model.simulate(elastic.x[0] - nominal.x[0])
            missed.append(np.abs(nominal.x + deviation - elastic.x).max())
        errors.append(missed[0])
        without = np.abs(nominal.x - elastic.x).max()
        assert np.abs(ltv.c).max() > 1e-3 and errors[-1] < 0.01 * without
        assert missed[1] > FEWER[name] * missed[0]
    assert slope(4 * SIZES, errors) == pytest.approx(2, abs=0.1)


@pytest.mark.every(3)
@pytest.mark.parametrize("name", ["two", "two stiffened", "one offset"])
def test_a_slew_of_the_rigid_arm_is_a_nominal_as_it_is(name):
    """The whole rigid motion with its torques; the elastic arm from the same rest, by nonlinear simulation."""
    arm, times, fewer = RIGID_NOMINALS[name], np.linspace(0, 1, 801), 100 if name == "two" else 20
    arm, rigid = (dataclasses.replace(a, gravity=0.0) for a in (arm, arm.ladder()[0]))
    peak = np.array([4.0, 1.5]) if arm.nu == 2 else np.array([30.0])

    def drive(t):
        return peak * np.sin(2 * np.pi * t)

    slew, true = (a.simulate(np.zeros(a.nx), drive, times, rtol=1e-11, atol=1e-13) for a in (rigid, arm))
    x, dx = np.zeros((2, len(times), arm.nx))
    columns = [*range(arm.nu), *range(arm.nx // 2, arm.nx // 2 + arm.nu)]
    x[:, columns], dx[:, columns] = slew.x, slew.dx
    ltv = arm.linearize_along(Trajectory.from_arrays(times, x, slew.u, plant=arm, dx=dx))
    away, n = true.x - x, arm.nx // 2
    missed = [
        np.abs(model.simulate(np.zeros(arm.nx))[0] - away)[:, :n].max()
        for model in (ltv, at_its_own_accelerations(arm, ltv))
    ]
    assert missed[0] < 0.01 * np.abs(away[:, :n]).max() and missed[1] > fewer * missed[0]


@pytest.mark.every(3)
def test_along_a_motion_of_the_plant_both_linearisations_are_one(plant, random_state):
    own_states = {"attitude": "quaternion"} if hasattr(plant, "appendages") else {}
    x = np.array([random_state(plant, seed) for seed in range(4)])
    u, t = np.full((4, plant.nu), 0.3), np.arange(4.0)
    w = np.tile(np.linspace(1.0, -2.0, plant.nw), (4, 1))
    rate = plant.dynamics(x, u, w=w, t=t)
    own = Trajectory.from_arrays(t, x, u, plant=plant, dx=rate, w=w, disturbances=plant.disturbances)
    ltv = plant.linearize_along(own, **own_states)
    for name, wanted in zip("ABECDF", plant.jacobians(x, u, w=w, t=t)):
        atol = 1e-11 * np.abs(wanted).max(initial=1.0)
        np.testing.assert_allclose(getattr(ltv, name), wanted, rtol=1e-9, atol=atol, err_msg=name)


def test_linearised_residual_agrees_with_central_differences(lagrangian, random_state):
    """M(q) a - r(q, v, u, w) at accelerations that the plant does not have."""
    plant, rng = lagrangian, np.random.default_rng(3)
    x, u, w = random_state(plant, 8), np.full(plant.nu, 0.5), np.linspace(0.2, 0.1, plant.nw)
    n = plant.nx // 2
    a = 3 * rng.uniform(-1, 1, n)
    dx = np.tile(np.concatenate([x[n:], a]), (2, 1))
    nominal = Trajectory.from_arrays(
        [0.0, 1.0], np.tile(x, (2, 1)), np.tile(u, (2, 1)), plant=plant, dx=dx, w=np.tile(w, (2, 1)),
        disturbances=plant.disturbances,
    )  # fmt: skip
    ltv = plant.linearize_along(nominal)
    free = [i for i in range(n) if i not in plant.driven]

    terms = ca.Function("terms", list(plant.symbols), list(plant._terms[:2]))

    def missing(x, u, w):
        moving = a.copy()
        for i, k in plant.driven.items():
            moving[i] = u[k]
        M, r = (np.array(value) for value in terms(0.0, x, u, w, []))
        return (r[:, 0] - M @ moving)[free]

    M = plant.mass_matrix(x)[np.ix_(free, free)]
    for j, (block, size) in enumerate(zip((ltv.A[0], ltv.B[0], ltv.E[0]), (plant.nx, plant.nu, plant.nw))):
        for k in range(size):
            h = 1e-6 if j == 0 and plant.states[k].unit == "m" else 1e-5
            ends = []
            for s in (h, -h):
                point = [x.copy(), u.copy(), w.copy()]
                point[j][k] += s
                ends.append(missing(*point))
            wanted = (ends[0] - ends[1]) / (2 * h)
            scale = np.abs(M @ block[n:][free]).max()
            np.testing.assert_allclose(M @ block[n:, k][free], wanted, rtol=1e-5, atol=1e-5 * max(1.0, scale))


def test_linear_model_along_a_nominal_keeps_its_disturbance():
    times = np.linspace(0, 0.2, 11)
    nominal = ARM.simulate(np.zeros(ARM.nx), None, times, w=[0.5, -2.0])
    ltv = ARM.linearize_along(nominal)
    np.testing.assert_array_equal(ltv.w, np.tile([0.5, -2.0], (11, 1)))
    assert np.abs(ltv.c).max() < 1e-9 * np.abs(nominal.dx).max()


@pytest.mark.campaign
def test_a_compiled_plant_gives_the_same_model_along_a_nominal():
    rng = np.random.default_rng(4)
    x, u = 0.02 * rng.normal(size=(30, OFFSET_LINK.nx)), rng.normal(size=(30, 1))
    nominal = Trajectory.from_arrays(np.linspace(0, 1, 30), x, u, plant=OFFSET_LINK, dx=rng.normal(size=x.shape))
    slow, fast = OFFSET_LINK.linearize_along(nominal), OFFSET_LINK.compile().linearize_along(nominal)
    for name in "ABECDFc":
        have, want = getattr(fast, name), getattr(slow, name)
        np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-10 * np.abs(want).max(initial=1.0))
