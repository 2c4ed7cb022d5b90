"""The `pliant` command: tables and pictures, or --json. Data go to stdout, progress to stderr.

A command's module is imported when the command is given; the list of commands takes their first lines from here.
"""

from __future__ import annotations

import importlib
import warnings
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from pliant.plants.core.imports import Late

from .console import Commands, in_words

machine, own_modules = Late("pliant.studies.common.machine"), Late("pliant.envs.scene_files.own_modules")

COMMANDS = {  # name: "module:function", and the first line of what the function says of itself
    "scenes": (
        "scenes:scenes",
        "List the scenes: shipped, registered by --with, of installed packages; or print one's page.",
    ),
    "new": (
        "scenes:new",
        "Write a commented start into this folder: a plant with its scene, or a scene that changes another.",
    ),
    "check": (
        "scenes:check",
        "Hold a plant's word against its equations: names, ladder, derivatives, energy; play a scene once.",
    ),
    "simulate": (
        "models:simulate",
        "Play a scene: its nominal inputs, or its LQR.",
    ),
    "linearize": (
        "models:linearize",
        "The exact linear model of a scene's plant at its goal or start: modes, matrices with --json.",
    ),
    "identify": (
        "models:identify",
        "Estimate parameters of a scene's plant from measured motions, with intervals and what cannot be told.",
    ),
    "chart": (
        "fidelity:chart",
        "Measure speed against accuracy: every variant of the plant, by every path and method, at several steps.",
    ),
    "choose": (
        "fidelity:choose",
        "Find the smallest model that a scene needs. Exit code 1 where none is shown to be good enough.",
    ),
    "study": (
        "fidelity:study",
        "Try what `choose` claims on random scenes. Exit code 1 where it was wrong, or crashed.",
    ),
    "train": (
        "train:command",
        "Learn to play a scene: a policy as arrays and JSON, its evaluation curve, a checkpoint to go on from.",
    ),
    "report": (
        "report:report",
        "Everything about one scene in one folder: report.html, the pictures, the tables; or about two, side by side.",
    ),
    "open": (
        "report:open_report",
        "Print where the last report of this folder is, reports/*/report.html; --show opens it.",
    ),
    "figures": (
        "report:figures",
        "Draw the figures of the paper that a plant comes from.",
    ),
    "doctor": (
        "doctor:doctor",
        "Say which compiler and vector width serve, where the cache is, and what to do if something is missing.",
    ),
    "cache": (
        "doctor:cache",
        "Show, empty or check the cache of compiled kernels; verify ends with 1 where a file is refused or damaged.",
    ),
    "stability": (
        "stability:stability",
        "Say how far disturbances push a scene's nominal motion, and whether deviations from it die out or grow.",
    ),
    "scoreboard": (
        "scoreboard:scoreboard",
        "Score every controller on every scene: cost, and its ratio to the least that is possible.",
    ),
}


class Shipped(Commands):
    """The commands by name, each imported when it is given."""

    brief = False  # whether only names and first lines are asked for

    def list_commands(self, ctx: Any) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in COMMANDS:
            return None
        if self.brief:
            return TyperCommand(cmd_name, help=COMMANDS[cmd_name][1])
        if cmd_name not in self.commands:
            self.commands[cmd_name] = command(cmd_name)
        return self.commands[cmd_name]

    def format_help(self, ctx: Any, formatter: Any) -> None:
        self.brief = True
        try:
            super().format_help(ctx, formatter)
        finally:
            self.brief = False


def command(name: str) -> Any:
    """The command of a name, whose module is imported."""
    module, _, function = COMMANDS[name][0].partition(":")
    alone = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    alone.command(name, epilog=f"Example:  {EXAMPLES[name]}")(
        getattr(importlib.import_module(f"{__package__}.{module}"), function)
    )
    return typer.main.get_command(alone)


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
    "report": "pliant report single-link-slew --versus payload.mass=0.3 --out reports/slew",
    "open": "pliant open",
    "figures": "pliant figures single-link",
    "doctor": "pliant doctor",
    "cache": "pliant cache",
    "stability": "pliant stability spacecraft-orbit",
    "scoreboard": "pliant scoreboard",
}
TRY = "Three things to try:  pliant scenes  ·  pliant choose two-link-reach  ·  pliant report single-link-slew"

app = typer.Typer(
    cls=Shipped,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    epilog=TRY,
    help="Plants that bend, for people who design controllers.",
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"pliant {machine.version('pliant')}")
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
        own_modules.import_file(path)


def main() -> None:
    """The console script."""
    warnings.formatwarning = in_words(warnings.formatwarning)
    app()
