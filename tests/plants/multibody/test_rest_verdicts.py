"""A sample of tests/campaigns/tree_verdicts.py: random trees at rest; the whole is run by `make campaign`."""

import pytest
import tree_verdicts


@pytest.mark.parametrize("seed", [2, 3, 20, 29])
def test_what_grows_is_what_the_potential_energy_counts(seed):
    row = tree_verdicts.run(seed)
    assert row["rest"] and row["clear"] and row["decided"] and not row["wrong"], row
    assert row["verdict"] == ("unstable" if row["falls"] else "stable") and row["grows"] == row["falls"]
