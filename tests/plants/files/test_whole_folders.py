"""Folders take their places whole, with and without a system that exchanges two in one step."""

import os
import stat

import pytest

from pliant.plants.files import leftovers, whole_folders
from pliant.plants.files.whole_folders import exchange, renewed, whole_folder


@pytest.fixture(params=["one step", "two steps"])
def system(request, monkeypatch):
    if request.param == "two steps":
        monkeypatch.setattr(whole_folders, "exchange", lambda *_: False)


def content(folder):
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_two_folders_change_places(tmp_path):
    for name in "ab":
        (tmp_path / name).mkdir()
        (tmp_path / name / name).touch()
    if not exchange(tmp_path / "a", tmp_path / "b"):
        pytest.skip("this system cannot exchange")
    assert [p.name for p in (tmp_path / "a").iterdir()] == ["b"]
    with pytest.raises(FileNotFoundError):
        exchange(tmp_path / "a", tmp_path / "none")


def test_a_folder_is_replaced_whole(tmp_path, system):
    out = tmp_path / "deep" / "out"
    for text in ("first", "second"):
        with whole_folder(out, "mark") as made:
            (made / "mark").write_text(text)
            assert not out.exists() or content(out) == {"mark": "first"}
        assert content(out) == {"mark": text} and list(out.parent.iterdir()) == [out]
        out.chmod(0o750)
    assert stat.S_IMODE(out.stat().st_mode) == 0o750  # of the first, which the second takes over


def test_when_it_cannot_take_the_place_the_former_comes_back(tmp_path, monkeypatch):
    out = tmp_path / "out"
    with whole_folder(out, "mark") as made:
        (made / "mark").write_text("former")
    monkeypatch.setattr(whole_folders, "exchange", lambda *_: False)
    real = os.rename

    def refused(source, target):
        if str(target) == str(out) and ".former." not in str(source):
            raise PermissionError("no")
        real(source, target)

    monkeypatch.setattr(os, "rename", refused)
    with pytest.raises(PermissionError), whole_folder(out, "mark") as made:
        (made / "mark").write_text("new")
    assert content(out) == {"mark": "former"} and list(tmp_path.iterdir()) == [out]


def test_files_are_renewed_and_the_rest_of_the_folder_stays(tmp_path, system):
    out = tmp_path / "out"
    for text in ("first", "second"):
        with renewed(out) as made:
            for name in ("a", "b"):
                (made / name).write_text(text)
        assert {k: v for k, v in content(out).items() if k != "notes"} == {"a": text, "b": text}
        (out / "notes").write_text("mine")
        (out / "a").chmod(0o600)
    assert content(out)["notes"] == "mine" and list(tmp_path.iterdir()) == [out]
    assert stat.S_IMODE((out / "a").stat().st_mode) == 0o600


def test_a_folder_with_links_or_folders_keeps_them(tmp_path):
    out = tmp_path / "out"
    (out / "sub").mkdir(parents=True)
    (tmp_path / "elsewhere").write_text("old")
    (out / "a").symlink_to("../elsewhere")
    before = out.stat().st_ino
    with renewed(out) as made:
        (made / "a").write_text("new")
    assert (out / "a").is_symlink() and (tmp_path / "elsewhere").read_text() == "new"
    assert sorted(p.name for p in out.iterdir()) == ["a", "sub"] and out.stat().st_ino == before


def test_nobody_loses_the_folder_under_their_feet(tmp_path, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    monkeypatch.chdir(out)
    with renewed(out) as made:
        (made / "a").write_text("new")
    assert os.listdir() == ["a"]


def test_a_folder_above_that_is_not_ours_does_not_matter(tmp_path, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    real = os.mkdir

    def refused(path, *given):
        if os.path.dirname(path) == str(tmp_path):
            raise PermissionError(13, "no", str(path))
        real(path, *given)

    monkeypatch.setattr(os, "mkdir", refused)
    with renewed(out) as made:
        (made / "a").write_text("new")
    assert content(out) == {"a": "new"} and list(tmp_path.iterdir()) == [out]


def test_a_failure_leaves_the_folder_as_it_was(tmp_path, system):
    out = tmp_path / "out"
    with renewed(out) as made:
        (made / "a").write_text("1")
    with pytest.raises(KeyError), renewed(out) as made:
        (made / "a").write_text("2")
        raise KeyError
    assert content(out) == {"a": "1"} and not list(tmp_path.glob(f"{leftovers.PREFIX}*"))
