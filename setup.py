"""The four folders at the root install as pliant.plants, pliant.envs, pliant.controllers and pliant.studies."""

from setuptools import find_namespace_packages, setup

FOLDERS = ("plants", "envs", "controllers", "studies")


def packages(folder: str) -> list[str]:
    """The folder, its rooms and the folders of data in them: every one is named, so that a build has nothing to say."""
    rooms = find_namespace_packages(folder, exclude=["__pycache__", "*.__pycache__", "__pycache__.*"])
    return [f"pliant.{folder}", *(f"pliant.{folder}.{room}" for room in rooms)]


setup(packages=[package for folder in FOLDERS for package in packages(folder)])
