"""What the environments are handed, single and vector alike: actions, seeds, options of reset, lengths of episodes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from pliant.envs.mixtures import Mixture
from pliant.envs.scenes import registry
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_period import LARGEST
from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import as_number, require_count, shown

Array = np.ndarray
LARGEST_ACTION = float(np.finfo(np.float32).max)  # the action space is of single precision
OPTIONS = ("state", "parameters")


def require_actions(owner: str, name: str, actions: Any, shape: tuple[int, ...]) -> Array:
    """`actions` as an array of real numbers, as it is where it is one; ValueError unless it has `shape` and every
    number is finite in single precision. `name`: "action" of one environment (nu,), "actions" of lanes (n, nu).
    """
    try:
        found = np.asarray(actions)
    except Exception:  # whatever an object's own __array__ raises
        raise ValueError(f"{owner}: {name} must be an array {shape} of real numbers") from None
    have = "have" if name == "actions" else "has"
    if found.dtype.kind not in "fiu":
        raise ValueError(f"{owner}: {name} {have} dtype {found.dtype}, must be real numbers")
    if found.shape != shape:
        raise ValueError(f"{owner}: {name} {have} shape {found.shape}, must be {shape}")
    # the sum of squares tells at once that all is well; where it does not, each number is looked at
    if found.dtype.kind == "f" and not float(np.vdot(found, found)) < LARGEST_ACTION:
        bad = np.atleast_2d(~(np.abs(found.astype(float)) <= LARGEST_ACTION)).any(axis=1)
        if bad.any():
            k = int(np.argmax(bad))
            which = f"{name}[{k}] = {found[k]}" if name == "actions" else f"{name} = {found}"
            raise ValueError(
                f"{owner}: {which} must be finite numbers in [-1, 1]; beyond they are clipped, "
                f"up to {LARGEST_ACTION:.2g}"
            )
    return found


def require_seed(owner: str, seed: Any, name: str = "seed") -> int | None:
    """`seed` as an int or None; ValueError unless it is None or an integer >= 0."""
    if seed is None:
        return None
    try:
        return require_count(owner, name, seed, 0, math.inf)
    except ValueError:
        raise ValueError(f"{owner}: {name} = {shown(seed)} must be an integer >= 0 or None") from None


def require_seeds(owner: str, seed: Any, lanes: int) -> int | list[int | None] | None:
    """As require_seed; or one seed or None a lane, from any sequence of them."""
    if not isinstance(seed, (list, tuple, range)) and not (isinstance(seed, np.ndarray) and seed.ndim):
        return require_seed(owner, seed)
    if len(seed) != lanes:
        raise ValueError(f"{owner}: seed of length {len(seed)} must be one integer, None, or {lanes} of them")
    return [require_seed(owner, item, f"seed[{k}]") for k, item in enumerate(seed)]


def require_mask(owner: str, mask: Any, lanes: int) -> Array:
    """Which lanes a reset starts, as their indices; ValueError unless it is (lanes,) bool and names at least one."""
    try:
        found = np.asarray(mask)
    except (ValueError, TypeError, RuntimeError) as problem:
        raise ValueError(f"{owner}: reset_mask must be ({lanes},) bool: {problem}") from None
    if found.shape != (lanes,) or found.dtype != bool:
        raise ValueError(f"{owner}: reset_mask of {found.dtype}{found.shape} must be ({lanes},) bool")
    if not found.any():
        raise ValueError(f"{owner}: reset_mask is False in every lane, must name at least one to start")
    return np.flatnonzero(found)


def require_options(owner: str, options: Any, allowed: tuple[str, ...]) -> dict[str, Any]:
    """A dictionary of its own with the options of a reset; ValueError for unknown keys."""
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ValueError(f"{owner}: options = {shown(options)} must be a dictionary or None")
    for key in options:
        parameters.require_choice(owner, "options", key, allowed)
    return dict(options)


def known(mixture: Mixture | None) -> tuple[str, ...]:
    """What a reset may be given. States are of one model, so that a mixture takes none of them."""
    return OPTIONS if mixture is None else ("parameters", "fidelity")


def require_start(
    owner: str, scene: Scene, options: Mapping[str, Any], mixture: Mixture | None = None
) -> dict[str, Any]:
    """The options "state" and "parameters" of one lane: a state (nx,) of its own, numbers by name in their range; of a
    mixture also the place among its models of "fidelity".
    """
    found: dict[str, Any] = {}
    if "fidelity" in options and mixture is not None:
        found["fidelity"] = mixture.index(f"{owner}: options['fidelity']", options["fidelity"])
    if "state" in options:
        name = f"{owner}: options['state']"
        x = parameters.require_finite(name, options["state"], (scene.plant.nx,)).copy()
        if not np.abs(x).max() < LARGEST:
            raise ValueError(f"{name} = {x} must be finite numbers below {LARGEST:g}")
        found["state"] = x
    if "parameters" in options:
        values = options["parameters"]
        if not isinstance(values, Mapping):
            raise ValueError(
                f"{owner}: options['parameters'] = {shown(values)} must be a dictionary of numbers by name"
            )
        found["parameters"] = {}
        for path, value in values.items():
            parameters.require_choice(owner, "options['parameters']", path, scene.varied_plant.varied)
            value = as_number(value)
            parameters.put(scene.plant, path, value)  # ValueError where it is no number or out of range
            found["parameters"][path] = float(value)
    return found


def require_starts(
    owner: str, scene: Scene, options: Mapping[str, Any], lanes: int, mixture: Mixture | None = None
) -> list[dict[str, Any]] | None:
    """As require_start, for each of the lanes: states (nx,) or (lanes, nx), numbers or (lanes,) of them by name, models
    by one word or (lanes,).

    None where no such option is there. What all lanes share is looked at once.
    """
    shared, apart = {key: options[key] for key in known(mixture) if key in options}, {}
    if not shared:
        return None
    if _shape(f"{owner}: options['fidelity']", options.get("fidelity")) == (lanes,):
        apart["fidelity"] = shared.pop("fidelity")
    shape = _shape(f"{owner}: options['state']", options.get("state"))
    if len(shape) == 2 and shape[0] == lanes:
        apart["state"] = shared.pop("state")
    if isinstance(values := options.get("parameters"), Mapping):
        shapes = {name: _shape(f"{owner}: options['parameters'][{name!r}]", value) for name, value in values.items()}
        shared["parameters"] = {name: value for name, value in values.items() if shapes[name] != (lanes,)}
        apart["parameters"] = {name: value for name, value in values.items() if shapes[name] == (lanes,)}
    common, each = require_start(owner, scene, shared, mixture), []
    for k in range(lanes):
        own: dict[str, Any] = {key: apart[key][k] for key in ("state", "fidelity") if key in apart}
        if apart.get("parameters"):
            own["parameters"] = {name: value[k] for name, value in apart["parameters"].items()}
        found = require_start(owner, scene, own, mixture)
        if "parameters" in common:
            found["parameters"] = common["parameters"] | found.get("parameters", {})
        each.append(common | found)
    return each


def _shape(name: str, value: Any) -> tuple[int, ...]:
    """The shape of what is one thing for all lanes or one a lane; ValueError where rows differ in length."""
    try:
        return np.shape(value)
    except (ValueError, TypeError, RuntimeError):
        raise ValueError(f"{name} = {shown(value)} must have rows of one length") from None


def require_length(owner: str, scene: Scene, most: Any, hold: int = 1) -> int:
    """Periods of an episode: the scene's, or the fewer of `max_episode_steps` actions of `hold` periods each."""
    if most is None:
        return scene.steps
    try:
        actions = require_count(owner, "max_episode_steps", most, 1, -(-scene.steps // hold))
    except ValueError as refused:
        raise ValueError(
            f"{refused}, the {'periods' if hold == 1 else 'actions'} of scene {scene.name!r}; for longer episodes give "
            "the scene a longer duration"
        ) from None
    return min(actions * hold, scene.steps)


def require_scene(owner: str, scene: Any) -> Scene:
    """A Scene, or the one of that name."""
    if isinstance(scene, str):
        return registry.get(scene)
    if not isinstance(scene, Scene):
        raise ValueError(f"{owner}: scene = {shown(scene)} must be a Scene or the name of one")
    if not scene.observe:
        raise ValueError(f"scene {scene.name!r}: observe = () must name at least one signal")
    return scene
