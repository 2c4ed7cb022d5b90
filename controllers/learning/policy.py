"""A trained policy as a controller: a small network from arrays, in NumPy, without what trained it.

Law    u = limits * clip(net(z), -1, 1), or limits * tanh(net(z)) where `squash` says so,
       z = clip((y - goal - mean) / std, -clip, clip),
       net = W_n a(.. a(W_1 z + b_1) ..) + b_n with a = tanh or relu.

Of an action that is not a share of the limits, clip(net(z)) is followed by clip(middle + reach * it, -1, 1); `hold`
lets a command last so many control periods, and the network is asked anew in the next one.

With a `history` of h, z is followed by the h former ones, newest first, and by the h former commands over the limits.

A policy is NAME.npz (W1, b1, .., mean, std and all words) and NAME.json (the words once more). Neither can run code.

Guarantee   none; play it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self, final

import numpy as np

from pliant.controllers.base.scene_protocol import TrainableScene, require_scene
from pliant.plants.core.argument_gates import (
    as_number,
    as_tuple,
    real_array,
    require_choice,
    require_count,
    require_finite,
    require_flag,
    require_mapping,
    require_names,
    require_number,
    require_path,
    require_seconds,
    require_text,
)
from pliant.plants.core.signals import OwnsArrays

from . import policy_files

ACTIVATIONS = ("tanh", "relu")
FOLDER = Path(__file__).parent / "policies"
ROBUST = "-robust"  # ends the name of what was trained under delay, noise and other parameters
MOST_LAYERS = 100
MOST_HISTORY = 100
MOST_HOLD = 10_000


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Policy(OwnsArrays):
    """Made by `load`, `for_scene`, `from_sb3_zip` or training. `act` takes about 10 us for two layers of 64."""

    weights: tuple[np.ndarray, ...]  # (units, inputs) of each layer
    biases: tuple[np.ndarray, ...]  # (units,) of each layer
    mean: np.ndarray  # (ny,) of y - goal in training
    std: np.ndarray  # (ny,), > 0
    scene: str  # name of the scene that it was trained on
    reads: tuple[str, ...]  # (ny,) names
    goal: np.ndarray  # (ny,) values of what it reads at the goal
    inputs: tuple[str, ...]  # (nu,) names
    limits: np.ndarray  # (nu,) largest |u|, in the inputs' units
    dt: float  # [s]
    clip: float = np.inf  # largest |normalised observation|
    activation: str = "tanh"
    squash: bool = False  # the output through tanh instead of being cut off
    history: int = 0  # former readings and commands that are read too
    hold: int = 1  # control periods that a command lasts
    middle: np.ndarray | None = None  # (nu,) share of the limits of an action of 0, None: 0; and ..
    reach: np.ndarray | None = None  # .. how much further one of 1 is, None: 1
    made: Mapping[str, Any] = field(default_factory=dict)  # how: command, seed, steps, cost, versions
    _shift: np.ndarray = field(init=False, repr=False)
    _factor: np.ndarray = field(init=False, repr=False)
    _z: np.ndarray = field(init=False, repr=False)  # room for the normalised observation, and the memory behind it ..
    _layers: tuple[Any, ...] = field(init=False, repr=False)  # .. and for each layer's output
    _newest: np.ndarray = field(init=False, repr=False)  # (nu,) the last command over the limits
    _begun: bool = field(init=False, repr=False)  # whether the memory holds this episode's
    _place: Any = field(init=False, repr=False)  # (middle, reach), where actions are no shares of the limits
    _left: int = field(init=False, repr=False, default=0)  # control periods that the last command has still to last

    def __post_init__(self) -> None:
        own = f"Policy of {require_text('Policy.scene', self.scene, empty=True)!r}"
        require_choice(own, "activation", self.activation, ACTIVATIONS)
        reads, inputs = require_names(f"{own}: reads", self.reads), require_names(f"{own}: inputs", self.inputs)
        given = tuple(_each_layer(f"{own}: {name}", getattr(self, name)) for name in ("weights", "biases"))
        ny, nu, layers = len(reads), len(inputs), len(given[0])
        if not 1 <= layers == len(given[1]) <= MOST_LAYERS:
            raise ValueError(
                f"{own}: weights and biases of {layers} and {len(given[1])} layers must be as many, 1 to {MOST_LAYERS}"
            )
        seen = real_array(f"{own}: weights", given[0][0]).shape
        history = require_count(own, "history", self.history, 0, MOST_HISTORY)
        width = ny + history * (ny + nu)
        if len(seen) == 2 and seen[1] != width:
            told = f", and {history} former ones and commands" if history else ""
            raise ValueError(
                f"{own}: weights, W1 has shape {seen}, must have a column for each of reads = {reads}{told}"
            )
        weights, biases = [], []
        for k, (W, b) in enumerate(zip(*given), 1):
            W = require_finite(f"{own}: weights, W{k}", W, (nu if k == layers else -1, width))
            width = len(W)
            weights.append(np.ascontiguousarray(W))
            biases.append(require_finite(f"{own}: biases, b{k}", b, (width,)))
        values: dict[str, Any] = {"weights": tuple(weights), "biases": tuple(biases)}
        sizes = {"mean": ny, "std": ny, "goal": ny, "limits": nu}
        sizes |= {name: nu for name in ("middle", "reach") if getattr(self, name) is not None}
        for name, size in sizes.items():
            values[name] = require_finite(f"{own}: {name}", getattr(self, name), (size,))
        for name in ("std", "limits"):
            if not (values[name] > 0).all():
                raise ValueError(f"{own}: {name} = {values[name]} must be > 0")
        values |= {"dt": require_seconds(f"{own}: dt", self.dt), "reads": reads, "inputs": inputs}
        clip = as_number(self.clip)
        values["clip"] = (
            clip if isinstance(clip, float) and clip == np.inf else require_number(f"{own}: clip", clip, "positive")
        )
        place = [values.get(name, np.full(nu, missing)) for name, missing in (("middle", 0.0), ("reach", 1.0))]
        values["_place"] = place if len(sizes) > 4 else None
        values["hold"] = require_count(own, "hold", self.hold, 1, MOST_HOLD)
        if history and (self.hold > 1 or len(sizes) > 4):
            raise ValueError(f"{own}: history = {history} must be 0 where commands last or are no shares of the limits")
        values |= {"squash": require_flag(f"{own}: squash", self.squash)}
        values["made"] = require_mapping(f"{own}: made", self.made)
        values |= {
            "history": history,
            "_z": np.zeros(ny + history * (ny + nu)),
            "_begun": False,
            "_newest": np.zeros(nu),
        }
        values |= {"_shift": values["goal"] + values["mean"], "_factor": 1 / values["std"]}
        values["_layers"] = tuple((W, b, np.empty(len(b))) for W, b in zip(weights, biases))
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def reset(self) -> None:
        """Forget what was read and commanded."""
        object.__setattr__(self, "_begun", False)
        object.__setattr__(self, "_left", 0)

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) within the limits, from y (len(reads),)."""
        whole = self._z
        z = whole[: len(self.reads)] if self.history else whole
        if type(y) is not np.ndarray or y.dtype != float or y.shape != z.shape or not np.dot(y, y) < np.inf:
            y = require_finite("Policy.y", y, z.shape)
        if self._left:
            object.__setattr__(self, "_left", self._left - 1)
            return self.limits * self._newest
        if self.history and self._begun:
            self._shift_memory()
        np.subtract(y, self._shift, out=z)
        np.multiply(z, self._factor, out=z)
        np.maximum(z, -self.clip, out=z)
        np.minimum(z, self.clip, out=z)
        if self.history and not self._begun:  # as if it had always been read, and nothing commanded
            self._fill_memory(z)
        z = whole
        last = len(self._layers) - 1
        for k, (W, b, h) in enumerate(self._layers):
            np.dot(W, z, out=h)
            np.add(h, b, out=h)
            if k < last:
                np.tanh(h, out=h) if self.activation == "tanh" else np.maximum(h, 0.0, out=h)
            z = h
        action = np.tanh(z) if self.squash else np.minimum(np.maximum(z, -1.0), 1.0)
        if self._place is not None:
            middle, reach = self._place
            action = np.minimum(np.maximum(middle + reach * action, -1.0), 1.0)
        if self.history or self.hold > 1:
            self._newest[:] = action
            object.__setattr__(self, "_left", self.hold - 1)
        return self.limits * action

    def _fill_memory(self, z: np.ndarray) -> None:
        ny, h = len(self.reads), self.history
        self._z[ny : (h + 1) * ny] = np.tile(z, h)
        self._z[(h + 1) * ny :] = 0.0
        object.__setattr__(self, "_begun", True)

    def _shift_memory(self) -> None:
        """Every frame one place on: the last reading and the last command become the newest former ones."""
        ny, nu, h = len(self.reads), len(self.inputs), self.history
        readings, commands = self._z[: (h + 1) * ny], self._z[(h + 1) * ny :]
        readings[ny:] = readings[:-ny].copy()
        commands[nu:] = commands[:-nu].copy()
        commands[:nu] = self._newest

    def save(self, path: str | Path) -> None:
        """Write `path` with the endings .npz and .json: the former policy or this one, whenever the process is killed.

        OSError, which names the file, where it cannot be written.
        """
        policy_files.save(self, require_path("Policy.save: path", path))

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """From what `save` wrote. ValueError, which names the file, for damaged, incomplete or foreign ones."""
        fields = policy_files.load(require_path("Policy.load: path", path))
        try:
            return cls(**fields)
        except (TypeError, ValueError, OverflowError) as error:
            raise ValueError(f"Policy.load: {str(path)!r} holds no policy: {error}") from None

    @classmethod
    def for_scene(cls, name: str, *, robust: bool = False) -> Self:
        """The policy that is shipped for a named scene. ValueError, with the names there are, for others.

        robust: the one that was trained under delay, noise and other parameters.
        """
        robust = require_flag("Policy.for_scene: robust", robust)
        require_choice("Policy.for_scene", "name", name, shipped(robust=robust))
        return cls.load(FOLDER / (f"{name}{ROBUST}" if robust else name))

    @classmethod
    def from_sb3_zip(
        cls,
        path: str | Path,
        scene: TrainableScene,
        *,
        algorithm: str = "ppo",
        statistics: str | Path | None = None,
        trust: bool = False,
        hold: int = 1,
        actions: str = "limits",
    ) -> Self:
        """From a Stable-Baselines3 zip, and a pickled VecNormalize (`statistics`) where there was one; `hold` and
        `actions` ("limits", "midway", "nominal") as its environment had them, which the zip does not say.

        Both are pickles: reading one runs whatever code its author put in. ValueError unless trust=True.
        """
        if trust is not True:
            raise ValueError(
                f"{str(path)!r} holds a pickle, which can run any code when it is read: give trust=True if you "
                "made it yourself, or ask its author for arrays and JSON (Policy.save)"
            )
        require_scene("from_sb3_zip", scene, ("plant", "observe", "limits", "dt", "stage_cost"))
        require_choice("from_sb3_zip", "algorithm", algorithm, ("ppo", "sac"))
        found = None if statistics is None else require_path("from_sb3_zip.statistics", statistics)
        from .sb3_export import read_zip  # the other door to torch

        plain = actions == "limits"
        middle, reach = (None, None) if plain else scene.vector_env(1, threads=1, actions=actions).action_map
        return cls(
            **read_zip(require_path("from_sb3_zip.path", path), scene, algorithm, found),
            hold=hold,
            middle=middle,
            reach=reach,
        )


def _each_layer(name: str, value: Any) -> tuple[Any, ...]:
    """An array of each layer."""
    return tuple(value) if isinstance(value, np.ndarray) and value.ndim > 1 else as_tuple(name, value)


def shipped(*, robust: bool = False) -> Sequence[str]:
    """Scenes for which a policy is shipped, or a robust one."""
    files = [path.stem for path in FOLDER.glob("*.npz")]
    return sorted(name.removesuffix(ROBUST) for name in files if name.endswith(ROBUST) == robust)
