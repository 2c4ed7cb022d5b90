"""The one writer: rights, links, devices, what is kept when it fails, and files that belong together."""

import errno
import os
import re
import resource
import stat

import pytest

from pliant.plants.files import atomic_files, leftovers
from pliant.plants.files.atomic_files import Together, replacing, write_bytes, write_text


@pytest.fixture
def mask():
    """A mask that is not this process's own."""
    former = os.umask(0o027)
    yield
    os.umask(former)


def rights(path):
    return stat.S_IMODE(path.stat().st_mode)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_new_file_has_ordinary_rights_and_a_former_one_keeps_its_own(tmp_path, mask):
    write_text(tmp_path / "new", "a")
    (tmp_path / "ordinary").write_text("a")
    assert rights(tmp_path / "new") == rights(tmp_path / "ordinary") == 0o640
    for mode in (0o600, 0o664, 0o755):
        (tmp_path / "new").chmod(mode)
        write_text(tmp_path / "new", f"{mode}")
        assert rights(tmp_path / "new") == mode and (tmp_path / "new").read_text() == f"{mode}"


def test_what_is_unfinished_is_never_more_open_than_the_former_file(tmp_path):
    (tmp_path / "secret").write_text("a")
    (tmp_path / "secret").chmod(0o600)
    with replacing(tmp_path / "secret") as file:
        file.write(b"b")
        file.flush()
        (part,) = tmp_path.glob(".pliant-*")
        assert rights(part) == 0o600 and (tmp_path / "secret").read_text() == "a"
    assert (tmp_path / "secret").read_text() == "b"


def test_a_link_stays_one_and_its_target_is_written(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to("there/file")
    for text in ("first, of a link to nothing", "second"):
        write_text(tmp_path / "link", text)
        assert (tmp_path / "link").is_symlink() and (tmp_path / "there" / "file").read_text() == text
    assert names(tmp_path / "there") == ["file"]
    (tmp_path / "circle").symlink_to("circle")
    with pytest.raises(OSError, match="not written") as caught:
        write_text(tmp_path / "circle", "a")
    assert caught.value.errno == errno.ELOOP and (tmp_path / "circle").is_symlink()


def test_a_device_and_a_pipe_are_written_as_they_are(tmp_path):
    write_text("/dev/null", "a")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    write_text(tmp_path / "pipe", "through")
    assert os.read(reader, 100) == b"through" and stat.S_ISFIFO(os.stat(tmp_path / "pipe").st_mode)
    os.close(reader)


@pytest.mark.parametrize("stop", [KeyError, KeyboardInterrupt, SystemExit])
def test_an_exception_leaves_the_former_file_and_nothing_else(tmp_path, stop):
    write_text(tmp_path / "a", "former")
    with pytest.raises(stop), replacing(tmp_path / "a") as file:
        file.write(b"half")
        raise stop
    assert names(tmp_path) == ["a"] and (tmp_path / "a").read_text() == "former"


def test_a_full_disk_is_said_with_the_files_name_and_the_former_file_stays(tmp_path):
    """The system's own limit on the size of files stands for it: the write itself fails, after 100 bytes."""
    write_text(tmp_path / "a", "former")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, hard))
    try:
        with pytest.raises(OSError, match=rf"File too large: not written, .* kept: '{tmp_path}/a'"):
            write_bytes(tmp_path / "a", bytes(200))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert names(tmp_path) == ["a"] and (tmp_path / "a").read_text() == "former"


@pytest.mark.parametrize("call", ["open", "fsync", "replace", "fchmod"])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO, errno.EROFS])
def test_whatever_fails_the_former_file_stays(tmp_path, monkeypatch, call, number):
    write_text(tmp_path / "a", "former")

    def fails(*_, **__):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, call, fails)
    with pytest.raises(OSError, match=re.escape(f"{os.strerror(number)}: not written, what was there")) as caught:
        write_text(tmp_path / "a", "new")
    monkeypatch.undo()
    assert caught.value.errno == number and caught.value.filename == str(tmp_path / "a")
    assert names(tmp_path) == ["a"] and (tmp_path / "a").read_text() == "former"


def test_no_folder_no_rights_and_a_folder_in_its_place_are_said(tmp_path, monkeypatch):
    with pytest.raises(FileNotFoundError, match=rf"the folder '{tmp_path}/none' does not exist: not written"):
        write_text(tmp_path / "none" / "a", "text")
    with pytest.raises(IsADirectoryError, match="a folder of this name is there"):
        write_text(tmp_path, "text")
    write_text(tmp_path / "a", "former")
    (tmp_path / "a").chmod(0o444)
    monkeypatch.setattr(os, "access", lambda path, *_: False)  # the superuser, who may run this, is never refused
    with pytest.raises(PermissionError, match="the file there may not be written"):
        write_text(tmp_path / "a", "new")
    assert (tmp_path / "a").read_text() == "former" and names(tmp_path) == ["a"]


@pytest.mark.parametrize("path", [None, 3, b"bytes", "", "a\0b", ["a"]])
def test_what_is_no_path_is_refused(path):
    with pytest.raises(ValueError, match="must be a path"):
        write_text(path, "text")


def test_files_together_change_together(tmp_path):
    with Together() as files:
        files.text(tmp_path / "a", "1")
        files.text(tmp_path / "b", "1")
        assert all(name.startswith(leftovers.PREFIX) for name in names(tmp_path))
    with pytest.raises(KeyError), Together() as files:
        files.text(tmp_path / "a", "2")
        raise KeyError
    assert {p.name: p.read_text() for p in tmp_path.iterdir()} == {"a": "1", "b": "1"}
    (tmp_path / "other").mkdir()
    with Together() as files:
        files.text(tmp_path / "a", "3")
        files.text(tmp_path / "other" / "b", "3")
    assert (tmp_path / "a").read_text() == (tmp_path / "other" / "b").read_text() == "3"
    assert names(tmp_path) == ["a", "b", "other"] and names(tmp_path / "other") == ["b"]


def test_an_interrupt_between_two_files_lets_the_second_follow(tmp_path, monkeypatch):
    for name in "ab":
        write_text(tmp_path / name, "1")
    real, calls = os.replace, []

    def interrupted(*given):
        calls.append(given)
        if len(calls) == 2:
            raise KeyboardInterrupt
        real(*given)

    monkeypatch.setattr(atomic_files.os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt), Together() as files:
        files.text(tmp_path / "a", "2")
        files.text(tmp_path / "b", "2")
    assert {p.name: p.read_text() for p in tmp_path.iterdir()} == {"a": "2", "b": "2"}
