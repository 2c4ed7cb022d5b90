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
from .report import figures, open_report, report
from .scenes import check, new, scenes
from .scoreboard import scoreboard
from .stability import stability

# One line of each command's help: a call that works as it stands.
EXAMPLES = {
    "scenes": "pliant scenes two-link-reach",
    "new": "pliant new plant crane",
    "check": "pliant check two-link-reach",
    "simulate": "pliant simulate two-link-reach --set payload.mass=0.7 --plot motion.png",
    "linearize": "pliant linearize two-link-reach",
    "identify": "pliant identify two-link-reach run1.csv --vary payload.mass",
    "chart": "pliant chart two-link-reach --out charts",
    "choose": "pliant choose two-link-reach --tolerance 1e-3",
    "study": "pliant study effectivity",
    "train": "pliant train single-link-slew",
    "report": "pliant report single-link-slew --out reports/slew",
    "open": "pliant open",
    "figures": "pliant figures single-link",
    "doctor": "pliant doctor",
    "cache": "pliant cache",
    "stability": "pliant stability spacecraft-orbit",
    "scoreboard": "pliant scoreboard",
}
TRY = "Three things to try:  pliant scenes  ·  pliant choose two-link-reach  ·  pliant report single-link-slew"

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    epilog=TRY,
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
    "open": open_report,
    "figures": figures,
    "doctor": doctor.doctor,
    "cache": doctor.cache,
    "stability": stability,
    "scoreboard": scoreboard,
}
for name, function in COMMANDS.items():
    app.command(name, epilog=f"Example:  {EXAMPLES[name]}")(function)


def main() -> None:
    """The console script."""
    warnings.formatwarning = in_words(warnings.formatwarning)
    app()
