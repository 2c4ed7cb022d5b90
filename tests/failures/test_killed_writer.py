"""A process that is killed while it writes: in place the file is lost, beside it one moment stays whole.

Killed by the system itself after so many bytes (RLIMIT_FSIZE, as if the disk were full and the program had no say), or
before a chosen call of the system: no test waits for the right moment.
"""

import json
import os
import sys

import corruption
import kills
import numpy as np
import pytest
from file_kinds import KINDS, motion, policy

from pliant.controllers import Policy
from pliant.controllers.learning import policy_files
from pliant.plants import Trajectory
from pliant.plants.files import leftovers, whole_folders

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the system's limits and signals are Linux's")


def killed(write, before):
    _, status = os.waitpid(kills.child(write, before), 0)
    assert os.WIFSIGNALED(status)


def in_place(path, version):
    m = motion(version)
    with open(path, "wb") as file:
        np.savez(file, t=m.t, x=m.x, u=m.u)


def test_in_place_the_former_motion_is_lost_and_beside_it_is_kept(tmp_path):
    path = tmp_path / "run.npz"
    in_place(path, 1)
    killed(lambda: in_place(path, 2), lambda: kills.at_byte(5000))
    with pytest.raises(Exception, match=r".*"), np.load(path) as found:
        dict(found)
    with pytest.raises(ValueError, match=r"Trajectory\.load: '.*run\.npz' cannot be read: cut off"):  # it says so
        Trajectory.load(path)
    motion(1).save(path)
    killed(lambda: motion(2).save(path), lambda: kills.at_byte(5000))
    assert Trajectory.load(path)["x1"].tolist() == [1.0] * 500
    assert len(list(tmp_path.iterdir())) == 2  # what was begun ..
    motion(3).save(path)
    assert list(tmp_path.iterdir()) == [path]  # .. goes with the next


def test_two_files_each_whole_are_mixed_and_one_is_not(tmp_path):
    """Each file by renaming, killed between the two: version 0.1's format read arrays of one policy and limits of
    the other, without a word."""

    def each_whole(version):
        words, arrays = policy_files.parts_of(policy(version))
        np.savez(tmp_path / "part.npz", **arrays)
        (tmp_path / "part").write_text(json.dumps({"format": 1, **words}))
        os.replace(tmp_path / "part.npz", tmp_path / "mine.npz")
        os.replace(tmp_path / "part", tmp_path / "mine.json")

    each_whole(1)
    real = os.replace

    def only_the_first(*given):
        real(*given)
        os.kill(os.getpid(), 9)

    killed(lambda: each_whole(2), lambda: setattr(os, "replace", only_the_first))
    mixed = Policy.load(tmp_path / "mine")
    assert (mixed.weights[0][0, 0], mixed.limits[0]) == (2.0, 1.0)
    (tmp_path / "part").unlink()
    policy(1).save(tmp_path / "mine")
    killed(lambda: policy(2).save(tmp_path / "mine"), lambda: setattr(os, "replace", only_the_first))
    with pytest.warns(UserWarning, match="belongs to another policy"):
        found = Policy.load(tmp_path / "mine")
    assert (found.weights[0][0, 0], found.limits[0]) == (2.0, 2.0)
    policy(3).save(tmp_path / "mine")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine.json", "mine.npz"]


def test_a_flipped_bit_that_numpy_reads_without_a_word_is_noticed(tmp_path):
    """The archive's own CRC is asked for only where a member is read to its end: a smaller shape ends before."""
    path = tmp_path / "run.npz"
    motion(1).save(path)
    content = path.read_bytes()
    path.write_bytes(content.replace(b"'shape': (500,)", b"'shape': (400,)"))
    with np.load(path, allow_pickle=False) as found:
        assert found["t"].shape == (400,)  # wrong, and nothing is said
    with pytest.raises(ValueError, match=r"run\.npz' is damaged: its checksum is another"):
        Trajectory.load(path)


@pytest.mark.parametrize(("name", "every"), [("motion", 1), ("policy", 5), ("scoreboard", 11), ("report", 17)])
def test_a_kill_before_any_call_of_the_system_loses_and_mixes_nothing(name, every):
    """A sample of tests/campaigns/kills.py."""
    row = kills.run(kills.RANDOM, (name,), every)
    assert row["how"] == "steps" and row["kills"] > 2
    assert not kills.faulty(row), row


@pytest.mark.parametrize("seed", range(3))
def test_a_kill_at_a_random_moment_loses_nothing(seed):
    row = kills.run(seed, ("motion", "policy", "table"))
    assert row["kills"] == 1 and not kills.faulty(row), row


def test_without_exchange_a_report_is_put_back(tmp_path, monkeypatch):
    monkeypatch.setattr(whole_folders, "exchange", lambda *_: False)
    kind = KINDS["report"]
    kind.write(tmp_path, 1)
    real = os.rename

    def only_the_first(*given):
        real(*given)
        os.kill(os.getpid(), 9)

    killed(lambda: kind.write(tmp_path, 2), lambda: setattr(os, "rename", only_the_first))
    assert not (tmp_path / "report").exists()
    leftovers.settle(tmp_path)
    assert kind.read(tmp_path) == {1} and len(list(tmp_path.iterdir())) == 1


DAMAGED = tuple(name for name in corruption.ALL if name != "checkpoint")  # whose reader needs torch


@pytest.mark.parametrize("seed", range(len(DAMAGED)))
def test_damage_is_noticed(seed):
    """A sample of tests/campaigns/corruption.py."""
    row = corruption.run(seed, DAMAGED)
    assert row["tried"] > 10 and row["refused"] > row["tried"] // 2 and not corruption.faulty(row), row


def test_the_campaign_notices_a_writer_in_place(monkeypatch):
    """The same kills find what is wrong with writing in place: the campaign is not blind."""
    kind = kills.Kind("motion", lambda f, v: in_place(f / "run.npz", v), read_in_place)
    monkeypatch.setitem(kills.KINDS, "motion", kind)
    row = kills.run(kills.RANDOM + 1, ("motion",))
    assert row["how"] == "bytes" and row["lost"] > 3 and kills.faulty(row)


def read_in_place(folder):
    try:
        with np.load(folder / "run.npz") as found:
            return set(np.unique(found["x"]))
    except Exception as error:
        raise ValueError("lost") from error
