"""Valid calls of what plants do."""

from __future__ import annotations

from typing import Any

import numpy as np
from argument_kinds import Call, Choice, Flag, Kind, Names, Object
from calls_of_declarations import declaration_calls, part_calls, tree
from further_kinds import ByName
from kinds_of_numbers import POSITIVE, Array, Count, Number

from pliant.plants import (
    FlexibleSpacecraft,
    LargeDeflectionBeam,
    SingleLinkArm,
    SliderCrank,
    Trajectory,
    TransferMatrices,
    TwoLinkArm,
    paper_terms,
    step_limit,
)

PLANTS = {
    "SingleLinkArm": SingleLinkArm.textbook(),
    "TwoLinkArm": TwoLinkArm.textbook(),
    "LargeDeflectionBeam": LargeDeflectionBeam.textbook(),
    "SliderCrank": SliderCrank.textbook(),
    "FlexibleSpacecraft": FlexibleSpacecraft.textbook(),
    "FlexibleTree": tree(),
}
ARM = PLANTS["SingleLinkArm"]


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
        Call("equilibrium.fixed", ARM.equilibrium, {"fixed": ByName({"hub_angle": 0.0}, none=True)}),
        Call("equilibrium.guess", ARM.equilibrium, {"guess": ByName({"hub_angle": 0.0}, none=True)}),
        Call("step_limit", step_limit, {"plant": Object(ARM), "x": Array(x), "method": Choice("rk4")}),
    ]


def own_calls() -> list[Call]:
    """What single plants do."""
    arm, beam, craft = PLANTS["TwoLinkArm"], PLANTS["LargeDeflectionBeam"], PLANTS["FlexibleSpacecraft"]
    crank = PLANTS["SliderCrank"]
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
        Call("SliderCrank.state", crank.state, {"angle": Number(0.5), "speed": Number(1.0, none=True)}),
        Call("FlexibleTree.lines", tree().lines, {"x": Array(rest(tree())), "points": Count(10, low=2)}),
        Call("FlexibleSpacecraft.momentum", craft.momentum, {"x": s}),
        Call("FlexibleSpacecraft.turn", craft.turn, {"x": s}),
        Call("FlexibleSpacecraft.consistent", craft.consistent, {"x": Array(rest(craft), wrong=False, finite=False)}),
        Call("FlexibleSpacecraft.residual", craft.residual, still),
        Call("FlexibleSpacecraft.rest_to_rest", craft.rest_to_rest, turn, compare=False),
        Call("FlexibleSpacecraft.state", craft.state, {"values": ByName({craft.states[0].name: 1.0}, none=True)}),
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
