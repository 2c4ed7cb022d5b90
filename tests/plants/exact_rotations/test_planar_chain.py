"""A plant's machine as links in a plane: what it says agrees with its equations."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import FlexibleSpacecraft, LargeDeflectionBeam, SingleLinkArm, SliderCrank, TwoLinkArm
from pliant.plants.exact_rotations.planar_chain import PlanarChain


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach", "spin-up"])
def test_moment_of_inertia_about_the_root_is_the_plants(name):
    plant = scenes.get(name).plant.physics()
    chain, start, found = plant.planar_chain, 0.0, 0.0
    for i, (link, hub) in enumerate(zip(chain.links, chain.hub_inertia, strict=True)):
        found += hub + link.mass * (start**2 + start * link.length + link.length**2 / 3)
        found += link.density * link.I_z * link.length * chain.sheared
        start += link.length
        found += (i < len(chain.links) - 1) * chain.joint_mass * start**2
    found += chain.payload.mass * start**2 + chain.payload.inertia_z
    assert found == pytest.approx(plant.mass_matrix(np.zeros(plant.nx))[0, 0], rel=1e-9)
    assert set(chain.turning) <= {s.name for s in plant.states} and len(chain.links) == len(chain.friction)


def test_roots():
    assert TwoLinkArm.textbook().planar_chain.turning == ("theta1", "theta2")
    assert scenes.get("spin-up").plant.planar_chain.root == "motion"
    beam = LargeDeflectionBeam.textbook()
    assert beam.planar_chain.root == "clamped" and beam.planar_chain.gravity == (0.0, -9.8)
    assert dataclasses.replace(beam, root="driven").planar_chain.root == "motion"


@pytest.mark.parametrize(
    "plant, words",
    [
        (FlexibleSpacecraft.textbook(), "hub in space"),
        (SliderCrank.textbook(), "closed loop"),
        (dataclasses.replace(LargeDeflectionBeam.textbook(), planar=False), "planar = False"),
        (dataclasses.replace(LargeDeflectionBeam.textbook(), root="hinged"), "hinged"),
        (dataclasses.replace(SingleLinkArm.textbook(), hub_radius=0.1), "off the hub"),
    ],
)
def test_what_is_none_says_why(plant, words):
    assert not isinstance(plant.planar_chain, PlanarChain) and words in plant.planar_chain
