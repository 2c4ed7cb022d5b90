"""The picture of a policy's training."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pliant.controllers.learning.evaluation import Evaluation
from pliant.envs.scenes.scene import Scene

from .style import COLOURS, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
