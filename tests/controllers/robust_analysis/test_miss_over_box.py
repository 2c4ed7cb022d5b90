"""What a motion misses over a box: bounded from above, beside what was simulated."""

import missed_over_boxes
import numpy as np
import pytest

from pliant.controllers.robust_analysis.miss_over_box import _coefficients, _largest, _values, miss_over_box
from pliant.controllers.robust_analysis.worst_parameters import motions_in_box
from pliant.envs import scenes
from pliant.plants.core.errors import PliantError

BOX = {"payload.mass": (0.8, 1.2), "link.E": (1.6e11, 2.6e11)}


@pytest.fixture(scope="module")
def slew():
    plant = scenes.get("single-link-slew").plant
    t = np.linspace(0.0, 0.4, 161)
    return plant, plant.simulate(np.zeros(plant.nx), 2.0 * np.ones((len(t), 1)), t)


def test_a_polynomial_is_bounded_by_its_own_maximum():
    """x^3 + y, x^3 = (3 T1 + T3)/4, is 2 at a corner; 1 - 2 x^2 y^2 = 1/2 - (T2 + T2' + T2 T2')/2 is 1 inside."""
    corner, inside = np.zeros((4, 4, 1)), np.zeros((3, 3, 1))
    corner[1, 0], corner[3, 0], corner[0, 1] = 0.75, 0.25, 1.0
    inside[0, 0], inside[2, 0], inside[0, 2], inside[2, 2] = 0.5, -0.5, -0.5, -0.5
    at = np.array([[0.3, -0.6]])
    assert _values(corner, at)[0, 0] == pytest.approx(0.3**3 - 0.6, rel=1e-12)
    assert _values(inside, at)[0, 0] == pytest.approx(1 - 2 * 0.3**2 * 0.6**2, rel=1e-12)
    for c, largest in ((corner, 2.0), (inside, 1.0)):
        found, where = _largest(c)
        assert largest <= found < 1.01 * largest
        assert abs(_values(c, where[None])[0, 0]) == pytest.approx(largest, rel=0.01)


def test_the_first_degree_is_the_linear_model_with_its_affine_term(slew):
    """d(dx)/dt = A dx + c: the nominal is no motion of the plant with other parameters, and c says by how much."""
    plant, nominal = slew
    varied, middle, h = plant.vary(*BOX), np.array([1.0, 2.1e11]), 1e-4
    box = {n: (m * (1 - h), m * (1 + h)) for n, m in zip(BOX, middle)}
    c = _coefficients(motions_in_box("test", plant, nominal, box, ["hub_angle"], None, 4), 3)
    for i, e in enumerate(np.eye(2)):
        models = (varied.linearize_along(nominal, p=middle * (1 + s * h * e)) for s in (1, -1))
        ends = [model.simulate(np.zeros(plant.nx))[0] for model in models]
        slope = (ends[0] - ends[1])[:, 0] / 2  # of hub_angle, the first state, for one side
        own = c[(1, 0) if i == 0 else (0, 1)][:, 0]
        assert np.abs(own - slope).max() < 2e-3 * np.abs(slope).max()


def test_upper_and_lower_are_close_and_no_motion_gets_past(slew):
    plant, nominal = slew
    found = miss_over_box(plant, nominal, BOX, ["tip_deflection"])["tip_deflection"]
    assert found.lower <= found.upper < 1.01 * found.lower and found.rest < 0.01 * found.lower
    sides = np.random.default_rng(8).uniform(-1, 1, (500, 2))
    missed = motions_in_box("test", plant, nominal, BOX, ["tip_deflection"], None, 10).missed(sides)[..., 0]
    assert np.abs(missed).max() <= found.upper
    assert (missed >= found.tube[:, 0]).all() and (missed <= found.tube[:, 1]).all()
    assert "at most" in found.words and "not shown" in found.words


def test_a_sample_of_the_campaign():
    assert not missed_over_boxes.run(2, 1000)["wrong"]


def test_a_box_over_which_no_polynomial_follows(slew, monkeypatch):
    plant, _ = slew
    monkeypatch.setattr("pliant.controllers.robust_analysis.miss_over_box.MOST_LANES", 16)  # of degree 3
    t = np.linspace(0.0, 2.0, 41)  # many turns of the first mode
    nominal = plant.simulate(np.zeros(plant.nx), 2.0 * np.ones((len(t), 1)), t)
    with pytest.raises(PliantError, match="smaller box"):
        miss_over_box(
            plant, nominal, {"payload.mass": (0.2, 2.0), "link.E": (0.2e11, 4e11)}, ["tip_deflection"], substeps=40
        )


def test_what_is_no_box(slew):
    with pytest.raises(ValueError, match=r"miss_over_box\.box"):
        miss_over_box(*slew, {}, ["tip_deflection"])
    six = ("hub_inertia", "payload.mass", "payload.inertia", "link.E", "link.density", "link.damping")
    with pytest.raises(ValueError, match="at most 5"):
        miss_over_box(*slew, dict.fromkeys(six, (1.0, 2.0)), ["tip_deflection"])
