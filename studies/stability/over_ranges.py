"""What a scene's own regulator stands of the ranges that its parameters are drawn from, in one sentence."""

from __future__ import annotations

import math

from pliant.controllers import LQR, stands
from pliant.envs.scenes.scene import Scene
from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.errors import PliantError

from .own_rests import own_rests

RESTS = "(The linear loop from sample to sample, its matrix taken between sampled corners.)"
MOST_STATES = 16  # of a plant whose loop is looked at: a larger one takes more than the second that this may take


def over_ranges(scene: Scene) -> str:
    """Of LQR about the goal, as it is sampled; "" where a scene has no ranges or its goal no such loop.

    Of the linear loop, shown in parts by `stands`: what its state matrix does between corners of a part was measured
    and not shown.

    Example
    -------
    >>> over_ranges(scenes.get("two-link-reach"))
    "LQR about the goal is stable for all payload.mass 0.7 to 1.3 times its own; margin: 3 times these ranges. .."
    """
    require_instance("over_ranges.scene", scene, Scene)
    ranges = [(path, low, high) for path, low, high in scene.randomise if low < high]
    if not ranges or scene.plant.nx > MOST_STATES:
        return ""
    box = {}
    for path, low, high in ranges:
        value = parameters.get(scene.plant, path)
        box[path] = (min(low * value, high * value), max(low * value, high * value))
    try:
        law = LQR.for_scene(scene)
        shown = math.floor(100 * stands(scene.plant, law, box, dict(scene.goal))) / 100
        found = own_rests(scene.plant, law, box, scene.target)
        beyond = own_rests(scene.plant, law, box, scene.target, shown) if shown > 1 else found
    except (PliantError, ValueError):  # no rest, no linear law, or one that reads what the model does not tell
        return ""
    named = ", ".join(f"{path} {low:g} to {high:g} times its own" for path, low, high in ranges)
    if found.worst:
        return f"LQR about the goal is not stable for all {named}: {found.worst}."
    if shown >= 1:
        margin = f"margin: {shown:g} times these ranges"
        if found.moved:
            margin += f", but {beyond.worst}" if beyond.worst else "; at the ends the loop's own rests are stable too"
        return f"LQR about the goal is stable for all {named}; {margin}. {RESTS}"
    told = f"stability is shown for {shown:g} of these ranges" if shown else "stability is shown for no part of them"
    return f"LQR about the goal is not shown to be stable for all {named}: {told}."
