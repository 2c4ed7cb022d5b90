"""MkDocs hook: the pages that are written once elsewhere, and the API page from the public `__all__`s.

README.md becomes the start page, CONTRIBUTING.md the page of the house, SECURITY.md its own, with links set right;
`api.md` gets an entry for each name that the four packages export, `theory.md` the table of one paper's misprints.
"""

from __future__ import annotations

import ast
import re
import shutil
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
FOLDERS = ("plants", "controllers", "envs", "studies")
COPIED = {
    "index.md": "README.md",
    "house.md": "CONTRIBUTING.md",
    "security.md": "SECURITY.md",
    "benchmarks.md": "benchmarks/results/benchmark.md",
}


def on_startup(**_: Any) -> None:
    """Lay the folders out under their one name, for mkdocstrings to read: nothing of Pliant is imported."""
    target = ROOT / "build" / "api" / "pliant"
    shutil.rmtree(target, ignore_errors=True)
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, target / folder, ignore=shutil.ignore_patterns("__pycache__"))


def on_page_markdown(markdown: str, *, page: Any, config: Any, files: Any) -> str:
    """The page's text: copied from the root, or with the API's entries."""
    place = page.file.src_uri
    page.meta["hide"] = ["navigation"]  # the tabs do
    if place in COPIED:
        return relinked((ROOT / COPIED[place]).read_text(encoding="utf-8"))
    if place == "theory.md":
        return markdown.replace("<!-- remarks -->", remarks())
    if place == "api.md":
        return re.sub(r"<!-- pliant\.(\w+) -->", lambda found: entries(found[1]), markdown)
    return markdown


def remarks() -> str:
    """A table of the spacecraft paper's blocks that differ in print, from where they are found."""
    source = ROOT / "plants" / "spacecraft_perturbation" / "printed_equations.py"
    for node in ast.parse(source.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "REMARKS":
            told: dict[str, str] = ast.literal_eval(node.value)
            return "\n".join(["| block | in print |", "|---|---|", *(f"| {k} | {v} |" for k, v in told.items())])
    raise LookupError(f"{source}: no REMARKS")


def relinked(text: str) -> str:
    """Links of a page at the root, for the same page inside docs/; other files of the tree are told, not linked."""
    text = re.sub(r"\]\(docs/([^)]*)\)", r"](\1)", text)
    for name in ("README.md", "CONTRIBUTING.md"):
        page = next(page for page, source in COPIED.items() if source == name)
        text = text.replace(f"]({name})", f"]({page})")
    return re.sub(
        r"\[([^\]]*)\]\((?!https?:|#)((?:benchmarks|examples|tests|plants|LICENSE)[^)]*)\)", r"\1 (`\2`)", text
    )


def exported(folder: str) -> list[tuple[str, str]]:
    """[(public name, full name of what it is)] of a top package, from its __init__, in its order."""
    tree = ast.parse((ROOT / folder / "__init__.py").read_text(encoding="utf-8"))
    where: dict[str, str] = {}
    names: list[str] = []
    for node in ast.walk(tree):  # some stand under TYPE_CHECKING: imported when they are asked for
        if isinstance(node, ast.ImportFrom) and node.module:
            where |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            names = ast.literal_eval(node.value)
    return [(name, where[name]) for name in names]


def entries(folder: str) -> str:
    """mkdocstrings entries of a package's public names."""
    return "\n\n".join(entry(name, full, folder) for name, full in exported(folder))


def entry(name: str, full: str, folder: str) -> str:
    options = f'    options:\n      heading: "{name}"\n      toc_label: "{name}"\n'
    path = ROOT.joinpath(*full.split(".")[1:])
    if path.is_dir() or path.with_suffix(".py").is_file():  # a module: what it exports itself
        return f"### pliant.{folder}.{name}\n\n::: {full}\n" + options.replace(
            "options:\n", "options:\n      show_root_heading: false\n      heading_level: 4\n"
        )
    return f"::: {full}\n{options}"
