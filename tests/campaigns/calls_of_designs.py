"""Valid calls of what designs on models: Riccati equations, regulators, filters, predictive control."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Names, Object, Objects
from further_kinds import Blocks, ByName, Pair
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, DT, GAIN, LIMITS, LTV, MODEL, SAMPLED, SENSOR, STATES, Q, R, fresh, law

from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    TVLQR,
    DisturbanceSet,
    Feedback,
    Kalman,
    Predictive,
    Sensor,
    TubeMPC,
    delayed,
    riccati,
    sensors,
)
from pliant.controllers.linear_quadratic.delay import delay_margin, predictive_gain, radius
from pliant.controllers.riccati.periodic_drawn import drawn_periodic, multipliers_of
from pliant.plants import Beam, Material

A, B, N = Array(MODEL.A), Array(MODEL.B), Array(np.zeros((2, 1)), none=True)
C, E = Array(MODEL.C, leads=True), Array(MODEL.E)
NAMES = Names(("s", "v"), none=True)
WEIGHED = ByName({"wind": 0.5}, low=0.0, open=True)
BEAM = Beam.rectangular(1.0, width=0.01, depth=0.05, material=Material(density=7800.0, E=2e11, G=8e10))


def design_calls() -> list[Call]:
    """Of pure functions of arrays, then of laws and filters."""
    return [*riccati_calls(), *regulator_calls(), *late_calls(), *filter_calls(), *sensor_calls(), *predictive_calls()]


def riccati_calls() -> list[Call]:
    """Of pliant.controllers.riccati."""
    plain = {"A": A, "B": B, "Q": Array(Q), "R": Array(R), "N": N}
    sampled = plain | {"A": Array(SAMPLED.A)}
    steps = {"A": Array(np.repeat(SAMPLED.A[None], 3, 0)), "B": Array(np.repeat(np.array([[[0.0], [0.125]]]), 3, 0))}
    each = {"c": Array(np.ones(2), none=True), "q": Array(np.zeros(2), none=True), "s": Array(np.zeros(1), none=True)}
    ends = {"r": Number(0.0, none=True, array=False), "end": Array(Q, none=True)}
    noise = {"A": A, "E": E, "C": C, "W": Array(np.array([[0.5]])), "V": Array(np.array([[0.25]]))}
    along = {"model": Object(LTV), "Q": Array(Q), "R": Array(R), "N": N}
    drawn = np.array([[[[0.5, 0.25, 0.0], [0.0, 0.5, 1.0]]] * 2])
    slope = {"g": Array(np.zeros((1, 2, 3)))}
    timed = riccati.dtvlqr(steps["A"].value, steps["B"].value, Q, R)
    return [
        Call("riccati.lqr", riccati.lqr, plain | {"names": NAMES}),
        Call("riccati.dlqr", riccati.dlqr, sampled | {"names": NAMES, "dt": Number(DT, **POSITIVE)}),
        Call(
            "riccati.lqi",
            riccati.lqi,
            {"A": A, "B": B, "C": C, "Q": Array(np.eye(3)), "R": Array(R), "D": Array(np.zeros((1, 1)), none=True)}
            | {"names": NAMES},
        ),
        Call("riccati.sampled", riccati.sampled, plain | {"dt": Number(DT, **POSITIVE)}),
        Call("riccati.kalman", riccati.kalman, noise | {"names": NAMES}),
        Call(
            "riccati.dkalman",
            riccati.dkalman,
            noise | {"A": sampled["A"], "names": NAMES, "dt": Number(DT, **POSITIVE)},
        ),
        Call(
            "riccati.dplqr",
            riccati.dplqr,
            steps | {"Q": Array(Q), "R": Array(R), "N": N} | {name: each[name] for name in ("c", "q", "s")},
        ),
        Call(
            "riccati.dpkalman",
            riccati.dpkalman,
            {"A": steps["A"], "C": Array(np.repeat(np.array([[[1.0, 0.25]]]), 3, 0))}
            | {"W": Array(np.diag([0.5, 0.25])), "V": Array(np.array([[0.25]]))},
        ),
        Call(
            "drawn_periodic", drawn_periodic, {"F": Array(drawn), "W": Array(np.tile(np.eye(3), (1, 2, 1, 1)))} | slope
        ),
        Call("multipliers_of", multipliers_of, {"F": Array(drawn), "K": Array(np.zeros((2, 1, 2)))}),
        Call("riccati.dtvlqr", riccati.dtvlqr, steps | {"Q": Array(Q), "R": Array(R), "N": N} | each | ends),
        Call("riccati.tvlqr", riccati.tvlqr, along | {"end": Array(Q, none=True)}),
        Call("riccati.sampled_along", riccati.sampled_along, along),
        Call("riccati.noise_along", riccati.noise_along, {"model": Object(LTV), "W": Array(np.array([[0.5]]))}),
        Call("Regulator.cost_to_go", riccati.lqr(MODEL.A, MODEL.B, Q, R).cost_to_go, {"x": STATES}),
        Call("TimeVaryingRegulator.cost_to_go", timed.cost_to_go, {"i": Count(1, low=None), "x": STATES}),
    ]


def regulator_calls() -> list[Call]:
    """Of Feedback, LQR, TVLQR."""
    point = {"plant": Object(ARM), "x0": Array(np.zeros(2)), "u0": Array(np.zeros(1), none=True)}
    weights = {"Q": Array(Q), "R": Array(R)}
    named = {"Q": ByName({"s": 4.0, "place": 1.0}, low=0.0), "R": ByName({"force": 0.5}, low=0.0, open=True)}
    integral = {"integral": ByName({"place": 1.0}, none=True, low=0.0, open=True), "limits": LIMITS}
    start = {"start": Array(np.zeros(2), none=True), "reads": Names(("place", "rate"), none=True)}
    reads = {"reads": Names(("hub_angle", "hub_angle_rate"), none=True), "dt": Number(DT, none=True, **POSITIVE)}
    hold = (np.array([[2.0, 1.0]]), np.zeros(2), np.zeros(1))
    along = {"ltv": Object(LTV)} | weights | {"N": N, "end": Array(Q, none=True), "hold": Objects(hold, none=True)}
    follows = TVLQR.design(LTV, Q, R)
    return [
        Call(
            "Feedback",
            Feedback,
            {"K": Array(GAIN.K), "reads": Names(("s", "v")), "y_ref": Array(np.ones(2), none=True)}
            | {"u_ref": Array(np.ones(1), none=True), "limits": LIMITS, "dt": Number(DT, none=True, **POSITIVE)},
        ),
        Call("Feedback.act", GAIN.act, {"y": STATES}, {"t": 0.0}, ("t", "y")),
        Call(
            "LQR.design",
            LQR.design,
            {"model": Object(MODEL)} | weights | integral | start | {"dt": Number(DT, none=True, **POSITIVE)},
        ),
        Call("LQR.design, by name", LQR.design, named, {"model": MODEL}),
        Call("LQR.for_plant", LQR.for_plant, point | weights | reads | {"limits": LIMITS}),
        Call("LQR.act", fresh(law("lqr"), "act"), {"y": Array(np.array([0.25, 0.5, 0.25]))}, {"t": 0.0}),
        Call(
            "LQR.act, continuous",
            fresh(_integrating(), "act"),
            {"t": Number(0.25), "y": Array(np.array([0.25, 0.5, 0.25]))},
        ),
        Call("LQR.cost_to_go", law("lqr").cost_to_go, {"x": STATES, "xi": Array(np.ones(1), none=True)}),
        Call("TVLQR.design", TVLQR.design, along | {"limits": LIMITS, "index": Choice("time")}),
        Call("TVLQR.act", fresh(follows, "act"), {"t": Number(0.25), "y": STATES}),
        Call("TVLQR.cost_to_go", follows.cost_to_go, {"k": Count(1, low=None), "x": STATES}),
        Call("Funnel.place", _funnel().place, {"t": Number(0.25)}),
        Call("Funnel.use", _funnel().use, {"t": Number(0.25), "x": STATES}),
        Call("Funnel.inside", _funnel().inside, {"t": Number(0.25), "x": STATES}),
    ]


def _integrating() -> LQR:
    return LQR.design(MODEL, Q, R, integral={"place": 1.0})


def _funnel():
    return TVLQR.design(LTV, Q, R, limits=(-2.0, 2.0), end=Q).funnel


def late_calls() -> list[Call]:
    """Of inputs that act late."""
    model, K = {"model": Object(SAMPLED)}, {"K": Array(GAIN.K)}
    own = Feedback(GAIN.K, ("hub_angle", "hub_angle_rate"))
    given = {
        "law": Object(own),
        "plant": Object(ARM),
        "delay": Count(2),
        "dt": Number(DT, **POSITIVE),
        "substeps": Count(2),
    }
    predictive = Predictive(own, ARM, 2, dt=DT)
    return [
        Call("delayed", delayed, model | {"periods": Count(2, low=0)}),
        Call("radius", radius, model | K | {"periods": Count(2, low=0)}),
        Call("delay_margin", delay_margin, model | K | {"most": Count(3, low=0)}),
        Call("predictive_gain", predictive_gain, model | K | {"periods": Count(2, low=0)}),
        Call("Predictive", Predictive, given | {"limits": LIMITS, "start": Array(np.ones(1), none=True)}),
        Call("Predictive.act", fresh(predictive, "act"), {"t": Number(0.25), "y": STATES}),
    ]


def filter_calls() -> list[Call]:
    """Of Kalman and LQG."""
    seen = {"sensors": Objects((SENSOR,)), "W": WEIGHED}
    rest = {"dt": Number(DT, **POSITIVE), "delay": Count(1, low=0), "noise": Choice("white")}
    spread = {"P0": Array(np.eye(2), none=True)}
    along = {"ltv": Object(LTV)} | seen | {"P0": Array(np.eye(2)), "delay": Count(1, low=0), "noise": Choice("held")}
    filtered = Kalman.design(MODEL, (SENSOR,), {"wind": 0.5}, dt=DT)
    controller = LQG(law("lqr, plain"), filtered)
    weights = {"Q": Array(Q), "R": Array(R), "limits": LIMITS}
    return [
        Call("Kalman.design", Kalman.design, {"model": Object(MODEL)} | seen | rest | spread),
        Call("Kalman.along", Kalman.along, along),
        Call("Kalman.reset", fresh(filtered, "reset"), {"x0": Array(np.ones(2), none=True)}),
        Call("Kalman.step", fresh(filtered, "step"), {"y": Array(np.ones(1)), "u": Array(np.ones(1), none=True)}),
        Call("LQG", LQG, {"law": Object(law("lqr, plain")), "filter": Object(filtered)}),
        Call("LQG.design", LQG.design, {"model": Object(MODEL)} | weights | seen | rest),
        Call("LQG.act", fresh(controller, "act"), {"y": Array(np.ones(1))}, {"t": 0.0}),
    ]


def sensor_calls() -> list[Call]:
    """Of pliant.controllers.sensors."""
    sizes = {name: Number(0.5, low=0.0) for name in ("noise", "density", "quantum")}
    words = {"kind": Choice("other"), "output": Choice("place"), "unit": Choice("m")}
    rng = {"rng": Object(np.random.default_rng(0))}
    some = {"sensors": Objects((SENSOR,)), "dt": Number(DT, **POSITIVE)}
    return [
        Call("Sensor", Sensor, {"kind": words["kind"]} | sizes, {"output": "place", "unit": "m"}),
        Call("Sensor.deviation", SENSOR.deviation, {"dt": Number(DT, **POSITIVE)}),
        Call("Sensor.read", SENSOR.read, {"value": Number(0.5), "dt": Number(DT, **POSITIVE)} | rng, compare=False),
        Call("sensors.read", sensors.read, some | rng | {"y": Array(np.ones(1))}, compare=False),
        Call("sensors.covariance", sensors.covariance, some),
        Call("sensors.sensors_of", sensors.sensors_of, {"plant": Object(ARM)}),
        Call("sensors.gauge", sensors.gauge, {"beam": Object(BEAM)}, {"output": "strain"}),
        Call("sensors.gyro", sensors.gyro, {"density": Number(0.5, low=0.0)}, {"output": "rate"}),
    ]


def predictive_calls() -> list[Call]:
    """Of MPC."""
    weights = {"Q": Array(Q), "R": Array(R), "P": Array(Q, none=True)}
    bounds = {"bounds": _bounds(), "limits": LIMITS, "rates": Array(np.array([8.0]), none=True, infinite=True)}
    counts = {"horizon": Count(4), "terminal": Count(1, low=0), "blocks": Blocks((1, 3), none=True)}
    more = {"penalty": Number(8.0, none=True, **POSITIVE), "reads": Names(("s", "v"), none=True)}
    free = {"track": Names(("place",)), "disturbance": Choice("states", none=True), "time": Number(0.25, **POSITIVE)}
    noise = {"noise": Number(0.5, **POSITIVE)}
    whole = {"model": Object(SAMPLED)} | weights | {"N": N} | counts | bounds | more
    named = {
        "noise": ByName({"place": 0.5}, number=True, **POSITIVE),
        "rates": ByName({"force": 8.0}, none=True, number=True, **POSITIVE),
    }
    seen = {"track": ("place",), "reads": ("place",), "disturbance": "inputs", "horizon": 4}
    given = {"model": SAMPLED, "Q": Q, "R": R}
    along = {k: v for k, v in whole.items() if k not in ("model", "N")}
    return [
        Call("MPC.design", MPC.design, whole),
        Call("MPC.design, sampled", MPC.design, {"dt": Number(DT, **POSITIVE)}, given | {"model": MODEL, "horizon": 4}),
        Call("MPC.design, offset-free", MPC.design, free, given | {"horizon": 4}),
        Call("MPC.design, noise", MPC.design, noise, given | seen),
        Call("MPC.design, noise by name", MPC.design, named, given | seen),
        Call("MPC.along", MPC.along, {"ltv": Object(LTV)} | along),
        *tube_calls(),
        Call("MPC.aim", fresh(law("mpc"), "aim"), {"values": ByName({"place": 0.5})}),
        Call("MPC.act", fresh(law("mpc"), "act"), {"y": STATES}, {"t": 0.0}),
        Call("MPC.act, along", fresh(law("mpc, along"), "act"), {"t": Number(0.25), "y": STATES}),
    ]


def _bounds() -> ByName:
    return _Bounds({"v": (-1.0, 1.0)}, none=True)


class _Bounds(ByName):
    """Pairs by name."""

    def bad(self):
        """Nonsense in one of them."""
        yield from (p for p in ByName(self.value, none=True).bad() if "infinity" not in p[0])
        name = next(iter(self.value))
        yield from ((f"{what}, as a bound", {name: wrong}) for what, wrong in Pair((-1.0, 1.0)).bad())

    def good(self):
        """Lists and arrays."""
        for what, value in Pair((-1.0, 1.0)).good():
            yield what, dict.fromkeys(self.value, value)


def tube_calls() -> list[Call]:
    """Of MPC with tubes and of their sets."""
    points, noise = Array(np.array([[[0.125, 0.0], [0.0, -0.125]]]), wrong=False), Array(np.array([0.0, 0.125]))
    wind = DisturbanceSet.box([0.0, 0.0625])
    counts = {"horizon": Count(4), "terminal": Count(1, low=0), "penalty": Number(8.0, none=True, **POSITIVE)}
    whole = {"Q": Array(Q), "R": Array(R), "disturbances": Object(wind), "bounds": _bounds(), "limits": LIMITS} | counts
    tube = TubeMPC.design(SAMPLED, Q, R, wind, horizon=4, limits=(-2.0, 2.0))
    return [
        Call("DisturbanceSet", DisturbanceSet, {"points": points, "noise": noise}),
        Call(
            "DisturbanceSet.box",
            DisturbanceSet.box,
            {"size": Array(np.array([0.25, 0.5]), wrong=False), "noise": Array(np.array([0.0, 0.125]), none=True)},
        ),
        Call("DisturbanceSet.support", wind.support, {"k": Number(0.0), "directions": Array(np.eye(2), wrong=False)}),
        Call("DisturbanceSet.scaled", wind.scaled, {"share": Number(0.5, low=0.0)}),
        Call(
            "TubeMPC.design",
            TubeMPC.design,
            {"model": Object(MODEL), "delay": Count(1, low=0), "before": Array(np.array([0.25]), none=True)} | whole,
            {"dt": 0.25},
        ),
        Call("TubeMPC.along", TubeMPC.along, {"ltv": Object(LTV)} | whole),
        Call("TubeMPC.act", fresh(tube, "act"), {"t": Number(0.25), "y": STATES}),
    ]
