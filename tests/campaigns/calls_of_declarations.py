"""Valid calls that declare plants, and the parts they are made of."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Flag, Names, Object, Objects
from further_kinds import Text
from kinds_of_numbers import POSITIVE, Array, Count, Counts, Number

from pliant.plants import (
    Appendage,
    Beam,
    ElasticJoint,
    Environment,
    FlexibleSpacecraft,
    FlexibleTree,
    Frame,
    FrameThruster,
    Hinge,
    Hub,
    Joint,
    LargeDeflectionBeam,
    Material,
    Orbit,
    Payload,
    Signal,
    SingleLinkArm,
    SliderCrank,
    Sliding,
    Sun,
    Surface,
    Thruster,
    TreeBody,
    TwoLinkArm,
    Wheel,
)

STEEL = Material(density=7800.0, E=2e11, G=8e10)
BEAM = Beam.rectangular(1.0, width=0.01, depth=0.05, material=STEEL)


def declaration_calls() -> list[Call]:
    """Constructors of plants."""
    gravity = Number(9.5)
    basis = {"kinematics": Choice("linear"), "basis": Choice("clamped-free")}
    single = {
        "link": Object(BEAM),
        "hub_inertia": Number(0.5, low=0.0),
        "hub_radius": Number(0.25, low=0.0),
        "hub_friction": Number(0.5, low=0.0),
        "payload": Object(Payload(mass=1.0)),
        "gravity": gravity,
        "theory": Choice("timoshenko"),
        "modes": Count(2, low=0),
        "frame": Choice("clamped"),
        "drive": Choice("torque"),
        "varied": Names(("link.E",)),
    }
    two = {
        "link1": Object(BEAM),
        "link2": Object(BEAM),
        "joint_mass": Number(0.5, low=0.0),
        "payload": Object(Payload(mass=1.0)),
        "hub_inertia": Array((0.5, 0.25)),
        "joint_friction": Array((0.5, 0.25)),
        "gravity": gravity,
        "tip_slope": Flag(True),
        "reduction": Choice("full"),
        "modes": Counts((2, 1)),
    }
    beam = {
        "beam": Object(BEAM),
        "root": Choice("clamped"),
        "gravity": Array((0.0, -9.5, 0.0)),
        "payload": Object(Payload(mass=1.0)),
        "kinematics": Choice("strain"),
        "segments": Count(1),
        "modes": Count(3),
        "frame": Choice("mean-axis"),
        "basis": Choice("auto"),
        "planar": Flag(True),
        "points": Count(20, none=True),
        "theory": Choice("euler-bernoulli"),
        "extensible": Flag(True),
        "stretches": Count(2),
        "shears": Count(2),
        "tip_loads": Names(("force", "moment")),
        "rest_curvature": Number(0.125),
        "rotary": Number(1.0, low=0.0),
    }
    craft = {
        "hub": Object(hub()),
        "appendages": Objects((appendage(),)),
        "kinematics": Choice("linear"),
        "translation": Flag(True),
        "environment": Object(Environment()),
    }
    crank = {
        "crank_radius": Number(0.125, **POSITIVE),
        "rod": Object(BEAM),
        "slider_mass": Number(0.5, low=0.0),
        "modes": Count(2, low=0),
        "crank_speed": Number(3.0, none=True),
    }
    return [
        Call("SingleLinkArm", SingleLinkArm, single | basis, compare=False),
        Call("TwoLinkArm", TwoLinkArm, two | basis, compare=False),
        Call("LargeDeflectionBeam", LargeDeflectionBeam, beam, compare=False),
        Call("FlexibleSpacecraft", FlexibleSpacecraft, craft, compare=False),
        Call("SliderCrank", SliderCrank, crank, compare=False),
        *tree_calls(),
    ]


def tree() -> FlexibleTree:
    """Two beams in space."""
    return FlexibleTree.serial(
        [
            TreeBody(name="one", joint=Joint(name="j1"), inertia=0.5, beam=BEAM, modes=(1, 1, 1, 0)),
            TreeBody(name="two", joint=Joint(name="j2", axis=(0.0, 1.0, 0.0)), mass=1.0, inertia=0.5),
        ]
    )


def tree_calls() -> list[Call]:
    """Trees and what they are made of."""
    gear = ElasticJoint(stiffness=0.5, rotor_inertia=0.5)
    elastic = {n: Number(0.5, **POSITIVE) for n in ("stiffness", "ratio", "rotor_inertia")}
    lossy = {n: Number(0.5, low=0.0) for n in ("damping", "rotor_friction")}
    place = {"position": Array((0.5, 0.0, 0.25)), "rotation": Array((0.5, 0.0, 0.25)), "station": Number(0.5, low=0.0)}
    joint = {
        "name": Text("j"),
        "kind": Choice("prismatic"),
        "axis": Array((0.0, 0.0, 1.0)),
        "turned": Flag(True),
        "rest": Number(0.5),
        "drive": Choice("torque"),
        "elastic": Object(gear, none=True),
    }
    held = {n: Number(0.5, low=0.0) for n in ("damping", "friction", "stiffness", "stop_stiffness")}
    held |= {n: Number(0.5, none=True) for n in ("lower", "upper")}
    held |= {n: Number(0.5, **POSITIVE) for n in ("friction_rate", "stop_width")}
    joint |= held | {"armature": Number(0.5, low=0.0)}
    joint |= {n: Number(0.5, none=True) for n in ("effort", "speed")}
    body = {
        "name": Text("b"),
        "joint": Object(Joint(name="j")),
        "mass": Number(0.5, low=0.0),
        "centre": Array((0.5, 0.0, 0.25)),
        "inertia": Number(0.5, low=0.0),
        "beam": Object(BEAM, none=True),
        "beam_rotation": Array((0.5, 0.0, 0.25)),
        "modes": Counts((2, 2, 1, 0)),
        "stiffness_factor": Number(0.5, **POSITIVE),
        "damping_ratio": Number(0.5, low=0.0),
    }
    spun = {
        "name": Text("w"),
        "parent": Text("hub", empty=True),
        "axis": Array((0.0, 0.0, 1.0)),
        "position": Array((0.5, 0.0, 0.0)),
    }
    spun |= {"inertia": Number(0.5, **POSITIVE), "mass": Number(0.5, low=0.0), "friction": Number(0.5, low=0.0)}
    made = tree()
    whole = {
        "bodies": Objects(made.bodies),
        "frames": Objects((Frame(name="f", body="one"),)),
        "tip": Text("two", empty=True),
        "payload": Object(Payload(mass=1.0)),
        "gravity": Array((0.0, 0.0, -9.5)),
        "loads": Names(("tip",)),
        "devices": Names(("gyro",)),
        "kinematics": Choice("linear"),
        "basis": Choice("clamped-free"),
        "base": Choice("free"),
        "platform": Object(Payload(mass=1.0, inertia=0.5)),
        "base_freedoms": Names(("x", "turn_z")),
        "root": Text("base"),
        "repairs": Names(("the hand",), free=True),
    }
    return [
        Call("ElasticJoint", ElasticJoint, elastic | lossy, compare=False),
        Call("Joint", Joint, joint | place, compare=False),
        Call("Sliding", Sliding, held, compare=False),
        Call("Frame", Frame, {"name": Text("f"), "body": Text("b")} | place, compare=False),
        Call("TreeBody", TreeBody, body, compare=False),
        Call("TreeBody.wheel", TreeBody.wheel, spun, compare=False),
        Call("FrameThruster", FrameThruster, {"frame": Text("f"), "direction": Array((0.0, 0.0, 1.0))}, compare=False),
        Call("FlexibleTree", FlexibleTree, whole, compare=False),
        Call("FlexibleTree.serial", FlexibleTree.serial, {"bodies": Objects(made.bodies)}, compare=False),
    ]


def hub() -> Hub:
    """A hub with a wheel."""
    return Hub(mass=100.0, inertia=(50.0, 40.0, 30.0), wheels=(Wheel(axis=(0.0, 0.0, 1.0), inertia=0.125),))


def appendage() -> Appendage:
    """A boom."""
    return Appendage(position=(1.0, 0.0, 0.0), body=BEAM, modes=(1, 1))


def part_calls() -> list[Call]:
    """Beams, payloads and parts of craft."""
    length, vector, unit = Number(0.5, **POSITIVE), Array((0.5, 0.0, 0.25)), Array((0.0, 0.0, 1.0))
    section = {"length": length, "material": Object(STEEL)}
    numbers = {n: Number(0.5, **POSITIVE) for n in ("length", "area", "I_y", "I_z", "J", "density", "E", "G")}
    tensor = Array(np.diag([3.0, 2.0, 2.0]))
    stuff = {n: Number(0.5, **POSITIVE) for n in ("density", "E", "G")} | {"damping": Number(0.5, low=0.0)}
    light = {"area": Number(2.0, low=0.0), "normal": unit, "specular": Number(0.5, low=0.0)}
    hinge = {
        "axes": Array(((0.0, 0.0, 1.0),), wrong=False),
        "stiffness": Number(0.5, low=0.0, array=True),
        "drive": Choice("free"),
    }
    part = {
        "position": vector,
        "body": Object(BEAM),
        "hinge": Object(Hinge()),
        "orientation": Array(np.eye(3)),
        "damping": Number(0.5, low=0.0),
        "stiffness_factor": Number(0.5, **POSITIVE),
        "surface": Object(Surface(area=1.0, normal=(0.0, 0.0, 1.0)), none=True),
        "modes": Count(2, low=0, none=True, tuples=True),
    }
    acting = {
        "orbit": Object(Orbit(rate=1e-3), none=True),
        "sun": Object(Sun(direction=(0.0, 0.0, 1.0)), none=True),
        "dipole": vector,
        "magnetic_field": vector,
        "torque": vector,
    }
    return [
        Call("Material", Material, stuff, compare=False),
        Call("Beam", Beam, numbers | {"damping": Number(0.5, low=0.0)}, compare=False),
        Call("Beam.rectangular", Beam.rectangular, section | {"width": length, "depth": length}, compare=False),
        Call("Beam.circular", Beam.circular, section | {"diameter": length}, compare=False),
        Call("Beam.tube", Beam.tube, section | {"outer": length}, {"inner": 0.25}, compare=False),
        Call("Payload", Payload, {"mass": Number(0.5, low=0.0), "inertia": tensor, "offset": vector}, compare=False),
        Call("Payload of one moment", Payload, {"inertia": Number(0.5, low=0.0, array=True)}, compare=False),
        Call("Signal", Signal, {"name": Text("theta", empty=True), "unit": Text("rad", empty=True)}, compare=False),
        Call("Wheel", Wheel, {"axis": unit, "inertia": length, "friction": Number(0.5, low=0.0)}, compare=False),
        Call("Thruster", Thruster, {"position": vector, "direction": unit}, compare=False),
        Call("Orbit", Orbit, {"rate": length, "radius": length, "gravity": Flag(True)}, compare=False),
        Call("Sun", Sun, {"direction": unit, "pressure": Number(0.5, low=0.0)}, compare=False),
        Call("Surface", Surface, light | {"centre": vector, "both": Flag(True)}, compare=False),
        Call("Hinge", Hinge, hinge, compare=False),
        Call("Hub", Hub, {"mass": length, "inertia": tensor, "wheels": Objects(hub().wheels)}, compare=False),
        Call("Appendage", Appendage, part, compare=False),
        Call("Environment", Environment, acting, compare=False),
    ]
