"""What killed processes leave is finished or removed; what a living one writes stays."""

import os
import time

import kills
import pytest

from pliant.plants.files import leftovers


def ended():
    """The number of a process that has ended."""
    number = os.fork()
    if number == 0:
        os._exit(0)
    os.waitpid(number, 0)
    return number


def of(process, role="part", machine=None, start=None):
    """A name as another process would have made it."""
    _, own, _, began, serial = leftovers.name(role).split("-")
    return "-".join([".pliant", machine or own, str(process), start or began, serial])


def test_a_name_says_whose_it_is_and_each_is_new():
    one, other = leftovers.name("part"), leftovers.name("part")
    assert one != other and one.startswith(leftovers.PREFIX) and f"-{os.getpid()}-" in one
    assert len(one) < 100  # far from what file systems allow


def test_only_the_dead_are_cleaned_after(tmp_path):
    own, dead, reused = leftovers.name("part"), of(ended()), of(os.getpid(), start="1")
    for name in (own, dead, reused, "report.json", ".pliant-mine"):
        (tmp_path / name).write_text("half")
    (tmp_path / of(ended())).mkdir()
    leftovers.settle(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {own, "report.json", ".pliant-mine"}


def test_a_process_that_ended_but_was_not_asked_for_is_dead(tmp_path):
    number = os.fork()
    if number == 0:
        os._exit(0)
    name = of(number, start="0")
    (tmp_path / name).write_text("half")
    late = time.monotonic() + 5
    while not leftovers.is_left(tmp_path / name) and time.monotonic() < late:
        time.sleep(0.01)
    assert leftovers.is_left(tmp_path / name)
    os.waitpid(number, 0)


def test_of_another_machine_only_age_tells(tmp_path):
    """Its process numbers mean nothing here, where one of them may run or not."""
    young, old = of(1, machine="0123456789ab"), of(2, machine="0123456789ab")
    for name in (young, old):
        (tmp_path / name).write_text("half")
    yesterday = time.time() - leftovers.AGE - 1
    os.utime(tmp_path / old, (yesterday, yesterday))
    leftovers.settle(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [young]


def announced(folder, dead, pairs):
    """What a process leaves that was killed after it had announced, before anything took its place."""
    names = []
    for place, text in pairs:
        part = folder / of(dead)
        part.write_text(text)
        names.append((part.name, place))
    ready = leftovers.announce(folder, names)
    os.rename(ready, folder / of(dead, "ready"))
    return names


def test_what_was_announced_takes_its_place(tmp_path):
    (tmp_path / "a").write_text("old a")
    names = announced(tmp_path, ended(), [("a", "new a"), ("b", "new b")])
    os.replace(tmp_path / names[0][0], tmp_path / "a")  # one was quick
    leftovers.settle(tmp_path)
    assert {p.name: p.read_text() for p in tmp_path.iterdir()} == {"a": "new a", "b": "new b"}
    leftovers.settle(tmp_path)


def test_whoever_finishes_may_be_killed_too(tmp_path):
    """Before each of its calls of the system: the next one finishes all the same."""
    k, kills_done = 1, 0
    while True:
        folder = tmp_path / str(k)
        folder.mkdir()
        for name in "ab":
            (folder / name).write_text("old")
        announced(folder, ended(), [("a", "new"), ("b", "new")])
        number = kills.child(lambda folder=folder: leftovers.settle(folder), lambda k=k: kills.at_call(k))
        _, status = os.waitpid(number, 0)
        leftovers.settle(folder)
        assert {p.name: p.read_text() for p in folder.iterdir()} == {"a": "new", "b": "new"}
        if os.WIFEXITED(status):
            break
        k, kills_done = k + 1, kills_done + 1
    assert kills_done >= 3


def test_what_cannot_take_its_place_is_kept_for_another_time(tmp_path):
    (tmp_path / "a").mkdir()
    announced(tmp_path, ended(), [("a", "new a"), ("b", "new b")])
    leftovers.settle(tmp_path)
    assert len(list(tmp_path.glob(".pliant-*"))) >= 2
    (tmp_path / "a").rmdir()
    leftovers.settle(tmp_path)
    assert {p.name: p.read_text() for p in tmp_path.iterdir()} == {"a": "new a", "b": "new b"}


@pytest.mark.parametrize("pair", [["notes.txt", "a"], ["PART", "../a"], ["PART", ".."], ["PART", ""]])
def test_a_list_moves_nothing_but_own_parts_within_its_folder(tmp_path, pair):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    part = folder / of(ended())
    part.write_text("x")
    ready = leftovers.announce(folder, [(part.name if pair[0] == "PART" else pair[0], pair[1])])
    with pytest.raises(ValueError, match="must be names of this folder"):
        leftovers.finish(ready)
    assert (folder / "notes.txt").read_text() == "mine" and list(tmp_path.iterdir()) == [folder]


def test_a_folder_that_made_room_comes_back_unless_another_is_there(tmp_path):
    dead = ended()
    former = tmp_path / of(dead, "former.report")
    for content in ("former", "newer"):
        former.mkdir()
        (former / "a").write_text(content)
        leftovers.settle(tmp_path)
        assert {p.name for p in tmp_path.iterdir()} == {"report"}
    assert (tmp_path / "report" / "a").read_text() == "former"


def test_a_missing_folder_has_nothing_left(tmp_path):
    leftovers.settle(tmp_path / "none")
    assert not leftovers.is_left(tmp_path / of(1, machine="0123456789ab"))
