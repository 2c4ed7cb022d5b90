"""What the commands share: plain errors, tables; the bar on stderr is that of studies."""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
import textwrap
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperGroup

from pliant.plants.core.errors import PliantError
from pliant.studies.common.atomic_files import dumps
from pliant.studies.common.progress_bar import progress_bar as bar
from pliant.studies.figures.style import require_ending

USAGE: Any = typer.BadParameter.__mro__[1]  # what typer says of an option that it does not know or cannot read
LONGEST_NAME = 255  # bytes of a file's name
REPORT_IT = "This is a fault of Pliant's: please report this line with the command that you gave and `pliant doctor`"
BORDERS = 3  # characters of a table beside each column
__all__ = ["bar"]  # what commands take from here and other rooms made


class Commands(TyperGroup):
    """Bad input ends with its message and exit code 2, any other failure that a plant reports, or fault, with 1."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except BrokenPipeError:  # the reader, such as `head`, has seen enough
            raise
        except USAGE as error:
            complain(_with_help(error.format_message(), ctx))
            raise typer.Exit(2) from None
        except (ValueError, OSError) as error:
            complain(_with_help(str(error), ctx))
            raise typer.Exit(2) from None
        except PliantError as error:
            complain(f"{type(error).__name__}: {error}")
            raise typer.Exit(1) from None
        except (typer.Exit, typer.Abort):
            raise
        except Exception as error:  # last: a fault, which people are told in a line that they can report
            complain(f"{type(error).__name__}: {error} in {_where(error)}. {REPORT_IT}")
            raise typer.Exit(1) from None


def _with_help(message: str, ctx: Any) -> str:
    """The message, and where to look for what is right unless it says so itself."""
    command = " ".join(("pliant", *filter(None, [ctx.invoked_subcommand])))
    return message if "`pliant" in message else f"{message} (see `{command} --help`)"


def _where(error: BaseException) -> str:
    """The innermost place of this library that an exception went through: module and line."""
    frames = [(f.f_globals.get("__name__", "?"), line) for f, line in traceback.walk_tb(error.__traceback__)]
    module, line = next((at for at in reversed(frames) if at[0].startswith("pliant.")), frames[-1])
    return f"{module}, line {line}"


def print_json(value: Any) -> None:
    """JSON on stdout."""
    print(dumps(value))


def complain(message: str) -> None:
    """One line on stderr."""
    print(f"error: {' '.join(message.split())}", file=sys.stderr)


def in_words(plain: Callable[..., str]) -> Callable[..., str]:
    """How warnings are printed: those of this library in one line, as errors are, all others as by `plain`."""

    def line(message: Warning | str, category: type[Warning], *where: Any) -> str:
        if not category.__module__.startswith("pliant."):
            return plain(message, category, *where)
        return f"warning: {' '.join(str(message).split())}\n"

    return line


def writable(option: str, path: Path | None) -> None:
    """ValueError, before long work, where a file cannot be written: no folder, no right, a folder of that name."""
    if path is None:
        return
    _require_short(option, path)
    if not path.name or path.is_dir():
        raise ValueError(f"{option} {str(path)!r} must be a file")
    if not path.parent.is_dir():
        raise ValueError(f"{option} {str(path)!r}: there is no folder {str(path.parent)!r}")
    if not (os.access(path, os.W_OK) if path.exists() else _takes_files(path.parent)):
        raise ValueError(f"{option} {str(path)!r} cannot be written")


def writable_folder(option: str, path: Path | None) -> None:
    """The same of a folder, which is made where it is missing."""
    if path is None:
        return
    _require_short(option, path)
    nearest = next((p for p in (path, *path.parents) if p.exists()), Path())
    if not nearest.is_dir():
        raise ValueError(f"{option} {str(path)!r}: {str(nearest)!r} must be a folder")
    if not _takes_files(nearest):
        raise ValueError(f"{option} {str(path)!r}: nothing can be written into {str(nearest)!r}")


def _require_short(option: str, path: Path) -> None:
    """Asked first: of a longer name nothing else can be asked."""
    longest = max((len(os.fsencode(part)) for part in path.parts), default=0)
    if longest > LONGEST_NAME:
        raise ValueError(f"{option} has a name of {longest} bytes, must be at most {LONGEST_NAME}")


def _takes_files(folder: Path) -> bool:
    """Whether a file can be made there: rights alone do not tell it of /proc, or of a full or read-only disk."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def drawable(path: Path | None) -> None:
    """The same of a picture, whose ending says how it is drawn."""
    writable("--plot", path)
    if path is not None:
        require_ending("--plot", path)


def show(
    title: str, head: Sequence[str], rows: Sequence[Sequence[Any]], *, caption: str = "", whole: Sequence[int] = (0,)
) -> None:
    """A table on stdout; numbers to four digits, set right.

    Cells of the columns `whole` (names) stay on one line, others break between words. Columns that do not fit beside
    one another go into further tables, each with the first column again; only a column that does not fit beside the
    first makes a table wider than the terminal.
    """
    from rich.console import Console
    from rich.text import Text

    cells = [[_text(value) for value in row] for row in rows]
    columns = [[name, *(row[i] for row in cells)] for i, name in enumerate(head)]
    numeric = [any(isinstance(row[i], (int, float)) for row in rows) for i in range(len(head))]
    room = Console().width
    for part in beside(columns, room, whole):
        kept = [k for k, i in enumerate(part) if i in whole]
        _print_table([columns[i] for i in part], [numeric[i] for i in part], room, kept, title)
        title = ""
    if caption:
        Console(width=room).print(Text(caption, style="table.caption"))


def _print_table(
    columns: Sequence[Sequence[str]], numeric: Sequence[bool], room: int, whole: Sequence[int], title: str
) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    widths = column_widths(columns, room, whole)
    table = Table(title=Text(title) if title else None, title_justify="left")
    for (name, *_), right, width in zip(columns, numeric, widths):
        table.add_column(Text(name), justify="right" if right else "left", width=width)
    for line in list(zip(*columns))[1:]:
        table.add_row(*(Text(text) for text in line))
    Console(width=max(room, _taken(widths))).print(table)


def _taken(widths: Sequence[int]) -> int:
    """Characters of a table with its borders."""
    return sum(widths) + BORDERS * len(widths) + 1


def beside(columns: Sequence[Sequence[str]], room: int, whole: Sequence[int]) -> list[list[int]]:
    """Which columns of texts stand beside one another in `room` characters: tables, each with the first column."""
    found = [[0]]
    for i in range(1, len(columns)):
        wider = [*found[-1], i]
        least = column_widths([columns[k] for k in wider], 0, [n for n, k in enumerate(wider) if k in whole])
        if len(wider) > 2 and _taken(least) > room:
            wider = [0, i]
            found.append(wider)
        found[-1] = wider
    return found


def column_widths(columns: Sequence[Sequence[str]], room: int, whole: Sequence[int]) -> list[int]:
    """Characters of each column of texts in `room` characters, borders not counted.

    At least the longest word, of the columns `whole` the longest text; what is left goes where most lines are saved.
    """
    full = [max(map(len, texts)) for texts in columns]
    least = [max((len(word) for text in texts for word in text.split()), default=1) for texts in columns]
    widths = [full[i] if i in whole else max(1, least[i]) for i in range(len(columns))]
    for _ in range(room - sum(widths) - BORDERS * len(widths) - 1):
        wanting = [i for i in range(len(widths)) if widths[i] < full[i]]
        if not wanting:
            break
        widths[max(wanting, key=lambda i: full[i] / widths[i])] += 1
    return widths


def listed(title: str, entries: Sequence[tuple[Sequence[str], str, Sequence[str]]]) -> None:
    """Entries on stdout: names, a sentence, facts. The sentence breaks between words, names and facts never break."""
    room = shutil.get_terminal_size().columns
    print(title)
    for names, sentence, facts in entries:
        lines = [*_joined(names, "  ", room), *_wrapped(sentence, room - 2), *_joined(facts, "; ", room - 2)]
        head = len(_joined(names, "  ", room))
        print("\n".join(["", *lines[:head], *(f"  {line}" for line in lines[head:])]))


def say(text: str) -> None:
    """Sentences on stdout, broken between words."""
    print("\n".join(_wrapped(text, shutil.get_terminal_size().columns)))


def say_lines(text: str) -> None:
    """Lines of a name and words beside it on stdout, the words broken under one another."""
    room = shutil.get_terminal_size().columns
    for line in text.splitlines():
        named = re.match(r"(\s*\S.*?\s{2,})(\S.*)", line)
        name, words = named.groups() if named and len(line) > room else ("", line)
        broken = _wrapped(words, max(room - len(name), 20)) if name or len(line) > room else [line]
        print("\n".join([name + broken[0], *(" " * len(name) + rest for rest in broken[1:])]))


def _wrapped(text: str, room: int) -> list[str]:
    return textwrap.wrap(text, room, break_long_words=False, break_on_hyphens=False)


def _joined(parts: Sequence[str], between: str, room: int) -> list[str]:
    """The parts on as few lines as hold each of them whole."""
    lines = [parts[0]]
    for k, part in enumerate(parts[1:], 2):
        longer = f"{lines[-1]}{between}{part}"
        if len(longer) + (len(between.rstrip()) if k < len(parts) else 0) <= room:
            lines[-1] = longer
        else:
            lines[-1] += between.rstrip()
            lines.append(part)
    return lines


def _text(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
