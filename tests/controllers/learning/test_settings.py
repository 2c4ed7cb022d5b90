"""Settings are frozen and stand by the names that `train` takes."""

import dataclasses

import pytest

from pliant.controllers import rl
from pliant.controllers.learning.settings import SETTINGS, APGSettings, PPOSettings, SACSettings


def test_names():
    assert {"apg": APGSettings, "ppo": PPOSettings, "sac": SACSettings} == SETTINGS and rl.PPOSettings is PPOSettings
    assert PPOSettings().num_envs * PPOSettings().n_steps % PPOSettings().batch_size == 0  # batches leave no rest
    with pytest.raises(dataclasses.FrozenInstanceError):
        PPOSettings().gamma = 0.5


def test_only_apg_may_read_and_act_without_noise():
    assert APGSettings(noise=0.0).noise == 0.0
    with pytest.raises(ValueError, match=r"PPOSettings\.noise = 0\.0 must be"):
        PPOSettings(noise=0.0)
