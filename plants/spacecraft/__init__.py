"""FlexibleSpacecraft: a hub with hinged flexible appendages, wheels, thrusters and the loads of its orbit."""

from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel

from .plant import FlexibleSpacecraft

__all__ = [
    "Appendage",
    "Environment",
    "FlexibleSpacecraft",
    "Hinge",
    "Hub",
    "ModalData",
    "Orbit",
    "Sun",
    "Surface",
    "Thruster",
    "Wheel",
]
