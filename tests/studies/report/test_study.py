"""The report of the spacecraft's scenes: every section is made and true; LQR about a goal that moves or spins."""

import dataclasses
import json

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import EquilibriumError
from pliant.plants.motions.time_limit import TooLong, check_time, processor_time, time_left
from pliant.studies import report
from pliant.studies.closed_loop.closed_loop import closed_loop, driven_to_goal, regulator
from pliant.studies.closed_loop.comparison import Contest
from pliant.studies.common import operating_point
from pliant.studies.figures import style
from pliant.studies.report import study as room
from pliant.studies.report.findings import FAULT

SHORT = {"spacecraft-spin": 20.0, "spacecraft-orbit": 240.0}
PICTURES = {"motion", "shapes", "eigenvalues", "stability", "closed_loop", "speed_accuracy", "ladder"}


@pytest.fixture(scope="module")
def drawn_once():
    """Figures go into the page alone: test_report.py looks at the files beside it, which take as long again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", lambda figure, path: path.touch())
        yield


@pytest.fixture(scope="module", params=[pytest.param(name, marks=pytest.mark.campaign) for name in SHORT])
def made(request, drawn_once, tmp_path_factory):
    """A scene, its report's folder and the page's text."""
    scene = scenes.get(request.param, duration=SHORT[request.param])
    page = report(scene, tmp_path_factory.mktemp("reports") / scene.name, budget=0.3)
    return scene, page.parent, page.read_text(encoding="utf-8").replace("&#x27;", "'")


TREES = ("crane-swing", "six-axis-pick", "three-link-flexible", "satellite-arm")
QUICK = pytest.param("flexible-joint-slew", {"duration": 0.4, "move_time": 0.2})


@pytest.mark.parametrize(
    ("name", "shorter"), [QUICK, *(pytest.param(name, {}, marks=pytest.mark.campaign) for name in TREES)]
)
def test_every_section_of_a_tree_is_made(name, shorter, drawn_once, tmp_path):
    """Nothing is lost by a fault, and what is drawn is said."""
    page = report(scenes.get(name, **shorter), tmp_path / name, budget=0.3)
    text, told = page.read_text(encoding="utf-8"), json.loads((tmp_path / name / "report.json").read_text())
    assert text.count("<h2>") == 11 and not [why for why in told["lost"].values() if FAULT in why]
    pictures = {path.stem for path in page.parent.glob("*.png")}
    assert pictures >= {"motion", "shapes", "tip_path", "eigenvalues", "stability", "speed_accuracy", "ladder"}
    if shorter:
        assert not told["lost"] and "effects" not in pictures  # it has no effect that could be left out
        assert "rigid, elastic joints (4 states) is the plant&#x27;s only variant" in text


def table(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def test_every_section_is_made(made):
    scene, folder, text = made
    pictures = {path.stem for path in folder.glob("*.png")}
    effects = set() if scene.name == "spacecraft-orbit" else {"effects"}  # what its rigid model lacks is not told apart
    assert pictures >= PICTURES | effects and "tip_path" not in pictures
    assert text.count("<figure") == len(pictures) and text.count("<h2>") == 11
    assert '<div id="arm">' not in text and "homogeneous box" in text
    assert ("The goal moves, hinge1_1 by 0.0011 1/s and hinge2_1 by -0.0011 1/s" in text) == bool(scene.goal_rates)
    assert "millimetres" not in text and ("attitude_y [1]" in text) == (scene.name == "spacecraft-orbit")


def test_lqr_is_stable_on_every_plant(made):
    scene, folder, _ = made
    found = table(folder, "closed_loop")
    assert found["failure"] is None and all(loop["stable"] for loop in found["loops"])
    assert not any(name.startswith(("quaternion", "q_")) for name in found["reads"])
    assert ("attitude_z" in found["reads"]) == (scene.name != "spacecraft-spin")
    assert found["loops"][0]["cost"] < found["open_loop_cost"]


def test_linear_model_along_the_motion_predicts(made):
    scene, folder, _ = made
    found = table(folder, "linearization_along")
    (_, first, size), (_, second, _) = (e.values() for e in found["prediction_errors"])
    assert found["perturbed"] in operating_point.coordinates(scene.plant) and size > 1e-6
    assert first < 0.1 * size and first / second > 50  # second order or higher


@pytest.mark.campaign
def test_following_keeps_up_with_the_goal():
    """Over an orbit the panels turn once; without following, the regulator pulls them back to where they began."""
    scene = scenes.get("spacecraft-orbit", duration=5712.0)
    law = regulator(scene)
    assert driven_to_goal(scene)[-2:] == ("hinge1_1", "hinge2_1")
    options = {"method": "cvodes", "rtol": 1e-7, "atol": 1e-9}
    motion = scene.plant.simulate(scene.initial[0], law, scene.times, **options)
    naive = scene.plant.simulate(scene.initial[0], dataclasses.replace(law, drift=None), scene.times, **options)
    turned = 1.1e-3 * motion.t[-1]
    assert motion["hinge1_1"][-1] == pytest.approx(turned, abs=0.01)
    assert motion["hinge2_1"][-1] == pytest.approx(-turned, abs=0.01)
    assert abs(naive["hinge1_1"][-1] - turned) > 5.0
    assert scene.cost(motion) < 0.1 * scene.cost(naive)
    for c in "xyz":  # less than the start by far; the turning panels and the gravity gradient keep some
        assert np.abs(motion[f"attitude_{c}"][-100:]).max() < 0.01


@pytest.mark.campaign
def test_slew_from_any_attitude_is_brought_to_the_goal():
    """40 degrees about an axis out of all planes, with 12 more degrees of freedom in the plant than are read."""
    scene = scenes.get("spacecraft-slew")
    half, axis = np.deg2rad(20.0), np.array([0.48, 0.6, 0.64])
    start = tuple(zip([f"quaternion_{k}" for k in range(4)], [np.cos(half), *(np.sin(half) * axis)]))
    _, loops = closed_loop(dataclasses.replace(scene, start=start))
    assert [loop.stable for loop in loops] == [True] * 4 and max(loop.final_error for loop in loops) < 1e-3
    assert loops[-1].states == scene.plant.nx + 12


def test_a_goal_that_moves_in_another_way_is_refused():
    scene = scenes.get("spacecraft-orbit")
    with pytest.raises(EquilibriumError, match=r"hinge1_1 changes by 0\.0011 rad/s"):
        regulator(dataclasses.replace(scene, goal_rates=()))


def test_a_part_that_takes_too_long_is_lost_alone():
    """Its share of the time over, and no more: what comes after has its own."""

    def endless():
        while True:
            check_time()

    until = processor_time() + 8.0  # a quarter of it, and of a second what is late
    with pytest.raises(TooLong, match="its time was over"):
        room.in_its_time("law", endless, until - 7.0)()
    assert processor_time() < until and 6.0 < room.in_its_time("goal", time_left, until)() < 8.0
    assert room.in_its_time("contests", time_left, until)() < 2.0
    assert room.in_its_time("physics", time_left, until - 100.0)() > 19.0


def test_motions_whose_physics_takes_too_long_are_not_asked_for(monkeypatch):
    scene = scenes.get("single-link-slew", duration=1.2)
    contests = [Contest(name, "plant", 4, motion=scene.open_loop()) for name in ("LQR", "MPC")]
    monkeypatch.setattr(room, "physics_motion", lambda motions, tolerance: check_time())
    had, unasked = room._closed_loops(scene, contests, 60.0)
    assert len(had) == 2 and not unasked
    assert room._closed_loops(scene, contests, -1.0) == ([], ["LQR", "MPC"])
