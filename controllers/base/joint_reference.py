"""The motion that a joint is to make: from rest to rest, shaped where asked, or a constant rate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, final

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_instance, require_seconds, shown
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, index, read_only
from pliant.plants.dynamics.plant import Plant
from pliant.plants.integration.minimum_jerk import profile_of

from .controller import moment

if TYPE_CHECKING:
    from .scene_protocol import CostedScene


class Impulses(Protocol):
    """What a motion is shaped by: pliant.controllers.Shaper is one."""

    @property
    def times(self) -> np.ndarray: ...  # (n,) [s]
    @property
    def amplitudes(self) -> np.ndarray: ...  # (n,), sum 1
    @property
    def duration(self) -> float: ...  # [s] what shaping adds to a motion


@final
@dataclass(frozen=True, eq=False)
class RestToRest(OwnsArrays):
    """From `begin` to `end` (n,) in `time` [s] plus the shaper's duration: call it for position, rate, acceleration.

    profile: "minimum-jerk", "jerk-limited" or "bang-bang".
    """

    begin: np.ndarray
    end: np.ndarray
    time: float
    shaper: Impulses | None = None
    profile: str = "minimum-jerk"

    def __post_init__(self) -> None:
        for name in ("begin", "end"):
            object.__setattr__(self, name, read_only(f"RestToRest.{name}", getattr(self, name), (-1,)))
        if self.begin.shape != self.end.shape:
            raise ValueError(f"RestToRest.end has shape {self.end.shape}, must be {self.begin.shape} as begin")
        object.__setattr__(self, "time", require_seconds("RestToRest.time", self.time))
        object.__setattr__(self, "_motion", profile_of("RestToRest", self.profile))
        impulses = [(0.0, 1.0)]
        if self.shaper is not None:
            if isinstance(self.shaper, type) or not all(
                hasattr(self.shaper, name) for name in ("times", "amplitudes", "duration")
            ):
                raise ValueError(f"RestToRest.shaper = {shown(self.shaper)} must be a Shaper")
            impulses = list(zip(self.shaper.times.tolist(), self.shaper.amplitudes.tolist()))
        object.__setattr__(self, "_impulses", impulses)

    @property
    def duration(self) -> float:
        """[s] until `end` is reached."""
        return self.time + (0.0 if self.shaper is None else self.shaper.duration)

    def __call__(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        t = moment("RestToRest", t)
        way = rate = acceleration = 0.0
        for start, share in self._impulses:  # type: ignore[attr-defined]
            s, ds, dds = self._motion((t - start) / self.time)  # type: ignore[attr-defined]
            way, rate, acceleration = way + share * s, rate + share * ds, acceleration + share * dds
        span = self.end - self.begin
        return self.begin + way * span, rate / self.time * span, acceleration / self.time**2 * span


@final
@dataclass(frozen=True, eq=False)
class Follow(OwnsArrays):
    """A sampled motion: positions, rates, accelerations (nt, n) every `dt` [s]. At its end it goes on at its rate."""

    dt: float
    positions: np.ndarray
    rates: np.ndarray
    accelerations: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "dt", require_seconds("Follow.dt", self.dt))
        positions = read_only("Follow.positions", self.positions, (-1, -1))
        if not len(positions):
            raise ValueError("Follow.positions are empty, must hold at least one row")
        object.__setattr__(self, "positions", positions)
        for name in ("rates", "accelerations"):
            object.__setattr__(self, name, read_only(f"Follow.{name}", getattr(self, name), positions.shape))

    @property
    def end(self) -> np.ndarray:
        """The last position (n,)."""
        return self.positions[-1]

    def __call__(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        last = len(self.positions) - 1
        k = min(max(round(moment("Follow", t) / self.dt), 0), last)
        late = t - k * self.dt if k == last else 0.0
        return self.positions[k] + late * self.rates[k], self.rates[k], self.accelerations[k]


def require_reference(owner: str, reference: Any) -> None:
    """ValueError unless it is a motion of joints."""
    if not isinstance(reference, (RestToRest, Follow)):
        raise ValueError(f"{owner}.reference = {shown(reference)} must be a RestToRest or a Follow")


class Joints(NamedTuple):
    """Where each input acts, by names of states or outputs."""

    positions: tuple[str, ...]
    rates: tuple[str, ...]


def joints(plant: Plant) -> Joints:
    """The coordinate that each input drives, as the plant states it.

    PliantError where there is not one for each input: forces at a tip in the plane, thrusters, wheels about skew axes.
    """
    require_instance("joints.plant", plant, Plant)
    found = {joint.input: joint for joint in plant.joints}
    known = {s.name for s in plant.states + plant.outputs}
    driven = [found[s.name] for s in plant.inputs if s.name in found]
    at = Joints(tuple(j.position for j in driven), tuple(j.rate for j in driven))
    if len(set(at.positions)) != plant.nu or not {*at.positions, *at.rates} <= known:
        raise PliantError(
            f"{type(plant).__name__} has {plant.nu} inputs {tuple(s.name for s in plant.inputs)} and the rigid "
            f"coordinates {tuple(plant.ladder()[0].rates)}: no joint for each input, so name the positions and rates "
            "yourself"
        )
    return at


def driven(plant: Plant) -> Joints:
    """`joints`, or where there is not one for each input those that the inputs drive together."""
    require_instance("driven.plant", plant, Plant)
    one_each = {joint.input for joint in plant.joints} == {s.name for s in plant.inputs}
    if one_each or not plant.shared_joints:
        return joints(plant)
    return Joints(tuple(j.position for j in plant.shared_joints), tuple(j.rate for j in plant.shared_joints))


def motion_of(scene: CostedScene, at: Joints) -> RestToRest | Follow:
    """From rest to rest in the scene's move_time; where the goal moves, the rigid plant under the nominal inputs."""
    if scene.goal_at_rest:
        return RestToRest(*ends(scene, at.positions), scene.move_time)
    rigid, (x, _) = scene.plant.ladder()[0], scene.initial
    known = dict(zip((s.name for s in scene.plant.states), x))
    start = np.array([known.get(s.name, 0.0) for s in rigid.states])
    missing = {*at.positions, *at.rates} - {s.name for s in rigid.states}
    if missing:
        raise PliantError(
            f"the goal of scene {scene.name!r} moves, and {sorted(missing)} are no states to follow there"
        )
    motion = rigid.simulate(start, scene.nominal_input, scene.times)
    moving = motion.derivative()[:, [index(rigid.states, name, "state") for name in at.rates]]
    positions, rates = (np.stack([motion[name] for name in names], axis=1) for names in at)
    return Follow(scene.dt, positions, rates, moving)


def ends(scene: CostedScene, names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Values of the named states or outputs at the scene's start and goal, each (n,)."""
    return values_of(scene.plant, *scene.initial, names), values_of(scene.plant, *scene.target, names)


def values_of(plant: Plant, x: Any, u: Any, names: tuple[str, ...]) -> np.ndarray:
    """Of the named states or outputs (n,) at x (nx,), u (nu,)."""
    places = [index(plant.states + plant.outputs, name, "state or output") for name in names]
    return np.concatenate([require_finite("x", x, (plant.nx,)), plant.measure(x, u)])[places]
