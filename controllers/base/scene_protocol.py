"""What a controller asks of a scene. This folder knows none: pliant.envs.Scene is one, handed over by the caller."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from pliant.plants import Plant
from pliant.plants.core.argument_gates import shown

Pairs = tuple[tuple[str, float], ...]
TELLING = ("plant", "weights", "effort", "limits", "dt")  # what every scene has and hardly anything else


class CostedScene(Protocol):
    """What planning and predictive control ask of a scene: a goal, a cost, limits. See pliant.envs.Scene."""

    @property
    def name(self) -> str: ...
    @property
    def plant(self) -> Plant: ...
    @property
    def weights(self) -> Pairs: ...
    @property
    def effort(self) -> Pairs: ...
    @property
    def bounds(self) -> Pairs: ...
    @property
    def limits(self) -> tuple[float, ...]: ...
    @property
    def dt(self) -> float: ...  # [s]
    @property
    def substeps(self) -> int: ...
    @property
    def steps(self) -> int: ...
    @property
    def move_time(self) -> float: ...  # [s]
    @property
    def times(self) -> np.ndarray: ...  # (steps + 1,) [s]
    @property
    def goal_at_rest(self) -> bool: ...
    @property
    def goal_rates(self) -> Pairs: ...
    @property
    def nominal_input(self) -> Callable[[float], np.ndarray]: ...
    @property
    def initial(self) -> tuple[np.ndarray, np.ndarray]: ...
    @property
    def target(self) -> tuple[np.ndarray, np.ndarray]: ...


class TrainableScene(Protocol):
    """What training asks of a scene: see pliant.envs.Scene, a frozen dataclass. `start_spread` can be replaced."""

    @property
    def name(self) -> str: ...
    @property
    def plant(self) -> Plant: ...
    @property
    def start(self) -> Pairs: ...
    @property
    def goal(self) -> Pairs: ...
    @property
    def start_spread(self) -> float: ...
    @property
    def dt(self) -> float: ...  # [s]
    @property
    def steps(self) -> int: ...
    @property
    def limits(self) -> tuple[float, ...]: ...
    @property
    def observe(self) -> tuple[str, ...]: ...
    @property
    def initial(self) -> tuple[np.ndarray, np.ndarray]: ...
    @property
    def early_end_rate(self) -> float: ...  # [1/s]
    def goal_values(self, names: tuple[str, ...]) -> np.ndarray: ...
    def stage_cost(self, x: np.ndarray, u: np.ndarray, y: np.ndarray) -> Any: ...
    def vector_env(self, num_envs: int, *, threads: int | None, **options: Any) -> Any: ...
    def sb3_env(self, num_envs: int, *, randomise: bool = False, threads: int | None = None) -> Any: ...


def require_scene(owner: str, scene: Any, asked: tuple[str, ...] = TELLING) -> Any:
    """`scene` itself; ValueError unless it has what tells one, of which nothing is computed for that."""
    own = getattr(scene, "__dict__", {})
    if isinstance(scene, type) or not all(name in own or hasattr(type(scene), name) for name in asked):
        raise ValueError(f"{owner}.scene = {shown(scene)} must be a Scene, not {type(scene).__name__}")
    return scene
