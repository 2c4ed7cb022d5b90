"""Inputs that act late: the linear model with its delay, what the delay does to a loop, and a cure.

Model   z = [x; u_{k-n}; ..; u_{k-1}],  x+ = A x + B u_{k-n}: n whole periods of delay as states
Cure    the law reads the state that it will meet when its input acts, predicted by the plant's own steps over the
        inputs that are on their way. For a linear plant that is the optimal regulator of the model above: its gain is
        K [A^n, A^{n-1} B, .., B] with the gain K of the regulator without delay (Mirkin and Raskin 2003, "Every
        stabilizing dead-time controller has an observer-predictor-based structure", for continuous time).

Guarantee   for a linear plant, the model's, and the delay that was given, the loop is as stable as the law's without
            delay. For another delay or other parameters: none, and a shorter delay than was told can ruin it.
"""

from __future__ import annotations

import dataclasses
from typing import Any, Self, final

import numpy as np

from pliant.controllers.base.controller import Controller, moment, reading, saturation
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.riccati.late_inputs import delay_range
from pliant.plants.core.argument_gates import require_count, require_finite, require_instance, require_seconds
from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.signals import OwnsArrays, Signal, index
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.lti import LinearModel

from .lqr import LQR
from .state_ahead import StateAhead

MOST = 1000  # periods of delay


def delayed(model: LinearModel, periods: int) -> LinearModel:
    """The sampled model whose inputs act `periods` samples late; its added states are the inputs on their way.

    A name "tau1 2 late" means the value that was asked for two samples ago, the oldest first. ValueError for a
    continuous-time model.

    Example
    -------
    >>> from pliant.plants import LinearModel
    >>> motor = LinearModel.from_matrices([[0.0, 1.0], [0.0, -1.0]], [[0.0], [1.0]])
    >>> delayed(motor.discretize(0.1), 2).A.shape
    (4, 4)
    """
    require_instance("delayed.model", model, LinearModel)
    if model.dt is None:
        raise ValueError("delayed: model.dt = None must be a sampling time: give model.discretize(dt)")
    periods = require_count("delayed", "periods", periods, 0, MOST)
    if periods == 0:
        return model
    nx, nu = len(model.states), len(model.inputs)
    size = nx + periods * nu
    A, B = np.zeros((size, size)), np.zeros((size, nu))
    A[:nx, :nx], A[:nx, nx : nx + nu] = model.A, model.B
    A[nx : size - nu, nx + nu :] = np.eye(size - nx - nu)
    B[size - nu :] = np.eye(nu)
    C = np.hstack([model.C, model.D, np.zeros((len(model.outputs), size - nx - nu))])
    waiting = tuple(Signal(f"{s.name} {k} late", s.unit) for k in range(periods, 0, -1) for s in model.inputs)
    return dataclasses.replace(
        model,
        A=A,
        B=B,
        E=np.vstack([model.E, np.zeros((size - nx, model.E.shape[1]))]),
        C=C,
        D=np.zeros_like(model.D),
        states=model.states + waiting,
        x0=np.concatenate([model.x0, np.tile(model.u0, periods)]),
        f0=np.concatenate([model.f0, np.zeros(size - nx)]),
    )


def radius(model: LinearModel, K: Any, periods: int) -> float:
    """Largest |z| of u = -K x (nu, nx) on a sampled model whose inputs act `periods` samples late: stable below 1."""
    late = delayed(model, periods)
    K = require_finite("radius.K", K, (len(model.inputs), len(model.states)))
    padded = np.hstack([K, np.zeros((len(K), len(late.states) - len(model.states)))])
    return float(np.abs(np.linalg.eigvals(late.A - late.B @ padded)).max())


def delay_margin(model: LinearModel, K: Any, most: int = 100) -> int:
    """The most whole periods of input delay at which u = -K x stays stable, looked for up to `most`; -1 if none."""
    most = require_count("delay_margin", "most", most, 0, MOST)
    for periods in range(most + 1):
        if radius(model, K, periods) >= 1:
            return periods - 1
    return most


def predictive_gain(model: LinearModel, K: Any, periods: int) -> np.ndarray:
    """K [A^n, A^{n-1} B, .., B], (nu, nx + n nu): the gain K for a sampled model, on the states of `delayed`."""
    late = delayed(model, periods)
    nx = len(model.states)
    K = require_finite("predictive_gain.K", K, (len(model.inputs), nx))
    return K @ np.linalg.matrix_power(late.A, periods)[:nx]


@final
class Predictive(OwnsArrays):
    """A law of states for inputs that act `delay` periods late; it reads the plant's states."""

    def __init__(
        self,
        law: Controller,
        plant: Plant,
        delay: float,
        *,
        dt: float,
        substeps: int = 10,
        limits: Any = None,
        start: Any = None,
    ) -> None:
        """law: reads states or outputs of `plant`, the model that predicts, by RK4 in `substeps` steps a period.

        delay: periods, whole ones or with a part of one. start (nu,): what acts until the law's first input does; zero
        where None. limits: (lowest, highest) (nu,), what the actuator makes of an input.
        """
        delay, dt = delay_range("Predictive", delay)[0], require_seconds("Predictive.dt", dt)
        if not delay:
            raise ValueError(f"Predictive.delay = {delay!r} must be > 0 periods")
        substeps = require_count("Predictive", "substeps", substeps, 1, 100_000)
        require_instance("Predictive.law", law, Controller)
        require_instance("Predictive.plant", plant, Plant)
        if law.dt is not None and abs(law.dt - dt) > 1e-9 * dt:
            raise ValueError(f"Predictive: law.dt = {law.dt} must be dt = {dt} s, or None")
        self.law, self.plant, self.delay, self.dt = law, plant, delay, dt
        self.reads = tuple(s.name for s in plant.states)
        known = plant.states + plant.outputs
        self._picks = [index(known, name, "Predictive: law reads") for name in law.reads]
        self._outputs = max(self._picks, default=0) >= plant.nx
        self._low, self._high = saturation("Predictive", limits, [s.name for s in plant.inputs])
        held = np.zeros(plant.nu) if start is None else start
        start = require_finite("Predictive.start", held, (plant.nu,)).copy()
        self._ahead = StateAhead(plant, dt, delay, substeps, start)
        self.reset()

    @classmethod
    def for_scene(cls, scene: CostedScene, delay: float = 1, law: Controller | None = None) -> Self:
        """The scene's LQR, or another `law`, on the scene's plant, for inputs `delay` [periods] late; the input of the
        scene's start acts first."""
        require_scene("Predictive.for_scene", scene)
        law = LQR.for_scene(scene) if law is None else law
        high = np.array(scene.limits, dtype=float)
        start = np.clip(scene.initial[1], -high, high)
        return cls(law, scene.plant, delay, dt=scene.dt, substeps=scene.substeps, limits=(-high, high), start=start)

    def reset(self) -> None:
        """Forget the inputs on their way."""
        self.law.reset()
        self._ahead.reset()

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from the states y (nx,) at time t [s]; it acts `delay` periods later."""
        seen, t = self._ahead(reading("Predictive.y", y, len(self.reads))), moment("Predictive", t)
        if not np.isfinite(seen).all():
            raise IntegrationError(
                f"Predictive: the model diverges within {self.delay} periods from {y}; the state is out of its reach",
                t,
                y,
                self.dt,
            )
        if self._outputs:
            seen = np.append(seen, self.plant.measure(seen, self._ahead.last()))
        wanted = self.law.act(t + self.delay * self.dt, seen[self._picks])
        self._ahead.remember(np.minimum(np.maximum(wanted, self._low), self._high))
        return wanted
