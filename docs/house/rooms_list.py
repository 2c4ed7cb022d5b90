"""Write the list of rooms in CONTRIBUTING.md from rooms.toml: `python docs/house/rooms_list.py`."""

from __future__ import annotations

import re

from import_graph import FOLDERS, ROOT, settings

from pliant.plants.files.atomic_files import write_text

PAGE = ROOT / "CONTRIBUTING.md"


def listed() -> str:
    """The rooms in their order, folder by folder where they follow each other."""
    lines = ["| room | what is in it |", "|---|---|"]
    lines += [f"| {room['name'].replace('.', '/')} | {room['what']} |" for room in settings()["room"]]
    assert all(room["name"].split(".")[0] in FOLDERS for room in settings()["room"])
    return "\n".join(lines)


def written(text: str) -> str:
    """The page with the list in its place."""
    list_ = f"<!-- rooms -->\n{listed()}\n<!-- /rooms -->"
    return re.sub(r"<!-- rooms -->.*?<!-- /rooms -->", lambda _: list_, text, flags=re.DOTALL)


if __name__ == "__main__":
    write_text(PAGE, written(PAGE.read_text(encoding="utf-8")))
