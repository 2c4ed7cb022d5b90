"""What bounds adaptive steps and what is said where they end."""

import numpy as np
import pytest

from pliant.plants import IntegrationError, SingleLinkArm
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


def test_inside_fewer_steps_end_a_simulation_and_outside_as_many_as_ever():
    plant = SingleLinkArm.textbook()
    x, t = np.zeros(plant.nx), [0.0, 1.0]
    with adaptive_steps.at_most(3):
        assert adaptive_steps.most_steps() == adaptive_steps.limits()[-1] == 3
        for method in ("dop853", "rodas5p"):
            with pytest.raises(IntegrationError, match=rf"{method} stopped at t = .* after 3 steps"):
                plant.simulate(x, np.ones(plant.nu), t, method=method, rtol=1e-12, atol=1e-14)
    assert adaptive_steps.most_steps() == adaptive_steps.MOST_STEPS
    assert plant.simulate(x, np.ones(plant.nu), t).stats["steps"] > 3
