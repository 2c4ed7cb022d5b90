"""How far long work is: a bar in a terminal and in a notebook, a line now and then elsewhere."""

from __future__ import annotations

import html
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, Any

from pliant.plants.core.argument_gates import require_text

if TYPE_CHECKING:  # of a room that takes long to import
    from .reference_motions import Progress


def progress_bar(title: str) -> AbstractContextManager[Progress]:
    """What studies take as `progress`, a function of the share that is done [-] and of words on what is being done.

    In a terminal a bar on stderr, in a notebook one below the cell, elsewhere a line on stderr for each tenth.
    ValueError unless the title is text.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> from pliant.studies import choose
    >>> with progress_bar("choose") as told:
    ...     found = choose(scenes.get("single-link-slew"), progress=told)
    >>> found.met
    True
    """
    return _shown(require_text("progress_bar.title", title))


@contextmanager
def _shown(title: str) -> Iterator[Progress]:
    cell = _notebook()
    if cell is not None:
        yield _in_cell(title, cell)
        return
    from rich.console import Console

    console = Console(stderr=True, force_jupyter=False)
    if not console.is_terminal:
        yield _lines(title)
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[doing]}"),
    )
    with Progress(*columns, console=console, transient=True) as bars:
        task = bars.add_task(title, total=1.0, doing="")
        yield lambda fraction, doing: bars.update(task, completed=fraction, doing=doing)


def _lines(title: str) -> Progress:
    last = -1

    def tell(fraction: float, doing: str) -> None:
        nonlocal last
        tenth = int(10 * fraction + 1e-9)
        if tenth > last:
            last = tenth
            print(f"{title} {10 * tenth:3d} %  {doing}", file=sys.stderr, flush=True)

    return tell


def _notebook() -> Any:
    """IPython's `display` and `HTML` where a notebook's kernel runs this, else None; IPython is never imported."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return None if getattr(shell, "kernel", None) is None else sys.modules["IPython"].display


def _in_cell(title: str, cell: Any) -> Progress:
    """One output of the cell, written anew for each per cent or new words."""
    shown: tuple[int, str] = (0, "")

    def drawn() -> Any:
        name, words = html.escape(title), html.escape(shown[1])
        return cell.HTML(f"{name} <progress max='100' value='{shown[0]}'></progress> {shown[0]} % {words}")

    handle = cell.display(drawn(), display_id=True)

    def tell(fraction: float, doing: str) -> None:
        nonlocal shown
        now = (int(100 * fraction + 1e-9), doing)
        if now != shown:
            shown = now
            handle.update(drawn())

    return tell
