"""Machines of the named scenes: trees of bodies and what spacecraft carry, with their numbers and sources."""
