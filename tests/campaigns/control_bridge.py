"""Plants as python-control has them, and what checks of that are made with."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from pliant.plants import FlexibleSpacecraft, SingleLinkArm, TwoLinkArm

ARM = dataclasses.replace(TwoLinkArm.textbook(), reduction="rigid").vary("payload.mass")
LINK = dataclasses.replace(SingleLinkArm.textbook(), kinematics="rigid").vary("payload.mass")
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="rigid", appendages=())
HEAVY = {"payload.mass": 2.0}
T = np.linspace(0.0, 0.3, 31)
TIGHT = {"solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-11}}


Checks = list[tuple[str, Callable[[], None]]]


def checklist() -> tuple[Checks, Callable[[Callable[[], None]], Callable[[], None]]]:
    """A module's checks by name, and the decorator that adds one."""
    checks: Checks = []

    def check(made: Callable[[], None]) -> Callable[[], None]:
        checks.append((made.__name__, made))
        return made

    return checks, check


def near(a: Any, b: Any, rtol: float = 1e-9) -> None:
    """Numbers of one shape that differ by no more than `rtol` of the largest."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    assert a.shape == b.shape, (a.shape, b.shape)
    off = np.abs(a - b).max(initial=0.0)
    assert off <= rtol * max(np.abs(b).max(initial=0.0), 1e-12), off


def refused(ask: Callable[[], Any], kind: Any = (ValueError, TypeError)) -> None:
    """An error of that kind, with words."""
    try:
        ask()
    except kind as error:
        assert len(str(error)) > 10
        return
    raise AssertionError("was not refused")


def arm(**options: Any) -> Any:
    """The two-link arm as a system of python-control."""
    return ARM.to_control(name="arm", **options)


def link(**options: Any) -> Any:
    """The single link."""
    return LINK.to_control(name="link", **options)


@cache
def rest() -> tuple[np.ndarray, np.ndarray]:
    """A state of the arm and the torques that hold it there."""
    return ARM.equilibrium(theta1=-0.9, theta2=0.6)
