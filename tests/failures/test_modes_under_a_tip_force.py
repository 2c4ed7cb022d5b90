"""Natural modes of a free end sum the moment of a tip force as 1/n^3, and no count of them tells how far they are off.

The default shapes of a beam of large deflections carry that moment exactly while it is straight and converge faster
than any power when it is bent.
"""

import dataclasses

import numpy as np
import pytest
from euler_elastica import elastica

from pliant.plants import LargeDeflectionBeam
from pliant.plants.beams import STEEL, Beam
from pliant.plants.large_deflection.declaration import BASES

ROD = Beam.circular(1.0, 0.01, STEEL)
DEFAULT = LargeDeflectionBeam(beam=ROD, gravity=(0.0, 0.0, 0.0))


def error(plant, alpha):
    """Of the tip's place at rest under alpha = F L^2/(E I), of its displacement; Newton on the plant's own shapes."""
    at, shapes = plant.fields.tangents.points, plant.fields.shapes
    psi, w, q = shapes(at.xi), at.weight, np.zeros(shapes.n)
    for load in np.linspace(0.0, alpha, 12)[1:]:
        for _ in range(12):
            theta = psi @ q
            force = shapes.stiffness @ q - load * psi.T @ (w * np.cos(theta))
            q = q - np.linalg.solve(shapes.stiffness + load * psi.T @ ((w * np.sin(theta))[:, None] * psi), force)
    x, y, _ = elastica(alpha)
    return np.hypot(w @ np.cos(psi @ q) - x, w @ np.sin(psi @ q) - y) / np.hypot(1 - x, y)


def test_modes_err_as_one_over_the_cube_of_their_number():
    counts = np.array([3, 4, 6, 8])
    naive = [error(dataclasses.replace(DEFAULT, basis="modes", modes=n), 0.1) for n in counts.tolist()]
    assert np.polyfit(np.log(counts), np.log(naive), 1)[0] == pytest.approx(-2.9, abs=0.15)
    assert naive[0] > 1e-3


@pytest.mark.parametrize("alpha", [0.1, 1.0, 3.0])
def test_the_default_serves_its_own_tip_force_best(alpha):
    for n in (1, 2, 3, 4, 5):
        errors = {basis: error(dataclasses.replace(DEFAULT, basis=basis, modes=n), alpha) for basis in BASES}
        least = max(min(errors.values()), 1e-12)
        assert errors[DEFAULT.rotation_basis] <= 1.05 * least, (n, errors)
    assert error(DEFAULT, alpha) < 2e-5  # three shapes


def test_stiffness_is_its_price():
    """The highest frequency of eight shapes: 555 of modes, 820, and 2586 of plain polynomials."""
    unit = np.sqrt(ROD.EI / ROD.linear_density) / ROD.length**2
    top = {b: dataclasses.replace(DEFAULT, basis=b, modes=8).natural_frequencies()[-1] / unit for b in BASES}
    assert top["modes"] < top["tip-force"] < 1.6 * top["modes"] < top["polynomial"] / 2
