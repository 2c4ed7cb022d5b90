"""The README's lines, as a script of a user's, under mypy --strict and pyright: with the wheel, then as installed here.

    python .ci/typed_readme.py

The wheel is unpacked into an environment of its own, which borrows the other packages from this one. basedpyright is
pyright with its Node beside it; without it (`pip install basedpyright`) this says so, and mypy alone has checked.
"""

import json
import re
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK = ROOT / "build" / "typed"
VERSION = "\nimport pliant\n\nprint(pliant.__version__.upper())\n"


def script() -> Path:
    """The README's Python blocks one after the other."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    path = WORK / "readme.py"
    path.write_text("\n".join(blocks) + VERSION, encoding="utf-8")
    return path


def with_wheel() -> Path:
    """The Python of an environment in which Pliant's wheel is installed, and nothing editable."""
    wheels = WORK / "wheel"
    build = (sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(wheels), str(ROOT))
    subprocess.run(build, check=True)
    (wheel,) = wheels.glob("pliant-*.whl")
    place = WORK / "venv"
    venv.create(place, with_pip=False)
    python = place / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    asked = (str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")
    packages = Path(subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip())
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(packages)
    borrowed = {sysconfig.get_path("purelib"), *(p for p in sys.path if p.endswith("site-packages"))}
    (packages / "borrowed.pth").write_text("\n".join(sorted(borrowed)) + "\n", encoding="utf-8")
    return python


def faults(python: Path, path: Path) -> list[str]:
    """What each checker says against the script, with this Python's packages."""
    mypy = (sys.executable, "-m", "mypy", "--strict", "--config-file=", "--python-executable", str(python), path.name)
    checked = [("mypy --strict", mypy)]
    checker = shutil.which("basedpyright", path=sysconfig.get_path("scripts")) or shutil.which("basedpyright")
    if checker is None:
        print("basedpyright is not installed: mypy alone checks", file=sys.stderr)
    else:
        settings = {"pythonVersion": "3.11", "typeCheckingMode": "standard", "include": [path.name]}
        (WORK / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
        checked.append(("pyright", (checker, "--pythonpath", str(python), path.name)))
    found = []
    for name, command in checked:
        done = subprocess.run(command, capture_output=True, text=True, cwd=WORK)
        if done.returncode:
            found.append(f"{name}, {python}:\n{done.stdout}{done.stderr}")
    return found


def main() -> int:
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    path = script()
    found = [fault for python in (with_wheel(), Path(sys.executable)) for fault in faults(python, path)]
    print(*found, sep="\n", end="\n" if found else "")
    print(f"README's script: {len(found)} checks with faults")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
