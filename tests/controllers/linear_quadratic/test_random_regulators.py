"""A sample of tests/campaigns/regulators.py: designs on random plants; `make campaign` runs the whole."""

import regulators


def test_what_regulators_and_filters_claim_of_random_plants_holds():
    rows = [regulators.run(seed) for seed in range(20)]
    assert not [row for row in rows if row["wrong"]], regulators.summary(rows)
    assert {row["said"] for row in rows} >= {"lqr", "kalman", "tvlqr", "mpc, at its limits", "funnel"}
