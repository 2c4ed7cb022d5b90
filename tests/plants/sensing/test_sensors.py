"""Sensors of a data sheet: deviations by hand, and their samples."""

import numpy as np
import pytest

from pliant.plants import TwoLinkArm
from pliant.plants.sensing.sensors import COUNT, Sensor, read, sensors_of


def test_deviation_adds_noise_density_and_quantum() -> None:
    sensor = Sensor("other", "y", "m", noise=3.0, density=4.0, quantum=12.0)
    assert sensor.deviation(0.02) == pytest.approx(np.sqrt(9.0 + 16.0 / 0.04 + 12.0))


def test_samples_are_whole_counts_with_that_deviation() -> None:
    encoder = next(s for s in sensors_of(TwoLinkArm.textbook()) if s.kind == "encoder")
    rng = np.random.default_rng(0)
    found = np.array([read([encoder], np.array([0.1]), 0.02, rng)[0] for _ in range(2000)])
    counts = found / COUNT
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
    assert (found - 0.1).std() == pytest.approx(encoder.deviation(0.02), rel=0.05)
