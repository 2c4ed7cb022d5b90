"""python-control gets the plant: same motion, exact linear models, names kept."""

import control
import numpy as np
import pytest
import python_control

from pliant.plants import SingleLinkArm, TwoLinkArm

ARM = TwoLinkArm.textbook()
CONTRACT = dict(python_control.CHECKS)
SAMPLE = (
    *("rates_take_parameters", "outputs_take_parameters", "parameters_of_one_call_are_forgotten", "names_are_changed"),
    *("default_parameters_may_be_changed", "unknown_parameters_are_refused", "names_come_in_any_sequence"),
    *("parameters_that_are_no_numbers_are_refused", "parameters_that_are_no_mapping_are_refused"),
    *("states_are_outputs", "some_signals_are_outputs", "disturbances_are_inputs", "some_inputs_are_inputs"),
    *("unknown_signals_are_refused", "linearisation_takes_parameters", "linearisation_takes_numbers_and_parts"),
    *("the_linear_system_is_named", "names_are_copied_or_generic", "signals_of_the_linear_system_are_named"),
    *("names_that_do_not_fit_are_refused", "other_keywords_are_refused", "parameters_reach_into_a_loop"),
    *("linearisation_has_as_many_states_as_the_system", "response_takes_parameters", "copies_are_apart"),
    *("points_that_are_no_real_numbers_are_refused", "state_space_is_the_model"),
    *("operating_point_takes_parameters", "state_feedback_of_the_plant"),
)


def test_io_system_has_names_rates_and_outputs(plant, random_state):
    system = plant.to_control()
    assert isinstance(system, control.NonlinearIOSystem)
    assert list(system.state_labels) == [s.name for s in plant.states]
    assert list(system.input_labels) == [s.name for s in plant.inputs]
    assert list(system.output_labels) == [s.name for s in plant.outputs]
    x, u = random_state(plant, 1), np.full(plant.nu, 0.5)
    np.testing.assert_array_equal(system.dynamics(0.0, x, u), plant.dynamics(x, u))
    np.testing.assert_array_equal(system.output(0.0, x, u), plant.measure(x, u))


def test_linearize_is_exact_by_method_function_and_operating_point(random_state):
    system = ARM.to_control()
    x0, u0 = ARM.equilibrium(theta1=0.3, theta2=-0.4)
    A, B, _, C, D, _ = ARM.jacobians(x0, u0)
    point = control.OperatingPoint(x0, u0)
    for found in (system.linearize(x0, u0), control.linearize(system, x0, u0), system.linearize(point)):
        for ours, theirs in zip((A, B, C, D), (found.A, found.B, found.C, found.D)):
            np.testing.assert_array_equal(ours, theirs)
        assert found.state_labels[:2] == ["theta1", "theta2"]
        assert found.input_labels == ["tau1", "tau2"] and found.output_labels[-1] == "tip_acceleration"
    differences = control.NonlinearIOSystem(
        system.updfcn, system.outfcn, inputs=2, outputs=ARM.ny, states=ARM.nx
    ).linearize(x0, u0)
    assert np.abs(differences.A - A).max() > 1e-6  # what control does by itself is not exact
    np.testing.assert_array_equal(system.linearize(0, 0).A, ARM.jacobians(np.zeros(12))[0])


def test_state_space_of_the_linear_model_has_signal_names():
    model = SingleLinkArm.textbook().linearize(np.zeros(6))
    system = model.to_control()
    assert isinstance(system, control.StateSpace) and system.dt == 0
    assert system.state_labels[0] == "hub_angle" and system.input_labels == ["hub_torque"]
    first = ["hub_angle", "tip_deflection", "tip_deflection_rate", "tip_x", "tip_y"]
    assert system.output_labels == [*first, "root_curvature", "tip_acceleration"]
    np.testing.assert_array_equal(system.A, model.A)
    assert list(model.to_control(disturbances=True).input_labels)[1:] == ["tip_force_x", "tip_force_y"]


def test_python_control_simulates_the_same_motion():
    arm = SingleLinkArm.textbook()
    t = np.linspace(0, 0.2, 21)
    theirs = control.input_output_response(
        arm.to_control(), t, 2.0 * np.ones((1, 21)), np.zeros(6), solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-12}
    )
    np.testing.assert_allclose(theirs.states.T, arm.simulate(np.zeros(6), [2.0], t).x, atol=1e-7)


@pytest.mark.parametrize("name", SAMPLE)
def test_a_sample_of_python_controls_contract(name):
    """tests/campaigns/python_control.py tries all of it."""
    CONTRACT[name]()


def naive(plant, name=None, **options):
    """A system of two functions that takes params= and everything else, and uses none of it."""
    sizes = {"states": plant.nx, "inputs": plant.nu, "outputs": plant.ny, "params": options.get("params", {})}
    x, y = lambda t, x, u, params: plant.dynamics(x, u), lambda t, x, u, params: plant.measure(x, u)
    return control.nlsys(x, y, name=name, **sizes)


@pytest.mark.parametrize("name", ["rates_take_parameters", "linearisation_takes_parameters", "states_are_outputs"])
def test_the_contract_notices_a_system_that_drops_its_arguments(monkeypatch, name):
    monkeypatch.setattr(TwoLinkArm, "to_control", naive)
    with pytest.raises(AssertionError):
        CONTRACT[name]()
