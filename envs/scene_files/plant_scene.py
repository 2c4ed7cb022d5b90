"""A first scene of a plant of one's own: from its rest, each joint moved, limits that leave that motion room."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import Joint, names
from pliant.plants.dynamics.plant import Plant
from pliant.plants.files import toml_text

from .scene_tables import to_tables

MOVED = 0.5  # of a joint, in its own unit
FASTEST, SLOWEST = 1e-3, 0.02  # of control periods [s]
FEW = 4  # joints are named, more counted
ROOM = 2.0  # limits over what the motion takes
WIDTH = 120  # characters of a line
LEAST = 1e-30  # an effort below is none
UNKNOWN = 1e6  # a limit while it is asked what the motion takes
SAID = {
    "duration": "[s]",
    "dt": "[s], the control period",
    "move_time": "[s], of the motion from start to goal; a guess",
    "observe": "what an environment and a controller see",
    "compare": "outputs whose error tells models apart ..",
    "tolerance": ".. and how large it may be, in their unit",
    "limits": "largest |input|: put your machine's where its data did not say it (then twice what the motion takes)",
    "start": "coordinates of a rest; what is not named is as in the plant's rest_state, or in equilibrium",
    "weights": "cost: dt times weight times (signal - its value at the goal)^2, summed",
    "effort": "the same of inputs",
}


def first_scene(name: str, plant: Plant) -> Scene:
    """A scene in which every joint moves; ValueError where the plant has no coordinates with rates, or no such rest.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> first_scene("my-slew", SingleLinkArm.textbook()).goal
    (('hub_angle', 0.5),)
    """
    rest = dict(zip(names(plant.states), np.asarray(plant.rest_state).tolist()))
    shared = [n for n in names(plant.states) if all(n in names(rung.states) for rung in plant.ladder())]
    joints = {j.position: j for j in plant.joints if j.position in plant.rates and j.position in shared}
    moved = list(joints) or [n for n in plant.rates if n in shared][: plant.nu]
    manoeuvre = {n: _manoeuvre(rest[n], joints.get(n)) for n in moved}
    if not moved:
        raise ValueError(f"new scene: {type(plant).__name__} has no coordinate whose rate is a state, must have one")
    given: dict[str, Any] = {
        "name": name,
        "about": f"move {', '.join(moved) if len(moved) < FEW else f'{len(moved)} joints'}, rest to rest",
        "plant": plant,
        "start": tuple((joint, manoeuvre[joint][0]) for joint in moved),
        "goal": tuple((joint, manoeuvre[joint][1]) for joint in moved),
        "duration": 6.0,
        "move_time": 3.0,
        "observe": tuple(shared),
        "compare": names(plant.outputs)[:2] or names(plant.states)[:1],
        "weights": tuple((joint, 1.0) for joint in moved),
    }
    free = Scene(**given, limits=(UNKNOWN,) * plant.nu)
    try:
        used = np.abs([free.nominal_input(t) for t in free.times]).max(axis=0)
        used = np.maximum(used, np.maximum(abs(free.initial[1]), abs(free.target[1])))
    except (PliantError, ValueError):  # the motion is to be said otherwise
        used = np.zeros(plant.nu)
    asked = [float(f"{ROOM * u:.2g}") if u > 1e-9 * used.max(initial=0.0) else 1.0 for u in used]
    told = {joint.input: joint.effort for joint in plant.joints if LEAST < joint.effort < math.inf}
    limits = tuple(told.get(s.name, least) for s, least in zip(plant.inputs, asked))
    effort = tuple((s.name, float(f"{0.1 / limit**2:.2g}")) for s, limit in zip(plant.inputs, limits))
    return Scene(**given, dt=_period(free, len(moved)), limits=limits, effort=effort)


def _period(scene: Scene, joints: int) -> float:
    """A tenth of the period, at the goal with joints free, of the slowest vibration that is not theirs, as 1, 2 or 5
    times a power of ten [s].
    """
    bending = len(scene.plant.rates) - joints
    try:
        found = scene.plant.natural_frequencies(scene.target[0])
    except (PliantError, ValueError):  # no rest that could vibrate
        found = None
    vibrating = [] if found is None or not bending else [w for w in sorted(found)[-bending:] if w > 0]
    longest = min(SLOWEST, max(FASTEST, 2 * math.pi / min(vibrating) / 10)) if vibrating else SLOWEST
    power = 10.0 ** math.floor(math.log10(longest))
    return float(f"{max(step * power for step in (1, 2, 5) if step * power <= longest * (1 + 1e-9)):.3g}")


def _manoeuvre(rest: float, joint: Joint | None) -> tuple[float, float]:
    """Where a coordinate starts and ends: within its joint's range, a quarter of that or MOVED, away from its ends."""
    if joint is None:
        return rest, rest + MOVED
    step = min(MOVED, (joint.upper - joint.lower) / 4)
    start = min(max(rest, joint.lower + step), joint.upper - step)
    goal = start + step if start + 2 * step <= joint.upper else start - step
    return float(f"{start:.6g}"), float(f"{goal:.6g}")


def written(scene: Scene) -> str:
    """The scene's file with a word at each key."""
    lines = [
        "# A scene: what is to be done with a machine. Every command takes this file in place of a scene's name.",
        "# What a key means, and what may stand in it: docs/own_scene.md. Numbers here are guesses: put yours.",
        "",
    ]
    for line in toml_text.dumps(_ordered(to_tables(scene))).splitlines():
        key = line.removeprefix("[").removesuffix("]") if line.startswith("[") else line.split(" = ")[0]
        said = f"  # {SAID[key]}" if key in SAID and not line.endswith("[") else ""
        fits = len(line) + len(said) <= WIDTH
        lines += [line + said] if fits else [said.strip(), line]
    return "\n".join(lines) + "\n"


def _ordered(tables: dict[str, Any]) -> dict[str, Any]:
    """With what a scene leaves at its default written out where a start should show it."""
    return {"name": tables.pop("name"), "about": tables.pop("about"), "dt": SLOWEST, "tolerance": 1e-3} | tables
