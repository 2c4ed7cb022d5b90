"""Uniform beams: length, cross-section, material.

A beam lies along x and bends in the x-y plane about z. Stress is E (strain + damping strain rate), so that
`damping` is a time in seconds (Kelvin and Voigt). A field may be a CasADi expression: that is how a parameter
becomes an input.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca

from pliant.plants.core.argument_gates import shown
from pliant.plants.core.parameters import is_symbolic, number_or_symbol, quantity, validate


class MaterialLike(Protocol):
    """Anything that says density [kg/m^3], E and G [Pa] and damping [s]."""

    @property
    def density(self) -> Any: ...
    @property
    def E(self) -> Any: ...
    @property
    def G(self) -> Any: ...
    @property
    def damping(self) -> Any: ...


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic elastic material with Kelvin-Voigt damping."""

    density: Any = quantity("kg/m^3", "positive")
    E: Any = quantity("Pa", "positive", uncertain=True)
    G: Any = quantity("Pa", "positive")
    damping: Any = quantity("s", "nonnegative", 0.0, uncertain=True)

    def __post_init__(self) -> None:
        validate(self)


STEEL = Material(density=7850.0, E=210e9, G=81e9)  # EN 1993-1-1:2005, 3.2.6; EN 1991-1-1:2002, Table A.4
ALUMINIUM = Material(density=2700.0, E=70e9, G=27e9)  # EN 1999-1-1:2007, 3.2.5


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A uniform beam: its length, cross-section and material.

    I_z resists bending in the x-y plane and I_y in x-z; J is the torsion constant, which equals the polar
    moment I_y + I_z for circular sections only. The shear coefficient counts in Timoshenko's theory only; 5/6 is
    Reissner's for a rectangle, and a section made here has Cowper's, "The shear coefficient in Timoshenko's beam
    theory" (1966).
    """

    length: Any = quantity("m", "positive")
    area: Any = quantity("m^2", "positive")
    I_y: Any = quantity("m^4", "positive")
    I_z: Any = quantity("m^4", "positive")
    J: Any = quantity("m^4", "positive")
    density: Any = quantity("kg/m^3", "positive")
    E: Any = quantity("Pa", "positive", uncertain=True)
    G: Any = quantity("Pa", "positive")
    damping: Any = quantity("s", "nonnegative", 0.0, uncertain=True)
    shear_coefficient: Any = quantity("1", "positive", 5 / 6)

    def __post_init__(self) -> None:
        validate(self)

    @property
    def half_depth(self) -> float:
        """Distance [m] of the outer fibre from the neutral axis z, taken as in a rectangle: sqrt(3 I_z/A)."""
        return math.sqrt(3 * self.I_z / self.area)

    @classmethod
    def rectangular(cls, length: Any, width: Any, depth: Any, material: MaterialLike) -> Beam:
        """A solid rectangle: width along z, depth along y [m].

        J = a b^3 (1/3 - 64 b/(pi^5 a) sum over odd n of tanh(n pi a/(2 b))/n^5), a >= b the sides (Timoshenko
        and Goodier, "Theory of Elasticity", section 109). The sum with 1 for tanh is 31 zeta(5)/32; its
        difference from that converges to rounding in four terms.
        """
        width, depth = _positive("Beam.rectangular", width=width, depth=depth)
        _require_material("Beam.rectangular", material)
        symbolic = is_symbolic(width) or is_symbolic(depth)
        a = ca.fmax(width, depth) if symbolic else max(width, depth)
        b = ca.fmin(width, depth) if symbolic else min(width, depth)
        decay = (ca if symbolic else math).exp(-math.pi * a / b)
        missing = sum(2 * decay**n / ((1 + decay**n) * n**5) for n in (1, 3, 5, 7))
        total = 31 / 32 * 1.0369277551433699 - missing
        J = a * b**3 * (1 / 3 - 64 * b / (math.pi**5 * a) * total)
        nu = material.E / (2 * material.G) - 1
        kappa = 10 * (1 + nu) / (12 + 11 * nu)
        return cls._of(material, length, width * depth, depth * width**3 / 12, width * depth**3 / 12, J, kappa)

    @classmethod
    def circular(cls, length: Any, diameter: Any, material: MaterialLike) -> Beam:
        """A solid circle of this diameter [m]."""
        (diameter,) = _positive("Beam.circular", diameter=diameter)
        _require_material("Beam.circular", material)
        I = math.pi * diameter**4 / 64
        return cls._of(material, length, math.pi * diameter**2 / 4, I, I, 2 * I, _round(material, 0.0))

    @classmethod
    def tube(cls, length: Any, outer: Any, inner: Any, material: MaterialLike) -> Beam:
        """A circular tube of outer and inner diameter [m]. ValueError where the inner is not below the outer."""
        outer, inner = _positive("Beam.tube", outer=outer, inner=inner)
        _require_material("Beam.tube", material)
        if not (is_symbolic(outer) or is_symbolic(inner)) and inner >= outer:
            raise ValueError(f"Beam.tube inner = {inner!r} must be > 0 and < outer = {outer!r} [m]")
        area = math.pi * (outer - inner) * (outer + inner) / 4
        I = area * (outer**2 + inner**2) / 16
        return cls._of(material, length, area, I, I, 2 * I, _round(material, inner / outer))

    @classmethod
    def _of(cls, material: MaterialLike, length: Any, area: Any, I_y: Any, I_z: Any, J: Any, kappa: Any) -> Beam:
        return cls(
            length=length,
            area=area,
            I_y=I_y,
            I_z=I_z,
            J=J,
            density=material.density,
            E=material.E,
            G=material.G,
            damping=material.damping,
            shear_coefficient=kappa,
        )

    @property
    def linear_density(self) -> Any:
        """rho A [kg/m]."""
        return self.density * self.area

    @property
    def mass(self) -> Any:
        """rho A L [kg]."""
        return self.linear_density * self.length

    @property
    def section_ratios(self) -> dict[str, float]:
        """{"rotary": I_z/(A L^2), "shear": E I_z/(kappa G A L^2)} [-], in bending in x-y: Timoshenko's theory."""
        square = self.length**2
        return {"rotary": self.I_z / self.area / square, "shear": self.EI / self.shear_stiffness / square}

    @property
    def EI(self) -> Any:
        """Stiffness E I_z [N m^2] of bending in the x-y plane."""
        return self.E * self.I_z

    @property
    def GJ(self) -> Any:
        """Stiffness G J [N m^2] of torsion."""
        return self.G * self.J

    @property
    def shear_stiffness(self) -> Any:
        """kappa G A [N]."""
        return self.shear_coefficient * self.G * self.area

    @property
    def polar_moment(self) -> Any:
        """I_y + I_z [m^4]; density times it is the section's inertia about x."""
        return self.I_y + self.I_z


def _round(material: MaterialLike, m: Any) -> Any:
    """Cowper's shear coefficient of a circular tube, inner over outer diameter m."""
    nu = material.E / (2 * material.G) - 1
    return 6 * (1 + nu) * (1 + m * m) ** 2 / ((7 + 6 * nu) * (1 + m * m) ** 2 + (20 + 12 * nu) * m * m)


def _positive(owner: str, **lengths: Any) -> list[Any]:
    """Every length [m], positive or symbolic."""
    return [number_or_symbol(f"{owner} {name}", value, "positive", "m") for name, value in lengths.items()]


def _require_material(owner: str, material: Any) -> None:
    if not all(hasattr(material, name) for name in ("density", "E", "G", "damping")):
        raise ValueError(f"{owner} material = {shown(material)} must be a Material, or have density, E, G and damping")
