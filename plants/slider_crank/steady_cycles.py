"""Steady cycles of a slider-crank at constant crank speed, and the growth of deviations from them.

At speed W the elastic coordinates e of a steady cycle are functions of the crank angle with period 2 pi:
W^2 e'' = f(phi1, e, W e'), solved at equidistant angles with trigonometric polynomials by Newton's method.
Deviations from the cycle obey a linear equation of period 2 pi/W; its Floquet multipliers are the eigenvalues of
the transition matrix over one period, and the cycle is unstable where one exceeds 1 in size.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_function, require_instance, require_number
from pliant.plants.core.errors import EquilibriumError, MassMatrixError
from pliant.plants.core.parameters import require_count, require_finite
from pliant.plants.core.signals import OwnsArrays, index
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.stability.floquet import floquet
from pliant.plants.validity.ranges import judged

from .plant import SliderCrank

FEWEST, MOST = 16, 512  # angles at which the equations of motion hold
NEWTON = 12
UNSTABLE = 1e-6  # excess of a multiplier's size over 1 that counts


def steady_cycle(
    plant: SliderCrank,
    *,
    speed: float | None = None,
    points: int = 361,
    w: Any = None,
    tolerance: float = 1e-9,
    guess: Trajectory | None = None,
) -> Trajectory:
    """The periodic motion at constant crank `speed` [rad/s] (None: the plant's crank_speed), from angle 0 to 2 pi.

    At `points` equidistant times, the last one a period after the first. A plant with a free crank gets the torque
    that keeps its speed constant. `guess` is a steady cycle at a nearby speed. `tolerance` bounds what the highest
    harmonics hold of the largest deflection. EquilibriumError where no cycle is found; warns (ValidityWarning) where it
    leaves a range of the plant's `validity`.
    """
    require_instance("steady_cycle.plant", plant, SliderCrank)
    points = require_count("steady_cycle", "points", points, 9, 100_000)
    tolerance = require_number("steady_cycle.tolerance", tolerance, "positive")
    if guess is not None:
        require_instance("steady_cycle.guess", guess, Trajectory)
    if speed is None:
        speed = plant.crank_speed
    if speed is None:
        raise ValueError("steady_cycle.speed = None must be > 0 [rad/s], or plant.crank_speed given")
    speed = require_number("steady_cycle.speed", speed, "positive", "rad/s")
    driven = plant if plant.crank_speed is not None else dataclasses.replace(plant, crank_speed=speed)
    force = np.zeros(plant.nw) if w is None else require_finite("steady_cycle.w", w, (plant.nw,))
    n = plant.coordinates_slice.stop - 1
    e = np.zeros((FEWEST, n))
    if guess is not None:
        e = _spectrum_to(guess.x[:-1, 1 : n + 1], FEWEST)
    while True:
        e = _solve(driven, e, speed, force)
        tail = _tail(e)
        if tail < tolerance:
            break
        if 2 * len(e) > MOST:
            raise EquilibriumError(
                f"the steady cycle of {plant.label} at {speed:g} rad/s needs more than {MOST} angles: its highest "
                f"harmonics still hold {tail:.1e} of the largest deflection; more damping or another speed may help",
                tail,
            )
        e = _spectrum_to(e, 2 * len(e))
    angle = np.linspace(0.0, 2 * np.pi, points)
    q, rate = (_evaluate(e, angle, d) * speed**d for d in range(2))
    x = np.hstack([angle[:, None], q, np.full((points, 1), speed), rate])
    y = driven.measure(x, np.zeros((points, 1)), w=force)
    u = np.zeros((points, 1))
    if plant.crank_speed is None:
        u = y[:, [index(driven.outputs, "crank_torque", "output")]]
    made = Trajectory(
        t=angle / speed,
        x=x,
        u=u,
        y=y,
        states=plant.states,
        inputs=plant.inputs,
        outputs=plant.outputs,
        dx=plant.dynamics(x, u, w=force),
        w=np.tile(force, (points, 1)),
        disturbances=plant.disturbances,
        stats={"angles": len(e), "tail": tail},
    )
    return judged(plant, made)


def _solve(plant: SliderCrank, e: np.ndarray, speed: float, w: np.ndarray) -> np.ndarray:
    """Newton's method from e (m, n) on the equations of motion at m equidistant angles."""
    m, n = e.shape
    if n == 0:
        return e
    D1 = _evaluate(np.eye(m), 2 * np.pi * np.arange(m) / m, 1)
    D2 = _evaluate(np.eye(m), 2 * np.pi * np.arange(m) / m, 2)
    angle, held = 2 * np.pi * np.arange(m)[:, None] / m, np.zeros((m, 1))
    rows = slice(n + 2, None)
    constant = speed**2 * np.kron(D2, np.eye(n))
    change = np.inf
    for _ in range(NEWTON):
        x = np.hstack([angle, e, np.full((m, 1), speed), speed * D1 @ e])
        try:
            miss = plant.dynamics(x, held, w=w)[:, rows] - speed**2 * D2 @ e
        except MassMatrixError:  # the search has left the deflections that the model can have
            break
        A = plant.jacobians(x, held, w=w)[0][:, rows]
        J = -constant.reshape(m, n, m, n)
        J[np.arange(m), :, np.arange(m)] += A[:, :, 1 : n + 1]
        J += speed * np.einsum("kij,kl->kilj", A[:, :, n + 2 :], D1)
        step = np.linalg.solve(J.reshape(m * n, m * n), -miss.ravel()).reshape(m, n)
        before, change = change, float(np.abs(step).max())
        e = e + step
        size = np.abs(e).max()
        if not np.isfinite(size) or size > 0.5 * plant.rod.length:
            break
        if change <= 1e-13 * size or (change >= before and change < 1e-8 * size):
            return e
    raise EquilibriumError(
        f"no steady cycle of {plant.label} at {speed:g} rad/s: Newton's last step was {change:.3g} m; "
        "give a cycle at a nearby speed as guess, or more damping",
        change,
    )


def _evaluate(e: np.ndarray, angle: np.ndarray, derivative: int) -> np.ndarray:
    """A derivative of the trigonometric polynomial through e (m, n) at equidistant angles, at `angle` (k,)."""
    m = len(e)
    c = np.fft.rfft(e, axis=0) / m
    c[1:] *= 2
    if m % 2 == 0:
        c[-1] *= 0.5 * (derivative % 2 == 0)
    order = np.arange(len(c))
    return np.real(np.exp(1j * np.outer(angle, order)) * (1j * order) ** derivative @ c)


def _spectrum_to(e: np.ndarray, m: int) -> np.ndarray:
    """The same periodic function at m equidistant angles."""
    return _evaluate(e, 2 * np.pi * np.arange(m) / m, 0)


def _tail(e: np.ndarray) -> float:
    """Largest harmonic of the upper quarter over the largest of all."""
    if e.shape[1] == 0:
        return 0.0
    c = np.abs(np.fft.rfft(e, axis=0)).max(axis=1)
    return float(c[len(c) * 3 // 4 :].max() / max(c.max(), np.finfo(float).tiny))


def floquet_multipliers(model: LTVModel, states: Sequence[str] | None = None) -> np.ndarray:
    """Floquet multipliers (n,) of a model of one period, largest first; see `stability.floquet`.

    `states` keeps only those (None: all): right where the others do not feel them.
    """
    t = require_instance("floquet_multipliers.model", model, LTVModel).t
    return floquet(model, float(t[-1] - t[0]), states=states).multipliers


@dataclass(frozen=True, eq=False)
class SpeedScan(OwnsArrays):
    """Floquet multipliers of the rod's deviations (ns, 2n) at crank speeds (ns,) [rad/s], largest first."""

    speeds: np.ndarray
    multipliers: np.ndarray
    tongues: tuple[tuple[float, float], ...]  # unstable intervals of speed [rad/s]

    @property
    def growth(self) -> np.ndarray:
        """Growth rate (ns,) [1/s] of the worst deviation; below zero where the cycle is stable."""
        return _growth(self.multipliers[:, 0], self.speeds)


def _growth(multiplier: Any, speed: Any) -> Any:
    return np.log(np.abs(multiplier)) * speed / (2 * np.pi)


def speed_scan(
    plant: SliderCrank,
    speeds: Any,
    *,
    points: int = 181,
    edge: float = 1e-4,
    progress: Callable[[float], None] | None = None,
) -> SpeedScan:
    """Floquet multipliers of the rod over crank speeds (ns,) [rad/s], ascending, the crank's motion prescribed.

    Edges of unstable intervals are found by bisection to `edge` of the speed; intervals that lie between two
    speeds are missed. `points` times a cycle; the multipliers' error falls as points^-4.
    """
    require_instance("speed_scan.plant", plant, SliderCrank)
    speeds = require_finite("speed_scan.speeds", speeds, (-1,))
    if len(speeds) < 1 or speeds[0] <= 0 or (np.diff(speeds) <= 0).any():
        raise ValueError(f"speed_scan.speeds = {speeds} must be > 0 and ascending [rad/s]")
    edge = require_number("speed_scan.edge", edge, "positive", most=1.0)
    if progress is not None:
        require_function("speed_scan.progress", progress)
    driven = plant
    if plant.crank_speed is None:
        driven = dataclasses.replace(plant, crank_speed=float(speeds[0]))
    if driven.nx == 2:
        raise ValueError(f"speed_scan.plant is {driven.label}: its rod has no deviations")
    n = driven.coordinates_slice.stop
    kept = [s.name for i, s in enumerate(driven.states) if i not in (0, n)]

    def at(speed: float, guess: Trajectory | None) -> tuple[np.ndarray, Trajectory]:
        cycle = steady_cycle(driven, speed=speed, points=points, guess=guess)
        return floquet_multipliers(driven.linearize_along(cycle), kept), cycle

    def unstable(multipliers: np.ndarray) -> bool:
        return bool(np.abs(multipliers[0]) > 1 + UNSTABLE)

    found: list[np.ndarray] = []
    edges: list[float] = []
    cycle = None
    for k, speed in enumerate(speeds):
        multipliers, cycle = at(float(speed), cycle)
        if unstable(multipliers) != (unstable(found[-1]) if found else False):
            low, high = float(speeds[max(k - 1, 0)]), float(speed)
            while high - low > edge * high:
                middle = (low + high) / 2
                if unstable(at(middle, cycle)[0]) == unstable(multipliers):
                    high = middle
                else:
                    low = middle
            edges.append((low + high) / 2)
        found.append(multipliers)
        if progress is not None:
            progress(float(speed))
    if len(edges) % 2:
        edges.append(float(speeds[-1]))
    return SpeedScan(speeds, np.array(found), tuple(zip(edges[::2], edges[1::2])))
