"""Kalman filter on what a machine's sensors read: steady about a point, or time-varying along a nominal motion.

    predict   dx- = A dx + B du + c          u the input that was held since the last sample
    correct   dx = dx- + L (y - y0 - C dx- - D du)

The feedthrough D is that of the input held until the sample is taken, since a controller acts after it has read.
Samples may arrive `delay` periods late: the model then carries the outputs on their way as states. Inputs may act
`input_delay` periods late, whole ones and a part: the filter keeps those on their way, and u is what was asked for.

Process noise   what the model does not know, as white noise of density W [unit^2 s] on a disturbance, an input or the
                rate of a state, by name, integrated over the period; or held over each period (noise="held"): a
                disturbance of standard deviation s, new in each period dt, has the density s^2 dt. Noise on the inputs
                brings the margins of the state feedback back where the plant has no zeros that grow (Doyle and Stein
                1979); noise on the rate of a mode's coordinate tells the filter not to trust that mode's frequency.
Measurement     V = diag(deviation^2) of the sensors at dt; quantisation is taken as noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Self, final

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import reading
from pliant.controllers.base.inputs_on_their_way import OnTheirWay
from pliant.controllers.base.scene_protocol import require_scene
from pliant.controllers.riccati.checks import weight_matrix
from pliant.controllers.riccati.late_inputs import delay_range, past_of
from pliant.plants.core.argument_gates import require_all, require_instance, require_number
from pliant.plants.core.errors import PliantError
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.core.parameters import require_choice, require_count, require_finite, require_seconds
from pliant.plants.core.signals import OwnsArrays, names
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from . import kalman_gains, square_root
from .process_noise import scene_noise
from .sensors import Sensor, covariance, sensors_of

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import CostedScene

NOISES = ("white", "held")
MOST_DELAY = 16  # samples
SETTLED = 1e-9  # of the standard deviations: difference of the covariance from the steady one that is let pass
MOST_STEPS = 100_000  # until then


@final
@dataclass(eq=False)
class Kalman(OwnsArrays):
    """Made by `design`, `along` or `for_scene`. `step(y, u)` once a period; then `estimate` and `covariance`.

    Entry k of `steps` and `gains` serves sample k, the last one all that follow.
    """

    model: LinearModel | LTVModel
    sensors: tuple[Sensor, ...]
    dt: float  # [s]
    delay: int  # periods that a sample takes to arrive
    steps: tuple[kalman_gains.Sampled, ...] = field(repr=False)
    gains: tuple[kalman_gains.Filtered, ...] = field(repr=False)
    x0: np.ndarray = field(repr=False)  # (n, nx) nominal at the samples
    u0: np.ndarray = field(repr=False)  # (n, nu) nominal input of the step that ends there
    y0: np.ndarray = field(repr=False)  # (n, ns) nominal reading under that input
    start: np.ndarray | None = field(default=None, repr=False)  # (nx,) first estimate, the nominal where None
    input_delay: float = 0.0  # periods from asking for an input to its acting
    before: np.ndarray | None = field(default=None, repr=False)  # (nu,) what acts until the first one does

    def __post_init__(self) -> None:
        self.reset()

    @classmethod
    def design(
        cls,
        model: LinearModel,
        sensors: Sequence[Sensor],
        W: Mapping[str, float],
        *,
        dt: float,
        delay: int = 0,
        P0: Any = None,
        noise: str = "white",
        input_delay: float = 0.0,
    ) -> Self:
        """About the point of a continuous-time linear model; the gain is the steady one.

        input_delay [periods]: how late inputs act. W: densities [unit^2 s] by name of disturbance, input or state; of
        white noise, integrated over the period, or of noise that is "held" over each period. P0 (nx, nx): covariance of
        the first estimate; the gains then start from it and run until they are steady. UncontrollableError names modes
        that do not decay and that the sensors do not see or the noise does not drive.
        """
        require_instance("Kalman.design: model", model, LinearModel)
        if model.dt is not None:
            raise ValueError(f"Kalman.design: model.dt = {model.dt} must be None (a continuous-time model)")
        dt, delay = require_seconds("Kalman.dt", dt), require_count("Kalman", "delay", delay, 0, MOST_DELAY)
        late, _ = delay_range("Kalman", require_number("Kalman.input_delay", input_delay, "nonnegative"))
        sensors = _some(sensors)
        require_choice("Kalman", "noise", noise, NOISES)
        step, picked = _period(model, sensors, W, dt, noise, late), tuple(s.output for s in sensors)
        whole = kalman_gains.delayed(step, delay)
        limit = kalman_gains.steady(whole, model.state_names, dt)
        gains = (limit,) if P0 is None else _until(whole, limit, _first(step, delay, P0))
        y0 = np.concatenate([model.x0, model.y0])[_places(model, picked)]
        n = len(gains)
        nominal = {name: np.tile(value, (n, 1)) for name, value in (("x0", model.x0), ("u0", model.u0), ("y0", y0))}
        return cls(model, tuple(sensors), float(dt), delay, (whole,) * n, gains, **nominal, input_delay=late)

    @classmethod
    def along(
        cls,
        ltv: LTVModel,
        sensors: Sequence[Sensor],
        W: Mapping[str, float],
        *,
        P0: Any,
        delay: int = 0,
        noise: str = "white",
    ) -> Self:
        """Along a nominal with a node at every sample; P0 (nx, nx) is the covariance of the first estimate.

        W, noise: as in `design`.
        The nominal's input is taken as held from node to node. After its end the last step's model and gain stay.
        ValueError where the nodes are not evenly spaced.
        """
        require_instance("Kalman.along: ltv", ltv, LTVModel)
        delay, sensors = require_count("Kalman", "delay", delay, 0, MOST_DELAY), _some(sensors)
        require_choice("Kalman", "noise", noise, NOISES)
        h = np.diff(ltv.t)
        dt = float(h.mean())
        if np.abs(h - dt).max() > 1e-6 * dt:
            raise ValueError(f"Kalman.along: nodes {h.min():.6g} to {h.max():.6g} s apart must be evenly spaced")
        wide, density = kalman_gains.driven_by(ltv, W)
        held, picked = wide.discretize(), tuple(s.output for s in sensors)
        C, D, F = kalman_gains.rows(wide, picked)
        V, before = covariance(sensors, dt), np.maximum(np.arange(len(ltv.t)) - 1, 0)
        whole = riccati.noise_along(wide, density) if noise == "white" else None
        plain = []
        for k, i in enumerate(before):
            G, H, w = held.E[i], F[k], density / dt
            if whole is not None:
                G, H, w = kalman_gains.with_rest(G, H, w, semidefinite_root(whole[i] - G @ w @ G.T))
            plain.append(kalman_gains.Sampled(held.A[i], held.B[i], G, C[k], D[k], H, w, V, held.c[i]))
        steps = tuple(kalman_gains.delayed(step, delay) for step in plain)
        gains = [kalman_gains.corrected(steps[0], _first(plain[0], delay, P0))]
        for step in steps[1:]:
            gains.append(kalman_gains.after(step, gains[-1].root))
        y0 = np.concatenate([ltv.x, ltv.y], axis=1)[:, _places(ltv, picked)]
        y0 = y0 + np.einsum("kij,kj->ki", D, ltv.u[before] - ltv.u)
        return cls(ltv, tuple(sensors), dt, delay, steps, tuple(gains), x0=ltv.x, u0=ltv.u[before], y0=y0)

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        sensors: Sequence[Sensor] | None = None,
        W: Mapping[str, float] | None = None,
        delay: int = 0,
        input_delay: float = 0.0,
        recovery: float = 0.0,
    ) -> Self:
        """About the scene's goal, moving or not; the first estimate is the scene's start.

        sensors None: those that its plant carries and whose outputs are in the model. W None: `process_noise(scene)`,
        held over each period; else densities of white noise.
        W: densities by name, each in its own unit squared times seconds; delay, input_delay: periods. recovery: of
        LQG, standard deviation of noise besides on each input, in its limits.
        """
        require_scene("Kalman.for_scene", scene)
        plant = scene.plant
        model, known = plant.feedback_model(*scene.target), names(plant.states + plant.outputs)
        if sensors is None:
            modelled = names(model.states + model.outputs)
            sensors = [s for s in sensors_of(plant) if s.output in modelled]
        W, noise = scene_noise(scene, W, recovery)
        made = cls.design(model, sensors, W, dt=scene.dt, delay=delay, noise=noise, input_delay=input_delay)
        x, u = scene.initial
        made.before = np.clip(u, -np.array(scene.limits), scene.limits)
        values = dict(zip(known, np.concatenate([x, plant.measure(x, u)])))
        made.start = np.array([values[name] for name in model.state_names])
        made.reset()
        return made

    @property
    def reads(self) -> tuple[str, ...]:
        """The plant's outputs that make up y."""
        return tuple(s.output for s in self.sensors)

    @property
    def poles(self) -> np.ndarray:
        """Eigenvalues of the estimation error in the z plane, with the last step's gain. (nx,), dimensionless."""
        step, gain = self.steps[-1], self.gains[-1]
        return np.linalg.eigvals(step.A - gain.L @ step.C @ step.A).astype(complex)

    @property
    def estimate(self) -> np.ndarray:
        """Of the model's states (nx,), after the last sample."""
        i = min(max(self.k, 0), len(self.x0) - 1)
        return self.x0[i] + self._x[: self.x0.shape[1]]

    @property
    def covariance(self) -> np.ndarray:
        """Of the estimate's error (nx, nx), after the last sample."""
        nx = self.x0.shape[1]
        return self.gains[self._entry].P[:nx, :nx]

    @property
    def innovation_covariance(self) -> np.ndarray:
        """(ns, ns), of the last `innovation`."""
        return self.gains[self._entry].S

    @property
    def _entry(self) -> int:
        return min(max(self.k, 0), len(self.gains) - 1)

    def reset(self, x0: Any = None) -> None:
        """Start again from the estimate x0 (nx,), from `start` where None."""
        nx, x0 = self.x0.shape[1], self.start if x0 is None else x0
        dx = np.zeros(nx) if x0 is None else require_finite("Kalman.x0", x0, (nx,)) - self.x0[0]
        C = kalman_gains.rows(self.model, self.reads)[0]
        self._x = self.begun = kalman_gains.resting(C[0] if C.ndim == 3 else C, self.delay) @ dx  # before a sample
        first = np.zeros(self.u0.shape[1]) if self.before is None else self.before - self.u0[0]
        self._asked = OnTheirWay(np.tile(first, past_of(self.input_delay) + 1), len(first))  # less u0
        self.k = -1  # number of the last sample
        self.innovation = np.zeros(len(self.sensors))

    def step(self, y: np.ndarray, u: np.ndarray | None = None) -> np.ndarray:
        """The estimate (nx,) after the sample y (ns,). u (nu,): the input asked for since the last, nominal where None.

        With the first sample only the feedthrough of u counts; with an `input_delay`, of what acts `before`.
        """
        y, nu = reading("Kalman.y", y, len(self.sensors)), self.u0.shape[1]
        given = None if u is None else reading("Kalman.u", u, nu)
        self.k += 1
        i = self._entry
        step, x = self.steps[i], self._x
        du = np.zeros(nu) if given is None else given - self.u0[i]
        if self.input_delay:
            if given is not None:
                self._asked.push(du)
            du = self._asked.values[: step.B.shape[1]]
        if self.k:
            x = step.A @ x + step.B @ du + step.c
        base = self.y0[min(max(self.k - self.delay, 0), len(self.y0) - 1)] if self.delay else self.y0[i]
        self.innovation = y - base - step.C @ x - step.D @ du
        self._x = x + self.gains[i].L @ self.innovation
        return self.estimate


def _period(
    model: LinearModel, sensors: Sequence[Sensor], W: Mapping[str, float], dt: float, noise: str, late: float
) -> kalman_gains.Sampled:
    """One step of the filter's model about a point."""
    wide, density = kalman_gains.driven_by(model, W)
    held = wide.discretize(dt)
    C, D, F = kalman_gains.rows(wide, tuple(s.output for s in sensors))
    G, H, w = held.E, F, density / dt
    if noise == "white":
        G, rest, w = square_root.white(wide.A, wide.E, density, dt)
        G, H, w = kalman_gains.with_rest(G, F, w, rest)
    B, D = kalman_gains.split_period(model.A, model.B, D, dt, late) if late else (held.B, D)
    return kalman_gains.Sampled(held.A, B, G, C, D, H, w, covariance(sensors, dt), held.f0)


def _some(sensors: Sequence[Sensor]) -> tuple[Sensor, ...]:
    found = require_all("Kalman.sensors", sensors, Sensor)
    if not found:
        raise ValueError("Kalman.sensors = () must hold at least one Sensor")
    return found


def _places(model: LinearModel | LTVModel, wanted: Sequence[str]) -> list[int]:
    known = names(model.states + model.outputs)
    return [known.index(name) for name in wanted]


def _first(step: kalman_gains.Sampled, delay: int, P0: Any) -> np.ndarray:
    """Covariance before the first sample, with that of the outputs under way."""
    nx = len(step.A)
    P = weight_matrix("Kalman.P0", P0, nx, definite=False)
    T = kalman_gains.resting(step.C, delay)
    return T @ P @ T.T


def _until(
    step: kalman_gains.Sampled, limit: kalman_gains.Filtered, P: np.ndarray
) -> tuple[kalman_gains.Filtered, ...]:
    """Gains from the covariance P before the first sample on until they are those of `limit`, which comes last."""
    gains = [kalman_gains.corrected(step, P)]
    scale = np.sqrt(np.outer(np.diag(limit.P), np.diag(limit.P))) + np.finfo(float).tiny
    while np.abs((gains[-1].P - limit.P) / scale).max() > SETTLED:
        if len(gains) == MOST_STEPS:
            raise PliantError(f"the filter's gains are not steady after {MOST_STEPS} samples: take P0 = None")
        gains.append(kalman_gains.after(step, gains[-1].root))
    return (*gains, limit)
