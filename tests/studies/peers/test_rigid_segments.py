"""Links lumped into rigid segments."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.rigid_segments import segments, tips

BEAM = machine_of(scenes.get("cantilever-drop"))


def first_frequency(parts):
    """[rad/s] of small oscillations of the clamped chain."""
    chain = segments(BEAM, parts)
    starts = np.cumsum([0.0, *(s.length for s in chain[:-1])])
    M = np.zeros((parts, parts))
    for i, s in enumerate(chain):
        turned = (np.arange(parts) < i).astype(float)  # hinge k turns segment k + 1 and all beyond
        moved = turned * (starts[i] + s.centre - starts[1:])
        M += s.mass * np.outer(moved, moved) + s.inertia * np.outer(turned, turned)
    K = np.diag([s.stiffness for s in chain[1:]])
    return np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real.min())


def test_frequency_of_a_cantilever_to_second_order():
    link = BEAM.links[0]
    exact = 1.875104068711961**2 * np.sqrt(link.EI / (link.linear_density * link.length**4))  # Euler and Bernoulli
    errors = [abs(first_frequency(n) / exact - 1) for n in (4, 8, 16)]
    assert errors[2] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15) and errors[1] / errors[2] == pytest.approx(4, rel=0.15)


def test_masses_and_moments_are_kept():
    scene = scenes.get("two-link-reach")
    machine, parts = machine_of(scene), 3
    chain, plant = segments(machine, parts), scene.plant
    total = plant.link1.mass + plant.link2.mass + plant.joint_mass + plant.payload.mass
    assert sum(s.mass for s in chain) == pytest.approx(total)
    assert [s.driven for s in chain] == [True, *[False] * parts, True, *[False] * parts]
    starts = np.cumsum([0.0, *(s.length for s in chain[:-1])])
    about = sum(s.inertia + s.mass * (x + s.centre) ** 2 for s, x in zip(chain, starts))
    M = plant.physics().mass_matrix(np.zeros(plant.physics().nx))
    assert about == pytest.approx(M[0, 0], rel=1e-9)  # all of it turned about the root


def test_tip_of_bent_segments():
    machine = dataclasses.replace(BEAM, links=(dataclasses.replace(BEAM.links[0], length=2.0),))
    at = tips(segments(machine, 2), np.array([[0.0, np.pi / 2, 0.0]]))
    np.testing.assert_allclose(at, [[0.5, 1.5]], atol=1e-15)
