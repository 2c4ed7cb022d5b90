"""What modal analysis reads off eigenvalues; modes of models are in test_lti.py."""

import numpy as np

from pliant.plants.linear.modal_analysis import rates


def test_rates_of_a_sampled_model_are_those_of_the_continuous_one():
    """s = log(z) / dt, and what dies within one period (z = 0) decays at an infinite rate."""
    exact = np.array([complex(-0.02, -2.0), complex(-0.02, 2.0), -1.0])
    np.testing.assert_array_equal(rates(exact, None), exact)
    for dt in (1e-3, 0.3, 1.5):  # 2 rad/s is below pi / 1.5 s
        np.testing.assert_allclose(rates(np.exp(exact * dt), dt), exact, rtol=0, atol=1e-11)
    assert rates(np.zeros(1, dtype=complex), 0.1).tolist() == [complex(-np.inf, 0.0)]
