"""Scenes: a plant, a manoeuvre, limits, a cost and a tolerance, by name.

A scene is what controllers are scored on, what environments wrap and what the speed-accuracy chart runs. It names
signals, never indices, so that every fidelity of its plant can play it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pliant.plants import Payload, Plant, SingleLinkArm, Trajectory, TwoLinkArm
from pliant.plants.parameters import quantity, require_choice, unit_of, validate
from pliant.plants.signals import index

Pairs = tuple[tuple[str, float], ...]


def minimum_jerk(s: np.ndarray | float) -> tuple[Any, Any, Any]:
    """The quintic from 0 to 1 over s in [0, 1] with zero end rates and accelerations, and its two derivatives."""
    s = np.clip(s, 0.0, 1.0)
    return (
        10 * s**3 - 15 * s**4 + 6 * s**5,
        30 * s**2 - 60 * s**3 + 30 * s**4,
        60 * s - 180 * s**2 + 120 * s**3,
    )


@dataclass(frozen=True, kw_only=True)
class Scene:
    """Drive `plant` from rest at `start` to rest at `goal`, at least cost, within limits.

    Cost [-]  sum over control periods of dt (sum_i weights_i (z_i - z_i,goal)^2 + sum_j effort_j (u_j - u_j,goal)^2),
              z any states or outputs by name; reward is minus that.
    """

    name: str
    about: str
    plant: Plant
    start: Pairs  # coordinates at rest [rad, m]
    goal: Pairs
    duration: float = quantity("s", "positive")
    dt: float = quantity("s", "positive", 0.02)  # control period
    substeps: int = 10  # RK4 steps a control period
    move_time: float = quantity("s", "positive", 1.0)  # of the nominal motion from start to goal
    limits: tuple[float, ...] = quantity("N m", "positive")  # largest |u| of each input
    bounds: Pairs = ()  # largest |output| [its unit]; beyond it the episode ends
    weights: Pairs = ()
    effort: Pairs = ()
    observe: tuple[str, ...] = ()
    randomise: tuple[tuple[str, float, float], ...] = ()  # parameter, smallest and largest factor
    start_spread: float = quantity("rad", "nonnegative", 0.0)  # uniform, on every coordinate of `start`
    compare: tuple[str, ...] = ("tip_x", "tip_y")  # outputs whose error the chart measures
    tolerance: float = quantity(
        "m", "positive", 1e-3
    )  # largest error of those outputs that the scene can bear
    tags: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        validate(self)
        plant, owner = self.plant, f"scene {self.name!r}"
        if len(self.limits) != plant.nu:
            raise ValueError(f"{owner}: limits = {self.limits} must hold {plant.nu} numbers > 0 [N m]")
        if not (isinstance(self.substeps, int) and self.substeps >= 1):
            raise ValueError(f"{owner}: substeps = {self.substeps!r} must be an integer >= 1")
        known = plant.states + plant.outputs
        for group in ("start", "goal", "bounds", "weights"):
            for name, value in getattr(self, group):
                index(known, name, f"{owner}: {group}")
                if not np.isfinite(value) or (group in ("bounds", "weights") and value < 0):
                    raise ValueError(
                        f"{owner}: {group} {name} = {value} must be finite and, as a weight, >= 0"
                    )
        for name in (*self.observe, *self.compare):
            index(known, name, f"{owner}: signal")
        for name, value in self.effort:
            index(plant.inputs, name, f"{owner}: effort")
            if not value > 0:
                raise ValueError(f"{owner}: effort {name} = {value} must be > 0")
        for path, low, high in self.randomise:
            unit_of(plant, path)
            if not 0 < low <= high:
                raise ValueError(f"{owner}: randomise {path} from {low} to {high} must be 0 < low <= high")

    @property
    def steps(self) -> int:
        """Control periods in an episode."""
        return round(self.duration / self.dt)

    @property
    def times(self) -> np.ndarray:
        """Control times (steps + 1,) [s]."""
        return self.dt * np.arange(self.steps + 1)

    def with_plant(self, plant: Plant) -> Scene:
        """The same scene played by another fidelity."""
        return dataclasses.replace(self, plant=plant)

    @cached_property
    def initial(self) -> tuple[np.ndarray, np.ndarray]:
        """(x, u) at rest at the start, deflections in equilibrium."""
        return self.plant.equilibrium(dict(self.start))

    @cached_property
    def target(self) -> tuple[np.ndarray, np.ndarray]:
        """(x, u) at rest at the goal, deflections in equilibrium."""
        return self.plant.equilibrium(dict(self.goal))

    def signal_values(self, x: np.ndarray, y: np.ndarray, names: tuple[str, ...]) -> np.ndarray:
        """The named states or outputs from x (..., nx) and y (..., ny)."""
        known = self.plant.states + self.plant.outputs
        both = np.concatenate([x, y], axis=-1)
        return both[..., [index(known, name, "signal") for name in names]]

    @cached_property
    def _goal_signals(self) -> np.ndarray:
        x, u = self.target
        return self.signal_values(x, self.plant.measure(x, u), tuple(n for n, _ in self.weights))

    def stage_cost(self, x: np.ndarray, u: np.ndarray, y: np.ndarray) -> Any:
        """Cost rate [1/s] at x (..., nx), u (..., nu), y (..., ny)."""
        error = self.signal_values(x, y, tuple(n for n, _ in self.weights)) - self._goal_signals
        chosen = [index(self.plant.inputs, n, "input") for n, _ in self.effort]
        excess = (np.asarray(u) - self.target[1])[..., chosen]
        return error**2 @ np.array([v for _, v in self.weights]) + excess**2 @ np.array(
            [v for _, v in self.effort]
        )

    def cost(self, motion: Trajectory) -> float:
        """The scene's cost of a motion sampled at the control times."""
        if len(motion.t) != self.steps + 1 or not np.allclose(motion.t, self.times, atol=1e-9):
            raise ValueError(
                f"motion has {len(motion.t)} times, must have the scene's {self.steps + 1} every {self.dt} s"
            )
        return float(self.dt * self.stage_cost(motion.x, motion.u, motion.y)[:-1].sum())

    def quadratic(self) -> tuple[np.ndarray, np.ndarray]:
        """(Q (nx, nx), R (nu, nu)): the cost to second order about the goal, for linear-quadratic design."""
        C = self.plant.linearize(*self.target).C
        rows = np.vstack([np.eye(self.plant.nx), C])
        known = self.plant.states + self.plant.outputs
        Q = np.zeros((self.plant.nx, self.plant.nx))
        for name, weight in self.weights:
            row = rows[index(known, name, "signal")]
            Q += weight * np.outer(row, row)
        R = np.zeros((self.plant.nu, self.plant.nu))
        for name, weight in self.effort:
            i = index(self.plant.inputs, name, "input")
            R[i, i] = weight
        return Q, R

    @cached_property
    def nominal_input(self) -> Callable[[float], np.ndarray]:
        """Torques u(t) that take the rigid plant along a minimum-jerk motion from start to goal, then hold it.

        The same torques drive every fidelity in the speed-accuracy chart.
        """
        rigid = self.plant.ladder()[0]
        n = rigid.nx // 2
        begin, end = (
            np.array([dict(g).get(s.name, 0.0) for s in rigid.states[:n]]) for g in (self.start, self.goal)
        )

        def torque(t: float) -> np.ndarray:
            s, ds, dds = minimum_jerk(t / self.move_time)
            x = np.concatenate([begin + (end - begin) * s, (end - begin) * ds / self.move_time])
            wanted = (end - begin) * dds / self.move_time**2
            free = rigid.dynamics(x)[n:]
            B = rigid.jacobians(x)[1][n:]
            return np.linalg.solve(B, wanted - free)

        return torque

    def open_loop(self, **options: Any) -> Trajectory:
        """The plant's motion under `nominal_input`, at the control times; options as in Plant.simulate."""
        return self.plant.simulate(self.initial[0], self.nominal_input, self.times, **options)


def _single_link_slew() -> Scene:
    arm = SingleLinkArm.textbook()
    arm = dataclasses.replace(
        arm,
        link=dataclasses.replace(arm.link, damping=2e-4),
        hub_friction=0.05,
        payload=Payload(mass=1.0, inertia=0.001),
    )
    return Scene(
        name="single-link-slew",
        about="turn a steel link with a 1 kg payload by one radian, rest to rest",
        plant=arm,
        start=(("hub_angle", 0.0),),
        goal=(("hub_angle", 1.0),),
        duration=3.0,
        limits=(40.0,),
        bounds=(("tip_deflection", 0.3), ("hub_angle_rate", 12.0)),
        weights=(
            ("hub_angle", 10.0),
            ("hub_angle_rate", 0.1),
            ("tip_deflection", 100.0),
            ("tip_deflection_rate", 0.1),
        ),
        effort=(("hub_torque", 2e-3),),
        observe=("hub_angle", "hub_angle_rate", "tip_deflection", "tip_deflection_rate"),
        randomise=(("payload.mass", 0.7, 1.3), ("link.E", 0.9, 1.1)),
        start_spread=0.1,
    )


def _two_link_reach() -> Scene:
    arm = TwoLinkArm.textbook()
    damped = dataclasses.replace(arm.link1, damping=2e-4)
    arm = dataclasses.replace(
        arm, link1=damped, link2=damped, hub_inertia=(0.1, 0.02), joint_friction=(0.2, 0.1)
    )
    return Scene(
        name="two-link-reach",
        about="lift a 0.5 kg payload point to point with two elastic links under gravity",
        plant=arm,
        start=(("theta1", -np.pi / 2), ("theta2", 0.0)),
        goal=(("theta1", -0.9), ("theta2", 0.6)),
        duration=3.0,
        limits=(60.0, 20.0),
        bounds=(
            ("tip1_deflection", 0.4),
            ("tip2_deflection", 0.4),
            ("theta1_rate", 15.0),
            ("theta2_rate", 25.0),
        ),
        weights=(
            ("theta1", 10.0),
            ("theta2", 10.0),
            ("theta1_rate", 0.1),
            ("theta2_rate", 0.1),
            ("tip1_deflection_rate", 0.1),
            ("tip2_deflection_rate", 0.1),
        ),
        effort=(("tau1", 2e-3), ("tau2", 2e-3)),
        observe=(
            "theta1",
            "theta2",
            "theta1_rate",
            "theta2_rate",
            "tip1_deflection",
            "tip2_deflection",
            "tip1_deflection_rate",
            "tip2_deflection_rate",
        ),
        randomise=(("payload.mass", 0.7, 1.3),),
        start_spread=0.1,
    )


SCENES: Mapping[str, Callable[[], Scene]] = {
    "single-link-slew": _single_link_slew,
    "two-link-reach": _two_link_reach,
}


def names() -> tuple[str, ...]:
    """The names of all scenes."""
    return tuple(SCENES)


def get(name: str, **overrides: Any) -> Scene:
    """A scene by name; keywords override its fields: get("two-link-reach", duration=5.0, limits=(80.0, 30.0))."""
    require_choice("scenes", "name", name, names())
    scene = SCENES[name]()
    fields = {f.name for f in dataclasses.fields(Scene)}
    for key in overrides:
        require_choice("scenes.get", "keyword", key, sorted(fields))
    return dataclasses.replace(scene, **overrides)
