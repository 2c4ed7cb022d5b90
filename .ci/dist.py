"""`make dist`: the source archive and the wheel, checked, installed into an empty environment and tried there.

    python .ci/dist.py [--contents]

The wheel is built from the archive, so that an archive that lacks something is found. What both hold is compared with
the tree; twine looks at the metadata where it is installed. Then the wheel, with the versions of constraints.txt, goes
into an environment of its own in build/dist, and in an empty folder run: commands, the README's blocks, and tests of
the archive. `--contents` ends before that, as without a network.
"""

import ast
import importlib.util
import re
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from collections.abc import Iterable, Sequence
from email import message_from_bytes
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK, DIST = ROOT / "build" / "dist", ROOT / "dist"
FOLDERS = ("plants", "envs", "controllers", "studies")
MUST = ("README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff", "Makefile", "constraints.txt", "tests/conftest.py")
COMMANDS = (("--version",), ("scenes",), ("doctor",), ("check", "single-link-slew"), ("simulate", "single-link-slew"))
TESTS = ("tests/plants/beams", "tests/plants/contract", "tests/envs/scene_files", "tests/controllers/filters")


def version() -> str:
    """The one that pyproject.toml states; all else follows it."""
    found: str = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    return found


def tree() -> set[str]:
    """What the packages are made of, by the names that they have when they are installed."""
    files = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*"))
    ours = {f"pliant/{p.relative_to(ROOT).as_posix()}" for p in files if p.is_file() and "__pycache__" not in p.parts}
    return ours | {"pliant/__init__.py", "pliant/py.typed"}


def wrong_wheel(names: Iterable[str], metadata: bytes) -> list[str]:
    """What is wrong with a wheel that holds these files and these words on itself."""
    inside = {name for name in names if ".dist-info/" not in name}
    wrong = [f"the wheel lacks {name}" for name in sorted(tree() - inside)]
    wrong += [f"the wheel has {name}, which is not in the tree" for name in sorted(inside - tree())]
    said = message_from_bytes(metadata)
    if said["Version"] != version():
        wrong.append(f"the wheel says version {said['Version']}, must be {version()}")
    if said["Description-Content-Type"] != "text/markdown" or not said["License-Expression"]:
        wrong.append("the wheel must say its licence and that its description is Markdown")
    wrong += [f"the wheel lacks the ending {end}" for end in ("/LICENSE", "/entry_points.txt") if not _ends(names, end)]
    return wrong


def wrong_archive(names: Iterable[str]) -> list[str]:
    """What is wrong with a source archive that holds these files, below its one folder."""
    inside = {name.partition("/")[2] for name in names}
    sources = {name.removeprefix("pliant/") for name in tree()} - {"__init__.py", "py.typed"}
    wrong = [f"the archive lacks {name}" for name in sorted({*sources, *MUST} - inside)]
    kept = (name for name in inside if "__pycache__" in name or name.startswith((".venv", "build/", "reports/")))
    return wrong + [f"the archive has {name}" for name in sorted(kept)]


def _ends(names: Iterable[str], end: str) -> bool:
    return any(name.endswith(end) for name in names)


def build() -> tuple[Path, Path]:
    """(archive, wheel) in dist/, nothing else there."""
    for old in DIST.glob("pliant-*"):
        old.unlink()
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", str(DIST), str(ROOT), quiet=True)
    (archive,), (wheel,) = DIST.glob("pliant-*.tar.gz"), DIST.glob("pliant-*.whl")
    return archive, wheel


def check(archive: Path, wheel: Path) -> list[str]:
    """What is wrong with the two files."""
    with zipfile.ZipFile(wheel) as packed:
        names = packed.namelist()
        (told,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        wrong = wrong_wheel(names, packed.read(told))
    with tarfile.open(archive) as packed:
        wrong += wrong_archive(packed.getnames())
    if importlib.util.find_spec("twine") is None:
        print("twine is not installed: its check is left out (pip install twine)", file=sys.stderr)
    else:
        run(sys.executable, "-m", "twine", "check", "--strict", str(archive), str(wheel))
    return wrong


def installed(wheel: Path) -> Path:
    """The folder of the programs of an environment that holds the wheel, what it needs, and what its tests need."""
    venv.create(WORK / "venv", with_pip=True, clear=True)
    place = WORK / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
    pip = (str(place / "python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
    run(*pip, "--constraint", str(ROOT / "constraints.txt"), str(wheel))
    run(*pip, "pytest>=8", "mpmath")
    return place


def tried(place: Path, archive: Path) -> None:
    """Commands, the README and some tests, in an empty folder; CalledProcessError where one fails."""
    empty = WORK / "empty"
    empty.mkdir(exist_ok=True)
    for words in COMMANDS:
        run(str(place / "pliant"), *words, folder=empty, quiet=True)
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    script = WORK / "readme.py"
    script.write_text("\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL)), encoding="utf-8")
    ast.parse(script.read_text(encoding="utf-8"))
    run(str(place / "python"), str(script), folder=empty, quiet=True)
    with tarfile.open(archive) as packed:
        packed.extractall(WORK, filter="data")
    source = WORK / archive.name.removesuffix(".tar.gz")
    run(str(place / "python"), "-m", "pytest", "-q", "-p", "no:cacheprovider", *TESTS, folder=source)


def run(*words: str, folder: Path = ROOT, quiet: bool = False) -> None:
    """A command; what it printed is shown where it fails, or if it is not quiet."""
    print("$", *(Path(words[0]).name, *words[1:]), file=sys.stderr)
    done = subprocess.run(words, cwd=folder, capture_output=quiet, text=True)
    if done.returncode:
        print(done.stdout or "", done.stderr or "", file=sys.stderr)
        raise SystemExit(done.returncode)


def main(words: Sequence[str]) -> int:
    WORK.mkdir(parents=True, exist_ok=True)
    archive, wheel = build()
    wrong = check(archive, wheel)
    if wrong:
        print(*wrong, sep="\n", file=sys.stderr)
        return 1
    if "--contents" not in words:
        tried(installed(wheel), archive)
    print(f"{archive.relative_to(ROOT)}\n{wheel.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
