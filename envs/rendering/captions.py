"""What stands in the upper left corner of a picture."""

from __future__ import annotations

from pliant.envs.scenes.scene import Scene


def caption(scene: Scene, magnification: int = 1) -> str:
    """The scene, its model, and how many times as large as they are deflections are drawn."""
    return f"{scene.name}\n{scene.plant.label}\ndeflections x {magnification}"
