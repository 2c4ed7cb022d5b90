"""The report of scenes that do not go from rest to rest: every section is made, and says what cannot be had."""

import dataclasses
import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
from trolleys import trolley
from typer.testing import CliRunner
from users_plants import LIFT

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.envs.scenes.registry import is_by_name
from pliant.plants import EquilibriumError
from pliant.studies import report
from pliant.studies.closed_loop.closed_loop import closed_loop, regulator, variations
from pliant.studies.commands.cli import app
from pliant.studies.common import operating_point
from pliant.studies.figures import style
from pliant.studies.report import sections

SECTIONS = (
    "The answer",
    "The motion",
    "Modes and frequencies",
    "The linear model at the goal",
    "The linear model along the motion",
    "Stability along the motion",
    "LQR in closed loop",
    "Controllers in closed loop",
    "Speed against accuracy",
    "The smallest model",
    "Versions and machine",
)
NO_LAW = {
    "slider-crank-run": "EquilibriumError: the goal of scene 'slider-crank-run' is no equilibrium",
}


@pytest.fixture(scope="module")
def drawn_once():
    """Figures go into the page alone: test_report.py looks at the files beside it, which take as long again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", lambda figure, path: path.touch())
        yield


@pytest.fixture(
    scope="module",
    params=[*(pytest.param(name, marks=pytest.mark.campaign) for name in ("cantilever-drop", "spin-up", *NO_LAW))],
)
def made(request, drawn_once, tmp_path_factory):
    """A scene, the folder of its report and the page's text."""
    shorter = {"slider-crank-run": {"duration": 0.5}}
    scene = scenes.get(request.param, **shorter.get(request.param, {}))
    page = report(scene, tmp_path_factory.mktemp("reports") / scene.name, budget=0.5)
    return scene, page.parent, page.read_text(encoding="utf-8").replace("&#x27;", "'")


def table(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def test_every_section_is_made(made):
    scene, folder, text = made
    for title in SECTIONS:
        assert text.count(f"<h2>{title}</h2>") == 1
    pictures = {path.stem for path in folder.glob("*.png")}
    wanted = {"motion", "shapes", "eigenvalues", "stability", "speed_accuracy", "settings", "ladder", "effects"}
    assert wanted <= pictures and ("closed_loop" in pictures) == (scene.name not in NO_LAW)
    assert text.count("<figure") == len(pictures)


def test_lqr_or_why_there_is_none(made):
    scene, folder, text = made
    found = table(folder, "closed_loop")
    if scene.name in NO_LAW:
        assert found["failure"].startswith(NO_LAW[scene.name]) and found["gain"] is None and found["loops"] == []
        assert (
            text.count(found["failure"]) == 2
        )  # in the answer and in its section; those beside each other go by the cycle
    elif scene.name == "spin-up":  # the hub's angle, which nothing depends on, is not read
        assert found["failure"] is None and np.shape(found["gain"]) == (1, 5)
        assert [loop["stable"] for loop in found["loops"]] == [True, True, True, False]
        assert found["loops"][-1]["spillover"]  # undamped modes that the design model lacks
    else:
        assert found["failure"] is None and np.shape(found["gain"]) == (2, 6)
        assert [loop["name"] for loop in found["loops"][:3]] == [
            "the design plant",
            "beam.density -50%",
            "beam.density +50%",
        ]
        design = found["loops"][0]
        assert design["stable"] and design["cost"] < 0.5 * found["open_loop_cost"] and design["final_error"] < 0.1


def test_goal_that_is_no_equilibrium_is_called_so(made):
    scene, folder, text = made
    rest = table(folder, "modes")["residual"]
    moving = {"spin-up": "d(hub_angle)/dt = 6 rad/s", "slider-crank-run": "d(crank_angle)/dt = 15.1 rad/s"}
    assert rest == moving.get(scene.name)
    assert ("The goal is no equilibrium" in text) == (scene.name in moving)


def test_linear_model_along_the_motion_predicts_what_is_compared(made):
    scene, folder, _ = made
    found = table(folder, "linearization_along")
    (_, first, size), (_, second, _) = (e.values() for e in found["prediction_errors"])
    felt = {"cantilever-drop": "bend1", "spin-up": "eta1", "slider-crank-run": "crank_angle"}
    assert found["perturbed"] == felt[scene.name] and size > 1e-6
    if scene.name == "spin-up":  # linear where the hub's motion is prescribed
        assert first < 1e-6 * size
    else:
        assert first / second == pytest.approx(100.0, rel=0.3)


def test_frequencies_lock_only_coordinates(made):
    scene, folder, _ = made
    found = table(folder, "modes")["locked_frequencies_hz"][scene.plant.label]
    assert len(found) == scene.plant.nx // 2 - len(scene.plant.driven)


@pytest.mark.parametrize("name", NO_LAW)
def test_simulate_under_an_lqr_that_does_not_exist(name):
    result = CliRunner().invoke(app, ["simulate", name, "--lqr"])
    assert result.exit_code == 1 and result.stdout == ""
    assert result.stderr.startswith(f"error: {NO_LAW[name]}")


def test_regulator_refuses_a_goal_that_moves():
    with pytest.raises(EquilibriumError) as caught:
        regulator(scenes.get("slider-crank-run", rpm=60.0))
    assert caught.value.residual == pytest.approx(2 * np.pi)
    with pytest.raises(EquilibriumError):
        closed_loop(scenes.get("slider-crank-run"))


def test_simulate_under_the_lqr_of_a_scene_whose_angle_runs_on():
    """The scoreboard ranks it at 1.02 of the best controller's cost; `--lqr` plays the same law."""
    scene = scenes.get("spin-up")
    assert pytest.approx(LQR.for_scene(scene).K, abs=0) == regulator(scene).K
    result = CliRunner().invoke(app, ["simulate", "spin-up", "--lqr", "--json"])
    assert result.exit_code == 0, result.stderr


def test_inputs_beyond_the_limits_are_said_with_the_motion():
    motion = LIFT.open_loop(rtol=1e-6)
    for limit, words in (
        (100.0, None),
        (5.0, r"limits, .*: pull = -?28\.\d+ N at 0\.\d+ s \(limit 5\)"),
    ):
        found = SimpleNamespace(
            scene=dataclasses.replace(LIFT, limits=(limit,)), open_loop=motion, nominal=motion, loops=()
        )
        text = sections._motion(found)
        assert re.search(words, text) if words else "limits" not in text


def test_variations_change_what_there_is():
    """A payload of zero is not varied; the first randomised parameter is."""
    assert [name for name, _ in variations(scenes.get("spin-up"))][1:3] == ["link.E -50%", "link.E +50%"]
    assert [name for name, _ in variations(scenes.get("single-link-slew"))][1] == "payload.mass -50%"
    lift = dataclasses.replace(LIFT, randomise=())  # one rung: no plant counts twice
    assert [name for name, _ in variations(lift)] == ["the design plant", "load -50%", "load +50%"]


def test_linearize_says_where():
    for name, at, says in (
        ("slider-crank-run", "goal", "no equilibrium (d(crank_angle)/dt = 15.1 rad/s there)"),
        ("cantilever-drop", "start", "no equilibrium (d(bend2_rate)/dt"),
        ("cantilever-drop", "goal", "at rest with tip_force_x = 0 N"),
    ):
        scene = scenes.get(name)
        model = scene.plant.linearize(*(scene.target if at == "goal" else scene.initial))
        assert says in operating_point.words(model, scene.plant)
        result = CliRunner().invoke(app, ["linearize", name, "--at", at])
        assert result.exit_code == 0 and says[:14] in " ".join(result.stdout.split())


def test_inputs_are_called_what_they_are():
    """By their units; a command is named only where it gives the same scene."""
    assert sections._kind(trolley()) == "forces" and sections._kind(scenes.get("two-link-reach")) == "torques"
    assert sections._kind(scenes.get("spacecraft-spin")) == "inputs"  # torques and accelerations
    reach = scenes.get("two-link-reach")
    assert is_by_name(reach) and not is_by_name(trolley()) and not is_by_name(dataclasses.replace(reach, duration=4.0))
