"""What a training run can be told: the learners' numbers, how long, and what its files are called."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

from pliant.plants.core.argument_gates import require_count, require_number
from pliant.plants.core.imports import Late

Progress = Callable[[float, str], None]
SECONDS = {"apg": 60.0, "ppo": 300.0, "sac": 300.0}  # what a run may take where nothing is said
CURVE, POLICY = "curve.json", "policy"
CURVE_FORMAT = 2  # format 1, of version 0.1, has no checksum
FLOOR = 0.02  # share of the learning rate that is left at the end
COUNTS = {  # least and most
    "num_envs": (1, 1_000_000),
    "n_steps": (1, 1_000_000),
    "batch_size": (1, 100_000_000),
    "n_epochs": (1, 100_000),
    "buffer_size": (1, 10_000_000_000),
    "gradient_steps": (1, 1_000_000),
    "learning_starts": (0, 1_000_000_000_000),
    "width": (1, 1_000_000),
    "history": (0, 100),
    "delay": (0, 1000),
}
MOST = {"gamma": 1.0, "gae_lambda": 1.0, "tau": 1.0}  # of numbers > 0
MAY_BE_ZERO = ("gamma", "gae_lambda", "spread", "APGSettings.noise")  # PPO takes the logarithm of its own


def _check(settings: Any) -> None:
    """ValueError naming the field, its value and its range; NumPy's numbers become Python's."""
    owner = type(settings).__name__
    for field in fields(settings):
        name, value = field.name, getattr(settings, field.name)
        if name in COUNTS:
            value = require_count(owner, name, value, *COUNTS[name])
        else:
            allowed = "nonnegative" if {name, f"{owner}.{name}"} & {*MAY_BE_ZERO} else "positive"
            value = require_number(f"{owner}.{name}", value, allowed)
            if value > MOST.get(name, value):
                raise ValueError(f"{owner}.{name} = {value!r} must be at most {MOST[name]:g}")
        object.__setattr__(settings, name, value)


@dataclass(frozen=True, kw_only=True)
class PPOSettings:
    """Proximal policy optimisation on many short rollouts. Found by trial on this package's scenes."""

    num_envs: int = 1024
    n_steps: int = 20  # control periods of a rollout
    batch_size: int = 4096
    n_epochs: int = 4
    learning_rate: float = 1e-3  # at first; it falls linearly to FLOOR of it
    gamma: float = 0.98  # a control period's discount
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    noise: float = 0.135  # first standard deviation of the actions, of the limits
    width: int = 64  # units of each of two tanh layers
    spread: float = 1.5  # of training's starts: times the largest distance from start to goal

    def __post_init__(self) -> None:
        _check(self)


@dataclass(frozen=True, kw_only=True)
class SACSettings:
    """Soft actor-critic: fewer steps, each dearer."""

    num_envs: int = 64
    buffer_size: int = 500_000
    batch_size: int = 512
    gradient_steps: int = 8  # after each control period of all lanes
    learning_starts: int = 20_000  # steps before the first
    learning_rate: float = 1e-3
    gamma: float = 0.99
    tau: float = 0.01  # of the target networks' moving average
    width: int = 64  # units of each of two ReLU layers
    spread: float = 1.5

    def __post_init__(self) -> None:
        _check(self)


@dataclass(frozen=True, kw_only=True)
class APGSettings:
    """Analytic policy gradients: whole episodes differentiated through the plant's native step.

    Lane 0 always plays the scene as it is, without delay and noise; the others draw starts, parameters, delay and noise
    anew for each gradient.
    """

    num_envs: int = 16
    learning_rate: float = 1e-3  # at first, after some steps of rising; it falls as a cosine to FLOOR of it
    width: int = 64  # units of each of two tanh layers
    history: int = 0  # former readings and commands that the policy reads too
    delay: int = 0  # most [control periods] from reading to acting; each lane draws 0, 1, .. or this
    noise: float = 0.0  # standard deviation of readings, over their own spread in the scene

    def __post_init__(self) -> None:
        _check(self)


LEARNERS = {"apg": Late("pliant.controllers.analytic_gradients.training")}  # whose `learn` does; it imports this room
Settings = APGSettings | PPOSettings | SACSettings
SETTINGS: dict[str, type[Settings]] = {"apg": APGSettings, "ppo": PPOSettings, "sac": SACSettings}
