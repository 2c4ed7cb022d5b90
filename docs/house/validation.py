"""docs/validation.md from docs/validation.json: `python docs/house/validation.py`.

The json is what the tests' `agrees` measured: `python -m pytest -m "campaign or not campaign" --evidence
docs/validation.json` on the files that call it, in one process; Pinocchio's need the extra `robots`.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pliant.plants.files.atomic_files import write_text

DOCS = Path(__file__).parents[1]
LEVELS = {
    "closed form": "an equation, solved apart from the library; by others only where the source names the publication",
    "table": "numbers printed in a paper or a book",
    "other program": "another program's run of the same case",
    "finer model": "a model of other or finer physics, computed for this project apart from the library: finite "
    "elements, geometrically exact beams",
    "independent arithmetic": "numbers of this project's reference files, made apart from the library; not outside "
    "the project, so not counted as such",
}
OUTSIDE = tuple(kind for kind in LEVELS if kind != "independent arithmetic")
PUBLISHED = re.compile(r"\((?:[A-Z][\w .]*)?(?:19|20)\d\d\)|et al. (?:19|20)\d\d|\"")  # a year, or a title in quotes
RULE = """What counts as by others: a number or an equation printed in a publication that the line names with its
year or title, or what another program gave for the same case. An equation that this project derived, or solved without
naming who published it, does not count; nor does a finer model that this project computed, nor its reference files. The
same quantity of the same source counts once, however many variants of a plant or method meet it."""
NOT_VALIDATED = """## What is not validated

- No comparison is with a measurement on a machine: all sources are equations, tables and programs.
- What no line of the table names stands on the library's own tests alone: energy balance, Jacobians by
  differences, limits between fidelities, agreement among variants. Those find slips, and lack what all variants lack.
- Of the plants damping (Kelvin-Voigt, Rayleigh, friction at stops) is compared with formulas at most, and material data
  (strength, creep, plasticity), backlash, fluids and contact are not modelled.
- The table holds comparisons that go through `agrees`; other tests compare with outside sources too (python-control's
  designs, SciPy's integrators and solvers) and are not in it.
"""


def digits(error: float) -> str:
    return "all" if error == 0 else str(max(0, math.floor(-math.log10(error))))


def by_others(one: dict[str, Any]) -> bool:
    """Whether the comparison is with a publication or a program of others, as RULE says."""
    if one["kind"] in ("closed form", "table"):
        return bool(PUBLISHED.search(one["source"]))
    return one["kind"] == "other program"


def counted(found: Iterable[dict[str, Any]]) -> int:
    """Comparisons by others, each quantity of a source once."""
    return len({(one["of"], one["what"], one["source"]) for one in found if by_others(one)})


def page(kept: dict[str, list[dict[str, Any]]]) -> str:
    """The page's text."""
    found = [(test, one) for test, many in kept.items() for one in many]
    outside = [one for _, one in found if one["kind"] in OUTSIDE]
    sources = {one["source"].partition(",")[0] for _, one in found if by_others(one)}
    lines = [
        "# Validation",
        "",
        "Made from what the tests measured: no number here was typed by hand. `docs/house/validation.py` says how.",
        "",
        f"{len(found)} comparisons, {len(outside)} of them with what stands outside the library. "
        f"**{counted(one for _, one in found)} are with equations, tables and programs of others**, of {len(sources)} "
        "sources; the rest with finer models, such as finite elements, that this project's tests or reference files "
        "hold. Errors are the largest of the numbers compared, relative, or absolute where that is said; digits are "
        "those that agree at least, allowed is what the test takes.",
        "",
        RULE,
        "",
        "| evidence | what it is | comparisons |",
        "|---|---|---:|",
        *(f"| {k} | {told} | {sum(one['kind'] == k for _, one in found)} |" for k, told in LEVELS.items()),
    ]
    for subject in sorted({one["of"] for _, one in found}):
        lines += ["", f"## {subject}", "", "| what | with | evidence | by others | error | allowed | digits | test |"]
        lines += ["|---|---|---|:---:|---:|---:|---:|---|"]
        for test, one in found:
            if one["of"] == subject:
                unit = " abs." if one["absolute"] else ""
                short = test.rpartition("/")[2].replace("::", ": ").replace("|", "/")
                numbers = f"{one['error']:.1e}{unit} | {one['within']:.1e} | {digits(one['error'])}"
                what = ", ".join(filter(None, (one["what"], one.get("variant"))))
                theirs = "yes" if by_others(one) else ""
                lines.append(f"| {what} | {one['source']} | {one['kind']} | {theirs} | {numbers} | `{short}` |")
    return "\n".join(lines) + "\n\n" + NOT_VALIDATED


if __name__ == "__main__":
    write_text(DOCS / "validation.md", page(json.loads((DOCS / "validation.json").read_text(encoding="utf-8"))))
