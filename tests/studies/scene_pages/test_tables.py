"""Tables of a scene: against the tables that stand by hand in the scenes' docstrings."""

import dataclasses
import re

import pytest

from pliant.envs import scenes
from pliant.envs.scenes.registry import SCENES
from pliant.studies.scene_pages import tables

WRITTEN = {  # by hand, in docstrings: the head of a table -> what it is called here, and the columns that it shows
    "observation": ("observation", (0, 1)),
    "action": ("action", (0, 1, 2, 3)),
    "cost of the deviation in": ("cost", (0, 1, 2)),
    "ends beyond": ("ends beyond", (0, 1, 2)),
}


def by_hand(name: str) -> dict[str, list[list[str]]]:
    """The docstring's tables by their first head."""
    found: dict[str, list[list[str]]] = {}
    rows: list[list[str]] | None = None
    for line in (SCENES[name].__doc__ or "").splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if "|" not in line:
            rows = None
        elif rows is None:
            rows = found[cells[0]] = []
        elif not set(cells[0]) <= {"-"}:
            rows.append(cells)
    return found


@pytest.mark.parametrize("name", SCENES)
def test_tables_say_what_the_docstrings_say(name: str) -> None:
    made = {table.about: table for table in tables(scenes.get(name))}
    compared = 0
    for head, rows in by_hand(name).items():
        about, columns = WRITTEN.get(head, ("", ()))
        if about not in made or any(".." in cell or "," in cell for row in rows for cell in row[:1]):
            continue  # several signals told in one row
        for row, own in zip(rows, made[about].rows, strict=True):
            signal, unit, *numbers = row
            assert re.split(" [-+] ", signal)[0] == own[0] and unit in (own[1], "1" if own[1] == "" else own[1])
            for text, value in zip(numbers, [own[i] for i in columns[2:]]):
                assert float(text) == pytest.approx(value, rel=1e-3)
                compared += 1
    assert compared or name not in ("single-link-slew", "two-link-reach", "spin-up")


def test_a_scene_that_is_not_registered_has_no_id() -> None:
    scene = dataclasses.replace(scenes.get("single-link-slew"), limits=(20.0,))
    assert tables(scene)[0].rows[0][1] == "none; PlantEnv(scene) makes it"
    assert tables(scenes.get("single-link-slew"))[0].rows[0][1] == "pliant/SingleLinkSlew-v0"


def test_what_is_drawn_is_told() -> None:
    rows = {row[0]: row[1:] for row in tables(scenes.get("two-link-reach"))[-1].rows}
    assert rows == {
        "payload.mass": ("", "0.7 to 1.3 times"),
        "start of theta1": ("rad", "within 0.1"),
        "start of theta2": ("rad", "within 0.1"),
    }


def test_no_scene() -> None:
    with pytest.raises(ValueError, match=r"tables\.scene"):
        tables("two-link-reach")  # type: ignore[arg-type]
