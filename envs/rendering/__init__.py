"""Pictures of a scene, in the plane and in space."""

from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleSpacecraft

from .planar import Renderer
from .spatial import SpaceRenderer

__all__ = ["Renderer", "SpaceRenderer", "renderer"]


def renderer(scene: Scene, *, window: bool = False) -> Renderer:
    """What draws the scene: an arm in its plane, a spacecraft in space."""
    if isinstance(scene.plant, FlexibleSpacecraft):
        return SpaceRenderer(scene, window=window)
    return Renderer(scene, window=window)
