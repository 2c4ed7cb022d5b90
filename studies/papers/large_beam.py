"""Figures 3 and 4 of "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation".

Figure 3    displacement and velocity of the tip of the released cantilever, N sub-beams against the exact beam
Figure 4    N = 2 at 1.54 s: (a) deformed shape, (b) each sub-beam's deformation in its own floating frame
Frames      error of the tip with tangent, chord and mean-axis frames
The paper compares with Abaqus; here the exact beam is the rotation field with six shapes, within 2e-4 m of a
geometrically exact finite-element model. The paper does not say how many modes a sub-beam has: three give its digits.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import LargeDeflectionBeam, Trajectory
from pliant.plants.large_deflection.sub_beam_chain import FRAMES, Chain
from pliant.studies.figures.style import COLOURS, INK, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODES = 3  # of each sub-beam
SHOWN = 1.54  # [s], the paper's time of Figure 4
END = 3.0  # [s]


def chain(segments: int, frame: str = "mean-axis", modes: int = MODES) -> LargeDeflectionBeam:
    """The paper's cantilever of N sub-beams."""
    beam = LargeDeflectionBeam.textbook()
    return dataclasses.replace(beam, kinematics="substructured", segments=segments, frame=frame, modes=modes)


def exact() -> LargeDeflectionBeam:
    """The same cantilever with an exact rotation field."""
    return dataclasses.replace(LargeDeflectionBeam.textbook(), modes=6)


@lru_cache(maxsize=16)
def released(plant: LargeDeflectionBeam, end: float = END) -> Trajectory:
    """The motion from rest, straight along x, every 0.01 s."""
    return plant.simulate(np.zeros(plant.nx), None, np.arange(0.0, end + 0.005, 0.01), rtol=1e-8, atol=1e-9)


@styled
def tip_histories(segments: Sequence[int] = (1, 2, 3)) -> Figure:
    """Figure 3: u, v and their rates over 3 s."""
    figure, axes = panels(2, 2, height=2.6, sharex=True)
    signals = (
        ("tip_u", "u [m]"),
        ("tip_v", "v [m]"),
        ("tip_u_rate", "du/dt [m/s]"),
        ("tip_v_rate", "dv/dt [m/s]"),
    )
    truth = released(exact())
    for ax, (name, label) in zip(axes, signals):
        ax.plot(truth.t, truth[name], color=INK, lw=2.4, alpha=0.35, label="exact rotations")
        for i, n in enumerate(segments):
            motion = released(chain(n))
            ax.plot(motion.t, motion[name], "--", color=COLOURS[i], lw=1.1, label=f"N = {n}")
        ax.set_ylabel(label)
    axes[0].legend(loc="lower right")
    for ax in axes[2:]:
        ax.set_xlabel("time [s]")
    figure.suptitle("Tip of the released 10 m cantilever", fontsize=10)
    return figure


@styled
def deformed_shapes(segments: int = 2, time: float = SHOWN) -> Figure:
    """Figure 4: the beam at one time, and every sub-beam's deformation relative to its mean-axis frame."""
    plant = chain(segments)
    x = _state(released(plant), time)
    links = plant.shapes
    assert isinstance(links, Chain)
    figure, (left, right) = panels(1, 2, height=3.6)
    line = exact().positions(_state(released(exact()), time), np.linspace(0, 1, 200))
    left.plot(*line.T, color=INK, lw=2.6, alpha=0.35, label="exact rotations")
    at = np.linspace(0, 1, 61)
    length = plant.beam.length / segments
    for i in range(segments):
        xi = (i + at) / segments
        left.plot(*plant.positions(x, xi).T, color=COLOURS[i], label=f"sub-beam {i + 1}")
        moved = links.deformation(x[: links.n], i, at, plant.beam.length)
        right.plot(length * at + moved[:, 0], moved[:, 1], color=COLOURS[i], label=f"sub-beam {i + 1}")
        right.plot(length * at, 0 * at, color=COLOURS[i], lw=0.6, ls=":")
    tip = plant.positions(x, np.ones(1))[0]
    left.set_title(f"(a) t = {time:g} s: u = {tip[0] - plant.beam.length:.3f}, v = {tip[1]:.3f} m")
    left.set_aspect("equal")
    left.set_xlabel("x [m]")
    left.set_ylabel("y [m]")
    left.legend(loc="lower left")
    right.set_title("(b) in the sub-beams' own frames")
    right.set_xlabel("along the frame [m]")
    right.set_ylabel("across it [m]")
    right.legend(loc="best")
    return figure


def _state(motion: Trajectory, time: float) -> np.ndarray:
    return np.asarray(motion.x[int(np.argmin(np.abs(motion.t - time)))])


@styled
def frames_compared(segments: Sequence[int] = (2, 3, 4)) -> Figure:
    """Distance of the tip from the exact beam's over time, one panel a number of sub-beams, one curve a frame."""
    figure, axes = panels(1, len(segments), height=3.0, sharey=True)
    truth = released(exact())
    for ax, n in zip(axes, segments):
        for i, frame in enumerate(FRAMES):
            motion = released(chain(n, frame, modes=2))
            away = np.hypot(motion["tip_x"] - truth["tip_x"], motion["tip_y"] - truth["tip_y"])
            ax.semilogy(motion.t[1:], away[1:], color=COLOURS[i], label=f"{frame}: {away.max():.2g} m")
        ax.set_title(f"N = {n}, two modes each")
        ax.set_xlabel("time [s]")
        ax.set_ylim(1e-6, 10)
        ax.legend(loc="lower right")
    axes[0].set_ylabel("error of the tip [m]")
    return figure


def figures() -> dict[str, Figure]:
    """All figures by file name."""
    return {
        "figure3_tip_histories": tip_histories(),
        "figure4_deformed_shapes": deformed_shapes(),
        "frames_compared": frames_compared(),
    }
