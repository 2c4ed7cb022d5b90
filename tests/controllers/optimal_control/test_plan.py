"""Planned nominals: rest at the end, limits kept, the finer simulation follows, points, paths, failures."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.base.objective import Objective
from pliant.controllers.optimal_control.optimal import optimal
from pliant.controllers.optimal_control.plan import plan, rigid_motion
from pliant.envs import scenes
from pliant.plants.core.errors import InfeasibleError

SLEW, REACH = scenes.get("single-link-slew"), scenes.get("two-link-reach")


@pytest.mark.parametrize(
    "scene", [SLEW, pytest.param(REACH, marks=pytest.mark.campaign)], ids=lambda s: getattr(s, "name", None)
)
def test_ends_at_rest_within_limits_and_the_plant_follows(scene):
    found = plan(scene, reserve=0.2, substeps=40)
    assert found.t[-1] == pytest.approx(scene.move_time)
    assert np.all(np.abs(found.u) <= 0.8 * np.array(scene.limits) + 1e-9)
    np.testing.assert_allclose(found.x[-1], scene.target[0], atol=1e-9)
    np.testing.assert_allclose(found.x[0], scene.initial[0])
    motion = found.trajectory(scene.plant)
    for name, bound in scene.bounds:
        assert np.abs(motion[name]).max() <= bound + 1e-9
    # The plant integrated to 1e-10 under the same inputs, then held at the goal: it stays at rest.
    held = np.vstack([found.u, np.tile(scene.target[1], (26, 1))])
    t = scene.dt * np.arange(len(held))
    fine = scene.plant.simulate(found.x[0], held, t, rtol=1e-10, atol=1e-12)
    assert np.abs(fine.x[: len(found.t)] - found.x).max() < 2e-5
    assert np.abs(fine.x[len(found.t) :] - scene.target[0]).max() < 2e-5


def test_error_against_the_finer_simulation_falls_with_the_substeps():
    errors = []
    for substeps in (8, 16, 32):
        found = plan(SLEW, substeps=substeps)
        held = np.vstack([found.u, found.u[-1:]])
        fine = SLEW.plant.simulate(found.x[0], held, found.t, rtol=1e-11, atol=1e-13)
        errors.append(np.abs(fine.x[-1] - SLEW.target[0]).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.5)  # RK4


def test_deflection_and_speed_limits_bind_and_cost_effort():
    free = plan(SLEW)
    tight = plan(SLEW, bounds={"tip_deflection": 0.006, "hub_angle_rate": (-0.1, 1.6)})
    motion = tight.trajectory(SLEW.plant)
    assert np.abs(free.trajectory(SLEW.plant)["tip_deflection"]).max() > 0.007
    assert np.abs(motion["tip_deflection"]).max() == pytest.approx(0.006, abs=1e-6)
    assert motion["hub_angle_rate"].max() <= 1.6 + 1e-9
    assert tight.cost > free.cost
    np.testing.assert_allclose(tight.x[-1], SLEW.target[0], atol=1e-9)


def test_least_effort_is_that_of_the_linear_arm_for_a_small_turn():
    # A small turn is linear: of all inputs that end at rest the least-norm one, by the pseudo-inverse of the reach.
    scene = dataclasses.replace(SLEW, goal=(("hub_angle", 1e-3),))
    found = plan(scene, weights={}, effort={"hub_torque": 1e4}, tolerance=1e-10, substeps=40)
    model = SLEW.plant.linearize(*SLEW.initial).discretize(SLEW.dt)
    reach = np.hstack([np.linalg.matrix_power(model.A, 49 - k) @ model.B for k in range(50)])
    least = np.linalg.pinv(reach) @ (scene.target[0] - scene.initial[0])
    assert np.abs(found.u[:, 0] - least).max() < 1e-3 * np.abs(least).max()
    assert np.sum(found.u**2) == pytest.approx(np.sum(least**2), rel=1e-4)


def test_reserve_holds_on_both_sides():
    found = plan(SLEW, reserve=0.6)
    assert found.u.max() == pytest.approx(16.0, abs=1e-5) and found.u.min() == pytest.approx(-16.0, abs=1e-5)


@pytest.mark.campaign
def test_via_points_are_met():
    found = plan(REACH, via={0.5: {"theta1": -1.4, "theta2": 0.6}})
    motion = found.trajectory(REACH.plant)
    assert motion["theta1"][25] == pytest.approx(-1.4, abs=1e-9) and motion["theta2"][25] == pytest.approx(
        0.6, abs=1e-9
    )
    np.testing.assert_allclose(found.x[-1], REACH.target[0], atol=1e-9)
    found = plan(SLEW, via={0.5: {"tip_y": 0.3}})
    assert found.trajectory(SLEW.plant)["tip_y"][25] == pytest.approx(0.3, abs=1e-9)


def test_a_path_of_the_tip_is_followed_where_the_rigid_inputs_leave_it():
    end = REACH.plant.measure(*REACH.target)
    begin = REACH.plant.measure(*REACH.initial)
    i = [s.name for s in REACH.plant.outputs].index("tip_x")

    def straight(t):
        s = t / 1.2
        s = 10 * s**3 - 15 * s**4 + 6 * s**5
        return dict(zip(("tip_x", "tip_y"), begin[i : i + 2] + s * (end - begin)[i : i + 2]))

    found = plan(REACH, time=1.2, path=straight, weights={"tip_x": 1e4, "tip_y": 1e4})
    motion = found.trajectory(REACH.plant)
    wanted = np.array([list(straight(t).values()) for t in found.t])
    off = np.hypot(motion["tip_x"] - wanted[:, 0], motion["tip_y"] - wanted[:, 1])[5:].max()
    plain = plan(REACH, time=1.2).trajectory(REACH.plant)
    plain_off = np.hypot(plain["tip_x"] - wanted[:, 0], plain["tip_y"] - wanted[:, 1]).max()
    assert off < 5e-3 < 5e-2 < plain_off
    np.testing.assert_allclose(found.x[-1], REACH.target[0], atol=1e-9)


def test_starts_from_the_rigid_solution_in_fewer_iterations():
    warm = plan(REACH)
    x = REACH.initial[0] + np.linspace(0, 1, 51)[:, None] * (REACH.target[0] - REACH.initial[0])
    line = plan(REACH, guess=(x, np.tile(REACH.target[1], (50, 1))))
    assert warm.iterations < line.iterations and warm.cost == pytest.approx(line.cost, rel=1e-6)
    # The rigid inputs are those of the scene's own nominal, half a period on.
    _, u = rigid_motion(REACH.plant, REACH.initial[0], *REACH.target, 1.0, 50)
    np.testing.assert_allclose(u[20], REACH.nominal_input(20.5 * REACH.dt), rtol=1e-6, atol=1e-6)


@pytest.mark.campaign
def test_spacecraft_turns_from_rest_to_rest():
    scene = scenes.get("spacecraft-slew")
    found = plan(scene)
    motion = found.trajectory(scene.plant)
    for name in ("attitude_x", "attitude_y", "attitude_z", "rate_x", "rate_y", "rate_z", "eta1_1", "eta2_1_rate"):
        assert abs(motion[name][-1]) < 1e-8
    assert abs(np.linalg.norm(found.x[-1, :4]) - 1.0) < 1e-6


def test_what_cannot_be_done():
    with pytest.raises(InfeasibleError, match="violated by"):
        plan(SLEW, time=0.3, iterations=60)
    with pytest.raises(InfeasibleError, match=r"tip_deflection|the step of|at the goal|hub_angle"):
        plan(SLEW, bounds={"tip_deflection": 1e-4}, iterations=60)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"reserve": 1.0}, r"plan.reserve = 1.0 must be >= 0 and < 1"),
        ({"time": 0.0}, r"plan.time = 0.0 must be at least the control period 0.02 s"),
        ({"via": {2.0: {"hub_angle": 0.1}}}, r"plan.via at 2.0 s must be within \[0.02, 0.98\] s"),
        ({"via": {0.5: {"hub": 0.1}}}, r"hub"),
        ({"path": lambda t: {"hub_angle": t}}, r"plan.weights must name the signals that the path gives"),
        ({"bounds": {"tip": 1.0}}, r"Objective.bounds: state or output"),
    ],
)
def test_bad_input(change, message):
    with pytest.raises(ValueError, match=message):
        plan(SLEW, **change)


def test_end_pin_of_an_output_that_the_input_enters_is_refused():
    with pytest.raises(ValueError, match=r"optimal.at\[20\]: tip_acceleration depends on the input"):
        optimal(Objective.of(SLEW), SLEW.initial[0], 20, at={20: {"tip_acceleration": 0.0}})
    with pytest.raises(ValueError, match=r"optimal.at step = 21 must be an integer from 1 to 20"):
        optimal(Objective.of(SLEW), SLEW.initial[0], 20, at={21: {"hub_angle": 0.0}})
