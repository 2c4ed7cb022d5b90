"""A sample of tests/campaigns/units.py: designs in random units; the whole is run by `make campaign`."""

import units


def test_designs_do_not_depend_on_units():
    """Two rounds of all kinds, of which two scenes."""
    rows = [units.run(seed) for seed in range(100_000, 100_020)]
    assert not [row for row in rows if row["wrong"]], units.summary(rows)
    assert len(rows) == 20 and "0 faults" in units.summary(rows)
