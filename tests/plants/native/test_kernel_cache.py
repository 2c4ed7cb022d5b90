"""The kernel cache: keys, damage, ownership, and four processes at once."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pliant.plants.native import compiler, kernel_cache, kernel_loader

needs_compiler = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_a_file_comes_back_and_a_damaged_one_is_removed(folder: Path) -> None:
    path = kernel_cache.write("a", b"content")
    assert kernel_cache.read_text("a") == "content"
    path.write_bytes(path.read_bytes().replace(b"content", b"c0ntent"))
    assert kernel_cache.read_text("a") is None
    assert not path.exists()
    path = kernel_cache.write("a", b"content")
    path.write_bytes(path.read_bytes()[:-5])  # half written
    assert kernel_cache.path_of("a") is None


def test_the_folder_is_the_owners_alone(folder: Path) -> None:
    kernel_cache.write("a", b"content")
    assert folder.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("what", ["folder", "file", "above"])
def test_what_others_may_write_is_refused(folder: Path, what: str) -> None:
    path = kernel_cache.write("a", b"content")
    target = {"folder": folder, "file": path, "above": folder.parent}[what]
    target.chmod(0o777)
    with pytest.raises(
        kernel_cache.CacheError, match=r"may be (written|changed) by (others|another user).*PLIANT_CACHE"
    ):
        kernel_cache.path_of("a")
    target.chmod(0o700)
    assert kernel_cache.path_of("a") == path


def test_another_owner_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel_cache.write("a", b"content")
    monkeypatch.setattr(os, "geteuid", lambda: os.lstat(folder).st_uid + 1)
    with pytest.raises(kernel_cache.CacheError, match="belongs to user"):
        kernel_cache.path_of("a")


def test_a_link_is_refused(folder: Path, tmp_path: Path) -> None:
    kernel_cache.write("a", b"content")
    (folder / "b").symlink_to(folder / "a")
    with pytest.raises(kernel_cache.CacheError, match="symbolic link"):
        kernel_cache.path_of("b")


def test_clear_removes_everything(folder: Path) -> None:
    kernel_cache.write("a", b"1")
    kernel_cache.write("b", b"2")
    assert kernel_cache.clear() == 2
    assert kernel_cache.entries() == []


def test_what_killed_builds_leave_goes_with_the_next(folder: Path) -> None:
    kernel_cache.write("a", b"1")
    child = os.fork()
    if child == 0:
        kernel_cache.write_aside(b"half")
        os._exit(0)
    os.waitpid(child, 0)
    young, old = folder / "building-young.so", folder / "building-old.so"  # as version 0.1 named them
    for path in (young, old):
        path.write_bytes(b"half")
    os.utime(old, (0, 0))
    assert len(list(folder.iterdir())) == 4 and len(kernel_cache.entries()) == 3
    kernel_cache.write("b", b"2")
    assert sorted(path.name for path in folder.iterdir()) == ["a", "b", "building-young.so"]


def test_what_is_kept_is_checked_before_it_is_published(folder: Path) -> None:
    """A file that cannot be loaded is made again; one that is refused leaves nothing."""
    made: list[bytes] = []

    def load(path: Path) -> bytes:
        content = kernel_cache.unseal(path.read_bytes())
        if content == b"foreign":
            raise OSError("of another machine")
        return content or b""

    def make() -> bytes:
        made.append(b"x")
        return b"good"

    kernel_cache.write("a", b"foreign")
    assert [kernel_cache.kept("a", make, load) for _ in range(2)] == [b"good", b"good"] and len(made) == 1

    def refuse(path: Path) -> None:
        raise ValueError("wrong")

    with pytest.raises(ValueError, match="wrong"):
        kernel_cache.kept("b", make, load, refuse)
    assert [p.name for p in kernel_cache.entries()] == ["a"]


STEP = """
import sys
import numpy as np
from pliant.plants import SingleLinkArm
step = SingleLinkArm.textbook().ladder()[0].stepper(0.01, batch=2)
sys.stdout.write(f"{step.native} {step(np.zeros((2, 2)), np.ones(1)).sum()}\\n")
"""


@needs_compiler
def test_four_processes_on_an_empty_cache(folder: Path) -> None:
    """Forked once everything is imported, so that all four compile at the same moment."""
    script = f"""
import multiprocessing
import pliant.plants.native.batch_kernels
from pliant.plants import SingleLinkArm
SingleLinkArm.textbook().ladder()[0].dynamics([0.0] * 2)
def step():
    exec({STEP!r})
children = [multiprocessing.get_context("fork").Process(target=step) for _ in range(4)]
for child in children: child.start()
for child in children: child.join()
assert not any(child.exitcode for child in children)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=300)
    results = done.stdout.splitlines()
    assert done.stderr == "" and len(results) == 4
    assert len(set(results)) == 1
    assert results[0].startswith("True ")
    names = [p.name for p in kernel_cache.entries()]
    assert not [n for n in names if n.startswith("building")]
    assert len([n for n in names if n.startswith("kernel")]) == 1
    assert all(kernel_cache.path_of(n) for n in names)


@pytest.mark.campaign
@needs_compiler
def test_a_damaged_kernel_is_rebuilt(folder: Path) -> None:
    first = subprocess.run([sys.executable, "-c", STEP], capture_output=True, text=True, check=True).stdout
    kernel = next(p for p in kernel_cache.entries() if p.name.startswith("kernel"))
    content = kernel.read_bytes()
    kernel.write_bytes(content[: len(content) // 2])
    again = subprocess.run([sys.executable, "-c", STEP], capture_output=True, text=True, check=True)
    assert (again.stdout, again.stderr) == (first, "")
    assert kernel.read_bytes()[-40:] != content[len(content) // 2 - 40 : len(content) // 2]


@needs_compiler
def test_a_cache_open_to_others_is_said_and_the_virtual_machine_serves(folder: Path) -> None:
    folder.mkdir(mode=0o700)
    folder.chmod(0o777)
    done = subprocess.run([sys.executable, "-c", STEP], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("False ")
    assert "may be written by others" in done.stderr


@needs_compiler
def test_a_cache_that_cannot_be_made_is_not_blamed_on_the_compiler(monkeypatch, tmp_path):
    """A file where the folder should be, as a path that is too long or lies in /proc: it once said to install gcc."""
    (tmp_path / "file").write_text("mine")
    for where in ("file", "file/below", "a" * 300):
        monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / where))
        with pytest.raises(kernel_cache.CacheError, match="PLIANT_CACHE"):
            kernel_cache.checked_folder()
        compiler.toolchain.cache_clear()
        with pytest.raises(kernel_cache.CacheError, match="cannot be made"):
            compiler.toolchain()
    compiler.toolchain.cache_clear()
    assert (tmp_path / "file").read_text() == "mine"


def test_a_folder_in_the_place_of_a_file_goes_where_it_is_empty(monkeypatch, tmp_path):
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    (tmp_path / "cache" / "kernel-1.so").mkdir(parents=True, mode=0o700)
    assert kernel_cache.path_of("kernel-1.so") is None
    kernel_cache.write("kernel-1.so", b"whole")
    assert kernel_cache.read_text("kernel-1.so") == "whole"
    full = tmp_path / "cache" / "kernel-2.so"
    (full / "inner").mkdir(parents=True)
    with pytest.raises(kernel_cache.CacheError, match="is a folder"):
        kernel_cache.path_of("kernel-2.so")
    assert (full / "inner").exists()
