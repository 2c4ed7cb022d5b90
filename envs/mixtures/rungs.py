"""A scene played by other models of its machine: found by a word, with what makes them exchangeable checked."""

from __future__ import annotations

import dataclasses

from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.envs.simulation.control_period import enough_substeps
from pliant.plants import Plant
from pliant.plants.core.signals import names

OWN = "own"
ALIKE = ("inputs", "disturbances")  # signals that lanes of all models must share, in order


def plant_of(scene: Scene, word: str) -> Plant:
    """The model that a word names: "own", a label of the ladder, or the words before a label's first comma.

    Of several that begin so, the one whose number of states is nearest to that of the scene's own plant, which comes
    first where it is one of them. ValueError for other words.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> slew = scenes.get("single-link-slew")
    >>> [plant_of(slew, word).label for word in ("rigid", "linear", "stiffened, payload 3", "own")]
    ['rigid', 'linear, payload 2', 'stiffened, payload 3', 'stiffened, payload 2']
    """
    own = scene.plant
    rungs = (own, *(plant for plant in own.ladder() if plant.label != own.label))
    exact = [plant for plant in rungs if plant.label == word or (word == OWN and plant is own)]
    alike = exact or [plant for plant in rungs if plant.label.split(",")[0] == word]
    if not alike:
        labels = ", ".join(repr(plant.label) for plant in rungs)
        raise ValueError(
            f"Task.fidelities: {word!r} must be {OWN!r}, or a label of scene {scene.name!r} or its first words: "
            f"{labels}"
        )
    return min(alike, key=lambda plant: abs(plant.nx - own.nx))


def scene_on(scene: Scene, plant: Plant) -> Scene:
    """The scene on another model, with as many substeps as that takes. ValueError where it is not of the same inputs,
    disturbances and named signals, or has other values of the parameters that the scene draws.
    """
    kept = _scenes_on(scene)
    if plant not in kept:
        kept[plant] = _made(scene, plant)
    return kept[plant]


@once_per_scene
def _scenes_on(scene: Scene) -> dict[Plant, Scene]:
    return {scene.plant: scene}


def _made(scene: Scene, plant: Plant) -> Scene:
    for kind in ALIKE:
        want, have = names(getattr(scene.plant, kind)), names(getattr(plant, kind))
        if want != have:
            raise ValueError(
                f"Task.fidelities: {plant.label!r} has the {kind} {have}, must have those of scene {scene.name!r}: "
                f"{want}"
            )
    found = dataclasses.replace(scene, plant=plant)
    drawn = zip(scene.varied_plant.varied, scene.varied_plant.nominal_parameters, found.varied_plant.nominal_parameters)
    for name, want, have in drawn:  # lanes of all models get the same values, drawn about the scene's own
        if want != have:
            raise ValueError(
                f"Task.fidelities: {plant.label!r} has {name} = {have:g}, which scene {scene.name!r} draws about its "
                f"own {want:g}; must have that"
            )
    return enough_substeps(found)
