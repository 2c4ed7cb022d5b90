"""Valid calls of what plants do, and of the parts they are made of."""

from __future__ import annotations

from typing import Any

import numpy as np
from argument_kinds import Array, Call, Choice, Count, Counts, Flag, Kind, Names, Number, Object, Objects

from pliant.plants import (
    Appendage,
    Beam,
    Environment,
    FlexibleSpacecraft,
    Hinge,
    Hub,
    LargeDeflectionBeam,
    Material,
    Orbit,
    Payload,
    Signal,
    SingleLinkArm,
    SliderCrank,
    Sun,
    Surface,
    Thruster,
    Trajectory,
    TransferMatrices,
    TwoLinkArm,
    Wheel,
    paper_terms,
    step_limit,
)

PLANTS = {
    "SingleLinkArm": SingleLinkArm.textbook(),
    "TwoLinkArm": TwoLinkArm.textbook(),
    "LargeDeflectionBeam": LargeDeflectionBeam.textbook(),
    "SliderCrank": SliderCrank.textbook(),
    "FlexibleSpacecraft": FlexibleSpacecraft.textbook(),
}
ARM = PLANTS["SingleLinkArm"]
STEEL = Material(density=7800.0, E=2e11, G=8e10)
BEAM = Beam.rectangular(1.0, width=0.01, depth=0.05, material=STEEL)
POSITIVE: dict[str, Any] = {"low": 0.0, "open": True}


def plant_calls() -> list[Call]:
    """Of plants and their parts."""
    found = part_calls()
    for name, plant in PLANTS.items():
        found += point_calls(name, plant)
    return [*found, *declaration_calls(), *motion_calls(), *own_calls(), *trajectory_calls()]


def rest(plant: Any) -> np.ndarray:
    """A state at rest, of numbers that float32 holds."""
    return np.asarray(plant.rest_state, dtype=float)


def point_calls(name: str, plant: Any) -> list[Call]:
    """What a plant tells of one point."""
    x, u, w = Array(rest(plant)), Array(np.ones(plant.nu), none=True), Array(np.zeros(plant.nw), none=True)
    point = {"x": x, "u": u} | ({"w": w} if plant.nw else {})
    about = {"x0": x, "u0": u} | ({"w": w} if plant.nw else {})
    time = {"t": Number(0.5, array=True)}
    calls = [
        Call(f"{name}.dynamics", plant.dynamics, point | time),
        Call(f"{name}.measure", plant.measure, point | time),
        Call(f"{name}.jacobians", plant.jacobians, point),
        Call(f"{name}.energy", plant.energy, {"x": x}),
        Call(f"{name}.mass_matrix", plant.mass_matrix, {"x": x}),
        Call(f"{name}.power", plant.power, point),
        Call(f"{name}.linearize", plant.linearize, about | {"t": Number(0.5)}),
        Call(f"{name}.feedback_model", plant.feedback_model, {"x0": x, "u0": u}),
        Call(f"{name}.outline", plant.outline, {"x": x, "points": Count(10, low=2)}),
        Call(f"{name}.natural_frequencies", plant.natural_frequencies, {"x0": Array(rest(plant), none=True)}),
        Call(
            f"{name}.vary",
            lambda parameter, v=plant.vary: v(parameter).varied,
            {"parameter": Choice(plant.uncertain[0])},
        ),
        Call(f"{name}.stepper.dt", lambda plant=plant, **k: plant.stepper(**k).dt, stepper_kinds(), compare=False),
    ]
    return calls


def stepper_kinds() -> dict[str, Kind]:
    """Of a stepper's settings; `batch` of one, so that nothing large is compiled."""
    return {
        "dt": Number(2.0**-12, **POSITIVE),
        "method": Choice("rk4"),
        "batch": Count(1),
        "threads": Count(1, none=True),
        "substeps": Count(1),
        "check": Flag(True),
        "dtype": Choice("float64"),
    }


def declaration_calls() -> list[Call]:
    """Constructors of plants."""
    gravity, name = Number(9.5), "name"
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
    state = PLANTS["SliderCrank"].state
    del name
    return [
        Call("SingleLinkArm", SingleLinkArm, single | basis, compare=False),
        Call("TwoLinkArm", TwoLinkArm, two | basis, compare=False),
        Call("LargeDeflectionBeam", LargeDeflectionBeam, beam, compare=False),
        Call("FlexibleSpacecraft", FlexibleSpacecraft, craft, compare=False),
        Call("SliderCrank", SliderCrank, crank, compare=False),
        Call("SliderCrank.state", state, {"angle": Number(0.5), "speed": Number(1.0, none=True)}),
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
        Call("Signal", Signal, {"name": Word("theta"), "unit": Word("rad")}, compare=False),
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


class Word(Kind):
    """A string, any."""

    def bad(self) -> Any:
        """Everything else."""
        yield from Kind.bad(self)
        yield from (("a number", 3), ("bytes", b"ab"), ("a list", ["a"]))


def motion_calls() -> list[Call]:
    """Simulation and linear models along a motion, of the smallest arm."""
    t, x = np.linspace(0.0, 0.25, 5), rest(ARM)
    settings: dict[str, Kind] = {
        "x0": Array(x, none=True),
        "u": Array(np.ones(1), none=True, calls=True),
        "t": Array(t, wrong=False),
        "w": Array(np.zeros(ARM.nw), none=True),
        "rtol": Number(1e-6, **POSITIVE),
        "atol": Number(1e-8, **POSITIVE),
        "method": Choice("dop853"),
        "audit": Flag(True),
    }
    fixed = {"step": Number(2.0**-10, none=True, **POSITIVE), "method": Choice("rk4")}
    motion = ARM.simulate(x, [1.0], t)
    along = {"nominal": Object(motion)}
    jump = {"x": Array(x), "P": Array(np.ones(1)), "after": Array(x), "t": Number(0.5)}
    ends = {"begin": Array(x), "end": Array(x), "time": Number(2.0, **POSITIVE)}
    step = ARM.stepper(2.0**-12)
    rows = {"x": Array(x[None], finite=False), "u": Array(np.ones((1, 1)), none=True, finite=False)}
    return [
        Call("simulate", ARM.simulate, settings),
        Call("simulate by steps", ARM.simulate, settings | fixed | {"audit": Flag(False)}),
        Call("left_ranges", ARM.left_ranges, {"motion": Object(motion)}),
        Call("linearize_along", ARM.linearize_along, along),
        Call("jump_map", ARM.jump_map, jump),
        Call("rest_to_rest", ARM.rest_to_rest, ends, compare=False),
        Call("stepper's step", step, rows),
        Call("equilibrium", ARM.equilibrium, {"hub_angle": Number(0.0)}),
        Call("equilibrium.fixed", ARM.equilibrium, {"fixed": Mapping_({"hub_angle": 0.0})}),
        Call("equilibrium.guess", ARM.equilibrium, {"guess": Mapping_({"hub_angle": 0.0})}),
        Call("step_limit", step_limit, {"plant": Object(ARM), "x": Array(x), "method": Choice("rk4")}),
    ]


class Mapping_(Kind):
    """Numbers by name of a state or input."""

    def bad(self) -> Any:
        """Other names, other values."""
        yield from (("an object", object()), ("a list", [1.0]), ("a string", "abc"), ("a number", 3.0))
        yield from (("an unknown name", {"nonsense": 1.0}), ("a number as name", {1: 1.0}))
        (name,) = self.value
        for what, value in (("a string", "1"), ("NaN", np.nan), ("None", None), ("a list", [1.0]), ("complex", 1j)):
            yield f"{what} by name", {name: value}

    def good(self) -> Any:
        """NumPy's numbers."""
        yield "float64 by name", {name: np.float64(v) for name, v in self.value.items()}
        yield "an integer by name", {name: int(v) for name, v in self.value.items()}


def own_calls() -> list[Call]:
    """What single plants do."""
    arm, beam, craft = PLANTS["TwoLinkArm"], PLANTS["LargeDeflectionBeam"], PLANTS["FlexibleSpacecraft"]
    x, z, s = Array(rest(arm)), Array(rest(beam)), Array(rest(craft))
    still = {"x": s, "a": Array(np.zeros(6 + len(craft.coordinates)))}
    turn = {"begin": s, "end": s, "time": Number(2.0, **POSITIVE)}
    chain = LargeDeflectionBeam(beam=beam.beam, kinematics="substructured", segments=2, modes=1)
    found = TransferMatrices(chain)
    return [
        Call("paper_terms", paper_terms, {"arm": Object(arm), "x": x, "u": Array(np.ones(2), none=True)}),
        Call("LargeDeflectionBeam.positions", beam.positions, {"x": z, "xi": Array((0.0, 0.5, 1.0), wrong=False)}),
        Call("TransferMatrices", TransferMatrices, {"plant": Object(chain)}, compare=False),
        Call(
            "TransferMatrices.acceleration",
            found.acceleration,
            {"x": Array(rest(chain)), "u": Array(np.zeros(chain.nu), none=True), "method": Choice("sweep")},
        ),
        Call("FlexibleSpacecraft.momentum", craft.momentum, {"x": s}),
        Call("FlexibleSpacecraft.turn", craft.turn, {"x": s}),
        Call("FlexibleSpacecraft.consistent", craft.consistent, {"x": Array(rest(craft), wrong=False, finite=False)}),
        Call("FlexibleSpacecraft.residual", craft.residual, still),
        Call("FlexibleSpacecraft.rest_to_rest", craft.rest_to_rest, turn, compare=False),
        Call("FlexibleSpacecraft.state", craft.state, {"values": Mapping_({craft.states[0].name: 1.0}, none=True)}),
        Call("SingleLinkArm.in_frame", ARM.in_frame, {"frame": Choice("clamped"), "x": Array(rest(ARM), wrong=False)}),
        Call("SingleLinkArm.frame_map", ARM.frame_map, {"frame": Choice("clamped")}),
        Call("LargeDeflectionBeam.kinetic", beam.kinetic, {"x": z}),
        Call("LargeDeflectionBeam.potential", beam.potential, {"x": z}),
    ]


def trajectory_calls() -> list[Call]:
    """Motions as arrays."""
    t = np.linspace(0.0, 1.0, 5)
    motion = Trajectory.from_arrays(t, np.ones((5, 2)), np.ones((5, 1)), states=("a", "b"), inputs=("f",))
    arrays = {
        "t": Array(t),
        "x": Array(np.ones((5, 2))),
        "u": Array(np.ones((5, 1)), none=True),
        "states": Names(("a", "b"), none=True, free=True),
        "inputs": Names(("f",), none=True, free=True),
    }
    return [
        Call("Trajectory.from_arrays", Trajectory.from_arrays, arrays),
        Call("Trajectory.resample", motion.resample, {"t": Array((0.25, 0.5), wrong=False)}),
        Call("Motion.Trajectory", lambda name: motion[name], {"name": Choice("a")}),
    ]
