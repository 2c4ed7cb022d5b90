"""Sections of the classical problems of beams of large deflection by their stiffnesses, in the units of the sources."""

from pliant.plants import Beam

SHEARED = {"extensible": True, "theory": "timoshenko"}
WEIGHTLESS = {"gravity": (0.0, 0.0, 0.0)}


def section(length, EI, EA, GA, density, GJ=None):
    """A beam of these stiffnesses, of unit area; without a torsional one GJ = EI."""
    return Beam(
        length=length, area=1.0, I_y=EI / EA, I_z=EI / EA, J=(GJ or EI) / GA, density=density, E=EA, G=GA,
        shear_coefficient=1.0,
    )  # fmt: skip
