"""The printed Xi_33 softens the sections' rotation by the spin squared: a stable beam then looks unstable."""

import numpy as np
import scipy.linalg

from pliant.plants.beams import legendre_ritz
from pliant.plants.beams.rotating_beam import rotating_frequencies

SHEAR, ROTARY, MASS, INERTIA, OMEGA = 1 / 2000, 0.01, 0.5, 0.2, 3.0


def squares(xi_33):
    """Lowest omega^2 of the rotating Timoshenko beam with Xi_33 of Eq (16) times this factor."""
    shapes = legendre_ritz.StrainShapes.unit(20, 20)
    m, tip, turn = legendre_ritz.matrices(shapes), shapes(1.0), shapes.rotation(1.0)
    moving = m.mass + MASS * np.outer(tip, tip)
    turning = ROTARY * m.rotary + INERTIA * np.outer(turn, turn)
    K = m.bending + m.shearing / SHEAR + OMEGA**2 * (m.tension_beam + MASS * m.tension_uniform - moving)
    return scipy.linalg.eigh(K - xi_33 * OMEGA**2 * turning, moving + turning, eigvals_only=True)[:3]


def test_printed_xi_33_makes_the_first_frequency_imaginary(reference):
    expected = reference("rotating_beam")["timoshenko_check"]["geometrically_exact"]
    assert squares(1.0)[0] < -0.1
    np.testing.assert_allclose(np.sqrt(squares(0.0)), expected, rtol=1e-5)
    ours = rotating_frequencies(
        OMEGA, 3, "lag", theory="timoshenko", tip_mass=MASS, tip_inertia=INERTIA, rotary=ROTARY, shear=SHEAR
    )
    np.testing.assert_allclose(ours, expected, rtol=1e-4)
