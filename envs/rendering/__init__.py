"""Pictures of a scene, in the plane and in space."""
