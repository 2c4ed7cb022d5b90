"""Joints of a tree: their coordinates, speeds, forces and signals; joints below a base that moves."""
