"""Does the house stand? `make check-house` lists what breaks its rules, and fails if anything does.

Order    a room imports only from rooms above it in rooms.toml, also inside functions and for types
Folders  controllers and envs import plants; studies imports all three; nothing else
Lazy     inside a function only what rooms.toml names under [lazy], and the standard library
Circles  none between modules; what is imported for types alone keeps the order of rooms and may close one in a room
Size     files of a room, lines of a file, lines of a class: [limits], exceptions with reasons in CONTRIBUTING.md
Tests    each module has tests/<folder>/<room>/test_<module>.py, or stands in CONTRIBUTING.md with the reason
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from import_graph import FOLDERS, HERE, ROOT, Import, circles, imports, modules, room_of, settings

OPTIONAL = {"stable_baselines3", "torch", "pufferlib", "jax"}  # installed with an extra only
MAY = {"plants": {"plants"}, "controllers": {"plants", "controllers"}, "envs": {"plants", "envs"}}


def named(root: Path, heading: str) -> dict[str, str]:
    """{what stands in backquotes: the reason after it} of the list under a heading of CONTRIBUTING.md."""
    path = root / "CONTRIBUTING.md"
    if not path.is_file():
        return {}
    part = re.search(rf"^#+ {re.escape(heading)}\n(.*?)(?=^#|\Z)", path.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    found = {}
    for item in re.findall(r"^[-*] (.*(?:\n(?![-*#\n]).*)*)", part[1] if part else "", re.MULTILINE):
        names, _, why = item.partition(": ")
        found |= {name: why.strip() for name in re.findall(r"`([^`]+)`", names) if why.strip()}
    return found


def wrong_order(arrows: Sequence[Import], order: Mapping[str, int]) -> Iterator[str]:
    """Rooms not listed, rooms that import from below, folders that import the wrong way."""
    unknown = sorted({room_of(a.source) for a in arrows if "." in a.source} - set(order))
    yield from (f"room {room}: not in rooms.toml" for room in unknown)
    for a in arrows:
        if not a.own:
            continue
        place = f"{a.source}:{a.line} imports {a.target}"
        kind = " (for types)" if a.typing else " (in a function)" if a.lazy else ""
        here, there = room_of(a.source), room_of(a.target)
        if a.target.split(".")[0] not in MAY.get(a.source.split(".")[0], set(FOLDERS)):
            yield f"folder: {place}{kind}"
        elif here in order and there in order and order[there] > order[here]:
            yield f"order: {place}{kind}: {there} stands below {here}"
        elif here in order and there == here.split(".")[0]:
            yield f"order: {place}{kind}: import it from its room, not from {there}"


def wrong_lazy(arrows: Sequence[Import], allowed: Sequence[str]) -> Iterator[str]:
    """Imports inside functions of what has no reason to be late. A module of the same room that subclasses an optional
    package's classes, and so imports it at its top, is as late as the package.
    """
    optional = {a.source for a in arrows if not (a.own or a.lazy or a.typing) and a.target.split(".")[0] in OPTIONAL}
    for a in arrows:
        known = not a.own and a.target.split(".")[0] in {*allowed, *sys.stdlib_module_names}
        known |= a.own and a.target in optional and room_of(a.target) == room_of(a.source)
        if a.lazy and not known:
            yield f"late: {a.source}:{a.line} imports {'pliant.' * a.own}{a.target} inside a function"


def wrong_circles(arrows: Sequence[Import]) -> Iterator[str]:
    """Modules that import each other; what a package's __init__ re-exports is no part of it."""
    graph: dict[str, set[str]] = {}
    for a in arrows:
        if a.own and not a.typing:
            graph.setdefault(a.source, set()).add(a.target)
            graph.setdefault(a.target, set())
    for group in sorted(circles(graph)):
        yield f"circle: {' <-> '.join(group)}"


def wrong_sizes(found: Mapping[str, Path], limits: Mapping[str, int], allowed: Mapping[str, str]) -> Iterator[str]:
    """Rooms, files and classes over the limits and not named in CONTRIBUTING.md."""
    rooms: dict[str, list[str]] = {}
    for module, path in found.items():
        rooms.setdefault(".".join(path.parent.parts[-2:]), []).append(module)
        text = path.read_text(encoding="utf-8")
        lines = text.count("\n")
        if lines > limits["lines"] and module not in allowed:
            yield f"size: {module} has {lines} lines, more than {limits['lines']}"
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef):
                size = (node.end_lineno or 0) - node.lineno + 1
                if size > limits["class_lines"] and f"{module}.{node.name}" not in allowed:
                    yield f"size: class {module}.{node.name} has {size} lines, more than {limits['class_lines']}"
    for room, inside in rooms.items():
        if len(inside) > limits["files"] and room not in allowed:
            yield f"size: room {room} has {len(inside)} files, more than {limits['files']}"


def wrong_tests(found: Mapping[str, Path], root: Path, allowed: Mapping[str, str]) -> Iterator[str]:
    """Modules without a test file of their name, and names in the list that have one or are no module."""
    lacking = set()
    for module, path in found.items():
        if path.name == "__init__.py":
            continue
        *folders, name = module.split(".")
        if not (root / "tests" / Path(*folders) / f"test_{name}.py").is_file():
            lacking.add(module)
    yield from (f"test: {module} has no test file of its name" for module in sorted(lacking - set(allowed)))
    for module in sorted(set(allowed) - lacking):
        yield f"test: CONTRIBUTING.md lists {module}, which {'has one' if module in found else 'is no module'}"


def faults(root: Path = ROOT, house: Path = HERE) -> list[str]:
    """Every fault of the tree at root, one a line."""
    rules, found = settings(house), modules(root)
    arrows = imports(found)
    order = {room["name"]: k for k, room in enumerate(rules["room"])}
    return [
        *wrong_order(arrows, order),
        *wrong_lazy(arrows, rules["lazy"]["packages"]),
        *wrong_circles(arrows),
        *wrong_sizes(found, rules["limits"], named(root, "Larger than the limits")),
        *wrong_tests(found, root, named(root, "Modules without a test file")),
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=ROOT, help="the tree to check")
    given = parser.parse_args()
    found = faults(given.root)
    print(*found, sep="\n", end="\n" if found else "")
    said = f"{len(found)} faults" if found else "the house stands"
    print(f"{len(modules(given.root))} modules: {said}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
