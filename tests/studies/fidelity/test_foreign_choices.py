"""A sample of tests/campaigns/foreign_choices.py: `choose` on other sizes and loads than its study has."""

import foreign_choices
import pytest


@pytest.mark.parametrize("seed", [3, pytest.param(9, marks=pytest.mark.campaign)])
def test_what_is_met_is_within_its_bound_of_a_model_on_no_ladder(seed):
    row = foreign_choices.run(seed)
    assert not row["crashed"] and row["met"], row
    bound = next(bound for variant, _, bound, _ in row["said"] if variant == row["chosen"])
    assert row["error"] <= bound * (1 + 1e-3) <= row["tolerance"] * (1 + 1e-3) and not row["wrong"]
    for (variant, predicted, *_), true in zip(row["said"], row["true"], strict=True):
        assert predicted == pytest.approx(true, rel=0.25, abs=1e-3 * row["tolerance"]), variant
