"""Stable-Baselines3, which not every machine has."""

import pytest


@pytest.fixture(scope="session")
def stable_baselines():
    pytest.importorskip("torch")
    return pytest.importorskip("stable_baselines3")
