"""Kalman filter of a machine that runs in a cycle: steady gains that go round with it, on the plant's own steps.

    predict   x- = F(x, u)          the plant's RK4 over a period, u the input that was held in it
    correct   x = x- + L(phi-) (y - h(x-, u))

L is found along the cycle at its nodes and linear in between by the angle of the estimate, so that no clock is needed:
an error along the cycle, which no machine corrects, is one of the states, and the readings have to see it. Prediction
and reading are the plant's and hold beside the cycle too. An angle that is read may start again at each turn.

Noise     held over each period, of variance W/dt for a density W [unit^2 s] of an input or a disturbance, by name; it
          is still there when the reading is taken. Readings: diag(deviation^2) of the sensors at dt.
Guarantee the covariance is that of the linear model's error along the cycle. None beyond.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import reading
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.estimation.process_noise import process_noise
from pliant.controllers.estimation.sensors import Sensor, covariance, sensors_of
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.controllers.riccati.late_inputs import delay_range, periods_of
from pliant.plants.core.argument_gates import require_all, require_by_name, require_finite, require_number
from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.signals import OwnsArrays, names, rows_by_name
from pliant.plants.dynamics.plant import Plant

from .by_angle import ByAngle
from .cycle import Cycle

Array = np.ndarray
SHIFT = 1e-3  # of a disturbance's deviation: difference by which its slope is taken


@final
@dataclass(eq=False)
class PeriodicKalman(OwnsArrays):
    """Made by `for_scene`. `step(y, u)` once a period; then `estimate` and `covariance`.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> filter = PeriodicKalman.for_scene(scenes.get("slider-crank-run"))
    >>> filter.step(np.zeros(2)).shape
    (6,)
    """

    plant: Plant
    sensors: tuple[Sensor, ...]
    dt: float  # [s]
    substeps: int
    angle: int  # which state goes round
    nodes: ByAngle = field(repr=False)
    L: Array = field(repr=False)  # (N + 2, nx, ns) of the innovation, by angle
    P: Array = field(repr=False)  # (N + 2, nx, nx) covariance after a reading, by angle
    multipliers: Array  # sizes of the error's over one turn, largest first
    start: Array  # (nx,) first estimate
    before: Array  # (nu,) what acts until the first input does
    input_delay: float = 0.0  # [periods] from asking for an input to its acting

    def __post_init__(self) -> None:
        known = names(self.plant.states + self.plant.outputs)
        self._picks = [known.index(name) for name in self.reads]
        turn = self.plant.states[self.angle].name
        self._turns = np.array([name == turn for name in self.reads])
        self._compile()
        self.reset()

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        sensors: Sequence[Sensor] | None = None,
        W: Mapping[str, float] | None = None,
        input_delay: float = 0.0,
    ) -> PeriodicKalman:
        """About the cycle of a scene's goal; the first estimate is the scene's start.

        sensors None: those that its plant carries. W: densities [unit^2 s] by name of input or disturbance, None:
        `process_noise(scene)`. input_delay [periods]. EquilibriumError where the goal is no cycle, UncontrollableError
        where an error stays that the sensors do not see.
        """
        require_scene("PeriodicKalman.for_scene", scene)
        late, _ = delay_range(
            "PeriodicKalman", require_number("PeriodicKalman.input_delay", input_delay, "nonnegative")
        )
        return cls.about(Cycle.find(scene), sensors, W, late)

    @classmethod
    def about(
        cls, cycle: Cycle, sensors: Sequence[Sensor] | None, W: Mapping[str, float] | None, late: float
    ) -> PeriodicKalman:
        """The same about a cycle that is found, late [periods] the inputs' delay. ValueError where sensors or W name
        nothing."""
        scene, plant = cycle.scene, cycle.scene.plant
        known = sensors_of(plant) if sensors is None else require_all("PeriodicKalman.sensors", sensors, Sensor)
        if not known:
            raise ValueError("PeriodicKalman.sensors = () must hold at least one Sensor")
        given = process_noise(scene) if W is None else W
        inputs, pushes = names(plant.inputs), names(plant.disturbances)
        density = require_by_name("process noise W", given, inputs + pushes, "input or disturbance", "positive")
        if not density:
            raise ValueError("process noise W must name at least one input or disturbance")
        deviation = np.sqrt(np.array(list(density.values())) / cycle.dt)
        A, C, noise, V = _periods(cycle, known, list(density), deviation, late)
        found = riccati.dpkalman(A, C, noise, V)
        nx, nodes = plant.nx, ByAngle(cycle.x[:-1, cycle.angle])
        L, P = (nodes.around(M[nodes.order]) for M in (found.L[:, :nx], found.after[:, :nx, :nx]))
        sizes = np.abs(found.multipliers[:nx]) ** (1 / cycle.turns)
        high = np.array(scene.limits, dtype=float)
        x, u = scene.initial
        about = sizes, np.array(x, dtype=float), np.clip(u, -high, high), late
        return cls(plant, tuple(known), scene.dt, scene.substeps, cycle.angle, nodes, L, P, *about)

    @property
    def reads(self) -> tuple[str, ...]:
        """The plant's outputs that make up y."""
        return tuple(s.output for s in self.sensors)

    @property
    def estimate(self) -> Array:
        """Of the plant's states (nx,), after the last reading."""
        return self._x

    @property
    def covariance(self) -> Array:
        """Of the estimate's error (nx, nx), after a reading at the estimate's angle."""
        k, share = self.nodes.at(self._x[self.angle])
        return np.asarray((1 - share) * self.P[k] + share * self.P[k + 1])

    def reset(self, x0: Any = None) -> None:
        """Start again from the estimate x0 (nx,), from `start` where None."""
        first = self.start if x0 is None else require_finite("PeriodicKalman.x0", x0, self.start.shape)
        self._x, self._begun = first.copy(), False
        count = periods_of(self.input_delay)[0] + 2
        self._asked = deque([self.before] * count, maxlen=count)
        self.innovation = np.zeros(len(self.sensors))

    def step(self, y: Array, u: Array | None = None) -> Array:
        """The estimate (nx,) after the reading y (ns,). u (nu,): the input asked for since the last, that of the
        scene's start where None; with the first reading it does not matter. IntegrationError where the plant diverges.
        """
        y, x = reading("PeriodicKalman.y", y, len(self.sensors)), self._x
        if self._begun:
            self._asked.append(self.before if u is None else reading("PeriodicKalman.u", u, self.plant.nu))
            for stepper, age in self._steps:
                x = stepper(x[None], self._asked[-1 - age])[0]
            if not np.isfinite(x).all():
                raise IntegrationError(f"PeriodicKalman: the model diverges from {self._x}", 0.0, self._x, self.dt)
        self._begun = True
        acting = self._asked[-1 - self._steps[-1][1]]
        wanted = np.concatenate([x, self.plant.measure(x, acting)])[self._picks]
        off = y - wanted
        off[self._turns] -= 2 * np.pi * np.round(off[self._turns] / (2 * np.pi))
        k, share = self.nodes.at(x[self.angle])
        self.innovation = off
        self._x = np.array(x + (1 - share) * (self.L[k] @ off) + share * (self.L[k + 1] @ off))
        return self._x

    def _compile(self) -> None:
        m, part = periods_of(self.input_delay)
        shares = ((part, m + 1), (1.0 - part, m))
        self._steps = [
            (self.plant.stepper(s * self.dt, substeps=max(1, int(np.ceil(s * self.substeps - 1e-9)))), age)
            for s, age in shares
            if s
        ]

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in super().__getstate__().items() if name != "_steps"}  # compiled code

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._compile()


def _periods(
    cycle: Cycle, sensors: Sequence[Sensor], driven: Sequence[str], deviation: Array, late: float
) -> tuple[Array, Array, Array, Array]:
    """A, C, the noise's covariance and the readings' by node, of [x; the noise that is held when the reading is
    taken]."""
    plant, N = cycle.scene.plant, cycle.steps
    nx, nw = plant.nx, len(driven)
    A, B_first, B_after = cycle.late_slopes(late)
    G, H = np.empty((N, nx, nw)), np.empty((N, len(sensors), nw))
    one = plant.linearize(cycle.x[0], cycle.u)
    rows = [rows_by_name(plant.linearize(x, cycle.u), [s.output for s in sensors]) for x in cycle.x[:-1]]
    C, D, F = (np.array([r[i] for r in rows]) for i in (1, 2, 3))
    for j, name in enumerate(driven):
        if name in one.input_names:
            i = one.input_names.index(name)
            G[:, :, j], H[:, :, j] = (B_first + B_after)[:, :, i], D[:, :, i]
        else:
            i = names(plant.disturbances).index(name)
            G[:, :, j], H[:, :, j] = _pushed(cycle, i, SHIFT * deviation[j]), F[:, :, i]
    wide = np.zeros((N, nx + nw, nx + nw))
    wide[:, :nx, :nx] = A
    drive = np.concatenate([G, np.tile(np.eye(nw), (N, 1, 1))], axis=1) * deviation
    return wide, np.concatenate([C, H], axis=2), drive @ drive.transpose(0, 2, 1), covariance(sensors, cycle.dt)


def _pushed(cycle: Cycle, i: int, by: float) -> Array:
    """(N, nx) d(end)/dw_i of a disturbance that is held over a period, by a central difference."""
    plant, scene, ends = cycle.scene.plant, cycle.scene, []
    for w in (by, -by):
        value = np.zeros(plant.nw)
        value[i] = w
        t, u = cycle.dt * np.arange(cycle.steps), np.tile(cycle.u, (cycle.steps, 1))
        held = HeldSteps(plant, cycle.dt, scene.substeps, t, value, plant.nominal_parameters)
        ends.append(held.ends(cycle.x[:-1], u))
    return np.asarray((ends[0] - ends[1]) / (2 * by))
