"""Natural frequencies of a uniform cantilever that rotates steadily on a hub.

[K + gamma^2 (G - c M_w)] a = omega^2 M a: K strain, G the tension of the centrifugal force, M_w the mass at w,
c = 1 in the plane of rotation ("lag") and 0 across it ("flap").

Scale    frequencies and gamma in sqrt(E I/(rho A L^4)); the other numbers as in `legendre_ritz`
Valid    uniform, untwisted, inextensible; steady spin, so that Coriolis forces couple only through stretch
Source   "On the dynamic modelling of flexible manipulators", Eqs (13)-(16), corrected: Xi_33 is zero in the plane.
         Across it a section tilted by psi keeps -gamma^2 rotary psi^2/2 of the spin's energy
"""

from __future__ import annotations

import math

import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_number
from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_choice, require_count

from . import legendre_ritz

PLANES = ("flap", "lag")
THEORIES = ("euler-bernoulli", "timoshenko")
MOST_FREQUENCIES = 60
FASTEST = 1e4  # gamma


def rotating_frequencies(
    gamma: float,
    n: int,
    plane: str = "flap",
    stiffened: bool = True,
    *,
    theory: str = "euler-bernoulli",
    tip_mass: float = 0.0,
    tip_inertia: float = 0.0,
    hub_radius: float = 0.0,
    rotary: float = 0.0,
    shear: float = 0.0,
) -> np.ndarray:
    """The lowest n dimensionless frequencies (n,), ascending; -sqrt(|omega^2|) where omega^2 < 0 is unstable.

    gamma: the speed over sqrt(E I/(rho A L^4)). tip_mass/(rho A L), tip_inertia/(rho A L^3) the same about every axis,
    hub_radius/L. `rotary` = I/(A L^2) and
    `shear` = E I/(kappa G A L^2) need theory "timoshenko". ValueError names a bad argument.

    Example
    -------
    >>> rotating_frequencies(12.0, 2, plane="lag").round(3)
    array([ 5.427, 35.637])
    """
    require_choice("rotating_frequencies", "plane", plane, PLANES)
    require_choice("rotating_frequencies", "theory", theory, THEORIES)
    n = require_count("rotating_frequencies", "n", n, 0, MOST_FREQUENCIES)
    gamma, tip_mass, tip_inertia, hub_radius, rotary, shear = (
        require_number(f"rotating_frequencies.{name}", value, least=0.0, most=top)
        for name, value, top in (
            ("gamma", gamma, FASTEST),
            ("tip_mass", tip_mass, 1e6),
            ("tip_inertia", tip_inertia, 1e6),
            ("hub_radius", hub_radius, 1e6),
            ("rotary", rotary, 1.0),
            ("shear", shear, 10.0),
        )
    )
    stiffened = require_flag("rotating_frequencies.stiffened", stiffened)
    sheared = theory == "timoshenko"
    if not sheared and (rotary or shear):
        raise ValueError(
            f"rotating_frequencies.theory = {theory!r} must be 'timoshenko' where rotary or shear is not 0"
        )
    layer = math.ceil(4 * math.sqrt(gamma * math.sqrt(1 + hub_radius)))  # at the root, thin in fast spin
    size = min(legendre_ritz.MOST, legendre_ritz.enough(n) + layer)
    shapes = legendre_ritz.StrainShapes.unit(size, size if shear else 0)
    found = legendre_ritz.matrices(shapes)
    tip, turn = shapes(1.0), shapes.rotation(1.0)
    moving = found.mass + tip_mass * np.outer(tip, tip)
    K = found.bending + (found.shearing / shear if shear else 0.0)
    if stiffened:
        K = K + gamma**2 * (
            found.tension_beam + hub_radius * found.tension_hub + tip_mass * (1 + hub_radius) * found.tension_uniform
        )
    if plane == "lag":
        K = K - gamma**2 * moving
    else:
        K = K - gamma**2 * rotary * found.rotary
    M = moving + rotary * found.rotary + tip_inertia * np.outer(turn, turn)
    squares = _lowest(K, M, n)
    return np.sign(squares) * np.sqrt(np.abs(squares))


def _lowest(K: np.ndarray, M: np.ndarray, n: int) -> np.ndarray:
    """Lowest n eigenvalues of (K, M), the inverses of eigenvalues of (M, K + shift M): M decays fast in this basis.

    The shift makes K definite where spin has not.
    """
    shift = 0.0
    while True:
        try:
            above = 1 / linalg.eigh(M, K + shift * M, eigvals_only=True)[::-1][:n]
            return above - shift
        except np.linalg.LinAlgError:
            shift = 4 * shift if shift else 1.0
