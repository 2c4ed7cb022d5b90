"""A choice in sentences."""

import dataclasses

from pliant.envs import scenes
from pliant.studies import choose
from pliant.studies.fidelity.verdict_in_words import words

SLEW = scenes.get("single-link-slew", duration=0.5, move_time=0.3)


def test_what_is_chosen_and_why():
    good = choose(SLEW, 1e-3)
    for said in (
        good.plant.label,
        "within 1 mm of physics",
        "known to",
        "Left out: ",
        "Kept: bending",
    ):
        assert said in good.text
    missed = dataclasses.replace(good, met=False, missing=("exact rotations",), integrator=None)
    assert words(missed).startswith("No variant is shown to keep ") and "Missing: exact rotations." in words(missed)
    failed = dataclasses.replace(missed, physics="physics cannot be played: no rest", convergence=float("inf"))
    assert "Physics cannot be played: no rest." in words(failed)
