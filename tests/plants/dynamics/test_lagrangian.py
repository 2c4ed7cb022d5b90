"""What every plant must do, whatever its fidelity: definite mass, balanced energy, exact derivatives, known limits."""

import dataclasses
import os
import warnings

import casadi as ca
import numpy as np
import pytest
from convergence import slope

from pliant.plants import FlexibleSpacecraft, SingleLinkArm, TwoLinkArm
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.spacecraft_parts.environment import Environment

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()
HUBBED = dataclasses.replace(ARM, modes=(1, 1), hub_inertia=(0.1, 0.02))
METHOD_ORDER = {"rk4": 4, "midpoint": 2, "rosenbrock": 3}


def stiffer(plant, factor):
    """The plant with every beam's E multiplied."""
    changes = {
        name: dataclasses.replace(getattr(plant, name), E=getattr(plant, name).E * factor)
        for name in ("link", "link1", "link2")
        if hasattr(plant, name)
    }
    return dataclasses.replace(plant, **changes)


def test_mass_matrix_is_symmetric_and_positive_definite(plant, random_state):
    states = np.array([random_state(plant, seed) for seed in range(20)])
    M = plant.mass_matrix(states)
    np.testing.assert_allclose(M, M.transpose(0, 2, 1), rtol=0, atol=1e-14 * np.abs(M).max())
    assert np.linalg.eigvalsh(M).min() > 0


def test_kinetic_energy_is_that_of_the_mass_matrix(lagrangian, random_state):
    plant = lagrangian
    states = np.array([random_state(plant, seed) for seed in range(20)])
    M = plant.mass_matrix(states)
    v = states[:, plant.nx // 2 :]
    np.testing.assert_allclose(plant.kinetic(states), np.einsum("bi,bij,bj->b", v, M, v) / 2, rtol=1e-11)


def test_energy_changes_at_the_net_power(plant, random_state):
    driven = isinstance(plant, FlexibleSpacecraft) and any(a.hinge.drive == "motion" for a in plant.appendages)
    if driven or (isinstance(plant, FlexibleSpacecraft) and plant.environment.orbit is not None):
        pytest.skip("its power is defined as the rate of its energy; see the test of driven hinges below")
    for seed in range(5):
        x, u, w = random_state(plant, seed), np.full(plant.nu, 0.7), np.linspace(1.5, -0.4, plant.nw)
        put_in, lost = plant.power(x, u, w=w)
        rate = plant.dynamics(x, u, w=w)
        step = 1e-3 / np.abs(rate).max()
        steps = (step, step / 2, step / 4)
        differences = [(plant.energy(x + h * rate) - plant.energy(x - h * rate)) / (2 * h) for h in steps]
        change = (64 * differences[2] - 20 * differences[1] + differences[0]) / 45
        n = len(plant.mass_matrix(x))
        v = np.abs(x[plant.nx - n :]) @ np.abs(plant.mass_matrix(x)) @ np.abs(rate[plant.nx - n :])
        rounding = 1e-13 * abs(plant.energy(x)) / step
        assert put_in - lost == pytest.approx(change, abs=1e-7 * (v + abs(put_in)) + rounding)
        assert lost >= 0


def test_driving_hinges_takes_the_power_of_torques(random_state):
    """Hinges moved by their accelerations and by the torques that give the same are one motion: the same power."""

    textbook = FlexibleSpacecraft.textbook()

    def with_drive(drive):
        hinge = Hinge(axes=((0.0, 1.0, 0.0), (0.6, 0.0, 0.8)), stiffness=(100.0, 50.0), damping=2.0, drive=drive)
        parts = tuple(dataclasses.replace(a, hinge=hinge, damping=0.01, modes=1) for a in textbook.appendages)
        return dataclasses.replace(textbook, appendages=parts, environment=Environment(torque=(0.1, 0.0, 0.2)))

    moved, turned = with_drive("motion"), with_drive("torque")
    assert [s.name for s in moved.states] == [s.name for s in turned.states]
    slots = [k for part in turned.layout.hinge_inputs for k in range(part.start, part.stop)]
    rates = [k for part in turned.layout.hinge_rates for k in range(part.start, part.stop)]
    for seed in range(3):
        x = random_state(moved, seed)
        u, w = np.random.default_rng(seed).uniform(-1, 1, moved.nu), np.linspace(1.5, -0.4, moved.nw)
        unit = np.eye(turned.nu)[slots]
        zero = np.where(np.isin(np.arange(turned.nu), slots), 0.0, u)
        rest = turned.dynamics(x, zero, w=w)
        slope = np.array([turned.dynamics(x, zero + e, w=w)[rates] - rest[rates] for e in unit]).T
        torques = zero + np.linalg.solve(slope, u[slots] - rest[rates]) @ unit
        wanted = moved.dynamics(x, u, w=w)
        np.testing.assert_allclose(turned.dynamics(x, torques, w=w), wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())
        put_in, lost = turned.power(x, torques, w=w)
        np.testing.assert_allclose(moved.power(x, u, w=w), (put_in, lost), rtol=1e-9)
        assert abs(put_in) > 1e-3


@pytest.mark.every(4)
def test_work_done_equals_energy_gained(undamped):
    """Over two seconds, a swing; over twenty in tests/campaigns/long_motions.py."""
    seconds = int(os.environ.get("PLIANT_TEST_SECONDS", "2"))
    x = np.zeros(undamped.nx)
    x[0] = -1.2
    torque = 0.3 * np.ones(undamped.nu)
    motion = undamped.simulate(
        x, lambda t: torque * np.sin(2 * t), np.linspace(0, seconds, 4 * seconds + 1), rtol=1e-9, atol=1e-12, audit=True
    )
    assert np.ptp(undamped.energy(motion.x)) > 1e-3  # work was done
    assert motion.stats["energy_balance"] < 1e-9


@pytest.mark.every(6)
@pytest.mark.parametrize("method", list(METHOD_ORDER))
@pytest.mark.parametrize("arm", [HUBBED, LINK], ids=["two", "one"])
def test_drift_of_each_fixed_step_method_falls_at_its_order(arm, method):
    x = np.zeros(arm.nx)
    x[:2] = [-1.0, 0.5 if arm.nu == 2 else 0.01]
    t = np.linspace(0, 0.5, 3)
    exact = arm.simulate(x, None, t, rtol=1e-12, atol=1e-14).x[-1]
    steps = np.array([5e-4, 2.5e-4, 1.25e-4]) * (2 if method == "rk4" else 1)
    motions = [arm.simulate(x, None, t, method=method, step=h).x[-1] for h in steps]
    order = METHOD_ORDER[method]
    assert slope(steps, [np.abs(z - exact).max() for z in motions]) == pytest.approx(order, abs=0.25)
    drift = np.abs(arm.energy(np.array(motions)) - arm.energy(x))
    # Midpoint keeps a quadratic energy exactly, and RK4 loses it at one order above its own (|R(iz)| = 1 - z^6/144).
    assert drift.max() < 1e-8 * abs(arm.energy(x)) or slope(steps, drift) > order - 0.25


def complex_step(function, point, h=1e-30):
    """Jacobians of an SX function's first output, by running its instructions on complex numbers."""
    width = sum(len(p) for p in point)
    inputs = [np.tile(np.asarray(p, dtype=complex)[:, None], (1, width)) for p in point]
    column = 0
    for block in inputs:
        for row in block:
            row[column] += 1j * h
            column += 1
    unary = {
        ca.OP_NEG: np.negative, ca.OP_SIN: np.sin, ca.OP_COS: np.cos, ca.OP_SQ: np.square, ca.OP_SQRT: np.sqrt,
        ca.OP_TWICE: lambda a: 2 * a, ca.OP_INV: lambda a: 1 / a, ca.OP_ASSIGN: np.copy,
    }  # fmt: skip
    binary = {
        ca.OP_ADD: np.add,
        ca.OP_SUB: np.subtract,
        ca.OP_MUL: np.multiply,
        ca.OP_DIV: np.divide,
        ca.OP_CONSTPOW: np.power,
    }
    work, result = {}, np.zeros((function.numel_out(0), width), dtype=complex)
    for i in range(function.n_instructions()):
        op, into, of = (
            function.instruction_id(i),
            function.instruction_output(i),
            function.instruction_input(i),
        )
        if op == ca.OP_CONST:
            work[into[0]] = np.full(width, complex(function.instruction_constant(i)))
        elif op == ca.OP_INPUT:
            work[into[0]] = inputs[of[0]][of[1]]
        elif op == ca.OP_OUTPUT:
            if into[0] == 0:
                result[into[1]] = work[of[0]]
        elif op in unary:
            work[into[0]] = unary[op](work[of[0]])
        else:
            work[into[0]] = binary[op](work[of[0]], work[of[1]])
    return np.split(result.imag / h, np.cumsum([len(p) for p in point])[:-1], axis=1)


@pytest.mark.every(2)
def test_jacobians_agree_with_the_complex_step(plant, random_state):
    t, x, u, w, p = plant.symbols
    functions = [ca.Function("f", [t, x, u, w, p], [ca.densify(e)]) for e in plant.expressions]
    x, u, w = random_state(plant, 0), np.full(plant.nu, 2.0), np.linspace(1.0, -3.0, plant.nw)
    exact = [block for f in functions for block in complex_step(f, [np.array([0.3]), x, u, w, np.zeros(0)])[1:4]]
    found = plant.jacobians(x, u, w=w, t=0.3)
    for name, a, b in zip("ABECDF", found, exact):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-12 * max(1.0, np.abs(b).max(initial=0.0)), err_msg=name)


def test_jacobians_agree_with_central_differences(plant, random_state):
    x, u, w = random_state(plant, 7), np.full(plant.nu, 0.5), np.linspace(0.2, 0.1, plant.nw)
    found = plant.jacobians(x, u, w=w)
    point, sizes = [x, u, w], (plant.nx, plant.nu, plant.nw)
    for rows, of in ((found[:3], plant.dynamics), (found[3:], plant.measure)):
        for i, (block, size) in enumerate(zip(rows, sizes)):
            for k in range(size):
                # A step of the size at which the curvature of fast modes and rounding balance.
                h = 1e-6 if i == 0 and plant.states[k].unit == "m" else 1e-5
                unit = h * np.eye(size)[k]
                left, right = (
                    of(*(z + s * unit if i == j else z for j, z in enumerate(point[:2])),
                       w=w + s * unit if i == 2 else w)
                    for s in (-1, 1)
                )  # fmt: skip
                np.testing.assert_allclose(
                    (right - left) / (2 * h),
                    block[:, k],
                    rtol=1e-6,
                    atol=1e-6 * max(1.0, np.abs(block).max()) + 1e-15 * np.abs(right).max() / h,
                )


def test_batched_calls_equal_single_ones(plant, random_state):
    x = np.array([random_state(plant, seed) for seed in range(4)])
    u, w = np.linspace(-1, 1, 4 * plant.nu).reshape(4, -1), np.linspace(0.3, 0.2, plant.nw)
    for call in (plant.dynamics, plant.measure):
        rows = call(x, u, w=w)
        assert rows.shape[0] == 4
        for k in range(4):
            np.testing.assert_array_equal(rows[k], call(x[k], u[k], w=w))
    for many, *single in zip(plant.jacobians(x, u, w=w), *(plant.jacobians(x[k], u[k], w=w) for k in range(4))):
        np.testing.assert_array_equal(many, single)
    np.testing.assert_array_equal(plant.energy(x), [plant.energy(z) for z in x])


@pytest.mark.every(3)
def test_mirror_image_moves_in_mirror_image(arm, random_state):
    """Without gravity, (q, v, u) -> (-q, -v, -u) and a tip force mirrored in x give mirrored rates."""
    plant = arm
    straight = dataclasses.replace(plant, gravity=0.0)
    if any(straight.payload.offset):
        straight = dataclasses.replace(straight, payload=dataclasses.replace(plant.payload, offset=(0.05, 0.0, 0.0)))
    for seed in range(4):
        x, u, w = random_state(straight, seed), np.full(plant.nu, 0.6), np.array([0.4, -0.9])
        one, other = straight.dynamics(x, u, w=w), straight.dynamics(-x, -u, w=w * [1, -1])
        np.testing.assert_allclose(other, -one, rtol=0, atol=1e-11 * np.abs(one).max())
        mirrored = -np.ones(plant.ny)
        mirrored[[s.name == "tip_x" for s in plant.outputs]] = 1.0
        np.testing.assert_allclose(straight.measure(-x), mirrored * straight.measure(x), atol=1e-14)


@pytest.mark.every(6)
def test_stiff_plant_tends_to_the_rigid_one(arm):
    """At rest with its deflections settled, joint accelerations and tip differ from the rigid arm's as 1/EI."""
    plant = arm
    rigid = plant.ladder()[0]
    assert rigid.label == "rigid"
    if plant.label == "rigid" or any(plant.driven):
        pytest.skip("rigid already, or its hub is driven")
    nj = plant.nu
    errors, factors = [], np.array([10.0, 100.0, 1000.0])
    for factor in factors:
        stiff = stiffer(plant, factor)
        angles = {s.name: 0.4 for s in stiff.states[:nj]}
        x0, u0 = stiff.equilibrium(angles)
        xr, ur = rigid.equilibrium(angles)
        at = [i for i, s in enumerate(stiff.outputs) if s.name in ("tip_x", "tip_y")]
        tip = np.abs(stiff.measure(x0, u0)[at] - rigid.measure(xr, ur)[at]).max()
        errors.append(tip if plant.gravity else 1 / stiff.natural_frequencies(locked=tuple(angles))[0] ** 2)
    assert slope(factors, errors) == pytest.approx(-1, abs=0.02)


@pytest.mark.campaign
def test_outputs_of_all_fidelities_agree_as_stiffness_grows():
    for arm in (dataclasses.replace(ARM, hub_inertia=(0.1, 0.02)), dataclasses.replace(LINK, gravity=9.81)):

        def drive(t, n=arm.nu):
            return 0.5 * np.sin(2 * np.pi * t) * np.ones(n)

        spread = []
        for factor in (1.0, 10.0):
            tips = []
            for step in arm.ladder()[:6:2] + arm.ladder()[5:6]:
                stiff = stiffer(step, factor)
                x0, _ = stiff.equilibrium(
                    {s.name: -np.pi / 2 if i == 0 else 0.0 for i, s in enumerate(stiff.states[: arm.nu])}
                )
                motion = stiff.simulate(x0, drive, np.linspace(0, 1, 21), rtol=1e-6, atol=1e-9)
                tips.append([motion["tip_x"], motion["tip_y"]])
            spread.append(np.abs(np.array(tips) - tips[0]).max())
        assert spread[1] < 0.15 * spread[0] < 1e-2


def test_frequencies_about_a_state_beyond_numbers_are_refused_in_words():
    arm = TwoLinkArm.textbook()
    with warnings.catch_warnings(), pytest.raises(ValueError, match=r"natural_frequencies\.x0 = .* not finite"):
        warnings.simplefilter("ignore")
        arm.natural_frequencies(np.full(arm.nx, 1e140))
