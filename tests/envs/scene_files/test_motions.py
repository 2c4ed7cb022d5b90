import pytest

from pliant.envs import scenes
from pliant.envs.scene_files.motions import TYPES, Samples, motion_of, motion_table


@pytest.mark.parametrize("name", ["two-link-reach", "cantilever-drop", "spin-up", "spacecraft-spin"])
def test_a_motion_comes_back(name):
    drive = scenes.get(name).drive
    table = motion_table(drive)
    assert motion_of("motion", table) == drive and table["type"] in TYPES


@pytest.mark.parametrize("times", [(), (0.5, 1.0), (0.0, 0.0), (0.0, float("nan"))])
def test_times_of_samples_increase_from_zero(times):
    with pytest.raises(ValueError, match=r"samples\.(times|inputs)"):
        Samples(times, tuple((0.0,) for _ in times))
