"""Valid calls of controllers, scenes and studies, and what of these packages is not called, with the reason."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from fnmatch import fnmatch
from types import ModuleType
from typing import Any

from argument_kinds import Call
from calls_of_designs import design_calls
from calls_of_kit import kit_calls
from calls_of_optima import optima_calls
from calls_of_scene_laws import scene_law_calls
from calls_of_scenes import scene_calls
from calls_of_studies import study_calls
from reasons_without_call import REASONS

import pliant.controllers
import pliant.envs.scenes
import pliant.studies


def law_calls() -> list[Call]:
    """Of everything."""
    return [*design_calls(), *kit_calls(), *scene_law_calls(), *optima_calls(), *scene_calls(), *study_calls()]


def public() -> Iterator[str]:
    """Functions, classes and their methods, by module and name without "pliant.", where they are defined."""
    for package in (pliant.controllers, pliant.envs.scenes, pliant.studies):
        for info in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not info.ispkg and not reason(info.name.removeprefix("pliant.")):  # of a whole module
                yield from _of(importlib.import_module(info.name))


def _of(module: ModuleType) -> Iterator[str]:
    short = module.__name__.removeprefix("pliant.")
    for name, thing in vars(module).items():
        if name.startswith("_") or not callable(thing) or getattr(thing, "__module__", None) != module.__name__:
            continue
        yield f"{short}.{name}"
        if inspect.isclass(thing):
            for method, own in vars(thing).items():
                if not method.startswith("_") and (
                    inspect.isfunction(own) or isinstance(own, (classmethod, staticmethod))
                ):
                    yield f"{short}.{name}.{method}"


def called(call: Call) -> str:
    """The same of a call."""
    thing: Any = call.function
    return f"{thing.__module__}.{thing.__qualname__}".removeprefix("pliant.")


def reason(name: str) -> str:
    """Why it has no call; empty where there is none."""
    return next((why for pattern, why in REASONS.items() if fnmatch(name, pattern)), "")


def without_call(found: list[Call]) -> list[str]:
    """What has neither a call nor a reason."""
    have = {called(call) for call in found}
    return [name for name in public() if name not in have and not reason(name)]
