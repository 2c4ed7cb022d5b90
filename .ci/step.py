"""Run one step of the set-up: one line that says what is being done and for how long, its output in a log.

    python .ci/step.py "what is being done" LOG command ...

The log is shown when the command fails, and only then. On a terminal the line also names the package at hand; elsewhere
a dot is added every ten seconds.
"""

import re
import subprocess
import sys
import time
from pathlib import Path

FIRST_WORDS = re.compile(r"(Collecting|Downloading|Building|Preparing|Installing) +([^\s:;(\[<>=~!]+)")
SHOWN_ON_FAILURE = 60  # lines of the log
DOT_EVERY = 10.0  # [s]


def at_hand(log: Path) -> str:
    """What the log speaks of last, in two words."""
    found = FIRST_WORDS.findall(log.read_text(errors="replace"))
    return "" if not found else " ".join((found[-1][0].lower(), Path(found[-1][1]).name))


def run(what: str, log: Path, command: list[str], terminal: bool) -> int:
    """The command's exit status; progress goes to stderr."""
    log.parent.mkdir(parents=True, exist_ok=True)
    start, dots = time.monotonic(), 0
    if not terminal:
        print(f"{what} ", end="", file=sys.stderr, flush=True)
    with log.open("wb") as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        while True:
            passed = time.monotonic() - start
            if terminal:
                print(f"\r\x1b[K{what}: {passed:.0f} s  {at_hand(log)[:40]}", end="", file=sys.stderr, flush=True)
            elif passed > (dots + 1) * DOT_EVERY:
                dots += 1
                print(".", end="", file=sys.stderr, flush=True)
            try:
                code = process.wait(0.5)
                break
            except subprocess.TimeoutExpired:
                continue
    start_of_line = f"\r\x1b[K{what}: " if terminal else " " * (dots > 0)
    passed = time.monotonic() - start
    print(f"{start_of_line}{'done' if code == 0 else 'FAILED'} after {passed:.0f} s", file=sys.stderr, flush=True)
    if code:
        lines = log.read_text(errors="replace").splitlines()[-SHOWN_ON_FAILURE:]
        print(*lines, f"(the last lines of {log})", sep="\n", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(run(sys.argv[1], Path(sys.argv[2]), sys.argv[3:], sys.stderr.isatty()))
