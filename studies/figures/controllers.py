"""The pictures of controllers: side by side, and how a policy was trained."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from pliant.controllers.learning.evaluation import Evaluation
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.signals import index, names
from pliant.studies.closed_loop.closed_loop import driven_to_goal
from pliant.studies.closed_loop.comparison import Contest
from pliant.studies.closed_loop.scores import deflections

from .style import COLOURS, INK, WIDTH, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLES = ("-", "--")
FEW, MOST = 3, 8  # panels in one column, and in all
LABEL = 14  # characters of a line beside an axis
WIDE = 105  # characters of a legend in one line
STILL = 1e-9  # of a signal's limit or 1, below which it is not drawn


@styled
def controllers(scene: Scene, contests: Sequence[Contest]) -> Figure:
    """What the goal names, deflections and inputs over time: colours are controllers, line styles plants.

    Signals that stay zero in every run are left out, and what exceeds MOST panels.
    """
    from matplotlib.lines import Line2D

    runs = [(c, c.motion) for c in contests if c.motion is not None]
    own = dict(scene.goal) | dict(scene.goal_rates)
    signals = [*dict.fromkeys((*driven_to_goal(scene), *deflections(scene))), *names(scene.plant.inputs)]
    limits = dict(zip(names(scene.plant.inputs), scene.limits, strict=True))
    peak = {name: max(float(np.abs(m[name]).max()) for _, m in runs) for name in signals}
    signals = [name for name in signals if peak[name] > STILL * limits.get(name, 1.0)][:MOST]
    columns = 1 if len(signals) <= FEW else 2
    rows = -(-len(signals) // columns)
    figure, axes = panels(rows, columns, height=1.4, width=WIDTH * 1.1, sharex=True)
    players = list(dict.fromkeys(c.controller for c, _ in runs))
    plants = list(dict.fromkeys(c.plant for c, _ in runs))
    every = (*scene.plant.states, *scene.plant.outputs, *scene.plant.inputs)
    for ax, name in zip(axes, signals):
        for contest, motion in runs:
            held = "steps-post" if name in limits else "default"
            style = STYLES[plants.index(contest.plant)]
            colour = COLOURS[players.index(contest.controller)]
            ax.plot(motion.t, motion[name], style, color=colour, drawstyle=held, lw=1.2)
        if name in own and name not in dict(scene.goal_rates):
            ax.axhline(own[name], color=INK, lw=0.8, ls=(0, (1, 3)))
        if limits.get(name, np.inf) < 1.3 * peak[name]:
            for sign in (-1, 1):
                ax.axhline(sign * limits[name], color=INK, lw=0.8, ls=(0, (5, 2)), alpha=0.5)
        unit = every[index(every, name, "signal")].unit
        ax.set_ylabel(f"{fill(name.replace('_', ' '), LABEL)}\n[{unit}]")
        ax.margins(x=0.02)
    for ax in axes[len(signals) :]:
        ax.remove()
        axes[len(signals) - 2].tick_params(labelbottom=True)
    for ax in axes[max(0, len(signals) - columns) : len(signals)]:
        ax.set_xlabel("time [s]")
    axes[0].set_title("Controllers in closed loop")
    handles = [Line2D([], [], color=COLOURS[i], label=name) for i, name in enumerate(players)]
    handles += [Line2D([], [], color=INK, ls=STYLES[i], label=f"on {name}") for i, name in enumerate(plants)]
    room = sum(len(str(handle.get_label())) + 7 for handle in handles) <= WIDE
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles) if room else 2)
    return figure


@styled
def learning_curve(scene: Scene, algorithm: str, curve: Sequence[Evaluation], lqr: float | None) -> Figure:
    """Cost of the deterministic policy against training steps."""
    figure, (axis,) = panels(1, height=3.0)
    axis.plot([p.steps / 1e6 for p in curve], [p.cost for p in curve], marker=".", label=algorithm.upper())
    if lqr is not None:
        axis.axhline(lqr, color=COLOURS[1], label="LQR")
        axis.axhline(2 * lqr, color=COLOURS[1], linestyle=":", label="twice LQR")
    axis.set_yscale("log")
    axis.set_xlabel("environment steps [million]")
    axis.set_ylabel("cost of the scene as it is [-]")
    axis.set_title(f"{scene.name}: {curve[-1].seconds:.0f} s of training")
    axis.legend()
    return figure
