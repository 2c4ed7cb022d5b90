"""A policy's files: one of them is the policy, the other its words; damaged, foreign, old and future ones."""

import json
import warnings

import numpy as np
import pytest
from file_kinds import policy

from pliant.controllers import Policy
from pliant.controllers.learning import policy_files
from pliant.controllers.learning.policy import shipped
from pliant.plants.files import sealed_json


def load(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return Policy.load(folder / "mine")


def old(folder, version=1, **changes):
    """The two files as version 0.1 wrote them."""
    words, arrays = policy_files.parts_of(policy(version))
    np.savez_compressed(folder / "mine.npz", **arrays)
    words = {"format": 1, **words, **changes}
    (folder / "mine.json").write_text(json.dumps({k: v for k, v in words.items() if v != "absent"}, indent=1) + "\n")


def test_the_archive_alone_is_the_policy(tmp_path):
    policy(2).save(tmp_path / "mine")
    (tmp_path / "mine.json").unlink()
    assert load(tmp_path).made == {"seed": 2} and load(tmp_path).weights[0][0, 0] == 2


def test_a_json_of_another_moment_is_told_and_not_mixed_in(tmp_path):
    """What a kill between the two files leaves: the archive is new, the JSON old."""
    for first in (lambda: policy(1).save(tmp_path / "mine"), lambda: old(tmp_path)):
        first()
        before = (tmp_path / "mine.json").read_text()
        policy(2).save(tmp_path / "mine")
        (tmp_path / "mine.json").write_text(before)
        with pytest.warns(UserWarning, match=r"mine\.json' belongs to another policy than mine\.npz"):
            found = Policy.load(tmp_path / "mine")
        assert found.weights[0][0, 0] == found.limits[0] == found.dt == found.made["seed"] == 2


def test_the_json_holds_the_words_for_others(tmp_path):
    policy(2).save(tmp_path / "mine")
    told = json.loads((tmp_path / "mine.json").read_text())
    assert told["format"] == 2 and told["reads"] == ["a", "b", "c"] and told["limits"] == [2.0]
    assert set(told) == {*policy_files.WORDS, "format", "sha256"}


def changed(**changes):
    def change(folder):
        path = folder / "mine.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | changes))

    return change


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda f: (f / "mine.npz").write_bytes(b"PK no zip"), r"mine\.npz' cannot be read"),
        (lambda f: (f / "mine.json").write_text("{"), r"mine\.json' cannot be read"),
        (lambda f: (f / "mine.json").write_bytes(b""), r"mine\.json' is empty"),
        (lambda f: np.savez(f / "mine.npz", W1=np.array([{}], dtype=object)), r"mine\.npz' holds objects"),
        (lambda f: sealed_json.save(f / "mine.json", {"format": 2, "curve": []}), "which are no policy's words"),
        (changed(limits=[3.0]), r"mine\.json' was edited or is damaged"),
        (changed(format=3), r"mine\.json' was written by format 3, this Pliant reads up to 2"),
        (lambda f: (f / "mine.npz").write_bytes((f / "mine.json").read_bytes()), r"mine\.npz' cannot be read"),
    ],
)
def test_damaged_files_are_refused(tmp_path, damage, words):
    policy(1).save(tmp_path / "mine")
    damage(tmp_path)
    with pytest.raises(ValueError, match=r"Policy\.load: '.*" + words):
        Policy.load(tmp_path / "mine")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"format": 99}, "was written by format 99"),
        ({"format": 2}, "has no checksum"),
        ({"limits": "absent"}, r"words \['limits'\] are missing or unknown"),
        ({"extra": 1}, r"words \['extra'\] are missing or unknown"),
        ({"dt": "soon"}, "holds no policy"),
        ({"goal": [0.0]}, "goal has shape"),
        ({"reads": "abc"}, "reads = 'abc' must be names"),
        ({"reads": [1, 2, 3]}, "must be names"),
        ({"scene": 5}, "scene = 5 must be a str"),
        ({"squash": "no"}, "squash = 'no' must be a bool"),
        ({"made": []}, r"made = \[\] must be a dict"),
        ({"clip": [1]}, "holds no policy"),
        ({"limits": [10**400]}, "holds no policy"),
        ({"limits": [-1.0]}, "limits .* must be > 0"),
    ],
)
def test_files_of_version_0_1_are_read_and_refused_where_they_are_wrong(tmp_path, changes, words):
    old(tmp_path)
    assert load(tmp_path).dt == 1.0
    old(tmp_path, **changes)
    with pytest.raises(ValueError, match=r"Policy\.load: '.*mine.*" + words):
        Policy.load(tmp_path / "mine")


def test_of_version_0_1_both_files_are_needed(tmp_path):
    old(tmp_path)
    (tmp_path / "mine.json").unlink()
    with pytest.raises(FileNotFoundError):
        Policy.load(tmp_path / "mine")


@pytest.mark.parametrize(
    ("name", "robust"), [*((n, False) for n in shipped()), *((n, True) for n in shipped(robust=True))]
)
def test_shipped_policies_load_without_a_word(name, robust):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = Policy.for_scene(name, robust=robust)
    assert found.scene == name


@pytest.mark.parametrize("path", [None, 3, "", ".npz"])
def test_what_is_no_path_is_refused(path):
    for call in (Policy.load, policy(1).save):
        with pytest.raises(ValueError, match=r"Policy.*path"):
            call(path)
