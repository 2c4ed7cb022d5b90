"""Who imports whom in the four folders, read from the source: nothing is imported to find out.

Imports inside functions and under TYPE_CHECKING are counted and marked. A module is named without `pliant.`:
`plants.core.signals`; its room is `plants.core`, and the `__init__` of a top folder belongs to no room.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGE = "pliant"
FOLDERS = ("plants", "controllers", "envs", "studies")


@dataclass(frozen=True)
class Import:
    """One import statement's arrow: `source` imports `target`, both modules."""

    source: str
    target: str  # of another package: its full name
    line: int
    lazy: bool = False  # inside a function
    typing: bool = False  # under `if TYPE_CHECKING:`
    own: bool = True  # target is a module of the four folders


def settings(folder: Path = HERE) -> dict:
    """rooms.toml: limits, what may be lazy, the rooms in order."""
    return tomllib.loads((folder / "rooms.toml").read_text(encoding="utf-8"))


def modules(root: Path = ROOT) -> dict[str, Path]:
    """{module: its file}; a package is named without `__init__`."""
    found = {}
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def room_of(module: str) -> str:
    """The room that a module stands in; a top folder's own __init__: the folder."""
    return ".".join(module.split(".")[:2])


class _Reader(ast.NodeVisitor):
    """Collects a file's imports, knowing whether it stands in a function or under TYPE_CHECKING."""

    def __init__(self, module: str, package: str, known: Mapping[str, Path], faces: Mapping[str, str]) -> None:
        self.module, self.package, self.known, self.faces = module, package, known, faces
        self.lazy = self.typing = 0
        self.found: list[Import] = []

    def visit_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> None:
        self.lazy += 1
        self.generic_visit(node)
        self.lazy -= 1

    visit_AsyncFunctionDef = visit_Lambda = visit_FunctionDef

    def visit_If(self, node: ast.If) -> None:
        if not ast.unparse(node.test).endswith("TYPE_CHECKING"):
            return self.generic_visit(node)
        self.typing += 1
        for child in node.body:
            self.visit(child)
        self.typing -= 1
        for child in node.orelse:
            self.visit(child)

    def visit_Import(self, node: ast.Import) -> None:
        for alias in node.names:
            self._add(alias.name, None, node.lineno)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        base = node.module or ""
        if node.level:
            parts = self.package.split(".")
            kept = parts[: len(parts) - node.level + 1]
            base = ".".join([PACKAGE, *kept, *([base] if base else [])])
        for alias in node.names:
            self._add(base, alias.name, node.lineno)

    def _add(self, base: str, name: str | None, line: int) -> None:
        own = base == PACKAGE or base.startswith(PACKAGE + ".")
        target = base
        if own:
            target = base.removeprefix(PACKAGE).removeprefix(".")
            inner = ".".join(part for part in (target, name) if part)
            target = inner if name and inner in self.known else target
            if target in FOLDERS and self.module.split(".")[0] != target:
                target = self.faces.get(inner, target)
        if target and target != self.module:
            self.found.append(Import(self.module, target, line, bool(self.lazy), bool(self.typing), own))


def _read(module: str, found: Mapping[str, Path], faces: Mapping[str, str]) -> list[Import]:
    path = found[module]
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    reader = _Reader(module, package, found, faces)
    reader.visit(ast.parse(path.read_text(encoding="utf-8")))
    return reader.found


def imports(found: Mapping[str, Path]) -> list[Import]:
    """Every import of the modules, in their order. A name taken from the face of another top folder
    (`from pliant.plants import Beam`) counts as an import of the module that the face has it from."""
    faces: dict[str, str] = {}
    for folder in FOLDERS:
        if folder in found:
            tree = ast.parse(found[folder].read_text(encoding="utf-8"))
            for node in (n for n in tree.body if isinstance(n, ast.ImportFrom) and n.module and not n.level):
                base = node.module.removeprefix(PACKAGE).removeprefix(".")
                for alias in node.names:
                    inner = f"{base}.{alias.name}"
                    faces[f"{folder}.{alias.asname or alias.name}"] = inner if inner in found else base
    return [arrow for module in found for arrow in _read(module, found, faces)]


def circles(arrows: Mapping[str, set[str]]) -> list[list[str]]:
    """Groups of nodes that reach each other (Tarjan's strongly connected components of two or more)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(node: str) -> Iterator[str]:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(arrows.get(node, ())):
            if other not in index:
                yield other
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            at = stack.index(node)
            if len(stack) - at > 1:
                groups.append(sorted(stack[at:]))
            del stack[at:]

    for first in sorted(arrows):
        if first in index:
            continue
        work = [visit(first)]
        while work:
            deeper = next(work[-1], None)
            if deeper is None:
                work.pop()
            else:
                work.append(visit(deeper))
    return groups


def between_rooms(arrows: Sequence[Import]) -> dict[tuple[str, str], int]:
    """{(importing room, imported room): how many pairs of modules}, of what is imported when a program runs."""
    pairs = {(a.source, a.target) for a in arrows if a.own and not a.typing}
    counts: dict[tuple[str, str], int] = {}
    for source, target in pairs:
        key = room_of(source), room_of(target)
        if key[0] != key[1] and all("." in room for room in key):
            counts[key] = counts.get(key, 0) + 1
    return counts
