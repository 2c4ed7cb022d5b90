"""Counts of a predictive controller: the worst excess of each limit stays until all is cleared."""

import numpy as np

from pliant.controllers.base.solver_record import Record


def test_the_worst_of_each_limit_is_kept():
    record = Record(("bend", "rate"))
    record.violate(np.array([0.1, 2.0]))
    record.violate(np.array([0.3, 1.0]))
    record.calls = record.failures = 5
    assert record.violations == 2 and record.worst.tolist() == [0.3, 2.0]
    record.clear()
    assert (record.calls, record.failures, record.violations) == (0, 0, 0)
    assert record.worst.tolist() == [0.0, 0.0]
