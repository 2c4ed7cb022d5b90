"""The four folders at the root install as pliant.plants, pliant.envs, pliant.controllers and pliant.studies."""

from setuptools import find_namespace_packages, setup

FOLDERS = ("plants", "envs", "controllers", "studies")
rooms = [
    f"pliant.{folder}.{room}"
    for folder in FOLDERS
    for room in find_namespace_packages(folder, exclude=["*__pycache__*"])
]
setup(packages=[f"pliant.{folder}" for folder in FOLDERS] + rooms)
