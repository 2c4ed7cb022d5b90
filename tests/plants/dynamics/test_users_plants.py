"""What the library asks of plants that answer nothing themselves: a crane and two turntables of a user."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from users_plants import LIFT, LOAD, ROPE, TROLLEY, TURN, Crane, Tables

from pliant.controllers import PD, sensors_of
from pliant.controllers.base.joint_reference import Joints, joints
from pliant.controllers.joint_control.pd import fastest_decay
from pliant.controllers.optimal_control.plan import rigid_motion
from pliant.envs import PlantEnv
from pliant.envs.rendering.planar import renderer
from pliant.plants import Plant, PliantError, Signal
from pliant.plants.core.signals import Joint
from pliant.plants.integration.minimum_jerk import minimum_jerk
from pliant.plants.native.batch_kernels import random_points
from pliant.studies.closed_loop.closed_loop import driven_to_goal
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.rollout import rollout
from pliant.studies.closed_loop.scores import deflections, score
from pliant.studies.common import operating_point
from pliant.studies.figures import arm_outline
from pliant.studies.stability.verdicts import left_out


def test_rates_are_read_from_the_equations():
    assert Crane().rates == {"lean": "sway", "place": "going"}
    assert Tables().rates == {"alpha": "omega", "beta": "zeta"}
    assert Tables().velocities == ("omega", "zeta") and Tables().repeated == ("alpha",)
    assert operating_point.coordinates(Tables()) == ("alpha", "beta")


def test_joints_of_a_users_plants():
    assert Crane().joints == (Joint("pull", "place", "going"),)
    assert joints(Tables()) == Joints(("beta", "alpha"), ("zeta", "omega"))


def test_sensors_of_a_users_plants():
    (encoder,) = sensors_of(Crane())
    assert (encoder.kind, encoder.output, encoder.unit) == ("encoder", "place", "m")
    assert encoder.quantum == pytest.approx(2 * np.pi / 2**17 * 0.05)  # [m], a pinion of 50 mm
    assert [(s.output, s.unit) for s in sensors_of(Tables())] == [("beta", "rad"), ("alpha", "rad")]


def test_nominal_input_of_a_crane():
    """The load hangs back by atan(x''/g) and is accelerated as the trolley is: pull = (M + m) x''."""
    for t in (0.1, 0.4, 0.9):
        assert LIFT.nominal_input(t) == pytest.approx([(TROLLEY + LOAD) * minimum_jerk(t)[2]], rel=1e-9)


def test_nominal_input_takes_the_tables_to_their_goal():
    """Stiffness held by the inputs at the end: k (beta, alpha), in the order of the inputs."""
    assert TURN.nominal_input(1.5) == pytest.approx([-1.0, 0.5], abs=1e-12)
    motion = TURN.plant.simulate(TURN.initial[0], TURN.nominal_input, np.linspace(0.0, 1.0, 201))
    assert motion.x[-1] == pytest.approx([0.0, 0.5, -1.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("scene", [LIFT, TURN], ids=lambda s: s.name)
def test_environment_controller_and_score(scene):
    env = PlantEnv(scene)
    obs, _ = env.reset(seed=1)
    assert obs.shape == env.observation_space.shape
    obs, _, terminated, _, _ = env.step(env.action_space.sample())
    assert np.isfinite(obs).all() and not terminated
    assert driven_to_goal(scene) == tuple(name for name, _ in scene.goal)
    law = PD.for_scene(scene)
    assert law.reads[: len(scene.goal)] == tuple(j.position for j in scene.plant.joints)
    found = score(scene, rollout(scene, law))
    assert not found.failure and np.isfinite(found.cost)
    assert left_out(scene.plant, scene.goal_model) == ()


def test_evaluation_scene_varies_what_is_uncertain():
    played = play(LIFT)
    assert played.randomise == (("load", 0.7, 1.3),)
    assert deflections(played) == ("hook",)
    assert play(TURN).randomise == ()


def test_pictures():
    assert arm_outline.has_shape(Crane()) and not arm_outline.has_shape(Tables())
    assert arm_outline.lines(Crane(), np.array([0.0, 3.0, 0.0, 0.0]), 2)[0] == pytest.approx(
        np.array([[3.0, 0.0], [3.0, -ROPE]])
    )
    picture = renderer(LIFT).draw(LIFT.initial[0], np.zeros(1), 0.0, 0.0)
    assert picture.shape == (600, 600, 3) and np.ptp(picture) > 100
    with pytest.raises(ValueError, match="'tables': its plant Tables has no outline to draw"):
        renderer(TURN)


def test_random_points_keep_lengths_small():
    _, x, *_ = random_points(Crane(), np.random.default_rng(0), 50)
    largest = np.abs(x).max(axis=1)
    assert (largest[[1, 3]] <= 0.02).all() and (largest[[0, 2]] > 0.5).all()


def test_words_about_a_point():
    spinning = Tables().linearize(np.array([2.0, 0.0, 0.0, 0.0]))
    assert operating_point.words(spinning, Tables()).startswith(
        "at a point that is no equilibrium (d(beta)/dt = 2 rad/s"
    )
    still = Tables().linearize(np.zeros(4))
    assert operating_point.words(still, Tables()).startswith("at rest with second = 0 N m")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sled(Plant):
    """Pulled by a winch through a cable, or stiffly; states in no usual order."""

    stiff: bool = False
    inputs = property(lambda self: (Signal("pull", "N"),))
    disturbances = property(lambda self: ())
    outputs = property(lambda self: (Signal("position", "m"),))
    label = property(lambda self: "stiff" if self.stiff else "elastic")

    @property
    def states(self):
        sled = (Signal("speed", "m/s"), Signal("place", "m"))
        return sled if self.stiff else (*sled, Signal("winch_speed", "m/s"), Signal("winch", "m"))

    def ode(self, t, x, u, w):
        if self.stiff:
            return ca.vertcat(u / 2.5, x[0])
        cable = 900.0 * (x[3] - x[1]) + 3.0 * (x[2] - x[0])
        return ca.vertcat(cable / 2.0, x[0], (u - cable) / 0.5, x[2])

    def output(self, t, x, u, w):
        return x[1]

    def ladder(self):
        return (dataclasses.replace(self, stiff=True), dataclasses.replace(self, stiff=False))


def test_an_input_drives_what_it_accelerates_not_what_a_spring_moves():
    """Stiffly the pull accelerates the sled; through the cable the winch alone."""
    assert Sled(stiff=True).joints == (Joint("pull", "place", "speed"),)
    assert Sled().joints == (Joint("pull", "winch", "winch_speed"),)


def test_a_plan_needs_no_order_of_states():
    """Pull on the stiff sled along a minimum-jerk way: 2.5 kg times its acceleration."""
    stiff, steps = Sled(stiff=True), 20
    x, u = rigid_motion(stiff, np.zeros(2), np.array([0.0, 3.0]), np.zeros(1), 2.0, steps)
    middle = (np.arange(steps) + 0.5) / steps
    assert u[:, 0] == pytest.approx(2.5 * 3.0 * minimum_jerk(middle)[2] / 2.0**2, rel=1e-9)
    assert x[-1] == pytest.approx([0.0, 3.0]) and x[steps // 2] == pytest.approx([3.0 * 1.875 / 2.0, 1.5])


def test_a_pd_at_what_no_motor_drives_is_refused_in_words():
    sled = Sled().linearize(np.zeros(4))
    with pytest.raises(PliantError, match="PD: no input accelerates each of place, must be one that a motor drives"):
        fastest_decay(sled, Joints(("place",), ("speed",)), 0.02)
    assert (fastest_decay(sled, Joints(("winch",), ("winch_speed",)), 0.02)[0] > 0).all()
