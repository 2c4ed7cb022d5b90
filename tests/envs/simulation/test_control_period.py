"""One control period of a scene: what it returns by hand, bounds on both sides, the plant's own motion."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.envs.simulation.control_period import observe_function, on_virtual_machine, reference, substep_function
from pliant.plants.validity.ranges import values

SLEW = scenes.get("single-link-slew")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_margin_is_the_share_left_of_the_tightest_bound_on_both_sides(sign: float) -> None:
    """The slew's hub may turn by 12 rad/s, either way: 10.8 leaves a tenth, 13.2 is a tenth beyond."""
    for rate, margin in ((10.8, 0.1), (13.2, -0.1)):
        x = np.zeros(SLEW.plant.nx)
        x[SLEW.positions(["hub_angle_rate"])] = sign * rate
        found = observe_function(SLEW)(x, 0.0, reference(SLEW), np.zeros(SLEW.plant.nw), [1.0, 2.1e11])[2]
        assert float(found) == pytest.approx(margin, rel=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_episode_ends_beyond_either_side_of_a_bound(sign: float) -> None:
    """No torque acts against the hub's 13 rad/s within one period; 11 rad/s is within."""
    for rate, ends in ((13.0, True), (11.0, False)):
        x = np.zeros(SLEW.plant.nx)
        x[SLEW.positions(["hub_angle_rate"])] = sign * rate
        env = PlantEnv(SLEW)
        env.reset(options={"state": x})
        _, _, terminated, truncated, info = env.step(np.zeros(1))
        assert (terminated, truncated, info["diverged"]) == (ends, False, False)
    many = PlantVectorEnv(SLEW, 8)
    many.reset()
    ended = np.zeros(8, dtype=bool)
    for _ in range(60):  # a constant full torque, four lanes each way, takes the hub past 12 rad/s
        _, _, terminated, _, _ = many.step(sign * np.repeat([[1.0], [-1.0]], 4, axis=0))
        ended |= terminated
    assert ended.all()


@pytest.mark.parametrize("name", scenes.names())
def test_the_virtual_machine_plays_the_plants_own_motion(name: str) -> None:
    """A period from the start under a held input, by Plant.simulate's RK4; the action is clipped."""
    scene = scenes.get(name)
    x0, p = scene.initial[0][None], scene.varied_plant.nominal_parameters[None]
    action = np.linspace(-0.2, 2.0, scene.plant.nu)[None] if scene.plant.nu > 1 else np.array([[2.0]])
    ref, w = reference(scene)[None], np.zeros((1, scene.plant.nw))
    compute = on_virtual_machine(scene)
    x, seen, cost, margin, sound = compute(
        np.zeros(1), x0, action, ref, w, p, (scene.dt / scene.substeps,), scene.substeps
    )
    u = np.clip(action[0], -1.0, 1.0) * scene.limits
    motion = scene.plant.simulate(
        x0[0], np.array([u, u]), scene.times[:2], method="rk4", step=scene.dt / scene.substeps
    )
    np.testing.assert_allclose(x[0], motion.x[1], rtol=1e-10, atol=1e-12)
    y0 = scene.plant.measure(x0[0], u)
    assert float(cost[0, 0]) == pytest.approx(scene.dt * float(scene.stage_cost(x0[0], u, y0)), rel=1e-12)
    assert sound[0, 0] == 1.0 and margin[0, 0] > 0 and seen.shape == (1, len(scene.observe) + 1)
    reached = values(scene.plant, motion)[1] / np.array([r.limit for r in scene.plant.validity])
    assert seen[0, -1] == pytest.approx(reached.max(initial=0.0), rel=1e-9)


def test_a_plant_that_depends_on_time_needs_a_goal_that_moves() -> None:
    scene = scenes.get("spacecraft-orbit")
    with pytest.raises(ValueError, match="the plant depends on time"):
        substep_function(dataclasses.replace(scene, goal_rates=()))
