"""The spacecraft's scenes against inertias by hand, Euler's equations, gravity-gradient librations and light pressure.

Inertias   a panel of 12 kg, two lines at +-1 m from its boom, from 1 m to 7 m off the hub's centre: int x^2 dm = 228
           kg m^2, int y^2 dm = 12 kg m^2
"""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.environments.env import PlantEnv
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.envs.rendering.spacecraft_geometry import box_of, exaggeration, reach_of, scenery
from pliant.envs.rendering.spatial import sun_direction
from pliant.plants.core.quaternions import matrix_of

REFERENCE = json.loads((Path(__file__).parents[2] / "reference" / "spacecraft.json").read_text())
NAMES = ("spacecraft-slew", "spacecraft-spin", "spacecraft-orbit")
ALONG, ACROSS = 228.0, 12.0  # [kg m^2] of a panel


def rigid(name, **changes):
    """The scene with its rigid plant."""
    scene = scenes.get(name, **changes)
    return scene.with_plant(scene.plant.ladder()[0])


def test_slew_takes_the_torque_of_a_rigid_body():
    """J d2(angle)/dt2 about z, J = 180 + 2 * 228, along the quintic of minimum jerk (Flash and Hogan, 1985)."""
    scene, t = scenes.get("spacecraft-slew"), np.linspace(0.0, 60.0, 61)
    s = t / 60.0
    wanted = (180.0 + 2 * ALONG) * (np.pi / 3) / 60.0**2 * (60 * s - 180 * s**2 + 120 * s**3)
    torque = np.array([scene.nominal_input(time) for time in t])
    np.testing.assert_allclose(torque[:, 2], wanted, atol=1e-12)
    np.testing.assert_allclose(torque[:, :2], 0.0, atol=1e-12)
    assert np.abs(torque).max() < 0.6 * min(scene.limits)

    motion = rigid("spacecraft-slew").open_loop(rtol=1e-10, atol=1e-12)
    s = np.minimum(motion.t / 60.0, 1.0)
    angle = np.pi / 3 * (10 * s**3 - 15 * s**4 + 6 * s**5 - 1)
    np.testing.assert_allclose(motion["attitude_z"], 2 * np.sin(angle / 2), atol=1e-8)
    np.testing.assert_allclose(motion["attitude_x"], 0.0, atol=1e-12)


def test_slew_of_a_turn_about_any_axis_ends_at_rest_at_the_goal():
    """Of a rigid spacecraft with three different moments of inertia, which precesses unless it is held on its axis."""
    quaternion = np.array([0.8, -0.3, 0.4, np.sqrt(1 - 0.64 - 0.25)])
    start = tuple((f"quaternion_{k}", float(v)) for k, v in enumerate(quaternion))
    motion = rigid("spacecraft-slew", start=start).open_loop(rtol=1e-10, atol=1e-12)
    left = np.array([motion[f"attitude_{c}"][-1] for c in "xyz"] + [motion[f"body_rate_{c}"][-1] for c in "xyz"])
    assert np.abs(motion["body_rate_x"]).max() > 0.01 and np.abs(left).max() < 1e-7


def test_slew_bends_the_panels_as_their_inertia_does():
    """Quasi-static tip deflection of the first clamped mode at the largest acceleration, -alpha (root + x) on the boom.

    phi of the uniform cantilever, lambda = 1.8751: int phi dx = 2 0.7341 L / lambda, int x phi dx = 2 L^2 / lambda^2,
    tip 2.
    """
    motion = scenes.get("spacecraft-slew").open_loop(rtol=1e-7, atol=1e-10)
    alpha = 5.7735 * np.pi / 3 / 60.0**2
    quasi = 2.0 * alpha * (0.7830 * 1.0 + 0.5688 * 6.0) / (2 * np.pi * 0.15) ** 2
    assert np.abs(motion["tip1_z"]).max() == pytest.approx(quasi, rel=0.15)  # the ringing adds some
    np.testing.assert_allclose(motion["tip1_z"], motion["tip2_z"], atol=1e-9)  # antisymmetric, each in its own axes


@pytest.mark.parametrize("axis", "xyz")
def test_spin_by_eulers_equations(axis):
    """Panels at 45 degrees: the boom's axis sees all of int y^2 dm, y and z half of it each."""
    I = dict(zip("xyz", (200 + 2 * ACROSS, 150 + 2 * ALONG + ACROSS, 180 + 2 * ALONG + ACROSS)))
    assert I["x"] < I["y"] < I["z"]
    others = [I[c] for c in "xyz" if c != axis]
    square = 0.1**2 * (others[0] - I[axis]) * (I[axis] - others[1]) / (others[0] * others[1])
    roots = rigid("spacecraft-spin", axis=axis).goal_model.eigenvalues
    wanted = np.sqrt(square + 0j)
    assert np.abs(roots - wanted).min() < 1e-9 and np.abs(roots + wanted).min() < 1e-9
    assert (roots.real.max() > 1e-6) == (axis == "y")

    flexible = scenes.get("spacecraft-spin", axis=axis).feedback_model
    own = flexible.eigenvalues
    if axis == "y":
        assert own.real.max() == pytest.approx(wanted.real, rel=0.01)
    elif axis == "z":  # largest moment of inertia: dampers take the nutation away
        nutation = own[np.argmin(np.abs(own - wanted))]
        assert -1e-6 < nutation.real < -1e-9 and nutation.imag == pytest.approx(wanted.imag, rel=0.02)
    else:  # smallest: they make it grow (energy sink; Likins, 1966)
        assert 1e-9 < own[np.argmin(np.abs(own - wanted))].real < 1e-6


def test_spin_about_the_intermediate_axis_tumbles_and_lqr_holds_it():
    from pliant.studies.closed_loop.closed_loop import closed_loop

    scene = scenes.get("spacecraft-spin", axis="y")
    assert np.abs(scene.open_loop(rtol=1e-8, atol=1e-10)["body_rate_y"] - 0.1).max() > 0.1
    law, loops = closed_loop(scene)
    assert not any(name.startswith(("attitude", "quaternion")) for name in law.reads)
    assert all(loop.stable and loop.final_error < 1e-6 for loop in loops)


def librations(k1, k3):
    """Roll-yaw frequencies over the orbital rate: s^4 + (1 + 3 k1 + k1 k3) s^2 + 4 k1 k3 (Hughes, 1986, Sec. 9.2)."""
    return np.sqrt(-np.roots([1.0, 1 + 3 * k1 + k1 * k3, 4 * k1 * k3]))


def test_orbit_librates_as_a_gravity_gradient_satellite():
    known = REFERENCE["gravity_gradient"]
    for wanted in librations(*known["k"]):  # the formula first, against the reference
        assert np.abs(np.array(known["frequencies_over_orbital_rate"]) - wanted).min() < 2e-4
    I1, I2, I3 = 1000 + 2 * ALONG, 1600 + 2 * ACROSS, 700 + 2 * ALONG + 2 * ACROSS  # panels flat: across is along x
    k1, k3 = (I2 - I3) / I1, (I2 - I1) / I3
    assert 0 < k3 < k1 < 1  # Lagrange's region
    held = rigid("spacecraft-orbit", goal=(("rate_y", -1.1e-3),), goal_rates=())  # turning panels would add momentum
    found = np.abs(held.goal_model.eigenvalues) / 1.1e-3
    for wanted in (*librations(k1, k3), np.sqrt(3 * (I1 - I3) / I2)):
        assert np.abs(found - wanted).min() < 1e-6

    scene = rigid("spacecraft-orbit", start=(("quaternion_0", 1.0), ("quaternion_2", 5e-4), ("rate_y", -1.1e-3)))
    pitch = scene.open_loop(rtol=1e-9, atol=1e-12)["attitude_y"]  # panels held flat
    times = scene.times[:-1][np.diff(np.sign(pitch)) != 0]
    half = np.pi / (1.1e-3 * np.sqrt(3 * (I1 - I3) / I2))
    assert np.diff(times) == pytest.approx(half, abs=scene.dt)


def test_orbit_panels_face_the_sun():
    scene = scenes.get("spacecraft-orbit")
    goal = scene.goal_motion()
    assert goal.t[-1] == pytest.approx(2 * np.pi / 1.1e-3, rel=1e-12)
    for k in (0, 137, 500, len(goal.t) - 1):
        drawn, sun = scenery(scene.plant, goal.x[k]), sun_direction(scene.plant, goal.t[k])
        for sheet in drawn.sheets:
            normal = np.cross(sheet[-1, 0] - sheet[0, 0], sheet[0, 1] - sheet[0, 0])
            assert abs(normal @ sun) == pytest.approx(np.linalg.norm(normal), rel=1e-9)
    # light on 12 m^2 face on, shared by the first mode (int phi dx = 0.7830 L); the whole is 0.5 % lighter than fixed
    force = 4.56e-6 * 12.0 * ((1 - 0.1) + 2 * (0.1 + 0.1 / 3))
    residual = dict(zip((s.name for s in scene.goal_model.states), scene.goal_model.f0))
    assert abs(residual["eta1_1_rate"]) == pytest.approx(0.7830 * force / 12.0, rel=0.03)
    assert residual["hinge1_1"] == residual["q_y"] == 0.0


def test_a_goal_that_moves_is_what_observations_are_measured_from():
    scene = scenes.get("spacecraft-orbit", duration=600.0)
    env = PlantEnv(scene)
    env.reset(options={"state": scene.target[0]})
    for _ in range(scene.steps):
        obs, reward, terminated, *_ = env.step(np.zeros(scene.plant.nu))
        assert not terminated and np.abs(obs).max() < 5e-3 and -1e-3 < reward <= 0  # it librates a little
        assert np.abs(obs[6:10]).max() < 1e-12  # hinges and their rates
    hinge = scene.plant.states.index(next(s for s in scene.plant.states if s.name == "hinge1_1"))
    assert env.state[hinge] == pytest.approx(1.1e-3 * 600.0, rel=1e-9)


def test_lanes_have_their_own_time():
    """A lane that starts later sees the goal and the sun where they are in its own episode."""
    scene = scenes.get("spacecraft-orbit", duration=3000.0)
    single, vector = PlantEnv(scene), PlantVectorEnv(scene, 3)
    vector.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(150):
        vector.step(rng.uniform(-0.2, 0.2, (3, scene.plant.nu)))
    vector.reset(options={"reset_mask": np.array([False, True, False])})
    single.reset(seed=0)
    for _ in range(150):
        actions = rng.uniform(-0.2, 0.2, (3, scene.plant.nu))
        many, one = vector.step(actions), single.step(actions[1])
        np.testing.assert_array_equal(many[0][1], one[0])
        assert many[1][1] == one[1]


@pytest.mark.parametrize("name", NAMES)
def test_the_quaternion_keeps_its_norm(name):
    scene = scenes.get(name)
    vector, at = PlantVectorEnv(scene, 32, randomise=True), scene.plant.layout.quaternion
    vector.reset(seed=1)
    rng, worst = np.random.default_rng(1), 0.0
    np.testing.assert_allclose(np.linalg.norm(vector.states[:, at], axis=1), 1.0, atol=1e-15)
    for _ in range(min(scene.steps - 1, 600)):
        vector.step(rng.uniform(-0.3, 0.3, (32, scene.plant.nu)))
        worst = max(worst, float(np.abs(np.linalg.norm(vector.states[:, at], axis=1) - 1).max()))
    assert worst < 1e-9


def test_random_starts_turn_about_every_axis():
    env = PlantEnv("spacecraft-slew", randomise=True)
    errors = np.array([env.reset(seed=k)[0][:3] for k in range(20)])
    assert (np.ptp(errors, axis=0) > 0.02).all() and np.abs(errors[:, 2] + 1).max() < 0.1
    wheels = PlantEnv("spacecraft-orbit", randomise=True)
    begun = np.array([wheels.reset(seed=k)[0] for k in range(5)])
    assert (begun[:, 6:] == 0).all()  # hinges at the sun's angle and rate, wheels at rest


def test_scenery_by_hand():
    """The textbook hub's box: 6 (I_y + I_z - I_x) / m and so on; panels from 1 m to 7 m, 2 m wide, bent as drawn."""
    scene = scenes.get("spacecraft-slew")
    craft = scene.plant
    np.testing.assert_allclose(box_of(craft) ** 2, np.array([130.0, 230.0, 170.0]) * 6 / 500, rtol=1e-12)
    assert reach_of(craft) == pytest.approx(np.hypot(7.0, 1.0), rel=1e-12)
    x = craft.state(eta1_1=0.01)
    at = craft.layout.quaternion
    x[at] = scene.initial[0][at]
    for factor in (1.0, 20.0):
        seen, true = scenery(craft, x, factor), scenery(craft, x, factor, from_hub=True)
        np.testing.assert_allclose(true.sheets[0] @ matrix_of(x[at]).T, seen.sheets[0], atol=1e-12)
        tip = true.sheets[0][-1].mean(axis=0)  # the first panel's z is the hub's -y
        np.testing.assert_allclose(tip, [7.0, -2 * 0.01 * factor, 0.0], atol=1e-6)
        assert np.linalg.norm(true.sheets[0][-1, 1] - true.sheets[0][-1, 0]) == pytest.approx(2.0)
    assert exaggeration(scene) == 20


def test_a_scene_with_loads_needs_its_own_drive():
    orbit = scenes.get("spacecraft-orbit")
    with pytest.raises(
        ValueError, match="'spacecraft-orbit': drive = None needs a spacecraft without loads and wheels"
    ):
        _ = dataclasses.replace(orbit, drive=None).nominal_input
    with pytest.raises(ValueError, match=r"spacecraft-spin\.axis = 'q' must be one of 'x', 'y', 'z'"):
        scenes.get("spacecraft-spin", axis="q")
