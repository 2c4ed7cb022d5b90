"""What a notebook shows of plants, models, motions, verdicts, choices and scenes: small tables that are well formed."""

from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np

from pliant.envs import scenes
from pliant.plants import SingleLinkArm, stability
from pliant.plants.files.html_tables import ChoiceTable, html_table

ARM = SingleLinkArm.textbook()


def cells(made):
    """{row: text} of a table, which must be well formed and small."""
    text = made._repr_html_()
    assert len(text) < 8000 and "<script" not in text
    root = ElementTree.fromstring(text)
    return {row[0].text: row[1].text for row in root.iter("tr")}


def test_a_plant_tells_its_fidelity_and_signals():
    told = cells(ARM)
    assert told["fidelity"] == ARM.label and "hub_angle [rad]" in told["states"] and "parameters" not in told
    assert "payload.mass [kg]" in cells(ARM.vary("payload.mass"))["parameters"]


def test_a_linear_model_tells_its_modes():
    model = ARM.linearize(np.zeros(ARM.nx))
    assert str(model.modes()[0]) in cells(model)["modes"] and cells(model)["time"] == "continuous"
    assert cells(model.discretize(0.01))["time"] == "sampled every 0.01 s"


def test_a_motion_tells_its_ranges():
    motion = ARM.simulate(np.zeros(ARM.nx), [1.0], np.linspace(0.0, 0.1, 11))
    told = cells(motion)
    assert told["times"] == "11, 0 to 0.1 s"
    assert told["hub_angle"].startswith("0 to ") and told["hub_angle"].endswith(" rad")


def test_a_verdict_tells_why():
    found = stability.assess(ARM.linearize(np.zeros(ARM.nx)))
    told = cells(found)
    assert told["verdict"] == found.verdict and told["why"] == found.why


def test_a_scene_tells_its_goal():
    scene = scenes.get("single-link-slew")
    told = cells(scene)
    assert told["about"] == scene.about and "hub_angle" in told["goal"]


def test_a_choice_never_says_more_than_was_shown():
    rungs = tuple(SimpleNamespace(variant=name, bound=bound) for name, bound in (("rigid", np.nan), ("linear", 1e-4)))
    shown = {"scene": "slew", "plant": ARM, "tolerance": 1e-3, "unit": "m", "met": False, "rungs": rungs, "missing": ()}
    choice = type("Shown", (ChoiceTable, SimpleNamespace), {})(**shown)
    told = cells(choice)
    assert (told["shown to keep it"], told["rigid"], told["linear"]) == ("no", "no bound", "at most 0.0001 m")


def test_what_is_told_is_escaped():
    assert "<b>" not in html_table("<b>", [("<b>", "<b>"), ("nothing", "")])
