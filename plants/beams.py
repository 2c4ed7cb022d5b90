"""Uniform beams, rigid payloads, and the shape functions by which a beam bends.

A beam lies along x and bends in the x-y plane about z. Stress is E (strain + damping strain rate), so that
`damping` is a time in seconds (Kelvin and Voigt). A field may be a CasADi expression: that is how a parameter
becomes an input.
"""

from __future__ import annotations

import math
import numbers
from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca
import numpy as np

from pliant.plants.basis import BASES, Basis, Polynomials, basis
from pliant.plants.modes import BOUNDARIES, ModeShapes, count_loaded, loaded_roots, roots, shapes
from pliant.plants.offset_payload import OffsetPayload, PayloadModes, clamped_payload_roots
from pliant.plants.parameters import is_symbolic, quantity, require_choice, validate
from pliant.plants.rotating import rotating_frequencies

__all__ = [
    "ALUMINIUM",
    "BASES",
    "BOUNDARIES",
    "STEEL",
    "Basis",
    "Beam",
    "Material",
    "ModeShapes",
    "OffsetPayload",
    "Payload",
    "PayloadModes",
    "Polynomials",
    "basis",
    "clamped_payload_roots",
    "count_loaded",
    "coupled_frequencies",
    "frequencies",
    "loaded_roots",
    "roots",
    "rotating_frequencies",
    "shapes",
]


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
    E: Any = quantity("Pa", "positive")
    G: Any = quantity("Pa", "positive")
    damping: Any = quantity("s", "nonnegative", 0.0)

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
    E: Any = quantity("Pa", "positive")
    G: Any = quantity("Pa", "positive")
    damping: Any = quantity("s", "nonnegative", 0.0)
    shear_coefficient: Any = quantity("1", "positive", 5 / 6)

    def __post_init__(self) -> None:
        validate(self)

    @classmethod
    def rectangular(cls, length: Any, width: Any, depth: Any, material: MaterialLike) -> Beam:
        """A solid rectangle: width along z, depth along y [m].

        J = a b^3 (1/3 - 64 b/(pi^5 a) sum over odd n of tanh(n pi a/(2 b))/n^5), a >= b the sides (Timoshenko
        and Goodier, "Theory of Elasticity", section 109). The sum with 1 for tanh is 31 zeta(5)/32; its
        difference from that converges to rounding in four terms.
        """
        _positive("Beam.rectangular", width=width, depth=depth)
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
        _positive("Beam.circular", diameter=diameter)
        I = math.pi * diameter**4 / 64
        return cls._of(material, length, math.pi * diameter**2 / 4, I, I, 2 * I, _round(material, 0.0))

    @classmethod
    def tube(cls, length: Any, outer: Any, inner: Any, material: MaterialLike) -> Beam:
        """A circular tube of outer and inner diameter [m]."""
        _positive("Beam.tube", outer=outer, inner=inner)
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


def _positive(owner: str, **lengths: Any) -> None:
    """Raise ValueError unless every length [m] is positive or symbolic."""
    for name, value in lengths.items():
        if not is_symbolic(value) and not (isinstance(value, numbers.Real) and 0 < float(value) < math.inf):
            raise ValueError(f"{owner} {name} = {value!r} must be > 0 [m]")


@dataclass(frozen=True)
class Payload:
    """A rigid body at the tip of a beam.

    `inertia` is the moment about every axis through the mass centre, or a 3 x 3 nested tuple about the mass
    centre in the axes of the beam's tip. `offset` points from the tip to the mass centre.
    """

    mass: Any = quantity("kg", "nonnegative", 0.0)
    inertia: Any = quantity("kg m^2", "finite", 0.0)
    offset: Any = quantity("m", "finite", (0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        for name in ("inertia", "offset"):
            object.__setattr__(self, name, _as_tuple(getattr(self, name)))
        validate(self)
        if not isinstance(self.offset, tuple) or len(self.offset) != 3:
            raise ValueError(f"Payload.offset = {self.offset!r} must be three numbers [m]")
        if isinstance(self.inertia, tuple):
            _check_inertia(self.inertia)
        elif not is_symbolic(self.inertia) and self.inertia < 0:
            raise ValueError(f"Payload.inertia = {self.inertia!r} must be >= 0 [kg m^2]")

    @property
    def inertia_z(self) -> Any:
        """Moment of inertia [kg m^2] about z through the mass centre."""
        return self.inertia[2][2] if isinstance(self.inertia, tuple) else self.inertia


def _as_tuple(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(_as_tuple(v) for v in value) if isinstance(value, (list, tuple)) else value


def _check_inertia(inertia: tuple[Any, ...]) -> None:
    """Raise ValueError unless a numeric inertia is one that a rigid body can have."""
    if len(inertia) != 3 or any(not isinstance(row, tuple) or len(row) != 3 for row in inertia):
        raise ValueError(f"Payload.inertia = {inertia!r} must be a number or 3 x 3 [kg m^2]")
    if any(is_symbolic(item) for row in inertia for item in row):
        return
    tensor = np.array(inertia, dtype=float)
    slack = 1e-9 * np.abs(tensor).max()
    if np.abs(tensor - tensor.T).max() > slack:
        raise ValueError(f"Payload.inertia = {inertia!r} must be symmetric [kg m^2]")
    principal = np.linalg.eigvalsh(tensor)
    if principal[0] < -slack:
        raise ValueError(f"Payload.inertia = {inertia!r} must have principal moments >= 0 [kg m^2]")
    if principal[0] + principal[1] < principal[2] - slack:
        raise ValueError(
            f"Payload.inertia = {inertia!r} must have no principal moment above the sum of the others "
            f"[kg m^2]; for planar motion give the scalar moment about z"
        )


def frequencies(beam: Beam, n: int, boundary: str = "clamped-free", payload: Payload | None = None) -> np.ndarray:
    """The lowest n natural frequencies [rad/s] (n,) of bending in the x-y plane.

    omega = beta^2 sqrt(EI/(rho A L^4)). A payload needs boundary "clamped-free"; its offset must lie in the
    x-y plane, else bending and torsion couple.
    """
    require_choice("frequencies", "boundary", boundary, BOUNDARIES)
    scale = math.sqrt(beam.EI / beam.linear_density) / beam.length**2
    if payload is None:
        return scale * roots(boundary, n) ** 2
    require_choice("frequencies", "boundary", boundary, ("clamped-free",))
    x, y, z = payload.offset
    if z != 0:
        raise ValueError(f"Payload.offset[2] = {z!r} must be 0 [m]: it couples bending with torsion")
    about_tip = payload.inertia_z + payload.mass * (x * x + y * y)
    beta = loaded_roots(
        n,
        payload.mass / beam.mass,
        about_tip / (beam.mass * beam.length**2),
        payload.mass * x / (beam.mass * beam.length),
    )
    return scale * beta**2


def coupled_frequencies(beam: Beam, n: int, payload: Payload) -> np.ndarray:
    """The lowest n frequencies [rad/s] (n,) of the clamped beam in bending about z and torsion, none missed."""
    scale = math.sqrt(beam.EI / beam.linear_density) / beam.length**2
    return scale * OffsetPayload.of(beam, payload).roots(n) ** 2
