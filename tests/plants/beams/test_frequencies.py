"""Frequencies of plain and loaded beams."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from evidence import agrees

from pliant.plants import beams
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import STEEL, Beam

REFERENCE = Path(__file__).parents[2] / "reference"


def test_frequencies_of_plain_and_loaded_beams():
    beam = Beam.rectangular(1.0, 0.04, 0.002, STEEL)
    first = 1.875104068711961**2 * math.sqrt(beam.EI / (7850 * 8e-5))
    agrees(
        beams.frequencies(beam, 3)[0],
        first,
        within=1e-14,
        of="beams.frequencies",
        what="first of a clamped beam",
        source="cos + sech = 0, Blevins (1979), table 8-1",
        kind="closed form",
    )
    heavy = Payload(mass=1e6 * beam.mass)
    assert beams.frequencies(beam, 1, payload=heavy)[0] == pytest.approx(math.sqrt(3 * beam.EI / heavy.mass), rel=1e-6)
    cases = json.loads((REFERENCE / "offset_payload.json").read_text())["cases"]
    exact = float(cases["ii_Mt1"]["lambda"][1]) ** 2 * math.sqrt(beam.EI / beam.linear_density)
    loaded = beams.frequencies(beam, 2, payload=Payload(mass=beam.mass))
    assert loaded[1] == pytest.approx(exact, rel=1e-11)
    along = beams.frequencies(beam, 2, payload=Payload(mass=beam.mass, offset=(0.1, 0.0, 0.0)))
    assert np.all(along < loaded)


def test_coupled_frequencies_have_units():
    """A heavy body on a short arm across a thin tube turns it: omega^2 = G J/(L I_xx), torsion alone."""
    tube = Beam.tube(0.5, 0.01, 0.009, STEEL)
    disc = Payload(mass=0.0, inertia=((1.0, 0, 0), (0, 0.5, 0), (0, 0, 0.5)))
    first = beams.coupled_frequencies(tube, 1, disc)[0]
    agrees(
        first,
        math.sqrt(tube.GJ / tube.length / 1.0),
        within=1e-4,
        of="beams.coupled_frequencies",
        what="torsion with a disc",
        source="omega^2 = G J/(L I)",
        kind="closed form",
    )
    plain = beams.coupled_frequencies(tube, 1, Payload())
    np.testing.assert_allclose(plain, beams.frequencies(tube, 1), rtol=1e-14)
    centred = Payload(mass=0.3, inertia=1e-9)
    np.testing.assert_allclose(
        beams.coupled_frequencies(tube, 2, centred), beams.frequencies(tube, 2, payload=centred), rtol=1e-12
    )
