"""Pictures of a scene, in the plane and in space."""

from .planar import Renderer, renderer
from .spatial import SpaceRenderer

__all__ = ["Renderer", "SpaceRenderer", "renderer"]
