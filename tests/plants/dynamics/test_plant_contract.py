"""What a plant is asked: every shipped plant's answers, and two plants of a user that answer nothing themselves.

The crane's numbers are of a load on a massless rope under a trolley: (M + m) x'' + m L lean'' = pull at lean = 0, so
that a trolley that moves with the load hanging straight needs (M + m) x'' less the load's share, which is M x'' as
a load that hangs free is not accelerated along the trolley's way at that instant.
"""

import dataclasses
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

from pliant.controllers import PD, sensors_of
from pliant.controllers.base.joint_reference import Joints, joints
from pliant.envs import PlantEnv
from pliant.envs.rendering.planar import renderer
from pliant.envs.scenes.scene import Scene
from pliant.plants import (
    FlexibleSpacecraft,
    LagrangianPlant,
    LargeDeflectionBeam,
    Plant,
    SingleLinkArm,
    SliderCrank,
    TwoLinkArm,
)
from pliant.plants.core.minimum_jerk import minimum_jerk
from pliant.plants.core.parameters import quantity
from pliant.plants.core.signals import Joint, Signal, Unfelt, per_second
from pliant.plants.native.batch_kernels import random_points
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel
from pliant.studies.closed_loop.closed_loop import driven_to_goal
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.rollout import rollout
from pliant.studies.closed_loop.scores import deflections, score
from pliant.studies.common import operating_point
from pliant.studies.figures import arm_outline
from pliant.studies.stability.verdicts import left_out

TROLLEY, LOAD, ROPE, g = 4.0, 1.0, 2.0, 9.81


@dataclass(frozen=True, kw_only=True)
class Crane(LagrangianPlant):
    """A trolley on a rail and a load on a rope: the coordinate that is driven comes last."""

    trolley: float = quantity("kg", "positive", TROLLEY)
    load: float = quantity("kg", "positive", LOAD, uncertain=True)

    coordinates = (Signal("lean", "rad"), Signal("place", "m"))
    states = (Signal("lean", "rad"), Signal("place", "m"), Signal("sway", "rad/s"), Signal("going", "m/s"))
    inputs = (Signal("pull", "N"),)
    disturbances = ()
    outputs = (Signal("hook", "m"), Signal("leaning", "rad"))
    label = "crane"

    def kinetic_energy(self, q, v):
        x = v[1] + ROPE * ca.cos(q[0]) * v[0]
        y = ROPE * ca.sin(q[0]) * v[0]
        return self.trolley * v[1] ** 2 / 2 + self.load * (x**2 + y**2) / 2

    def potential_energy(self, q):
        return -self.load * g * ROPE * (ca.cos(q[0]) - 1)

    def dissipation(self, q, v):
        return v[0] ** 2 / 10

    def generalized_force(self, t, q, v, u, w):
        return ca.vertcat(0, u[0])

    def output(self, t, x, u, w):
        return ca.vertcat(x[1] + ROPE * ca.sin(x[0]), x[0])

    def outline(self, x, points=30):
        hook = np.array([x[1] + ROPE * np.sin(x[0]), -ROPE * np.cos(x[0])])
        return np.linspace([x[1], 0.0], hook, points)[None]

    def ladder(self):
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Tables(Plant):
    """Two turntables coupled by their masses, M = [[2, 0.5], [0.5, 1]]: a rate before the angles, inputs swapped."""

    stiffness: float = quantity("N m/rad", "nonnegative", 0.0)

    states = (Signal("zeta", "rad/s"), Signal("alpha", "rad"), Signal("beta", "rad"), Signal("omega", "rad/s"))
    inputs = (Signal("second", "N m"), Signal("first", "N m"))
    disturbances = ()
    outputs = (Signal("gap", "rad"), Signal("turned", "rad"))
    label = "tables"

    def ode(self, t, x, u, w):
        load = ca.vertcat(u[1] - self.stiffness * x[1], u[0] - self.stiffness * x[2])
        a = ca.DM([[1.0, -0.5], [-0.5, 2.0]]) @ load / 1.75
        return ca.vertcat(a[1], x[3], x[0], a[0])

    def output(self, t, x, u, w):
        return ca.vertcat(x[2] - x[1], x[1])

    def ladder(self):
        return (self,)


COMMON = {"about": "made in a test", "dt": 0.02, "substeps": 4, "duration": 2.0, "move_time": 1.0}
LIFT = Scene(
    name="crane",
    plant=Crane(),
    start=(("place", 0.0),),
    goal=(("place", 1.0),),
    limits=(100.0,),
    weights=(("place", 10.0), ("going", 1.0)),
    effort=(("pull", 1e-3),),
    observe=("place", "going", "leaning"),
    compare=("hook",),
    **COMMON,
)
TURN = Scene(
    name="tables",
    plant=Tables(stiffness=1.0),
    start=(("alpha", 0.0), ("beta", 0.0)),
    goal=(("alpha", 0.5), ("beta", -1.0)),
    limits=(40.0, 50.0),
    weights=(("alpha", 10.0), ("beta", 10.0)),
    effort=(("first", 1e-3), ("second", 1e-3)),
    observe=("alpha", "beta", "zeta", "omega"),
    compare=("gap",),
    **COMMON,
)


# --- shipped plants ----------------------------------------------------------------------------------------------
def craft(drive):
    """Wheels about x and a skew axis, a thruster, one appendage on a hinge of one axis."""
    hub = Hub(
        mass=500.0,
        inertia=(200.0, 150.0, 180.0),
        wheels=(Wheel(axis=(1.0, 0.0, 0.0), inertia=0.1), Wheel(axis=(0.0, 0.6, 0.8), inertia=0.2)),
        thrusters=(Thruster(position=(0.5, 0.2, 0.0), direction=(0.0, 0.0, 1.0)),),
    )
    hinge = Hinge(axes=((1.0, 0.0, 0.0),), stiffness=(10.0,), drive=drive)
    part = dataclasses.replace(FlexibleSpacecraft.textbook().appendages[0], hinge=hinge, modes=1)
    return FlexibleSpacecraft(hub=hub, appendages=(part,), translation=False)


LARGE = LargeDeflectionBeam.textbook()
ROOTED = {root: dataclasses.replace(LARGE, root=root) for root in ("clamped", "hinged", "driven")}
ANSWERS = {
    "joints": [
        (SingleLinkArm.textbook(), (("hub_torque", "hub_angle", "hub_angle_rate"),)),
        (
            dataclasses.replace(SingleLinkArm.textbook(), drive="motion"),
            (("hub_acceleration", "hub_angle", "hub_angle_rate"),),
        ),
        (
            dataclasses.replace(SingleLinkArm.textbook(), frame="pinned"),
            (("hub_torque", "frame_angle", "frame_angle_rate"),),
        ),
        (TwoLinkArm.textbook(), (("tau1", "theta1", "theta1_rate"), ("tau2", "theta2", "theta2_rate"))),
        (SliderCrank.textbook(), (("crank_acceleration", "crank_angle", "crank_angle_rate"),)),
        (ROOTED["clamped"], ()),
        (ROOTED["hinged"], ()),
        (ROOTED["driven"], (("hub_acceleration", "hub_angle", "hub_angle_rate"),)),
        (FlexibleSpacecraft.textbook(), tuple((f"torque_{c}", f"attitude_{c}", f"body_rate_{c}") for c in "xyz")),
        (
            craft("torque"),
            (
                ("wheel1_torque", "attitude_x", "body_rate_x"),
                ("hinge1_1_torque", "hinge1_1", "hinge1_1_rate"),
            ),
        ),
    ],
    "sensors": [
        (
            SingleLinkArm.textbook(),
            ("encoder hub_angle", "strain gauge root_curvature", "accelerometer tip_acceleration"),
        ),
        (
            TwoLinkArm.textbook(),
            (
                "encoder theta1",
                "encoder theta2",
                "strain gauge root1_curvature",
                "strain gauge root2_curvature",
                "accelerometer tip_acceleration",
            ),
        ),
        (SliderCrank.textbook(), ("encoder crank_angle", "accelerometer mid_acceleration")),
        (ROOTED["clamped"], ("strain gauge root_curvature", "gyro tip_angle_rate")),
        (ROOTED["hinged"], ("encoder root_angle", "gyro tip_angle_rate")),
        (ROOTED["driven"], ("encoder hub_angle", "strain gauge root_curvature", "gyro tip_angle_rate")),
        (
            craft("torque"),
            (
                *(f"star tracker attitude_{c}" for c in "xyz"),
                *(f"fibre-optic gyro body_rate_{c}" for c in "xyz"),
                "tachometer wheel1_momentum",
                "tachometer wheel2_momentum",
                "encoder hinge1_1",
            ),
        ),
    ],
    "deflections": [
        (SingleLinkArm.textbook(), ("tip_deflection",)),
        (TwoLinkArm.textbook(), ("tip1_deflection", "tip2_deflection")),
        (SliderCrank.textbook(), ("mid_deflection",)),
        (LARGE, ("tip_deflection",)),
        (FlexibleSpacecraft.textbook(), ()),
    ],
    "prescribed": [
        (SingleLinkArm.textbook(), ()),
        (dataclasses.replace(SingleLinkArm.textbook(), drive="motion"), ("hub_angle",)),
        (SliderCrank.textbook(), ("crank_angle",)),
        (ROOTED["driven"], ("hub_angle",)),
        (craft("torque"), ()),
        (craft("motion"), ("hinge1_1",)),
    ],
    "lockable": [
        (SingleLinkArm.textbook(), ("hub_angle", "eta1", "eta2")),
        (SliderCrank.textbook(), ("eta1", "eta2")),
        (craft("torque"), ()),
    ],
    "attitude_states": [
        (TwoLinkArm.textbook(), ()),
        (craft("torque"), ("quaternion_0", "quaternion_1", "quaternion_2", "quaternion_3")),
    ],
    "attitude_outputs": [
        (TwoLinkArm.textbook(), ()),
        (craft("torque"), ("attitude_x", "attitude_y", "attitude_z")),
    ],
    "velocities": [
        (SingleLinkArm.textbook(), ("hub_angle_rate", "eta1_rate", "eta2_rate")),
        (
            craft("torque"),
            (
                *(f"rate_{c}" for c in "xyz"),
                *(f"q_{c}_rate" for c in "xyz"),
                "hinge1_1_rate",
                "eta1_1_rate",
            ),
        ),
    ],
    "repeated": [
        (SingleLinkArm.textbook(), ("hub_angle",)),
        (TwoLinkArm.textbook(), ("theta1", "theta2")),
        (craft("torque"), ("rate_x", "rate_y", "rate_z")),
    ],
    "uncertain": [
        (SingleLinkArm.textbook(), ("link.E", "link.damping", "payload.mass")),
        (
            TwoLinkArm.textbook(),
            ("link1.E", "link1.damping", "link2.E", "link2.damping", "payload.mass"),
        ),
        (SliderCrank.textbook(), ("rod.E", "rod.damping")),
        (LARGE, ("beam.E", "beam.damping", "payload.mass")),
        (
            craft("torque"),
            (
                "appendages.0.body.E",
                "appendages.0.body.damping",
                "appendages.0.damping",
                "appendages.0.stiffness_factor",
            ),
        ),
    ],
    "small_states": [
        (SingleLinkArm.textbook(), ("eta1", "eta2", "eta1_rate", "eta2_rate")),
        (LARGE, ()),
        (craft("torque"), ("eta1_1", "eta1_1_rate")),
    ],
    "seen_from": [
        (SingleLinkArm.textbook(), "hub_angle"),
        (dataclasses.replace(SingleLinkArm.textbook(), frame="pinned"), None),
        (ROOTED["driven"], "hub_angle"),
        (ROOTED["hinged"], None),
        (TwoLinkArm.textbook(), None),
    ],
    "cycle": [(SliderCrank.textbook(), "crank_angle"), (SingleLinkArm.textbook(), None)],
    "drawn_as": [(TwoLinkArm.textbook(), "links"), (craft("torque"), "spacecraft")],
    "output_rates": [
        (TwoLinkArm.textbook(), {f"tip{i}_deflection": f"tip{i}_deflection_rate" for i in (1, 2)}),
        (SliderCrank.textbook(), {}),
        (LARGE, {n: f"{n}_rate" for n in ("tip_u", "tip_v", "tip_angle", "tip_deflection")}),
    ],
}


def told(question, plant):
    answer = getattr(plant, question)
    if question == "sensors":
        return tuple(f"{place.device} {place.signal}" for place in answer())
    if question == "joints":
        return tuple(dataclasses.astuple(joint) for joint in answer)
    return answer


@pytest.mark.parametrize("question", ANSWERS)
def test_answers_of_the_shipped_plants(question):
    for plant, expected in ANSWERS[question]:
        assert told(question, plant) == expected, plant.label


def test_answers_name_what_the_plant_has(plant):
    states = {s.name for s in plant.states}
    signals = states | {s.name for s in plant.outputs}
    inputs = {s.name for s in plant.inputs}
    assert {*plant.rates, *plant.rates.values(), *plant.repeated, *plant.attitude_states} <= states
    assert {*plant.deflections, *plant.attitude_outputs} <= {s.name for s in plant.outputs}
    assert {*plant.output_rates, *plant.output_rates.values()} <= signals
    assert {j.input for j in plant.joints} <= inputs
    assert {name for j in plant.joints for name in (j.position, j.rate)} <= signals
    assert {place.signal for place in plant.sensors()} <= signals
    assert {*plant.prescribed, *plant.lockable} <= set(plant.rates)
    assert {plant.seen_from, plant.cycle} - {None} <= states


def test_rates_are_the_derivatives(plant, random_state):
    """Also what the default reads from the equations, for a plant that states its coordinates itself."""
    x = random_state(plant, 3)
    dx = plant.dynamics(x)
    known = [s.name for s in plant.states]
    for name, rate in plant.rates.items():
        assert dx[known.index(name)] == x[known.index(rate)]
    read = Plant.rates.func(plant)
    assert plant.rates.items() <= read.items()


def test_output_rates_are_the_derivatives(plant, random_state):
    """dy/dt = C dx/dt, as none of these outputs depends on time or inputs."""
    x = random_state(plant, 5)
    C, y = plant.jacobians(x)[3], plant.measure(x)
    row = {s.name: k for k, s in enumerate(plant.outputs)}
    for name, rate in plant.output_rates.items():
        assert C[row[name]] @ plant.dynamics(x) == pytest.approx(y[row[rate]], rel=1e-9, abs=1e-12)


def test_stiffening_has_the_same_states():
    for plant in (SingleLinkArm.textbook(), TwoLinkArm.textbook(), SliderCrank.textbook()):
        linear, stiff = plant.stiffening
        assert (linear.kinematics, stiff.kinematics) == ("linear", "stiffened")
        assert plant in (linear, stiff) and linear.states == stiff.states == plant.states
    assert LARGE.stiffening is None and FlexibleSpacecraft.textbook().stiffening is None


def test_what_a_spacecraft_may_not_feel():
    found = craft("motion").unfelt
    assert found.given == ("hinge1_1", "hinge1_1_rate")
    assert found.stored == ("wheel1_momentum", "wheel2_momentum")
    assert found.groups[1] == craft("motion").attitude_states and found.groups[2] == ("q_x", "q_y", "q_z")
    assert FlexibleSpacecraft.textbook().unfelt.groups[0][3:] == ("position_x", "position_y", "position_z")
    assert TwoLinkArm.textbook().unfelt == Unfelt()


def test_units_of_rates():
    assert [per_second(u) for u in ("rad", "rad/s", "m", "N m s", "m/s")] == [
        "rad/s",
        "rad/s^2",
        "m/s",
        "N m s/s",
        "m/s^2",
    ]


# --- a user's plants ---------------------------------------------------------------------------------------------
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
    """At lean = 0 the rope pulls straight down: the trolley alone is accelerated, pull = M x''."""
    for t in (0.1, 0.4, 0.9):
        assert LIFT.nominal_input(t) == pytest.approx([TROLLEY * minimum_jerk(t)[2]], rel=1e-9)


def test_nominal_input_takes_the_tables_to_their_goal():
    """Stiffness held by the inputs at the end: k (beta, alpha), in the order of the inputs."""
    assert TURN.nominal_input(1.5) == pytest.approx([-1.0, 0.5], abs=1e-12)
    motion = TURN.plant.simulate(TURN.initial[0], TURN.nominal_input, np.linspace(0.0, 1.0, 201))
    assert motion.x[-1] == pytest.approx([0.0, 0.5, -1.0, 0.0], abs=1e-6)


def test_inputs_that_reach_no_coordinate_are_refused():
    beam = LargeDeflectionBeam.textbook()
    with pytest.raises(ValueError, match=r"one coordinate each: the 2 of LargeDeflectionBeam .* drive none"):
        dataclasses.replace(beam, modes=3).rest_to_rest(np.zeros(6), np.zeros(6), 1.0)


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
