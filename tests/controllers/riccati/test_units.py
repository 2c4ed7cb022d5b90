"""A sample of tests/campaigns/units.py: designs in random units; the whole is run by `make campaign`."""

import units


def test_designs_do_not_depend_on_units():
    """Three rounds of all kinds, of which three scenes."""
    rows = [units.run(seed) for seed in range(100_000, 100_030)]
    assert not [row for row in rows if row["wrong"]], units.summary(rows)
    assert len(rows) == 30 and "0 faults" in units.summary(rows)
