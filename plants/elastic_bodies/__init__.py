"""Bodies that bend in a tree: beams of small slopes, beams of exact rotations, bodies given by their modes."""
