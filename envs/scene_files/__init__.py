"""Scenes in TOML files: read, written, changed by name; commented starts of one's own."""

from pliant.envs.scenes.registry import READERS

from .scene_file import load, save, text

READERS["toml"] = load

__all__ = ["load", "save", "text"]
