"""Keep CONTRIBUTING.md's list of modules without a test file of their name: `python docs/house/untested.py`.

A reason that stands in the list stays. A module that is new to it gets the test files that import from it, the nearest
first; one that no test imports from is printed, for a reason or a test to be written. Modules that have got a test
file, or that are gone, leave the list.
"""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from check import named
from import_graph import ROOT, imports, modules

from pliant.plants.files.atomic_files import write_text

HEADING = "Modules without a test file"
PAGE = ROOT / "CONTRIBUTING.md"
SHOWN = 2  # test files told of a module


def lacking(found: Mapping[str, Path]) -> Iterator[str]:
    for module, path in found.items():
        *folders, name = module.split(".")
        if path.name != "__init__.py" and not (ROOT / "tests" / Path(*folders) / f"test_{name}.py").is_file():
            yield module


def imported(path: Path) -> set[str]:
    """Modules of Pliant, without `pliant.`, that a test file imports from; modules imported from a package included."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("pliant."):
            base = node.module.removeprefix("pliant.")
            found |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            found |= {alias.name.removeprefix("pliant.") for alias in node.names if alias.name.startswith("pliant.")}
    return found


def tests_of(module: str, tests: Mapping[Path, set[str]], users: Mapping[str, set[str]]) -> list[Path]:
    """Test files that import from the module, else those of the modules of its room that do; the nearest first."""

    def near(path: Path) -> int:
        return -len(os.path.commonpath([path.with_suffix(""), ROOT / "tests" / Path(*module.split("."))]))

    direct = sorted((path for path, names in tests.items() if module in names), key=lambda p: (near(p), str(p)))
    if direct:
        return direct[:SHOWN]
    through = []
    for user in sorted(users.get(module, ()), key=lambda u: (u.rpartition(".")[0] != module.rpartition(".")[0], u)):
        *folders, name = user.split(".")
        path = ROOT / "tests" / Path(*folders) / f"test_{name}.py"
        if path.is_file():
            through.append(path)
    return through[:SHOWN]


def main() -> int:
    found = modules()
    kept = named(ROOT, HEADING)
    tests = {path: imported(path) for path in sorted((ROOT / "tests").rglob("test_*.py"))}
    users: dict[str, set[str]] = {}
    for arrow in imports(found):
        if arrow.own and not arrow.typing:
            users.setdefault(arrow.target, set()).add(arrow.source)
    reasons: dict[str, list[str]] = {}
    nothing = []
    for module in lacking(found):
        reason = kept.get(module, "")
        if not reason or reason.startswith("tests/"):  # the tests may have moved
            files = tests_of(module, tests, users)
            reason = " and ".join(str(path.relative_to(ROOT)) for path in files)
        if reason:
            reasons.setdefault(reason, []).append(module)
        else:
            nothing.append(module)
    lines = [f"- {', '.join(f'`{m}`' for m in names)}: {reason}" for reason, names in reasons.items()]
    text = PAGE.read_text(encoding="utf-8")
    head, rest = re.split(rf"(?<=## {HEADING}\n)", text)
    said, *_ = rest.split("\n- ", 1)
    write_text(PAGE, head + said.rstrip() + "\n\n" + "\n".join(lines) + "\n")
    print(*(f"no test imports from {module}" for module in nothing), sep="\n", file=sys.stderr)
    return 1 if nothing else 0


if __name__ == "__main__":
    sys.exit(main())
