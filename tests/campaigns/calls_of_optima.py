"""Valid calls of plans and the best motion, of nonlinear predictive control, and of learning."""

from __future__ import annotations

import dataclasses

import numpy as np
from argument_kinds import Call, Choice, Flag, Names, Object, Objects
from further_kinds import ByName, Function, Place, Text
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, DT, LIMITS, SCENE, SCENES, SHARE, STATES, folder, fresh, law, policy_arrays

from pliant.controllers import (
    NMPC,
    TVLQR,
    Objective,
    Policy,
    optimal,
    plan,
    rl,
)
from pliant.controllers.learning.settings import CURVE_FORMAT
from pliant.controllers.optimal_control.nominal_motions import nominal_for, rigid_nominal
from pliant.controllers.optimal_control.optimal import bound
from pliant.plants.files import sealed_json

LOADED = ARM.vary("payload.mass")


def optima_calls() -> list[Call]:
    """Of all of these."""
    return [*optimal_calls(), *nonlinear_calls(), *learning_calls(), *refused_training()]


def optimal_calls() -> list[Call]:
    """Of planning and of the best motion."""
    goal = {"x_goal": Array(np.array([0.03125, 0.0])), "u_goal": Array(np.zeros(1)), "plant": Object(ARM)}
    charge = {"weights": ByName({"hub_angle": 8.0}, low=0.0), "effort": ByName({"hub_torque": 0.5}, **POSITIVE)}
    moving = {"goal_rates": ByName({"hub_angle": 0.0}), "dt": Number(SCENE.dt, **POSITIVE), "limits": LIMITS}
    about = Objective.of(SCENE)
    rows = {"x": Array(np.zeros((3, 2)), leads=True), "u": Array(np.zeros((3, 1)), leads=True), "t0": Number(0.25)}
    given = {
        "objective": Object(dataclasses.replace(about, plant=LOADED)),
        "x0": Array(np.zeros(2)),
        "steps": Count(4),
        "substeps": Count(2),
    }
    words = {"solver": Choice("ipopt"), "hessian": Choice("gauss-newton"), "tolerance": Number(2.0**-20, **POSITIVE)}
    more = {
        "iterations": Count(50),
        "terminal": Array(np.eye(2), none=True),
        "w": Array(np.zeros(2), none=True),
        "p": Array(LOADED.nominal_parameters, none=True),
    }
    found = optimal(about, np.zeros(2), 4, substeps=2)
    planned = {"x0": Array(np.zeros(2), none=True), "time": Number(0.25, none=True, **POSITIVE), "reserve": SHARE}
    signals = {
        "bounds": ByName({"hub_angle_rate": 8.0}, none=True, **POSITIVE),
        "weights": ByName({"hub_angle": 8.0}, none=True, low=0.0),
    }
    return [
        Call("Objective", Objective, goal | charge | moving),
        Call("Objective.cost", about.cost, rows),
        Call("Objective.goal_at", about.goal_at, {"t": Number(0.25)}),
        Call("optimal", optimal, given | words | more),
        Call("bound", bound, SCENES),
        Call("Motion.trajectory", found.trajectory, {"plant": Object(ARM)}),
        Call("plan", plan, SCENES | planned | signals | {"effort": ByName({"hub_torque": 0.5}, none=True, **POSITIVE)}),
        Call(
            "plan, path",
            plan,
            {"path": Function(lambda t: {"hub_angle": t}, none=True)},
            {"scene": SCENE, "weights": {"hub_angle": 8.0}},
        ),
        Call("nominal_for", nominal_for, SCENES | {"kind": Choice("rigid"), "reserve": SHARE}),
        Call("rigid_nominal", rigid_nominal, SCENES),
        Call(
            "TVLQR.along",
            TVLQR.along,
            {
                "plant": Object(ARM),
                "nominal": Object(rigid_nominal(SCENE)),
                "dt": Number(SCENE.dt, **POSITIVE),
                "substeps": Count(2),
            },
            {"Q": np.eye(2), "R": np.eye(1)},
        ),
    ]


def nonlinear_calls() -> list[Call]:
    """Of NMPC."""
    about = Objective.of(SCENE)
    counts = {
        "horizon": Count(3),
        "substeps": Count(2, none=True),
        "first_steps": Count(5),
        "iteration_limit": Count(50, low=0),
    }
    more = {
        "terminal": Array(np.eye(2), none=True),
        "penalty": Number(8.0, **POSITIVE),
        "starts": Objects((np.zeros(2),)),
    }
    made = NMPC(about, 3, substeps=2)
    made.act(0.0, np.zeros(2))
    number = {"t": Number(0.25), "tolerance": Number(0.5, **POSITIVE), "limit": Count(50)}
    return [
        Call("NMPC", NMPC, {"objective": Object(about)} | counts | more),
        Call("NMPC.act", fresh(made, "act"), {"y": STATES}, {"t": 0.25}),
        Call("NMPC.start", fresh(made, "start"), {"t": Number(0.25), "y": STATES}),
        Call("NMPC.feedback", fresh(made, "feedback"), {"y": STATES}),
        Call("NMPC.iterate", fresh(made, "iterate"), {"x": Array(np.zeros(2))} | number),
    ]


def learning_calls() -> list[Call]:
    """Of policies and of training: what is checked before it loads torch."""
    arrays, place = policy_arrays(), folder()
    made = law("policy")
    made.save(place / "kept")
    curve = place / "curve.json"
    sealed_json.save(curve, {"format": CURVE_FORMAT, "curve": []})
    layers = {"weights": Objects(arrays["weights"]), "biases": Objects(arrays["biases"])}
    rows = {name: Array(arrays[name]) for name in ("mean", "std", "goal", "limits")}
    words = {
        "reads": Names(arrays["reads"]),
        "inputs": Names(arrays["inputs"], free=True),
        "scene": Text("short", empty=True),
    }
    rest = {
        "dt": Number(DT, **POSITIVE),
        "clip": Number(8.0, infinite=True, **POSITIVE),
        "activation": Choice("tanh"),
        "squash": Flag(True),
    }
    unit, positive = Number(0.5, low=0.0, high=1.0), Number(0.5, **POSITIVE)
    common = {
        "num_envs": Count(4),
        "batch_size": Count(4),
        "learning_rate": positive,
        "gamma": unit,
        "width": Count(4),
        "spread": Number(0.5, low=0.0),
    }
    ppo = {"n_steps": Count(4), "n_epochs": Count(4), "gae_lambda": unit, "clip_range": positive, "noise": positive}
    apg = {"history": Count(4, low=0), "delay": Count(4, low=0), "noise": Number(0.5, low=0.0)}
    sac = {
        "buffer_size": Count(4),
        "gradient_steps": Count(4),
        "learning_starts": Count(4, low=0),
        "tau": Number(0.5, low=0.0, open=True, high=1.0),
    }
    return [
        Call("Policy", Policy, layers | rows | words | rest),
        Call("Policy.act", made.act, {"y": STATES}, {"t": 0.0}, ("t", "y")),
        Call("Policy.load", Policy.load, {"path": Place(place / "kept")}, compare=False),
        Call("Policy.save", made.save, {"path": Place(place / "again")}),
        Call("Policy.for_scene", Policy.for_scene, {"name": Choice("single-link-slew")}, compare=False),
        Call("APGSettings", rl.APGSettings, {k: common[k] for k in ("num_envs", "learning_rate", "width")} | apg),
        Call("PPOSettings", rl.PPOSettings, common | ppo),
        Call("SACSettings", rl.SACSettings, common | sac),
        Call("rl.read_curve", rl.read_curve, {"path": Place(curve)}),
        Call("rl.evaluate", rl.evaluate, {"policy": Object(made), "scene": Object(SCENE)}),
    ]


def refused_training() -> list[Call]:
    """Of train: every valid one takes seconds, so that only what is refused before is tried."""
    numbers = {
        "seed": Count(1, low=0),
        "steps": Count(8, none=True),
        "num_envs": Count(4, none=True),
        "threads": Count(1, none=True),
    }
    others = {
        "scene": Object(SCENE),
        "algorithm": Choice("ppo"),
        "resume": Flag(False),
        "command": Text("pliant", empty=True),
    }
    more = {
        "settings": Object(rl.PPOSettings(num_envs=2), none=True),
        "progress": Function(print, none=True),
        "folder": Place("never", none=True),
    }
    return [
        Call("rl.train", rl.train, numbers | others | more, long=True),
        Call(
            "rl.train, seconds", rl.train, {"seconds": Number(1.0, none=True, **POSITIVE)}, {"scene": SCENE}, long=True
        ),
    ]
