"""Machines that are trees of bodies: an elastic joint, a six-axis arm, a three-joint arm with thin links, a crane.

What is published is said where it stands; the other numbers are chosen here, of the size of such machines.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from pliant.plants import Beam, ElasticJoint, FlexibleTree, Frame, Joint, Payload, TreeBody
from pliant.plants.beams.section import ALUMINIUM, STEEL, Material

SIX_AXIS = Path(__file__).with_name("six_axis.urdf")
# Acetal (POM) as its makers' data sheets have it: about 2.8 GPa, 1410 kg/m^3, Poisson's ratio 0.37
ACETAL = Material(density=1410.0, E=2.8e9, G=1.02e9, damping=5e-5)
DOWN = (0.0, np.pi / 2, 0.0)  # turns x to -z


def flexible_joint() -> FlexibleTree:
    """A 1 m bar of 5 kg with 2 kg at its tip on a geared motor, turning about a vertical axis.

    The gear (1:100) gives: with the motor held the bar swings at 3.7 Hz. The rotor's 2e-5 kg m^2 are 0.2 kg m^2 at the
    joint, a twentieth of what they turn.
    """
    gear = ElasticJoint(stiffness=2000.0, damping=2.0, ratio=100.0, rotor_inertia=2e-5, rotor_friction=1e-4)
    bar = TreeBody(
        name="bar",
        joint=Joint(name="joint", elastic=gear),
        mass=5.0,
        centre=(0.5, 0.0, 0.0),
        inertia=((0.001, 0.0, 0.0), (0.0, 5 / 12, 0.0), (0.0, 0.0, 5 / 12)),
    )
    end = Frame(name="end", body="bar", position=(1.0, 0.0, 0.0))
    return FlexibleTree.serial(
        [bar], frames=(end,), tip="end", payload=Payload(mass=2.0, inertia=0.005), gravity=(0.0, 0.0, 0.0)
    )


def six_axis(kinematics: str = "stiffened") -> FlexibleTree:
    """An arm of six joints with the geometry and masses of Universal Robots' UR5, its forearm a 30 mm rod of acetal.

    The rod takes the place of the forearm (2.3 kg of tube become 0.39 kg); it bends by two shapes in each plane and
    twists by one. Chosen are the gears' rotors, 0.4 kg m^2 at the large joints and 0.04 kg m^2 at the wrist's. A box of
    1.5 kg and 0.2 m is held, its centre 50 mm beyond the flange.
    """
    arm = FlexibleTree.from_urdf(
        SIX_AXIS,
        flexible={"forearm": Beam.circular(0.39225, 0.030, ACETAL)},
        tip="tool",
        payload=Payload(mass=1.5, inertia=0.01, offset=(0.05, 0.0, 0.0)),
        kinematics=kinematics,
    )
    rotors = {"pan": 0.4, "lift": 0.4, "elbow": 0.4, "roll_1": 0.04, "roll_2": 0.04, "roll_3": 0.04}
    bodies = [
        dataclasses.replace(b, joint=dataclasses.replace(b.joint, armature=rotors.get(b.joint.name, 0.0)))
        for b in arm.bodies
    ]
    return dataclasses.replace(arm, bodies=tuple(bodies))


def three_link(modes: tuple[int, ...] = (2, 0, 0, 0)) -> FlexibleTree:
    """The arm of "Safe Imitation Learning of Nonlinear Model Predictive Control for Flexible Robots" (Mamedov and
    others, 2024): a turning column and two steel strips, 500 x 50 x 2 mm, that bend in the vertical plane.

    Lengths, masses, E = 190 GPa, G = 74 GPa and a material damping of 851.1 MPa s as its code publishes them
    (github.com/shamilmamedov/flexible_arm, three_dof/flexible_link_params.yml and its URDF). There each strip is cut
    into rigid pieces on springs that bend about the joints' axes alone, as here: `modes` (2, 0, 0, 0).
    """
    strip = Beam.rectangular(0.5, 0.05, 0.002, Material(density=7870.0, E=190e9, G=74e9, damping=851.1e6 / 190e9))
    upright = (np.pi / 2, 0.0, 0.0)
    column = TreeBody(
        name="column",
        joint=Joint(name="joint1"),
        mass=2.0,
        centre=(0.0, 0.0, 0.12),
        inertia=((0.0061, 0.0, 0.0), (0.0, 0.0061, 0.0), (0.0, 0.0, 0.01125)),
    )
    shoulder = Joint(name="joint2", position=(0.0, 0.0, 0.15), rotation=upright)
    links = [TreeBody(name="link2", joint=shoulder, beam=strip, modes=modes)]
    links.append(TreeBody(name="link3", joint=Joint(name="joint3"), beam=strip, modes=modes))
    return FlexibleTree.serial([column, *links])


def crane() -> FlexibleTree:
    """A trolley of 50 kg on a beam; from it hangs, free to swing, a steel rod of 4 m and 30 mm with 200 kg.

    The load pulls the rod straight: it bends between hinge and load at 3.6 Hz, without that pull at 3.2 Hz.
    """
    hung = TreeBody(
        name="rod",
        joint=Joint(name="swing", axis=(0.0, -1.0, 0.0), damping=5.0, drive="none"),
        beam=Beam.circular(4.0, 0.03, Material(density=STEEL.density, E=STEEL.E, G=STEEL.G, damping=2e-4)),
        beam_rotation=DOWN,
        modes=(0, 2, 0, 0),
    )
    trolley = TreeBody(
        name="trolley",
        joint=Joint(name="trolley", kind="prismatic", axis=(1.0, 0.0, 0.0), damping=20.0),
        mass=50.0,
        inertia=2.0,
    )
    return FlexibleTree.serial([trolley, hung], payload=Payload(mass=200.0, inertia=8.0))


def satellite_arm() -> FlexibleTree:
    """A free satellite of 400 kg with three wheels and an arm of two aluminium rods, 1 m and 16 mm each, with 10 kg.

    Nothing holds it: what the arm does turns the satellite, and the wheels, discs of 0.02 kg m^2 about x, y and z, turn
    it back.
    """
    wheels = [
        TreeBody.wheel(f"wheel_{name}", "base", inertia=0.02, axis=tuple(axis), mass=3.0)
        for name, axis in zip("xyz", np.eye(3).tolist(), strict=True)
    ]
    link = Beam.circular(1.0, 0.016, Material(density=ALUMINIUM.density, E=ALUMINIUM.E, G=ALUMINIUM.G, damping=2e-4))
    shoulder = Joint(name="shoulder", position=(0.5, 0.0, 0.0), damping=0.5, armature=0.05)
    elbow = Joint(name="elbow", damping=0.5, armature=0.05)
    return FlexibleTree(
        bodies=(
            *wheels,
            TreeBody(name="upper", parent="base", joint=shoulder, beam=link, modes=(2, 1, 0, 0)),
            TreeBody(name="lower", parent="upper", joint=elbow, beam=link, modes=(2, 1, 0, 0)),
        ),
        base="free",
        platform=Payload(mass=400.0, inertia=70.0),
        payload=Payload(mass=10.0, inertia=0.1),
        gravity=(0.0, 0.0, 0.0),
    )
