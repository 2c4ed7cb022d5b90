"""Valid calls of what designs for scenes and plants, of loops and their margins, and of shaping."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Names, Object, Objects
from further_kinds import ByName, Function, Text
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, CYCLE, DT, GAIN, LIMITS, MODEL, SCENE, SCENES, SHARE, STATES, law

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
    loop,
    margins,
    periodic_nmpc,
    robust_lqg,
    shape,
    shaper_for,
    spillover,
    tune_mpc,
)
from pliant.controllers.analysis.linear_laws import LinearLaw, linearised
from pliant.controllers.analysis.loops import closed_loop, closed_loops
from pliant.controllers.analysis.margins import disk_gain, disk_phase_deg
from pliant.controllers.analysis.margins_along import margins_along
from pliant.controllers.analysis.spillover import case_of, crossover_hz, growth
from pliant.controllers.base.joint_reference import Follow, RestToRest
from pliant.controllers.estimation.process_noise import process_noise
from pliant.controllers.joint_control.input_shaping import shaper, switches
from pliant.controllers.optimal_control.nominal_motions import rigid_nominal
from pliant.controllers.robust_analysis.miss_over_box import miss_over_box
from pliant.controllers.robust_analysis.robust_gain import UncertainLTV, robust_gain, shows
from pliant.controllers.robust_analysis.robust_stability import over_box, robust_stability, stands
from pliant.controllers.robust_analysis.worst_parameters import worst_parameters
from pliant.plants import Trajectory

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
        Call("MPC.for_scene", MPC.for_scene, SCENES | {"horizon": Count(3), "nominal": Object(_motion(), none=True)}),
        Call(
            "TubeMPC.for_scene",
            TubeMPC.for_scene,
            SCENES
            | {"horizon": Count(3), "terminal": Count(1, low=0), "rounds": Count(1)}
            | {"nominal": Object(_motion(), none=True), "noise": ByName({"hub_angle": 0.5}, none=True, low=0.0)},
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


def _motion():
    return rigid_nominal(SCENE)


def loop_calls() -> list[Call]:
    """Of loops, margins, spillover."""
    model, controller = {"model": Object(MODEL)}, {"controller": Object(law("lqr, continuous"))}
    found = loop(MODEL, law("lqr, continuous"))
    reads = {"reads": Names(("place",), free=True), "dt": Number(DT, none=True, **POSITIVE), "delay": Count(1, low=0)}
    own = {
        "A": Array(np.array([[0.5]])),
        "B": Array(np.ones((1, 1))),
        "C": Array(np.ones((1, 1)), leads=True),
        "D": Array(np.ones((1, 1))),
    }
    more = {"at": ByName({"hub_angle": 0.5}, none=True), "reserve": Number(1.25, low=1.0)}
    spill = LQR.for_plant(ARM, np.zeros(2), np.zeros(1), np.eye(2), np.eye(1))
    return [
        *robust_calls(),
        Call("LinearLaw", LinearLaw, own | reads),
        Call(
            "linearised",
            linearised,
            {"controller": Object(GAIN), "y0": STATES, "step": Number(0.5, **POSITIVE), "t": Number(0.5)},
        ),
        Call("loop", loop, model | controller | {"at": Choice("input")}),
        Call("closed_loops", closed_loops, model | controller),
        Call("closed_loop", closed_loop, model | controller | {"gain": Number(0.5)}),
        Call("Loop.at", found.at, {"omega": Array(np.array([1.0, 2.0]), leads=True)}),
        Call("margins", margins, {"loop": Object(found)}),
        Call("disk_gain", disk_gain, {"disk": Number(0.5, low=0.0)}),
        Call("disk_phase_deg", disk_phase_deg, {"disk": Number(0.5, low=0.0)}),
        Call("growth", growth, model | controller | {"gain": Number(0.5)}),
        Call("case_of", case_of, model | controller | {"design": Object(MODEL), "label": Text("plant", empty=True)}),
        Call("crossover_hz", crossover_hz, {"found": Object(found), "gain": Number(0.5, **POSITIVE)}),
        Call("spillover", spillover, {"controller": Object(spill), "plants": Objects((ARM,))} | more),
        Call(
            "spillover, redesign",
            spillover,
            {"redesign": Function(lambda f: spill, none=True)},
            {"controller": spill, "plants": [ARM], "at": {"hub_angle": 0.0}},
        ),
    ]


def robust_calls() -> list[Call]:
    """Of boxes of parameters and of uncertain blocks."""
    one, t = np.ones((5, 1, 1)), np.linspace(0.0, 1.0, 5)
    fields = {n: Array(v) for n, v in {"t": t, "A": -one, "B": one, "E": one, "C": one, "D": 0 * one}.items()}
    along = UncertainLTV(t, -one, one, one, one, 0 * one, 0 * one, np.ones((1, 1)))
    sizes = {"size": Number(0.5, **POSITIVE), "pole": Number(2.0, **POSITIVE)}
    box, rest = {"link.E": (6e10, 7e10)}, {"hub_angle": 0.0}
    x, times = np.zeros((4, ARM.nx)), DT * np.arange(4)
    motion = Trajectory.from_arrays(times, x, np.zeros((4, ARM.nu)), plant=ARM)
    followed = ARM.linearize_along(motion)
    return [
        Call(
            "robust_stability",
            robust_stability,
            {"plant": Object(ARM), "controller": Object(LQR.for_scene(SCENE))},
            {"box": box, "at": rest},
            long=True,
        ),
        Call(
            "worst_parameters",
            worst_parameters,
            {"plant": Object(ARM), "nominal": Object(motion), "outputs": Names((ARM.outputs[0].name,))}
            | {"substeps": Count(2), "seed": Count(1, low=0)},
            {"box": box},
            long=True,
        ),
        Call(
            "miss_over_box",
            miss_over_box,
            {"plant": Object(ARM), "nominal": Object(motion), "outputs": Names((ARM.outputs[0].name,))}
            | {"substeps": Count(2), "seed": Count(1, low=0)},
            {"box": box},
            long=True,
        ),
        Call(
            "stands",
            stands,
            {"plant": Object(ARM), "controller": Object(LQR.for_scene(SCENE)), "parts": Count(20)},
            {"box": box, "at": rest},
            long=True,
        ),
        Call(
            "margins_along",
            margins_along,
            {"ltv": Object(followed), "K": Array(np.zeros((4, ARM.nu, ARM.nx)), wrong=False)}
            | {"limit": Number(2.0, low=1.0, open=True), "frozen": Count(2)}
            | {
                n: Names((s[0].name,), none=True)
                for n, s in (("outputs", ARM.outputs), ("disturbances", ARM.disturbances))
            },
            long=True,
        ),
        Call("robust_gain", robust_gain, {"system": Object(along)} | sizes, long=True),
        Call(
            "over_box",
            over_box,
            {"dt": Number(0.5, none=True, **POSITIVE)},
            {"state_matrix": lambda d: np.array([[-0.5 + d[0] / 4]]), "box": {"a": (1.0, 2.0)}},
            compare=False,
        ),
        Call("UncertainLTV", UncertainLTV, fields, {"F": 0 * one, "G": np.ones((1, 1))}),
        Call(
            "shows",
            shows,
            {"system": Object(along), "gain": Number(8.0, **POSITIVE), "multiplier": Array(np.eye(2), wrong=False)}
            | sizes,
        ),
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
