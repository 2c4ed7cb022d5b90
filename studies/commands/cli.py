"""The `pliant` command: tables and pictures, or --json. Data go to stdout, progress to stderr."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from pliant.envs.scene_files.own_modules import import_file
from pliant.studies.common.machine import version as version_of

from . import doctor, fidelity, models, train
from .console import Commands, in_words
from .report import figures, report
from .scenes import check, new, scenes
from .scoreboard import scoreboard
from .stability import stability

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Plants that bend, for people who design controllers.",
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"pliant {version_of('pliant')}")
        raise typer.Exit()


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and end.")
    ] = False,
    own: Annotated[
        list[Path] | None,
        typer.Option("--with", metavar="FILE.py", help="Run this Python file first: your plants and scenes."),
    ] = None,
) -> None:
    """Plants that bend, for people who design controllers."""
    for path in own or []:
        import_file(path)


COMMANDS: dict[str, Callable[..., Any]] = {
    "scenes": scenes,
    "new": new,
    "check": check,
    "simulate": models.simulate,
    "linearize": models.linearize,
    "identify": models.identify,
    "chart": fidelity.chart,
    "choose": fidelity.choose,
    "study": fidelity.study,
    "train": train.command,
    "report": report,
    "figures": figures,
    "doctor": doctor.doctor,
    "cache": doctor.cache,
    "stability": stability,
    "scoreboard": scoreboard,
}
for name, function in COMMANDS.items():
    app.command(name)(function)


def main() -> None:
    """The console script."""
    warnings.formatwarning = in_words(warnings.formatwarning)
    app()
