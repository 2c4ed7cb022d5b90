"""Lanes by name: what vector environments of single ones do with attributes and methods of these."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import VectorEnv

from pliant.envs.scenes.scene import Scene
from pliant.envs.tasks.infos import of_lanes

Array = np.ndarray
SHARED = ("randomise",)  # attributes of the environment that may be set, in all lanes at once
OWN = {"state": "states", "time": "times", "fidelity": "fidelities"}  # attributes of a lane: rows of an array
METHODS = ("reset", "get_wrapper_attr", "has_wrapper_attr", "set_wrapper_attr")  # of a lane alone
ABSENT = object()


class Lanes(VectorEnv[Array, Array, Array]):
    """Attributes and methods of the lanes of one batch, as if each were an environment of its own.

    A lane's own are "state", "time", "fidelity", its spaces, its random numbers, and what `set_lane_attr` has put
    there. All else is the batch's and the same in every lane. Where something cannot be done to one lane alone, it is
    refused.
    """

    marks: dict[str, list[Any]]  # what users have set, by name, lane by lane

    @property
    @abstractmethod
    def states(self) -> Array: ...

    @property
    @abstractmethod
    def times(self) -> Array: ...

    @property
    @abstractmethod
    def fidelities(self) -> Array: ...

    @abstractmethod
    def _played(self, lane: int) -> Scene: ...

    @abstractmethod
    def generator_of(self, lane: int) -> np.random.Generator:
        """The random numbers that a lane draws its episodes from."""

    def lane_attr(self, name: str, lanes: Sequence[int]) -> list[Any]:
        """The attribute of each of the lanes; AttributeError where there is none."""
        if name in self.marks:
            values = [self.marks[name][lane] for lane in lanes]
            if any(value is ABSENT for value in values):
                raise AttributeError(f"lanes {list(lanes)}: {name!r} is not set in all of them")
            return values
        if name in OWN:
            rows = getattr(self, OWN[name])
            if name == "state":  # without what stands beyond a lane's own states
                return [rows[lane][: self._played(lane).plant.nx].copy() for lane in lanes]
            return [rows[lane].item() for lane in lanes]
        if name == "np_random":
            return [self.generator_of(lane) for lane in lanes]
        if name in ("action_space", "observation_space"):
            name = f"single_{name}"
        value = getattr(self, name)
        return [value.copy() if isinstance(value, np.ndarray) else value for _ in lanes]

    def set_lane_attr(self, name: str, values: Sequence[Any], lanes: Sequence[int]) -> None:
        """Set the attribute of each of the lanes; ValueError where lanes cannot differ in it, or it is fixed."""
        if name in SHARED:
            different = any(value != values[0] for value in values[1:])
            if sorted(lanes) != list(range(self.num_envs)) or different:
                raise ValueError(f"set_attr({name!r}): indices = {list(lanes)} must name all lanes, which share it")
            setattr(self, name, values[0])
        elif name in OWN or (name not in self.marks and hasattr(type(self), name)) or name in self.__dict__:
            raise ValueError(f"set_attr({name!r}): is fixed when the environment is made, or by reset and step")
        else:
            own = self.marks.setdefault(name, [ABSENT] * self.num_envs)
            for lane, value in zip(lanes, values):
                own[lane] = value

    def call_lanes(self, name: str, lanes: Sequence[int], *args: Any, **kwargs: Any) -> list[Any]:
        """Call the method in each of the lanes; ValueError where it acts on all lanes and not all are named."""
        if name == "reset":
            return self._reset_lanes(lanes, *args, **kwargs)
        if name == "get_wrapper_attr":
            (attribute,) = args
            return self.lane_attr(attribute, lanes)
        if name == "has_wrapper_attr":
            (attribute,) = args
            own = self.marks.get(attribute)
            there = attribute in OWN or hasattr(self, attribute)
            return [there if own is None else own[lane] is not ABSENT for lane in lanes]
        if name == "set_wrapper_attr":
            attribute, value = args
            self.set_lane_attr(attribute, [value] * len(lanes), lanes)
            return [True] * len(lanes)
        method = getattr(self, name)
        if not callable(method):
            raise ValueError(f"{name!r} is no method; get_attr reads it")
        if name == "step" or sorted(lanes) != list(range(self.num_envs)):
            raise ValueError(f"{name}: acts on all lanes at once, cannot be called in lanes {list(lanes)} alone")
        return [method(*args, **kwargs)] * len(lanes)

    def _reset_lanes(self, lanes: Sequence[int], *, seed: Any = None, options: Any = None) -> list[Any]:
        """Reset the lanes, each with this seed and these options; (obs, info) of each."""
        mask = np.isin(np.arange(self.num_envs), lanes)
        each: Any = None if seed is None else [seed] * self.num_envs
        obs, found = self.reset(seed=each, options={**(options or {}), "reset_mask": mask})
        return list(zip(obs[lanes], of_lanes(found, np.array(lanes))))

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """The attribute of every lane."""
        return tuple(self.lane_attr(name, range(self.num_envs)))

    def set_attr(self, name: str, values: Any) -> None:
        """Set the attribute of every lane: one value for all, or a list or tuple of num_envs."""
        each = list(values) if isinstance(values, (list, tuple)) else [values] * self.num_envs
        if len(each) != self.num_envs:
            raise ValueError(f"set_attr({name!r}): {len(each)} values must be one for all lanes, or {self.num_envs}")
        self.set_lane_attr(name, each, range(self.num_envs))

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Call the method in every lane, or read the attribute."""
        lanes = range(self.num_envs)
        if name in self.marks or name in OWN or not (name in METHODS or callable(getattr(self, name))):
            return tuple(self.lane_attr(name, lanes))
        return tuple(self.call_lanes(name, lanes, *args, **kwargs))
