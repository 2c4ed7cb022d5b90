"""A choice in sentences."""

from pliant.envs import scenes
from pliant.studies import choose

SLEW = scenes.get("single-link-slew", duration=0.5, move_time=0.3)


def test_met_and_not_met_are_told_apart():
    good = choose(SLEW, 1e-3)
    for words in (
        good.plant.label,
        "within 1 mm of physics",
        "known to",
        "Left out: ",
        "Kept: bending",
    ):
        assert words in good.text
    bad = choose(SLEW, 1e-12)
    assert bad.text.startswith("No variant is shown to keep ") and "Missing: " in bad.text
