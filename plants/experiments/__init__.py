"""Measured motions of a plant, and their files."""
