"""What public docstrings lack: `python docs/house/docstrings.py` counts it, and names it with --list.

Public is what the four packages' `__all__` export, what exported modules export, and the public methods and properties
of exported classes, each counted where it is defined. Asked of each:

doc       a docstring
measure   a shape or a unit, where an argument or the result is an array or a float
arguments the names of its arguments that are numbers or arrays, but those of USUAL, which docs/api.md tells once
errors    the ValueError (or what is derived of it) that its own body raises, named
example   a prompt `>>>` of its own, or in the docstring or the session (docs/sessions) of its class, which uses it by
          name; an override has the example of what it overrides
"""

from __future__ import annotations

import argparse
import ast
import importlib
import inspect
import re
import sys
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from types import ModuleType
from typing import Any

from sessions import PAGES, sections

PACKAGES = ("plants", "controllers", "envs", "studies")
KINDS = ("doc", "measure", "arguments", "errors", "example")
USUAL = {*["t", "x", "u", "w", "p", "q", "v", "a", "y", "dt"], "path", "progress", "options"}

QUANTITY = re.compile(r"\b(float|NDArray|ndarray|ArrayLike|Array|Vector|Matrix|Floats)\b")
NUMBERS = re.compile(QUANTITY.pattern + r"|\bAny\b")
# A shape "(nx,)", "(nt, nx)", "n x n", "(3,)", or a unit in brackets, or said to have none.
MEASURE = re.compile(
    r"(?i)\(\w+,\)|\((?:\.\.\.|\w+), [\w ,.*+-]+\)|\[[^\]\n]*(?:\d|m|s|rad|N|Hz|kg|Pa|W|J|V|%|-|deg|dB|B)[^\]\n]*\]"
    r"|\b\w+ x \w+\b|\b(?:dimensionless|no unit|unit of|units of|own unit|SI)\b",
)
ERROR = re.compile(r"\bValueError\b|\b\w+Error\b|\bKeyError\b|\bTypeError\b|\braises\b|\brefused?\b")


@dataclass(frozen=True)
class Public:
    """One public name: where it is told from, and what it is."""

    name: str  # "pliant.plants.arms.single_link.SingleLinkArm.frequencies"
    what: Any  # function, class or property
    owner: type | None = None  # the class that it is a member of

    @cached_property
    def doc(self) -> str:
        """Its docstring, or that of what it overrides."""
        name = self.name.rpartition(".")[2]
        bases = [] if self.owner is None else [vars(base).get(name) for base in self.owner.__mro__]
        return next((text for what in (self.what, *bases) if what is not None and (text := inspect.getdoc(what))), "")

    @cached_property
    def function(self) -> Any:
        """What is called: of a property its getter; None of a class, whose fields are its own."""
        found = self.what
        for name in ("fget", "func", "__func__", "__wrapped__"):
            found = getattr(found, name, None) or found
        return found if inspect.isfunction(found) else None

    @cached_property
    def source(self) -> str:
        try:
            return textwrap.dedent(inspect.getsource(self.function or self.what))
        except (OSError, TypeError):
            return ""


def members(owner: type) -> Iterator[tuple[str, Any]]:
    """Public methods and properties that a class defines itself."""
    for name, what in vars(owner).items():
        if name.startswith("_"):
            continue
        if inspect.isfunction(what) or isinstance(what, classmethod | staticmethod | property | cached_property):
            yield name, what


def exported(module: ModuleType) -> Iterator[Any]:
    for name in getattr(module, "__all__", ()):
        found = getattr(module, name)
        if inspect.ismodule(found):
            yield from exported(found)
        elif inspect.isclass(found) or inspect.isfunction(found):
            yield found


def public() -> dict[str, Public]:
    """{name: Public} of everything, without what comes from other packages."""
    found: dict[str, Public] = {}
    for package in PACKAGES:
        for what in exported(importlib.import_module(f"pliant.{package}")):
            if not what.__module__.startswith("pliant."):
                continue
            full = f"{what.__module__}.{what.__qualname__}"
            found.setdefault(full, Public(full, what))
            if not inspect.isclass(what):
                continue
            for base in what.__mro__:
                if base.__module__.startswith("pliant.") and not base.__name__.startswith("_"):
                    for name, inner in members(base):
                        full = f"{base.__module__}.{base.__qualname__}.{name}"
                        found.setdefault(full, Public(full, inner, base))
    return found


def annotations(item: Public) -> str:
    """Types of arguments and result, as written."""
    if item.function is not None:
        node = ast.parse(item.source).body[0] if item.source else None
        if not isinstance(node, ast.FunctionDef):
            return ""
        given = [a.annotation for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
        return " ".join(ast.unparse(a) for a in (*given, node.returns) if a is not None)
    return " ".join(str(t) for t in vars(item.what).get("__annotations__", {}).values())


def unnamed(item: Public) -> list[str]:
    """Arguments that are numbers or arrays, and that neither its docstring nor its class's names."""
    if item.function is None:
        return []
    text = item.doc + (inspect.getdoc(item.owner) or "" if item.owner else "")
    given = inspect.signature(item.function).parameters.values()
    asked = [a.name for a in given if a.name not in USUAL and NUMBERS.search(str(a.annotation))]
    return [name for name in asked if not re.search(rf"\b{name}\b", text)]


def raises(item: Public) -> bool:
    """Whether its own body raises ValueError or asks a gate that does."""
    if item.function is None or not item.source:
        return False
    return any(
        isinstance(node, ast.Raise) and node.exc is not None and "ValueError" in ast.unparse(node.exc)
        for node in ast.walk(ast.parse(item.source))
    )


def examples(text: str) -> str:
    return "\n".join(line for line in text.splitlines() if line.lstrip().startswith((">>>", "...")))


@cache
def session(name: str) -> str:
    """The prompts of a class's session, "" where there is none."""
    return "\n".join(
        examples(text) for page in PAGES.glob("*.md") for heading, text, _ in sections(page) if heading == name
    )


def shown(item: Public) -> bool:
    """Whether a doctest of its own, or one of its class or of a class made of that, shows it."""
    if ">>>" in item.doc:
        return True
    if item.owner is None:
        return bool(session(item.name.rpartition(".")[2]))
    name = item.name.rpartition(".")[2]
    over = [base for base in item.owner.__mro__ if name in vars(base)]
    makers = {maker for base in over for maker in made_of(base)}
    return any(name in used(maker) for maker in makers)


@cache
def used(maker: type) -> set[str]:
    """What stands after a dot in a class's examples."""
    return set(re.findall(r"\.(\w+)", examples(inspect.getdoc(maker) or "") + session(maker.__name__)))


def made_of(base: type) -> Iterator[type]:
    """The class and all that inherit from it."""
    yield base
    for inner in type.__subclasses__(base):
        yield from made_of(inner)


def measured(item: Public) -> bool:
    """Whether its text (of a class its body as well, where fields have comments or units) gives a shape or a unit."""
    if item.function is not None:
        return bool(MEASURE.search(item.doc))
    return bool(MEASURE.search(item.doc + item.source) or re.search(r"\b(quantity|part)\(", item.source))


def lacks(item: Public) -> list[str]:
    """Which of KINDS a name lacks."""
    if not item.doc:
        return list(KINDS)
    found = []
    if QUANTITY.search(annotations(item)) and not measured(item):
        found.append("measure")
    if unnamed(item):
        found.append("arguments")
    if raises(item) and not ERROR.search(item.doc):
        found.append("errors")
    if not shown(item):
        found.append("example")
    return found


def gaps(names: dict[str, Public] | None = None) -> dict[str, list[str]]:
    """{name: what it lacks} of the public names that lack something."""
    return {name: found for name, item in (names or public()).items() if (found := lacks(item))}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="name each")
    given = parser.parse_args()
    names = public()
    found = gaps(names)
    if given.list:
        print(*(f"{name}: {', '.join(kinds)}" for name, kinds in sorted(found.items())), sep="\n")
    counts = {kind: len(names) - sum(kind in kinds for kinds in found.values()) for kind in KINDS}
    said = ", ".join(f"{kind} {n} ({100 * n / len(names):.0f} %)" for kind, n in counts.items())
    print(f"{len(names)} public names; whole {len(names) - len(found)}; {said}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
