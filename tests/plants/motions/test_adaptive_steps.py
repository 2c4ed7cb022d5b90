"""What bounds adaptive steps and what is said where they end."""

import numpy as np

from pliant.plants.motions import adaptive_steps


def test_limits_come_in_the_order_in_which_c_reads_them():
    assert adaptive_steps.limits() == (10.0, 0.2, 0.9, 1e-13, 100_000_000)


def test_each_end_has_its_words_and_carries_where_it_was():
    x = np.array([1.0, 2.0])
    many = adaptive_steps.stopped(adaptive_steps.TOO_MANY, 0.5, x, 1e-3, 2e-3, "dop853")
    small = adaptive_steps.stopped(adaptive_steps.TOO_SMALL, 0.5, x, 1e-15, 2e-3, "rodas5p")
    assert str(many).startswith("dop853 stopped at t = 0.5 s after 100,000,000 steps") and "rodas5p" in str(many)
    assert "larger rtol and atol" in str(adaptive_steps.too_many_steps(0.5, x, 1e-3, "rodas5p"))
    assert str(small).startswith("rodas5p stopped at t = 0.5 s, its step having fallen to 1e-15 s, at state [1. 2.]")
    assert (many.time, many.step, small.step) == (0.5, 2e-3, 1e-15) and many.state is x
