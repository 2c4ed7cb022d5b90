"""Trees of rigid and flexible bodies: any machine with joints and no closed loop."""

from pliant.plants.multibody_parts.joint import ElasticJoint, Frame, FrameThruster, Joint, Sliding
from pliant.plants.multibody_parts.tree_body import TreeBody

from .tree import FlexibleTree

__all__ = ["ElasticJoint", "FlexibleTree", "Frame", "FrameThruster", "Joint", "Sliding", "TreeBody"]
