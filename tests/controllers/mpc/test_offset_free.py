"""Offset-free control: no steady error under unknown forces; moves, targets and refusals in any units, 1e-9 to 1e+9."""

import dataclasses

import numpy as np
import pytest
from elastic_hub import DT, LINK, A, B, C, Q, R, roll

from pliant.controllers import MPC
from pliant.envs import scenes
from pliant.plants import LinearModel

RNG = np.random.default_rng(0)
A0, B0, C0 = RNG.standard_normal((4, 4)), RNG.standard_normal((4, 2)), RNG.standard_normal((2, 4))
A0 *= 0.9 / np.abs(np.linalg.eigvals(A0)).max()
NOISE, STEPS = {"a": 0.01, "b": 0.02, "u1": 1.0, "u2": 0.5}, 12


def played(kind, x, u, y):
    """Inputs (STEPS, nu) and the last target, in the first units: x, u, y are units of states, inputs, outputs."""
    A, B, C = x[:, None] * A0 / x, x[:, None] * B0 / u, y[:, None] * C0 / x
    model = LinearModel.from_matrices(A, B, C, outputs=["a", "b"], dt=0.1)
    units = dict(zip(NOISE, [*y, *u]))
    noise = {name: value * units[name] for name, value in NOISE.items()}
    more = {} if kind == "states" else {"reads": ("a", "b"), "noise": noise}
    weights = np.eye(4) / x / x[:, None], np.eye(2) / u / u[:, None]
    law = MPC.design(model, *weights, horizon=6, limits=(-0.5 * u, 0.5 * u), track=("a", "b"), disturbance=kind, **more)
    law.aim({"a": 0.3 * y[0], "b": -0.2 * y[1]})
    state, push, found = np.zeros(4), 0.1 * x * (kind != "outputs"), []
    for k in range(STEPS):
        move = law.act(0.1 * k, state if kind == "states" else C @ state)
        found.append(move / u)
        state = A @ state + B @ move + push
    target = law._knowledge._steady.copy()
    return np.array(found), target / np.concatenate([x, u])


@pytest.mark.parametrize("kind", ["states", "inputs", "outputs"])
def test_moves_and_targets_do_not_depend_on_units(kind):
    ones = np.ones(4), np.ones(2), np.ones(2)
    moves, target = played(kind, *ones)
    assert np.abs(moves).max() > 0.1
    for seed in range(2):
        rng = np.random.default_rng(seed)
        units = [10.0 ** rng.uniform(-9, 9, len(one)) for one in ones]
        for which in ([seed], [0, 1, 2]):
            given = [units[k] if k in which else one for k, one in enumerate(ones)]
            other, aimed = played(kind, *given)
            np.testing.assert_allclose(other, moves, atol=1e-8)
            np.testing.assert_allclose(aimed, target, atol=1e-8)


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_a_point_that_moves_is_refused_in_any_units(unit):
    """A mass that gravity moves by a third of what its input does in a step, and one that rounding moves."""
    still = LinearModel.from_matrices([[0.0, 1.0], [0.0, 0.0]], [[0.0], [unit]])
    law = {"dt": 0.1, "limits": (-30.0, 30.0)}
    for rate, refused in ((9.81, True), (1e-10, False)):
        model = dataclasses.replace(still, f0=np.array([0.0, rate * unit]))
        if refused:
            with pytest.raises(ValueError, match="no equilibrium, x2 moves by"):
                MPC.design(model, np.eye(2) / unit**2, [[1.0]], **law)
        else:
            MPC.design(model, np.eye(2) / unit**2, [[1.0]], **law)


def test_of_a_sampled_model_the_drift_is_that_of_a_step():
    """A step of a thousandth of a second moves by as much as it says, not by a thousandth of that."""
    model = LinearModel.from_matrices([[0.5]], [[1.0]], dt=1e-3)
    with pytest.raises(ValueError, match=r"x1 moves by 2e-05 in a step"):
        MPC.design(dataclasses.replace(model, f0=np.array([2e-5])), [[1.0]], [[1.0]])


def test_noise_by_name_is_checked():
    model = LinearModel.from_matrices(A0, B0, C0, outputs=["a", "b"], dt=0.1)
    options = {"track": ("a", "b"), "reads": ("a", "b"), "disturbance": "inputs"}
    with pytest.raises(ValueError, match=r"MPC.noise: reading or input 'c'"):
        MPC.design(model, np.eye(4), np.eye(2), noise={"c": 1.0}, **options)
    with pytest.raises(ValueError, match=r"MPC\.noise.*must be > 0"):
        MPC.design(model, np.eye(4), np.eye(2), noise={"a": 0.0}, **options)


@pytest.mark.parametrize(
    ("kind", "reads", "read"),
    [("states", None, np.eye(4)), ("inputs", ("theta", "bend"), np.eye(4)[:2]), ("inputs", ("tip", "theta"), None)],
)
def test_a_constant_unknown_force_leaves_no_steady_error(kind, reads, read):
    read = np.vstack([C[0], np.eye(4)[0]]) if read is None else read
    force = np.array([0.4, -0.2])
    options = {"dt": DT, "limits": (-1.5, 1.5)}
    plain = MPC.design(LINK, Q, R, **options)
    assert abs(C[0] @ roll(plain, np.zeros(4), 200, disturbance=force)[0][-1]) > 5e-3
    free = MPC.design(LINK, Q, R, **options, track=("tip", "bend"), disturbance=kind, reads=reads)
    free.aim({"tip": 0.3, "bend": 0.001})
    xs, us = roll(free, np.zeros(4), 800, disturbance=force, read=read)
    np.testing.assert_allclose(C @ xs[-1], [0.3, 0.001], atol=1e-8)
    assert free.record.limited and np.abs(us).max() <= 1.5


def test_output_disturbances_on_a_plant_whose_modes_decay():
    held = LinearModel.from_matrices(
        A - np.outer([0, 0, 1, -0.6], [9.0, 0, 1, 0]),
        B,
        C,
        states=LINK.states,
        inputs=LINK.inputs,
        outputs=LINK.outputs,
    )
    free = MPC.design(held, Q, R, dt=DT, track=("tip", "bend"), disturbance="outputs", reads=("tip", "bend"))
    free.aim({"tip": 0.1})
    xs, _ = roll(free, np.zeros(4), 600, disturbance=np.array([0.3, 0.1]), model=held, read=C)
    np.testing.assert_allclose(C @ xs[-1], [0.1, 0.0], atol=1e-6)
    free = MPC.design(
        held,
        Q,
        R,
        dt=DT,
        track=("tip", "bend"),
        disturbance="outputs",
        reads=("tip", "bend"),
        bounds={"tip": (-1, 0.08)},
    )
    free.aim({"tip": 0.1})
    xs, _ = roll(free, np.zeros(4), 600, disturbance=np.array([0.3, 0.1]), model=held, read=C)
    assert 0.079 < C[0] @ xs[-1] < 0.08 + 1e-6  # the bound is one on the tip as it is measured
    with pytest.raises(ValueError, match="do not tell such a disturbance from a state"):
        MPC.design(LINK, Q, R, dt=DT, track=("tip",), disturbance="outputs", reads=("tip", "bend"))


@pytest.mark.campaign
def test_payload_error_on_the_nonlinear_arm_leaves_no_steady_error():
    """The design model carries 0.5 kg, the plant 0.6 kg: gravity has changed, and the links bend differently.

    The third controller reads the joint encoders alone.
    """
    scene = scenes.get("two-link-reach")
    x0, _ = scene.target
    heavier = scene.plant.vary("payload.mass").stepper(scene.dt, substeps=scene.substeps)
    finals, free = [], {"track": ("theta1", "theta2")}
    for options in ({}, free, free | {"disturbance": "inputs", "reads": ("theta1", "theta2")}):
        controller = MPC.for_scene(scene, **options)
        x, picks = x0.copy(), scene.positions(controller.reads)
        for k in range(600):
            u = controller.act(k * scene.dt, x[picks])
            x = heavier(x[None], u[None], np.array([[0.6]]))[0].copy()
        finals.append(np.abs(x[:2] - x0[:2]).max())
    assert finals[0] > 1e-3 and max(finals[1:]) < 1e-7
