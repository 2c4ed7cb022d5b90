"""A sample of tests/campaigns/tree_choices.py: `choose` on trees that are also arms; `make campaign` runs the whole."""

import pytest
import tree_choices


@pytest.mark.parametrize("seed", [0, pytest.param(2, marks=pytest.mark.campaign)])
def test_what_is_met_is_within_its_bound_of_the_arm(seed):
    row = tree_choices.run(seed)
    assert not row["crashed"] and row["met"], row
    assert row["error"] <= row["bound"] <= row["tolerance"] and not row["wrong"]
    assert row["told"] == pytest.approx(row["error"], rel=0.25)
    assert 0.001 < row["bent"] < tree_choices.MOST
