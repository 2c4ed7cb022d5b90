"""The command line with nonsense in every option: one plain line and exit status 1 or 2, and nothing written.

    python tests/campaigns/bad_commands.py [--only WORD]

traceback  another exception than a refusal came out
taken      nonsense ended with status 0, or another status
words      no line "error: ..", or more than one
written    a file was left where nothing should have been
refused    a valid value ended with another status than 0
"""

from __future__ import annotations

import argparse
import collections
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from typer.testing import CliRunner

from pliant.studies.commands.cli import app

SLEW = "single-link-slew"
LONGEST = 20.0  # [s]
NUMBERS = (
    "abc",
    "",
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "1e400",
    "1,5",
    "0x10",
    "None",
    "[]",
    "\U0001f642",
    " ",
    "1 2",
    "1j",
)
COUNTS = ("abc", "", "-1", "0", "1.5", "nan", "1e3", "9" * 30, "None", "\U0001f642", "one")
WORDS = ("", "nonsense", " goal", "GOAL", "\U0001f642", "3", "goal,start", "--goal")
NAMES = ("", "nonsense", f" {SLEW}", SLEW.upper(), "../x", "\U0001f642", "3", f"{SLEW},{SLEW}", "x" * 10_000)
SETTINGS = (
    *("nonsense", "", "=", "=1", "payload.mass", "payload.mass=", "payload.mass=abc", "payload.mass=-1", "nonsense=1"),
    *("payload.mass=nan", "payload.mass=1e400", "payload.mass=[1]", "payload.mass='1'", "payload.mass=None"),
    *("payload=1", "payload.mass.x=1", "link.E=0", "modes=1.5", "modes=True", "modes=-1", "modes=abc"),
    *("duration=0", "duration=-1", "duration=1e300", "duration='3'", "dt=0", "dt=1e-300", "substeps=0", "substeps=1.5"),
    *("substeps=10**9", "limits=1", "limits=(1,2)", "limits=abc", "limits=(-1,)", "limits=()", "limits=None", "dt=1j"),
    *("payload.mass=__import__('os')", "payload.mass=(1).real", "payload.mass=" + "9" * 5000, "duration=" + "(" * 500),
    *("kinematics=nonsense", "kinematics=", "tolerance=0", "start_spread=-1", "payload.mass=\U0001f642", "name=x"),
)
NUMBER = {"--budget", "--step", "--rtol", "--tolerance", "--period", "--window", "--seconds"}
OPTIONS = {  # each command: its valid words, then its options
    "simulate": ((SLEW,), ("--set", "--method", "--step", "--rtol", "--out", "--plot")),
    "linearize": ((SLEW,), ("--set", "--at", "--plot")),
    "identify": ((SLEW, "missing.csv"), ("--vary", "--noise", "--bound", "--tries", "--plot")),
    "chart": ((SLEW,), ("--set", "--budget", "folder --out", "--plot")),
    "choose": ((SLEW,), ("--set", "--tolerance", "--plot")),
    "train": (
        (SLEW,),
        ("--set", "--algorithm", "--seed", "--seconds", "--steps", "--num-envs", "--threads", "folder --out"),
    ),
    "report": ((SLEW,), ("--set", "--versus", "--budget", "folder --out")),
    "figures": (("single-link",), ("folder --out",)),
    "stability": ((SLEW,), ("--set", "--period", "--window", "--plot")),
    "scoreboard": ((SLEW,), ("--seeds", "--controllers", "--seed", "--jobs", "--bounds", "folder --out")),
    "cache": (("info",), ()),
}
VALID = (
    ("scenes",),
    ("scenes", "--json"),
    ("cache", "info", "--json"),
    ("linearize", SLEW, "--at", "start"),
    ("linearize", SLEW, "--set", "payload.mass=1", "--set", "duration=2", "--json"),
    ("linearize", SLEW, "--set", "limits=[20]", "--set", "modes=1", "--set", "kinematics=linear"),
    ("linearize", "spin-up", "--set", "speed=4"),
    ("simulate", SLEW, "--method", "rk4", "--step", "0.01", "--set", "duration=1"),
    ("simulate", SLEW, "--rtol", "1e-4", "--set", "duration=0.5", "--json"),
)


def nonsense(folder: Path) -> Iterator[tuple[str, ...]]:
    """Arguments that must be refused; `folder` is where files would go."""
    for command, (words, options) in OPTIONS.items():
        yield from ((command, name) for name in NAMES)
        yield (command, *words, "--nonsense")
        yield (command, *words, "--nonsense=1")
        if command != "scoreboard":
            yield (command, *words, "more")
            yield (command,)
        for option in options:
            for value in values(command, option, folder):
                yield (command, *words, *option.split()[-1:], value)
            yield (command, *words, option.split()[-1])
    for command in ("scenes", "doctor"):
        yield from ((command, "more"), (command, "--nonsense"), (command, "--json=maybe"))
    yield from (("nonsense",), ("",), ("\U0001f642",), ("Simulate", SLEW))


def values(command: str, option: str, folder: Path) -> Iterator[str]:
    """What an option must not be."""
    if option in ("--set", "--versus"):
        yield from SETTINGS
    elif option in NUMBER:
        yield from NUMBERS
    elif option in ("--method", "--at", "--algorithm"):
        yield from WORDS
    elif option == "--controllers":
        yield from ("", ",", "nonsense", "LQR,nonsense", "LQR,", "lqr", "\U0001f642")
    elif option.startswith("--") and option not in ("--out", "--plot"):
        taken = {"--seed": "0", "--bounds": "0", "--jobs": "-1"}.get(option)  # -1: as many processes as cores
        yield from (value for value in COUNTS if value != taken)
    elif option.startswith("folder"):
        yield from (str(folder / "file"), str(folder / "file" / "x"), str(folder / ("n" * 300)))
        if command == "report":
            yield str(folder)  # holds other files
    else:
        ending = ".png" if option == "--plot" else ".json"
        yield from (str(folder), str(folder / "missing" / f"x{ending}"), str(folder / "file" / f"x{ending}"), "")
        yield str(folder / f"{'n' * 300}{ending}")
        yield from (str(folder / "x"), str(folder / "x.nonsense"), str(folder / ".png")) if option == "--plot" else ()


def judged(arguments: tuple[str, ...], valid: bool, folder: Path) -> tuple[str, str]:
    """(fault or "", the words of it)."""
    before = sorted(folder.iterdir())
    began = time.perf_counter()
    result = CliRunner().invoke(app, list(arguments))
    took, told = time.perf_counter() - began, result.stderr
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        return "traceback", repr(result.exception)
    if valid:
        return ("", "") if result.exit_code == 0 else ("refused", told)
    if result.exit_code not in (1, 2):
        return "taken", result.stdout[:100]
    lines = [line for line in told.splitlines() if " % " not in line]
    if len(lines) != 1 or not lines[0].startswith("error: ") or len(lines[0]) < 12:
        return "words", told
    if sorted(folder.iterdir()) != before:
        return "written", str(sorted(folder.iterdir()))
    return ("slow", f"{took:.0f} s") if took > LONGEST else ("", "")


def cases(folder: Path) -> list[tuple[tuple[str, ...], bool]]:
    """Every (arguments, whether they are valid)."""
    (folder / "file").write_text("kept\n", encoding="utf-8")
    return [*((given, False) for given in nonsense(folder)), *((given, True) for given in VALID)]


def main() -> None:
    """Run the campaign; exit with 1 where anything is at fault."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--only", default="", help="of commands that begin with this")
    given = ask.parse_args()
    home, found = Path.cwd(), collections.Counter()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        os.chdir(folder)  # what goes into a folder of the command's own choice is seen too
        try:
            for arguments, valid in cases(folder):
                if arguments[0].startswith(given.only):
                    fault, words = judged(arguments, valid, folder)
                    found[fault or "right"] += 1
                    if fault:
                        short = " ".join(a if len(a) < 60 else f"{a[:57]}..." for a in arguments)
                        print(f"{fault:9s} pliant {short}: {' '.join(words.split())[:200]}", flush=True)
        finally:
            os.chdir(home)
    print(", ".join(f"{count} {kind}" for kind, count in found.items()))
    sys.exit(any(kind != "right" for kind in found))


if __name__ == "__main__":
    main()
