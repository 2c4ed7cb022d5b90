"""What beams in a tree have alike, of small slopes and of exact rotations."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import beams
from pliant.plants.beams.section import Beam
from pliant.plants.elastic_bodies.beam_body import family_signals
from pliant.plants.elastic_bodies.bent_beam import BentBeam
from pliant.plants.elastic_bodies.strain_beam import StrainBeam
from pliant.plants.multibody_parts.tree_beam import TreeBeam

BEAM = Beam.rectangular(2.0, 0.02, 0.01, beams.ALUMINIUM)
STRAIGHT = TreeBeam(BEAM, (1, 1, 1, 1), "polynomial", True)


@pytest.mark.parametrize("kind", [BentBeam, StrainBeam])
def test_line(kind):
    """From the root to where `readings` has the end, sqrt(5) times the coordinate of x^2 for small ones."""
    body, eta = kind(STRAIGHT), np.array([0.002, -0.003, 0.1, 1e-4])
    line = np.array(ca.DM(body.line(ca.SX(ca.DM(eta)), 7))).T
    assert line.shape == (7, 3)
    np.testing.assert_allclose(line[0], 0.0, atol=1e-15)
    np.testing.assert_allclose(line[-1, 1:], np.sqrt(5) * eta[:2], rtol=2e-4)
    read = [float(ca.DM(e)) for e in body.readings(ca.SX(ca.DM(eta)), ca.SX.zeros(4))]
    np.testing.assert_allclose(line[-1, 1:], read[:2], rtol=1e-12)


@pytest.mark.parametrize("kind", [BentBeam, StrainBeam])
def test_dissipation_is_half_the_power_of_the_viscous_forces(kind):
    body = kind(dataclasses.replace(STRAIGHT, beam=dataclasses.replace(BEAM, damping=0.01)))
    rate, still = ca.SX(ca.DM([0.1, -0.2, 0.3, 0.01])), ca.SX.zeros(4)
    lost = float(ca.DM(ca.dot(rate, body.resistance(still, rate) - body.resistance(still, still))))
    assert lost > 0
    np.testing.assert_allclose(float(ca.DM(body.dissipation(rate))), lost / 2, rtol=1e-12)


def test_coordinates():
    assert [s.unit for s in family_signals((1, 1, 1, 1))] == ["m", "m", "rad", "m"]
