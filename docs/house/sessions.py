"""The sessions of docs/sessions: run, and written anew with `python docs/house/sessions.py --write`.

A page is headings with prompts below them: `## TwoLinkArm` is about that class, and each heading begins anew with no
names but `np`. What is printed stands below each prompt, so that doctest reads the page as it is.
"""

from __future__ import annotations

import argparse
import contextlib
import doctest
import io
import re
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

import numpy as np

PAGES = Path(__file__).parents[1] / "sessions"
OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def sections(page: Path) -> Iterator[tuple[str, str, int]]:
    """(heading, text below it, its first line) of a page."""
    text = page.read_text(encoding="utf-8")
    found = list(re.finditer(r"^## (.+)\n", text, re.MULTILINE))
    for here, following in zip(found, [*found[1:], None]):
        end = len(text) if following is None else following.start()
        yield here[1].strip(), text[here.end() : end], text[: here.end()].count("\n")


def tests() -> Iterator[doctest.DocTest]:
    """A doctest for each section."""
    for page in sorted(PAGES.glob("*.md")):
        for heading, text, line in sections(page):
            if ">>>" in text:
                text = re.sub(r"^```\w*$", "", text, flags=re.MULTILINE)
                yield doctest.DocTestParser().get_doctest(text, {"np": np}, f"{page.stem}: {heading}", str(page), line)


def told(source: str, names: dict[str, object]) -> str:
    """What a prompt prints."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            exec(compile(source, "<session>", "single"), names)
        except Exception as error:
            last = traceback.format_exception_only(error)[-1]
            return f"Traceback (most recent call last):\n    ...\n{last}"
    return out.getvalue()


def written(text: str) -> str:
    """The text with what its prompts print, now."""
    names: dict[str, object] = {"np": np}
    found = []
    for part in doctest.DocTestParser().parse(text.replace("```\n", "\n```\n")):
        if isinstance(part, str):
            found.append(part)
            continue
        lines = part.source.rstrip("\n").split("\n")
        found.append("".join(f"{'...' if k else '>>>'} {line}".rstrip() + "\n" for k, line in enumerate(lines)))
        found.append(told(part.source, names))
    return "".join(found).replace("\n\n```\n", "\n```\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write what the prompts print")
    given = parser.parse_args()
    np.set_printoptions(precision=4, suppress=True)
    if given.write:
        for page in sorted(PAGES.glob("*.md")):
            text = page.read_text(encoding="utf-8")
            head, *parts = re.split(r"^(?=## )", text, flags=re.MULTILINE)
            page.write_text(head + "".join(written(part) for part in parts), encoding="utf-8")
    runner = doctest.DocTestRunner(optionflags=OPTIONS)
    for test in tests():
        runner.run(test)
    return int(runner.summarize(verbose=False).failed > 0)


if __name__ == "__main__":
    sys.exit(main())
