"""Arguments and options that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

SceneName = Annotated[str, typer.Argument(help="A scene's name, which `pliant scenes` lists, or its file: crane.toml.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="Change the plant (payload.mass=0.7) or the scene (duration=5, goal.theta1=0.3).",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Write JSON to stdout in place of the table.")]
Picture = Annotated[Path | None, typer.Option("--plot", help="Draw into this file: png, svg or pdf.")]
Budget = Annotated[float, typer.Option(help="Seconds of processor time that the measurement may take.")]
