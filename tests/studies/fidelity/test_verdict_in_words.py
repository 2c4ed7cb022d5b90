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
    rungs = tuple(dataclasses.replace(r, error=float("inf")) for r in good.rungs[:2])
    failed = dataclasses.replace(missed, rungs=(*rungs, *good.rungs[2:]))
    assert f"Without a finite motion: {rungs[0].variant}; {rungs[1].variant}." in words(failed)
    failed = dataclasses.replace(failed, physics="physics cannot be played: no rest", convergence=float("inf"))
    assert "Physics cannot be played: no rest." in words(failed)
    assert "Without a finite motion" not in words(failed)  # nothing is known of the rungs, which may have one
