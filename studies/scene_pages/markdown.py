"""A scene's page in markdown."""

from __future__ import annotations

from collections.abc import Sequence

from pliant.envs.scenes.scene import Scene

from .tables import Cell, Table, tables

REWARD = (
    "The reward of a control period is minus dt times the sum of weight x (deviation from the goal)^2, at the "
    "period's start and with the clipped input; a return is their sum."
)


def markdown(scene: Scene, *further: Table, picture: str = "") -> str:
    """The page: what the scene is, its tables, then `further` ones; `picture` is a file's name beside it.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> markdown(scenes.get("single-link-slew")).splitlines()[0]
    '# single-link-slew'
    """
    found = [f"# {scene.name}", f"{_sentence(scene.about)}"]
    found += [f"![{scene.name} as its environment draws it]({picture})"] if picture else []
    for table in (*tables(scene), *further):
        found.append(f"## {_title(table.about)}")
        found += [REWARD] if table.about == "cost" else []
        found.append(_rows(table.head, table.rows))
    return "\n\n".join(found) + "\n"


def _rows(head: Sequence[str], rows: Sequence[Sequence[Cell]]) -> str:
    lines = [head, ["---" if not _numbers(rows, i) else "---:" for i in range(len(head))]]
    lines += [[_cell(value) for value in row] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _numbers(rows: Sequence[Sequence[Cell]], column: int) -> bool:
    return any(not isinstance(row[column], str) for row in rows)


def _cell(value: Cell) -> str:
    return value.replace("|", "\\|") if isinstance(value, str) else f"{value:.6g}"


def _title(text: str) -> str:
    return text[0].upper() + text[1:]


def _sentence(text: str) -> str:
    return f"{_title(text)}."
