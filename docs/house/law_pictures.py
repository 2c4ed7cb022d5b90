"""More pictures of docs/methods.md, of ranges and of laws: drawn by pictures.py, from the same namespace."""

from __future__ import annotations

import dataclasses
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pliant.studies.figures.style import COLOURS, QUIET, panels, styled

BOARD = Path(__file__).parents[1] / "scoreboard" / "suite-2" / "scoreboard.json"
Names = dict[str, Any]


@styled
def validity(n: Names) -> Figure:
    """The linear link and the stiffened one, spun up alike."""
    linear, spun = n["unstiffened"], n["spun"]
    held = dataclasses.replace(linear, kinematics="stiffened")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        true = held.simulate(np.zeros(held.nx), [20.0], spun.t)
    figure, (ax, other) = panels(1, 2, height=2.3)
    for k, (name, m) in enumerate((("linear", spun), ("stiffened", true))):
        ax.plot(m.t, 1e3 * m["tip_deflection"], label=name, color=COLOURS[k], ls=("-", "--")[k])
    ax.set(xlabel="time [s]", title="tip deflection, spun up by 20 rad/s^2 [mm]")
    ax.margins(y=0.25)
    ax.legend(loc="upper center", ncols=2)
    other.plot(spun.t, spun["hub_angle_rate"], color=COLOURS[0])
    for found in linear.left_ranges(spun)[:1]:
        other.axvline(found.since, color=QUIET, ls=":", label=f"range left at {found.since:.2g} s")
    other.set(xlabel="time [s]", title="speed [rad/s]")
    other.legend()
    return figure


@styled
def periodic_lqr(n: Names) -> Figure:
    """Multipliers of a turn within the unit circle, and the cycle's inputs."""
    law = n["circling"]
    figure, (ax, other) = panels(1, 2, height=2.6)
    circle = np.exp(1j * np.linspace(0.0, 2 * np.pi, 200))
    ax.plot(circle.real, circle.imag, color=QUIET, lw=0.8)
    ax.plot(np.real(law.multipliers), np.imag(law.multipliers), "x", color=COLOURS[1], mew=1.6)
    ax.set(title="multipliers of a turn", aspect="equal", xlabel="real part", ylabel="imaginary part")
    other.plot(np.rad2deg(law.x[:, law.angle]), law.u[:, 0], ".", ms=3, color=COLOURS[0])
    other.set(xlabel="angle [deg]", title="input of the cycle")
    return figure


@styled
def spillover(n: Names) -> Figure:
    """How the worst mode of the loop grows or decays, plant by plant."""
    cases = n["spilled"].cases
    figure, (ax,) = panels(1, height=1.6)
    colours = [COLOURS[1] if case.growth > 0 else COLOURS[0] for case in cases]
    ax.barh([f"{case.plant}, {case.states} states" for case in cases], [c.growth for c in cases], color=colours)
    ax.axvline(0.0, color=QUIET, lw=0.8)
    ax.margins(x=0.05)
    ax.set(title="growth of the loop's worst mode [1/s]: right of zero it is unstable")
    ax.invert_yaxis()
    return figure


@styled
def boxes(n: Names) -> Figure:
    """The box asked for, the largest shown stable and the nearest parameters at which the loop ends."""
    found = n["stands"]
    (one, other), worst = found.box, found.worst
    middle = [(low + high) / 2 for low, high in found.box.values()]
    half = [(high - low) / 2 for low, high in found.box.values()]
    scale = (1.0, 1e-9)  # [kg], [GPa]
    figure, (ax,) = panels(1, height=2.8)
    for size, label, look in (
        (found.stable_to, f"shown stable: {found.stable_to:.3g} boxes", {"fc": COLOURS[0], "alpha": 0.25}),
        (1.0, "asked for", {"fill": False, "ec": COLOURS[0], "lw": 1.5}),
    ):
        corner = [s * (m - size * h) for s, m, h in zip(scale, middle, half)]
        ax.add_patch(Rectangle(corner, *(2 * size * h * s for s, h in zip(scale, half)), label=label, **look))
    if worst is not None:
        ax.plot(
            worst[one], 1e-9 * worst[other], "X", color=COLOURS[1], label=f"unstable: {found.unstable_at:.3g} boxes"
        )
    ax.plot(middle[0], 1e-9 * middle[1], "+", color=QUIET)
    ax.autoscale_view()
    ax.set(xlabel=f"{one} [kg]", ylabel=f"{other} [GPa]", title="LQR on the two-link arm")
    ax.legend(loc="center left", bbox_to_anchor=(1.02, 0.5))
    return figure


@styled
def lasting(n: Names) -> Figure:
    """Failures of 64 runs on two-link-reach, of the second board: what a design that knows delay and errors mends."""
    rows = json.loads(BOARD.read_text(encoding="utf-8"))["rows"]
    laws = ("LQR", "LQR, delay 0 to 1", "MPC", "MPC, delay 0 to 1", "LQG", "robust LQG", "multi-model LQR")
    cases = ("varied", "delayed", "all at once")
    figure, (ax,) = panels(1, height=2.8)
    for k, case in enumerate(cases):
        own = [r for r in rows if (r["scene"], r["case"]) == ("two-link-reach", case)]
        failed = {r["controller"]: r["failures"] for r in own}
        ax.barh(
            np.arange(len(laws)) + 0.27 * (k - 1), [failed[law] for law in laws], 0.25, label=case, color=COLOURS[k]
        )
    ax.set_yticks(np.arange(len(laws)), laws)
    ax.set(title="failed of 64 runs on two-link-reach", xlim=(0, 64))
    ax.invert_yaxis()
    ax.legend(loc="lower right")
    return figure
