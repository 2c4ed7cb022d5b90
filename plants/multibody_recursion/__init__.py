"""Recursions over a tree of bodies: motions down it, forces and inertia up it."""
