"""A sample of tests/campaigns/loops.py: margins, windows and shapers of random plants, all by `make campaign`."""

import loops


def test_what_is_claimed_of_random_loops_holds():
    """Seeds with sampled and continuous loops, feedthrough, several channels, both cuts."""
    rows = [loops.run(seed) for seed in (0, 2, 5, 7)]
    assert not [row for row in rows if row["wrong"]], loops.summary(rows)
    said = {claim for row in rows for claim in row["said"]}
    assert {"delay", "sampled delay", "whole periods", "gain, phase, disk", "window", "shaper"} <= said
