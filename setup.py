"""The folders at the root install as pliant.plants, pliant.envs, pliant.controllers and pliant.studies.

An editable install puts a folder of links to them on the path, `.editable/pliant`: type checkers and editors find the
package there, which they do not through an import hook. Where links cannot be made, setuptools' own way is taken.
"""

import shutil
from pathlib import Path

from setuptools import find_namespace_packages, setup
from setuptools.command.editable_wheel import editable_wheel

ROOT = Path(__file__).resolve().parent
FOLDERS = ("plants", "envs", "controllers", "studies")
TOP = "package"  # pliant/__init__.py
LINKS = ".editable"


def packages(folder: str) -> list[str]:
    """The folder, its rooms and the folders of data in them: every one is named, so that a build has nothing to say."""
    rooms = find_namespace_packages(folder, exclude=["__pycache__", "*.__pycache__", "__pycache__.*"])
    return [f"pliant.{folder}", *(f"pliant.{folder}.{room}" for room in rooms)]


def linked() -> bool:
    """Lay out `.editable/pliant` with links to the folders; False where the system does not let us."""
    place = ROOT / LINKS / "pliant"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    try:
        for path in (*(ROOT / folder for folder in FOLDERS), *(ROOT / TOP).glob("*.*")):
            (place / path.name).symlink_to(path, target_is_directory=path.is_dir())
    except OSError:  # Windows without the right to make links
        shutil.rmtree(place)
        return False
    return True


class Linked(editable_wheel):
    """An editable install whose packages stand under one folder, as a checker reads them."""

    def finalize_options(self) -> None:
        if linked():
            self.distribution.package_dir = {"": LINKS}
        super().finalize_options()


setup(
    packages=["pliant", *(package for folder in FOLDERS for package in packages(folder))],
    cmdclass={"editable_wheel": Linked},
)
