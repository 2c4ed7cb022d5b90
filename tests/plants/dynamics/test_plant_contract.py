"""What a plant is asked: every shipped plant's answers."""

import dataclasses

import pytest

from pliant.plants import (
    FlexibleSpacecraft,
    LargeDeflectionBeam,
    Plant,
    SingleLinkArm,
    SliderCrank,
    TwoLinkArm,
)
from pliant.plants.core.signals import Unfelt, per_second
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel


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
            ("appendages.0.damping", "appendages.0.stiffness_factor"),  # what of its beam `vary` refuses is none
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
        return tuple((joint.input, joint.position, joint.rate) for joint in answer)
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
