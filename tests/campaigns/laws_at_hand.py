"""The models, scenes and laws that the calls of bad input are made with: small, of numbers that float32 holds.

Beside them the arguments that many of these calls take.
"""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Callable
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from argument_kinds import Object
from further_kinds import Pair
from kinds_of_numbers import Array, Number

from pliant.controllers import LQR, MPC, Feedback, Policy, Sensor
from pliant.envs import scenes
from pliant.plants import LinearModel, LTVModel

DT = 0.125  # [s]
MODEL = LinearModel.from_matrices(
    [[0.0, 1.0], [-4.0, -0.5]],
    [[0.0], [1.0]],
    [[1.0, 0.0]],
    E=[[0.0], [1.0]],
    states=("s", "v"),
    inputs=("force",),
    disturbances=("wind",),
    outputs=("place",),
)
SAMPLED = MODEL.discretize(DT)
Q, R = np.diag([4.0, 1.0]), np.array([[0.5]])
NODES = 5
LTV = LTVModel(
    t=DT * np.arange(NODES),
    A=np.repeat(MODEL.A[None], NODES, axis=0),
    B=np.repeat(MODEL.B[None], NODES, axis=0),
    E=np.repeat(MODEL.E[None], NODES, axis=0),
    C=np.repeat(MODEL.C[None], NODES, axis=0),
    D=np.repeat(MODEL.D[None], NODES, axis=0),
    F=np.repeat(MODEL.F[None], NODES, axis=0),
    c=np.zeros((NODES, 2)),
    x=np.zeros((NODES, 2)),
    u=np.zeros((NODES, 1)),
    y=np.zeros((NODES, 1)),
    states=MODEL.states,
    inputs=MODEL.inputs,
    disturbances=MODEL.disturbances,
    outputs=MODEL.outputs,
)
SENSOR = Sensor("encoder", "place", "m", noise=0.5, quantum=0.25)
GAIN = Feedback(np.array([[2.0, 1.0]]), ("s", "v"))
SLEW = scenes.get("single-link-slew")
CYCLE = dataclasses.replace(scenes.get("slider-crank-run"), dt=5 / 192, substeps=100)  # a turn is 16 periods
SCENE = dataclasses.replace(
    SLEW,
    name="short",
    plant=SLEW.plant.ladder()[0],
    duration=0.5,
    move_time=0.25,
    dt=0.0625,
    substeps=2,
    weights=(("hub_angle", 8.0), ("hub_angle_rate", 0.5)),
    effort=(("hub_torque", 0.5),),
    bounds=(("hub_angle_rate", 16.0),),
    observe=("hub_angle", "hub_angle_rate"),
    randomise=(),
    goal=(("hub_angle", 0.03125),),
)
ARM = SCENE.plant
STATE = np.array([0.25, 0.5])
SCENES, STATES = {"scene": Object(SCENE)}, Array(STATE)  # what many of them take
LIMITS, SHARE = Pair((-2.0, 2.0), none=True), Number(0.125, low=0.0)


@cache
def law(name: str) -> Any:
    """A law of the model, or of the scene."""
    limits = (-2.0, 2.0)
    made: dict[str, Callable[[], Any]] = {
        "lqr": lambda: LQR.design(MODEL, Q, R, dt=DT, limits=limits, integral={"place": 1.0}),
        "lqr, plain": lambda: LQR.design(MODEL, Q, R, dt=DT),
        "lqr, continuous": lambda: LQR.design(MODEL, Q, R),
        "mpc": lambda: MPC.design(SAMPLED, Q, R, horizon=4, limits=limits, track=("place",)),
        "mpc, along": lambda: MPC.along(LTV, Q, R, horizon=4, limits=limits),
        "policy": lambda: Policy(**policy_arrays()),
    }
    return made[name]()


def policy_arrays() -> dict[str, Any]:
    """Of a small network on the scene."""
    return {
        "weights": (np.array([[0.5, -0.25], [1.0, 0.5], [0.0, 1.0]]), np.array([[0.5, 0.25, -1.0]])),
        "biases": (np.array([0.0, 0.5, -0.5]), np.array([0.25])),
        "mean": np.zeros(2),
        "std": np.array([1.0, 2.0]),
        "scene": SCENE.name,
        "reads": ("hub_angle", "hub_angle_rate"),
        "goal": np.array([0.25, 0.0]),
        "inputs": ("hub_torque",),
        "limits": np.array([40.0]),
        "dt": SCENE.dt,
    }


FOLDER = tempfile.TemporaryDirectory(prefix="pliant-calls-")  # removed as this process ends


def folder() -> Path:
    """Where calls write."""
    return Path(FOLDER.name)


def fresh(thing: Any, method: str) -> Callable[..., Any]:
    """A method of a copy: every call finds the same state."""

    def called(*values: Any, **named: Any) -> Any:
        return getattr(deepcopy(thing), method)(*values, **named)

    called.__module__, called.__qualname__ = type(thing).__module__, f"{type(thing).__qualname__}.{method}"
    return called
