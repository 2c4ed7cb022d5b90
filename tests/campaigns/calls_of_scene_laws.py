"""Valid calls of what designs for scenes and plants, and of shaping."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Object, Objects
from calls_of_loops import loop_calls
from further_kinds import ByName, Function
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, CYCLE, DT, LIMITS, SCENE, SCENES, SHARE, STATES

from pliant import controllers
from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    NMPC,
    PD,
    TVLQR,
    ComputedTorque,
    DifferentiableMPC,
    Kalman,
    Led,
    MultiModelLQR,
    Objective,
    PeriodicKalman,
    PeriodicLQG,
    PeriodicLQR,
    PeriodicMPC,
    PeriodicTVLQR,
    Predictive,
    TubeMPC,
    periodic_nmpc,
    robust_lqg,
    shape,
    shaper_for,
    tune_mpc,
)
from pliant.controllers.base.joint_reference import Follow, RestToRest
from pliant.controllers.estimation.process_noise import process_noise
from pliant.controllers.joint_control.input_shaping import shaper, switches
from pliant.controllers.optimal_control.nominal_motions import rigid_nominal

RATE = {"bandwidth": Number(4.0, **POSITIVE), "damping": Number(0.5, **POSITIVE)}
SENSORS = Objects((controllers.Sensor("encoder", "hub_angle", "rad", noise=0.5),), none=True)


LASTING = MultiModelLQR.for_scene(SCENE, ranges={}, delays=(0,), iterations=5)


def scene_law_calls() -> list[Call]:
    """Of all of these."""
    return [*for_scene_calls(), *loop_calls(), *joint_calls()]


def cycle_calls() -> list[Call]:
    """Of laws of cycles."""
    scene, effort = {"scene": Object(CYCLE)}, {"effort": Number(2.0, **POSITIVE)}
    W = {"W": ByName({"crank_acceleration": 0.5}, none=True, **POSITIVE)}
    late = {"input_delay": Number(0.5, low=0.0)}
    led = {"nominal": Choice("rigid", none=True), "reserve": SHARE, "index": Choice("time")}
    made = [
        (PeriodicKalman, scene | W | late, {}),
        (PeriodicLQG, scene | W | effort, {"ranges": {}}),
        (PeriodicMPC, scene | {"horizon": Count(2), "penalty": Number(9.0, none=True, **POSITIVE)} | effort, {}),
        (PeriodicTVLQR, scene | effort | led, {}),
    ]
    calls = [Call(f"{law.__name__}.for_scene", law.for_scene, *given, compare=False) for law, *given in made]
    return [*calls, Call("periodic_nmpc", periodic_nmpc, scene | {"horizon": Count(2)}, compare=False)]


def for_scene_calls() -> list[Call]:
    """Of every for_scene."""
    effort = {"effort": Number(2.0, **POSITIVE)}
    W = {"W": ByName({"hub_torque": 0.5}, none=True, **POSITIVE)}
    integral = {"integral": ByName({"hub_angle": 1.0}, none=True, **POSITIVE)}
    seen = {"sensors": SENSORS, "delay": Count(1, low=0)} | W
    follow = {"nominal": Choice("rigid", none=True), "reserve": SHARE, "index": Choice("time")}
    own = LQR.for_scene(SCENE)
    return [
        Call("LQR.for_scene", LQR.for_scene, SCENES | effort | integral),
        Call(
            "PeriodicLQR.for_scene",
            PeriodicLQR.for_scene,
            {"scene": Object(CYCLE), "effort": effort["effort"]},
            compare=False,
        ),
        *cycle_calls(),
        Call("Kalman.for_scene", Kalman.for_scene, SCENES | seen),
        Call("LQG.for_scene", LQG.for_scene, SCENES | seen | effort | {"uncertain": SHARE}),
        Call(
            "MultiModelLQR.for_scene",
            MultiModelLQR.for_scene,
            SCENES | {"reads": Choice("states"), "iterations": Count(5)} | effort | {"sensors": SENSORS},
            {"ranges": {}, "delays": (0,)},
            compare=False,
        ),
        Call("Led.for_scene", Led.for_scene, SCENES | {"reserve": SHARE}, {"law": LASTING}, compare=False),
        Call(
            "robust_lqg",
            robust_lqg,
            SCENES | {"iterations": Count(2), "sensors": SENSORS},
            {"ranges": {}, "delays": (0,)},
            compare=False,
        ),
        Call("DifferentiableMPC.for_scene", DifferentiableMPC.for_scene, SCENES | {"horizon": Count(3)}, compare=False),
        Call(
            "tune_mpc",
            tune_mpc,
            SCENES | {"runs": Count(1), "steps": Count(1), "horizon": Count(3), "rate": Number(0.1, **POSITIVE)},
            {"ranges": {}},
            compare=False,
        ),
        Call("TVLQR.for_scene", TVLQR.for_scene, SCENES | {"effort": effort["effort"]} | follow),
        Call("Predictive.for_scene", Predictive.for_scene, SCENES | {"delay": Count(1), "law": Object(own, none=True)}),
        Call(
            "MPC.for_scene",
            MPC.for_scene,
            SCENES | {"horizon": Count(3), "nominal": Object(rigid_nominal(SCENE), none=True)},
        ),
        Call(
            "TubeMPC.for_scene",
            TubeMPC.for_scene,
            SCENES
            | {"horizon": Count(3), "terminal": Count(1, low=0), "rounds": Count(1), "delay": Count(0, low=0)}
            | {
                "nominal": Object(rigid_nominal(SCENE), none=True),
                "noise": ByName({"hub_angle": 0.5}, none=True, low=0.0),
            },
            {"ranges": {}},
            compare=False,
        ),
        Call("NMPC.for_scene", NMPC.for_scene, SCENES | {"horizon": Count(3)}),
        Call("PD.for_scene", PD.for_scene, SCENES | {"shape": Choice("zv", none=True)}),
        Call("ComputedTorque.for_scene", ComputedTorque.for_scene, SCENES | {"damping": RATE["damping"]}),
        Call(
            "ComputedTorque.for_scene, bandwidth",
            ComputedTorque.for_scene,
            {"bandwidth": Number(4.0, none=True, **POSITIVE)},
            {"scene": SCENE},
        ),
        Call("Objective.of", Objective.of, SCENES),
        Call("process_noise", process_noise, SCENES),
    ]


def joint_calls() -> list[Call]:
    """Of PD, computed torque, references and shapers."""
    point = {"plant": Object(ARM), "x0": Array(np.zeros(2)), "u0": Array(np.zeros(1))}
    ends = {"begin": Array(np.zeros(1), leads=True), "end": Array(np.ones(1))}
    rest = RestToRest(np.zeros(1), np.ones(1), 0.5)
    more = {"limits": LIMITS, "dt": Number(DT, none=True, **POSITIVE)}
    torque = ComputedTorque.design(ARM, rest, bandwidth=4.0)
    pd = PD.design(ARM, np.zeros(2), np.zeros(1), bandwidth=4.0, reference=rest)
    made = shaper(4.0)
    at = {"at": Objects((("hub_angle",), ("hub_angle_rate",)), none=True), "reference": Object(rest, none=True)}
    kinds = {"kind": Choice("zvd"), "tolerance": Number(0.125, **POSITIVE)}
    modes = {"modes": Array(np.array([4.0, 8.0]), leads=True)}
    follow = {"dt": Number(DT, **POSITIVE), "positions": Array(np.zeros((2, 1)), leads=True, wrong=False)}
    rows = {"rates": Array(np.ones((2, 1))), "accelerations": Array(np.ones((2, 1)))}
    followed = Follow(DT, np.zeros((2, 1)), np.ones((2, 1)), np.ones((2, 1)))
    steps = [(0.0, 0.0), (1.0, 1.0)]
    command = {"command": Function(lambda t: t)}
    return [
        Call("RestToRest", RestToRest, ends | {"time": Number(0.5, **POSITIVE), "shaper": Object(made, none=True)}),
        Call("RestToRest.__call__", rest.__call__, {"t": Number(0.25)}),
        Call("Follow", Follow, follow | rows),
        Call("Follow.__call__", followed.__call__, {"t": Number(0.25)}),
        Call("PD.design", PD.design, point | RATE | at | more),
        Call("PD.shaped", pd.shaped, {"model": Object(ARM.linearize(np.zeros(2))), "kind": Choice("zv")}),
        Call("PD.act", pd.act, {"t": Number(0.25), "y": STATES}),
        Call(
            "ComputedTorque.design",
            ComputedTorque.design,
            {"plant": Object(ARM), "reference": Object(rest)} | RATE | more,
        ),
        Call("ComputedTorque.act", torque.act, {"t": Number(0.25), "y": STATES}),
        Call(
            "shaper",
            shaper,
            {"frequency": Number(4.0, **POSITIVE), "damping": Number(0.125, low=0.0, high=0.9)} | kinds,
        ),
        Call("shaper_for", shaper_for, modes | kinds | {"most": Count(1, none=True)}),
        Call("shape", shape, command | modes | kinds),
        Call("Shaper", type(made), {"times": Array(made.times, leads=True), "amplitudes": Array(made.amplitudes)}),
        Call("Shaper.__call__", made.__call__, command),
        Call(
            "Shaper.residual",
            made.residual,
            {
                "frequency": Array(np.array([4.0, 8.0]), leads=True, wrong=False),
                "damping": Number(0.125, low=0.0, high=0.9),
            },
        ),
        Call("switches", switches, {"command": Objects(tuple(steps)), "by": Object(made)}),
    ]
