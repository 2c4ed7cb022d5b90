"""Plant: signals, calls with batches, the symbolic copy, and what a subclass has to write."""

import dataclasses
import pickle
import threading

import numpy as np
import pytest

from pliant.plants import SingleLinkArm, Trajectory, TwoLinkArm

ARM = TwoLinkArm.textbook()


def test_signals_have_distinct_names_and_sizes_that_fit(plant, random_state):
    sizes = {"states": plant.nx, "inputs": plant.nu, "disturbances": plant.nw, "outputs": plant.ny}
    for kind, size in sizes.items():
        signals = getattr(plant, kind)
        assert len(signals) == size == len({s.name for s in signals})
        assert all(s.unit for s in signals)
    assert plant.parameters == () and plant.label
    x = random_state(plant, 1)
    assert plant.dynamics(x).shape == (plant.nx,)
    assert plant.measure(x).shape == (plant.ny,)
    shapes = [block.shape for block in plant.jacobians(x)]
    columns = (plant.nx, plant.nu, plant.nw)
    assert shapes == [(rows, c) for rows in (plant.nx, plant.ny) for c in columns]


def test_every_argument_may_be_shared_or_one_per_row():
    rng = np.random.default_rng(0)
    x, u, w = rng.normal(size=(3, 12)) * 0.1, rng.normal(size=(3, 2)), rng.normal(size=(3, 2))
    expected = np.array([ARM.dynamics(x[0], u[k], w=w[0]) for k in range(3)])
    np.testing.assert_array_equal(ARM.dynamics(x[0], u, w=w[0]), expected)
    np.testing.assert_array_equal(ARM.dynamics(x[0], u, w=w[0], t=np.zeros(3)), expected)
    assert ARM.dynamics(x, w=w).shape == (3, 12)
    assert [b.shape for b in ARM.jacobians(x)] == [
        (3, r, c) for r, c in ((12, 12), (12, 2), (12, 2), (11, 12), (11, 2), (11, 2))
    ]
    assert ARM.mass_matrix(x).shape == (3, 6, 6) and ARM.energy(x).shape == (3,)


def test_results_are_fresh_arrays():
    x = np.zeros(12)
    first = ARM.dynamics(x)
    kept = first.copy()
    ARM.dynamics(x + 0.1)
    np.testing.assert_array_equal(first, kept)
    np.testing.assert_array_equal(x, np.zeros(12))


def test_threads_do_not_mix_up_their_buffers(random_state):
    states = [random_state(ARM, seed) for seed in range(4)]
    expected = [ARM.dynamics(x) for x in states]
    wrong = []

    def work(k):
        for _ in range(200):
            if not np.array_equal(ARM.dynamics(states[k]), expected[k]):
                wrong.append(k)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_plant_is_its_parameters(plant, random_state):
    same = pickle.loads(pickle.dumps(plant))
    x = random_state(plant, 2)
    assert same == plant and hash(same) == hash(plant)
    np.testing.assert_array_equal(same.dynamics(x), plant.dynamics(x))
    with pytest.raises(dataclasses.FrozenInstanceError):
        plant.varied = ()


def test_every_step_of_the_ladder_keeps_names_and_parameters(plant):
    ladder = plant.ladder()
    assert all(step.outputs == plant.outputs and step.inputs == plant.inputs for step in ladder)
    for name in ("payload", "gravity", "hub", "environment", "rod", "crank_speed"):
        assert all(getattr(step, name, None) == getattr(plant, name, None) for step in ladder)
    assert len({step.label for step in ladder}) == len(ladder)


def test_linear_model_holds_the_point_and_the_jacobians(random_state):
    x, u, w = random_state(ARM, 4), np.array([1.0, -2.0]), np.array([0.5, 0.1])
    model = ARM.linearize(x, u, w=w)
    for name, block in zip("ABECDF", ARM.jacobians(x, u, w=w)):
        np.testing.assert_array_equal(getattr(model, name), block)
    np.testing.assert_array_equal(model.f0, ARM.dynamics(x, u, w=w))
    np.testing.assert_array_equal(model.y0, ARM.measure(x, u, w=w))
    assert (model.states, model.inputs, model.outputs) == (ARM.states, ARM.inputs, ARM.outputs)


def test_motion_has_the_signals_and_the_energy_audit_needs_energies():
    arm = SingleLinkArm.textbook()
    motion = arm.simulate(np.zeros(6), [2.0], [0, 0.1, 0.2], audit=True)
    assert isinstance(motion, Trajectory)
    np.testing.assert_array_equal(motion.y, arm.measure(motion.x, motion.u))
    np.testing.assert_allclose(motion.dx, arm.dynamics(motion.x, motion.u), rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(motion["hub_torque"], [2.0, 2.0, 2.0])
    assert motion.stats["energy_balance"] < 1e-9 and motion.stats["steps"] > 0
    with pytest.raises(ValueError, match=r"audit = True needs .* \"dop853\", not 'rk4'"):
        arm.simulate(np.zeros(6), None, [0, 0.1], method="rk4", step=1e-3, audit=True)


def test_energy_audit_sees_a_wrong_power(monkeypatch):
    """The audit is a test only if work and energy are counted apart."""
    arm = dataclasses.replace(SingleLinkArm.textbook(), gravity=1.234)
    monkeypatch.setattr(SingleLinkArm, "net_power", lambda self: 1.001 * super(SingleLinkArm, self).net_power())
    motion = arm.simulate(np.zeros(6), [2.0], [0, 0.1, 0.2], audit=True)
    assert motion.stats["energy_balance"] > 1e-5


def test_power_of_a_tip_force_is_force_times_velocity(arm, random_state):
    plant = arm
    x, force = random_state(plant, 6), np.array([3.0, -2.0])
    names = [s.name for s in plant.outputs]
    C, rate = plant.jacobians(x)[3], np.zeros(plant.nx)
    n = plant.nx // 2
    rate[:n] = x[n:]
    velocity = (C @ rate)[[names.index("tip_x"), names.index("tip_y")]]
    if plant.driven:
        pytest.skip("the reaction of a driven hub changes with the force")
    change = plant.power(x, w=force)[0] - plant.power(x)[0]
    assert change == pytest.approx(force @ velocity, rel=1e-10)


def test_a_stepper_takes_one_step_unless_it_is_told_how_many():
    x = np.array([[0.3, -0.2, *[0.001] * 4, *[0.0] * 6]])
    one, alone = ARM.stepper(0.002)(x), ARM.simulate(x[0], None, [0.0, 0.002], method="rk4", step=0.002).x[-1]
    np.testing.assert_allclose(one[0], alone, rtol=1e-12, atol=1e-15)
    assert np.abs(ARM.stepper(0.002, substeps=2)(x) - one).max() > 1e-9


@pytest.mark.parametrize("call", ["dynamics", "measure", "jacobians", "linearize"])
@pytest.mark.parametrize("size", [11, 13])
def test_arrays_of_another_length_are_refused_in_every_call(call, size):
    with pytest.raises(ValueError, match=rf"TwoLinkArm\.x has shape \({size},\)"):
        getattr(ARM, call)(np.zeros(size), np.zeros(2))


def test_a_linear_model_is_about_one_point():
    for x, u in ((np.zeros((2, 12)), np.zeros(2)), (np.float64(0.0), np.zeros(2))):
        with pytest.raises(ValueError, match=r"TwoLinkArm\.x"):
            ARM.linearize(x, u)
