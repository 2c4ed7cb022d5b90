"""Pictures of a scene, in the plane and in space."""

from .planar import Renderer, renderer
from .spatial import SpaceRenderer
from .tree_space import TreeRenderer

__all__ = ["Renderer", "SpaceRenderer", "TreeRenderer", "renderer"]
