"""The specification that Gymnasium keeps with an environment, in words that become JSON and make it again."""

from __future__ import annotations

import copy
import enum
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec

from pliant.envs.scenes import registry
from pliant.envs.scenes.scene import Scene
from pliant.envs.tasks import Task


class Specified:
    """Base of an environment that ends episodes after `_steps` periods itself, and says so in its specification."""

    _steps: int
    task: Task
    _spec: EnvSpec | None = None

    @property
    def spec(self) -> EnvSpec | None:
        """The registered specification, with the max_episode_steps that this class enforces."""
        return self._spec

    @spec.setter
    def spec(self, value: EnvSpec | None) -> None:
        self._spec = own(value, -(-self._steps // self.task.hold))


def own(spec: EnvSpec | None, steps: int) -> EnvSpec | None:
    """A copy with the number of actions that the environment enforces, its keywords as JSON can hold them."""
    if spec is None:
        return None
    found = copy.copy(spec)
    found.max_episode_steps = steps
    found.kwargs = {key: _plain(key, value) for key, value in spec.kwargs.items() if key != "max_episode_steps"}
    return found


def _plain(key: str, value: Any) -> Any:
    """Scalar types by name, scenes that have one by name, enumerations by value, NumPy's numbers as Python's."""
    if key == "dtype":
        return np.dtype(value).name
    if isinstance(value, Scene):
        return (
            value.name
            if value.name in (*registry.names(), *registry.VARIANTS) and value is registry.get(value.name)
            else value
        )
    if isinstance(value, enum.Enum):
        return value.value
    return value.item() if isinstance(value, np.generic) else value
