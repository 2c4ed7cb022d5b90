"""Ids of scenes: words in capitals, variants too, thresholds where laws have been played."""

import gymnasium
import pytest

from pliant.envs import environment_id, scenes
from pliant.envs.scenes import registry


def test_every_scene_and_variant_has_an_id() -> None:
    assert environment_id("two-link-reach-weak") == "pliant/TwoLinkReachWeak-v0"
    for name in (*registry.SCENES, *registry.VARIANTS):
        assert gymnasium.spec(environment_id(name)).kwargs == {"scene": name}
    assert gymnasium.spec("pliant/SingleLinkSlew-v0").reward_threshold == -3.546
    assert scenes.get("single-link-slew-gentle") is scenes.get("single-link-slew-gentle")


def test_a_variants_name_is_taken() -> None:
    with pytest.raises(ValueError, match="name of its own"):
        scenes.register(scenes.get("two-link-reach-weak"))
