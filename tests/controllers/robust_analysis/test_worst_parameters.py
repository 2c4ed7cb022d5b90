"""The worst parameters of a motion, simulated."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.robust_analysis.worst_parameters import worst_parameters
from pliant.envs import scenes

BOX = {"payload.mass": (0.8, 1.2), "link.E": (1.6e11, 2.6e11)}


@pytest.fixture(scope="module")
def slew():
    scene = scenes.get("single-link-slew")
    t = np.linspace(0.0, 0.6, 31)
    u = np.array([np.atleast_1d(scene.nominal_input(s)) for s in t])
    return scene.plant, scene.plant.simulate(scene.initial[0], u, t)


def test_what_is_returned_is_what_the_plant_does(slew):
    plant, nominal = slew
    worst = worst_parameters(plant, nominal, BOX, ["tip_deflection"])["tip_deflection"]
    mass, E = worst.parameters["payload.mass"], worst.parameters["link.E"]
    # a plant built with these numbers has shape functions of its own
    built = dataclasses.replace(
        plant, payload=dataclasses.replace(plant.payload, mass=mass), link=dataclasses.replace(plant.link, E=E)
    )
    played = built.simulate(nominal.x[0], nominal.u, nominal.t)
    assert np.abs(played["tip_deflection"] - nominal["tip_deflection"]).max() == pytest.approx(worst.miss, rel=0.05)
    assert "or more" in worst.words and 0 <= worst.time <= 0.6


def test_no_random_parameters_get_further(slew):
    plant, nominal = slew
    worst = worst_parameters(plant, nominal, BOX, ["hub_angle"])["hub_angle"]
    varied, rng = plant.vary(*BOX), np.random.default_rng(3)
    ends = np.array(list(BOX.values()))
    for p in rng.uniform(ends[:, 0], ends[:, 1], (10, 2)):
        played = varied.simulate(nominal.x[0], nominal.u, nominal.t, p=p)
        assert np.abs(played["hub_angle"] - nominal["hub_angle"]).max() < worst.miss * (1 + 1e-3)


def test_outputs_that_are_not_there(slew):
    with pytest.raises(ValueError, match="nothing"):
        worst_parameters(slew[0], slew[1], BOX, ["nothing"])
