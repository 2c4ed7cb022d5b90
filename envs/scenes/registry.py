"""The named scenes. Each docstring tables what the scene's environment shows, takes and charges, and what a
few policies return from the scene's own start.

An observation is a signal less its value at the goal ("sag": what gravity bends there; "hanging": where the beam
hangs at rest; "speed": the goal's own), which moves in time where the docstring says so; the reward is minus the sum,
over the rows of the cost, of the control period times weight times deviation from the goal squared.

Beside those that are shipped there are scenes that a program registers, and those of installed packages, which name a
scene or a function that makes one in their pyproject.toml and are imported when it is asked for:

    [project.entry-points."pliant.scenes"]
    crane-swing = "cranes.scenes:crane_swing"
"""

from __future__ import annotations

import dataclasses
import inspect
import os
import re
from collections.abc import Callable, Mapping
from typing import Any

from pliant.plants.core.argument_gates import require_choice, require_flag, require_instance, require_number, shown
from pliant.plants.core.imports import loaded, offered
from pliant.plants.integration.minimum_jerk import minimum_jerk

from . import arms, beams, mechanisms, spacecraft, spacecraft_orbit, trees
from .scene import Scene

__all__ = ["SCENES", "Scene", "get", "load", "minimum_jerk", "names", "register"]

SCENES: Mapping[str, Callable[..., Scene]] = {
    "single-link-slew": arms.single_link_slew,
    "two-link-reach": arms.two_link_reach,
    "cantilever-drop": beams.cantilever_drop,
    "spin-up": beams.spin_up,
    "slider-crank-run": mechanisms.slider_crank_run,
    "flexible-joint-slew": mechanisms.flexible_joint_slew,
    "crane-swing": mechanisms.crane_swing,
    "six-axis-pick": trees.six_axis_pick,
    "three-link-flexible": trees.three_link_flexible,
    "satellite-arm": trees.satellite_arm,
    "spacecraft-slew": spacecraft.spacecraft_slew,
    "spacecraft-wheels": spacecraft.spacecraft_wheels,
    "spacecraft-spin": spacecraft.spacecraft_spin,
    "spacecraft-orbit": spacecraft_orbit.spacecraft_orbit,
}
VARIANTS: Mapping[str, Callable[..., Scene]] = {  # shipped too, but beside those that `names` lists
    "single-link-slew-gentle": arms.single_link_gentle,
    "two-link-reach-weak": arms.two_link_weak,
}
GROUP, ENDING = "pliant.scenes", ".toml"
NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
READERS: dict[str, Callable[[Any], Scene]] = {}  # "toml": filled by pliant.envs.scene_files, which imports this room
HEARERS: list[Callable[[str], None]] = []  # told the name of each scene before it is registered, and may refuse it
_registered: dict[str, Scene] = {}
_made: dict[str, Scene] = {}  # one scene a name, so that what is built from it is built once


def names() -> tuple[str, ...]:
    """The names of all scenes: shipped, registered, and of installed packages; VARIANTS of shipped ones have more.

    Example
    -------
    >>> names()[:2]
    ('single-link-slew', 'two-link-reach')
    """
    return tuple(dict.fromkeys((*SCENES, *_registered, *_of_packages())))


def _of_packages() -> tuple[str, ...]:
    """Scenes of installed packages; none takes the place of a shipped one or has a name that no folder could have."""
    return tuple(name for name in offered(GROUP) if NAME.fullmatch(name) and name not in _shipped())


def _shipped() -> Mapping[str, Callable[..., Scene]]:
    return {**SCENES, **VARIANTS}


def require_name(owner: str, name: Any) -> str:
    """A name that a folder and an environment can bear. ValueError for others."""
    if not isinstance(name, str) or not NAME.fullmatch(name) or len(name) > 100:
        raise ValueError(f"{owner} = {shown(name)} must be words of a-z and 0-9 joined by '-', as 'crane-swing'")
    return name


def register(scene: Scene, *, replace: bool = False) -> None:
    """Give a scene its name and its Gymnasium id: "crane-swing" is then `scenes.get("crane-swing")`, an argument of
    every function that takes a scene's name, and the environment "pliant/CraneSwing-v0".

    ValueError for a name that is no words of a-z and 0-9 joined by "-", that a shipped scene has, or that another scene
    has unless `replace`.

    Example
    -------
    >>> import dataclasses
    >>> register(dataclasses.replace(get("single-link-slew"), name="my-slew"), replace=True)
    >>> get("my-slew").name
    'my-slew'
    """
    require_instance("register.scene", scene, Scene)
    name = require_name("register: scene.name", scene.name)
    if name in _shipped():
        raise ValueError(f"register: scene.name = {name!r} must have a name of its own, not a shipped scene's")
    if not require_flag("register.replace", replace) and _registered.get(name, scene) != scene:
        raise ValueError(f"register: scene.name = {name!r} is another scene's, must be new unless replace=True")
    for hear in HEARERS:
        hear(name)
    _registered[name] = _made[name] = scene


def load(path: str | os.PathLike[str]) -> Scene:
    """The scene of a TOML file; docs/own_scene.md says what stands in one.

    ValueError in one line that names the file, the key, its value and what it must be. Nothing in it is executed.

    Example
    -------
    >>> import tempfile
    >>> from pliant.envs import scene_files
    >>> path = tempfile.mkdtemp() + "/slew.toml"
    >>> scene_files.save(get("single-link-slew"), path)
    >>> load(path).duration
    3.0
    """
    return READERS["toml"](path)


def is_file(name: Any) -> bool:
    """Whether this names a scene file, not a scene."""
    return isinstance(name, os.PathLike) or (isinstance(name, str) and name.endswith(ENDING))


def _maker(name: str) -> Callable[..., Scene]:
    """What makes the scene of a name."""
    if name in _shipped():
        return _shipped()[name]
    if name in _registered:
        return lambda: _registered[name]
    found = loaded(offered(GROUP)[name], f"scene {name!r}")
    if isinstance(found, Scene):
        return lambda: found
    if not callable(found):
        raise ValueError(f"scene {name!r}: entry point {GROUP} {name} = {shown(found)} must be a Scene or make one")
    made: Callable[..., Scene] = found
    return made


def keywords(name: str) -> dict[str, Any]:
    """{keyword of its own that a scene takes: its default}; none of a file."""
    if is_file(name):
        return {}
    require_choice("scenes", "name", name, (*names(), *VARIANTS))
    return {key: p.default for key, p in inspect.signature(_maker(name)).parameters.items()}


def _own(name: str, **given: Any) -> Scene:
    if not given and name in _made:
        return _made[name]
    scene = require_instance(f"scene {name!r}", _maker(name)(**given), Scene)
    if scene.name != name:
        raise ValueError(f"scene {name!r} calls itself {scene.name!r}, must have the name that it is listed by")
    return scene if given else _made.setdefault(name, scene)


def get(name: str, **overrides: Any) -> Scene:
    """A scene by name, or by the path of its file (.toml); `overrides` are its own keywords ("spin-up": speed,
    "spacecraft-spin": axis) or take the place of its fields (limits=(80.0, 30.0)).

    Example
    -------
    >>> get("two-link-reach").dt
    0.02
    """
    own = keywords(name)
    fields = {f.name for f in dataclasses.fields(Scene)}
    for key in overrides:
        require_choice("scenes.get", "keyword", key, sorted(fields | set(own)))
    built = {key: value for key, value in overrides.items() if key in own}
    for key, value in built.items():
        if not isinstance(own[key], str):  # else a choice, which the scene checks itself
            built[key] = require_number(f"scene {name!r}: {key}", value, "positive")
    scene = load(name) if is_file(name) else _own(name, **built)
    changed = {key: value for key, value in overrides.items() if key not in own}
    return dataclasses.replace(scene, **changed) if changed else scene


def is_by_name(scene: Scene) -> bool:
    """Whether commands in another process find this very scene by its name."""
    return (scene.name in _shipped() or scene.name in _of_packages()) and _own(scene.name) == scene
