"""Valid calls of linear models and of verdicts on them."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Flag, Names, Object
from calls_of_shapes import beam_calls, modal_calls
from further_kinds import ByName
from kinds_of_numbers import POSITIVE, Array, Count, Counts, Number

from pliant.plants import LinearModel, LTVModel, stability
from pliant.plants.exponents import slow_dichotomy, spectrum
from pliant.plants.periodic import campbell, multi_blade, multi_blade_model, output_mode

T = np.linspace(0.0, 2.0, 9)
A = np.array([[0.0, 1.0], [-4.0, -0.5]])
MODEL = LinearModel.from_matrices(A, [[0.0], [1.0]])


def along() -> LTVModel:
    """A spring that stiffens and slackens, of period 2 s."""
    n, e = len(T), np.zeros
    swing = np.array([A - np.array([[0.0, 0.0], [np.sin(np.pi * t), 0.0]]) for t in T])
    empty = e((n, 2, 0)), np.tile(np.eye(2), (n, 1, 1)), e((n, 2, 1)), e((n, 2, 0))
    return LTVModel(
        *(T, swing, np.ones((n, 2, 1)), *empty),
        c=e((n, 2)),
        x=e((n, 2)),
        u=e((n, 1)),
        y=e((n, 2)),
        states=MODEL.states,
        inputs=MODEL.inputs,
        disturbances=(),
        outputs=MODEL.states,
    )


LTV = along()


def model_calls() -> list[Call]:
    """Of models that are no plants."""
    return [*linear_calls(), *stability_calls(), *beam_calls(), *modal_calls()]


def linear_calls() -> list[Call]:
    """LTI and LTV."""
    matrices = {
        "A": Array(A),
        "B": Array([[0.0], [1.0]]),
        "C": Array([[1.0, 0.0]], none=True),
        "D": Array([[0.0]], none=True),
        "states": Names(("a", "b"), none=True, free=True),
        "inputs": Names(("f",), none=True, free=True),
    }
    fields = {n: Array(getattr(LTV, n)) for n in ("t", "A", "B", "C", "D", "c", "x", "u", "y")}
    signals = {n: getattr(LTV, n) for n in ("E", "F", "states", "inputs", "disturbances", "outputs")}
    push = Array([1.0], none=True, calls=True)
    return [
        Call("LinearModel.from_matrices", LinearModel.from_matrices, matrices, {"outputs": ("y",)}),
        Call(
            "LinearModel.from_matrices.dt",
            LinearModel.from_matrices,
            {"dt": Number(0.5, none=True, **POSITIVE)},
            {"A": A, "B": [[0.0], [1.0]]},
            compare=False,
        ),
        Call("LinearModel.discretize", MODEL.discretize, {"dt": Number(0.5, **POSITIVE)}),
        Call("LinearModel.reduce", MODEL.reduce, {"order": Count(1), "method": Choice("balanced")}),
        Call(
            "LinearModel.simulate", MODEL.simulate, {"dx0": Array([1.0, 0.0]), "du": push, "t": Array(T, wrong=False)}
        ),
        Call("LinearModel.to_control", MODEL.to_control, {"disturbances": Flag(False)}, compare=False),
        Call("LinearModel.from_control", LinearModel.from_control, {"system": Object(MODEL.to_control())}),
        Call("LTVModel", LTVModel, fields, signals),
        Call("LTVModel.at", LTV.at, {"k": Count(1, low=None)}),
        Call("LTVModel.simulate", LTV.simulate, {"dx0": Array([1.0, 0.0]), "du": push}),
    ]


def stability_calls() -> list[Call]:
    """Verdicts and the methods behind them."""
    model, states = {"model": Object(LTV)}, {"states": Names(("x1", "x2"), none=True)}
    period = {"period": Number(2.0, none=True, **POSITIVE)}
    time = {"window": Number(0.5, none=True, **POSITIVE)}
    return [
        Call("stability.assess", stability.assess, model | period | states | time | {"thorough": Flag(True)}),
        Call("stability.assess.periodic", stability.assess, model | {"periodic": Flag(True, none=True)}),
        Call("stability.assess.rigorous", lambda **k: stability.assess(LTV, **k).verdict, {"rigorous": Flag(False)}),
        Call(
            "stability.floquet",
            stability.floquet,
            model | period | {"tolerance": Number(2.0**-33, **POSITIVE), "undamped": Flag(False, none=True)},
        ),
        Call("stability.frozen_time", stability.frozen_time, model, compare=False),
        Call("stability.growth", stability.growth, model | time, compare=False),
        Call(
            "stability.lyapunov",
            stability.lyapunov,
            model | {"alpha": Number(0.125, none=True), "most": Count(1024)} | period,
            compare=False,
        ),
        Call(
            "stability.finite_horizon",
            lambda **k: stability.finite_horizon(**k).l2.lower,
            model
            | {"outputs": Names(("x1", "x2"), none=True), "disturbances": Names(("u1",))}
            | {"scale": ByName({"x1": 0.5}, low=0.0, open=True, none=True)}
            | {"limits": ByName({"u1": 0.5}, low=0.0, open=True, none=True)},
            {"disturbances": ("u1",)},
            compare=False,
        ),
        Call(
            "stability.assess.numbers",
            lambda **k: stability.assess(LTV, thorough=False, **k).verdict,
            {"outputs": Names(("x1", "x2"), none=True), "disturbances": Names(("u1",), none=True)}
            | {"scale": ByName({"x1": 0.5}, low=0.0, open=True, none=True)}
            | {"limits": ByName({"u1": 0.5}, low=0.0, open=True, none=True)},
            {"outputs": ("x1",), "disturbances": ("u1",)},
            compare=False,
        ),
        Call(
            "stability.pointing_budget",
            stability.pointing_budget,
            model
            | {"outputs": Names(("x1", "x2")), "window": Number(0.25, **POSITIVE)}
            | {"noise": ByName({"u1": 0.5}, low=0.0, none=True), "start": ByName({"x1": 0.5}, low=0.0, none=True)}
            | {"limits": ByName({"u1": 0.5}, low=0.0, none=True)}
            | {"confidence": Number(0.5, **POSITIVE)},
            {"noise": {"u1": 0.5}},
            compare=False,
        ),
        Call(
            "FiniteHorizon.deviation",
            stability.finite_horizon(LTV, disturbances=["u1"]).deviation,
            {"intensity": ByName({"u1": 0.5}, low=0.0), "start": ByName({"x1": 0.5}, low=0.0, none=True)},
            compare=False,
        ),
        Call("stability.slow_variation", stability.slow_variation, model, compare=False),
        Call(
            "exponents.spectrum",
            spectrum,
            model
            | {"window": Number(0.5, none=True, **POSITIVE), "settle": Number(0.5, none=True, **POSITIVE)}
            | {"beyond": Choice("persists")}
            | states,
            compare=False,
        ),
        Call(
            "exponents.spectrum.tends",
            spectrum,
            model | {"limit": Array(A, none=True), "within": Number(0.5, low=0.0)},
            {"beyond": "tends"},
            compare=False,
        ),
        Call(
            "periodic.campbell",
            campbell,
            {
                "speeds": Array((0.0, 1.0)),
                "orders": Counts((1, 2), wrong=False),
                "least": Number(0.5, low=0.0, high=1.0),
            },
            {"plant": lambda speed: LinearModel.from_matrices(A * (1.0 + speed), [[0.0], [1.0]])},
            compare=False,
        ),
        Call(
            "periodic.output_mode", output_mode, {"k": Count(1, low=0)}, {"model": LTV, "cycle": stability.floquet(LTV)}
        ),
        Call("periodic.multi_blade", multi_blade, {"blades": Count(3), "angle": Number(0.5)}),
        Call(
            "periodic.multi_blade_model",
            multi_blade_model,
            {"M": Array(np.eye(3)), "D": Array(np.eye(3)), "K": Array(np.eye(3))}
            | {"blades": Count(3), "angle": Number(0.5), "speed": Number(0.5)},
        ),
        Call("exponents.spectrum.periodic", spectrum, model | period, {"beyond": "periodic"}, compare=False),
        Call(
            "exponents.slow_dichotomy",
            slow_dichotomy,
            model | {"shift": Number(0.5), "samples": Count(16, none=True)} | states,
            compare=False,
        ),
    ]
