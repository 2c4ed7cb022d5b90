"""Figures 6-10 of "Elastodynamic Analysis of a Mechanism with Flexible Links", and the rod's unstable speeds.

The motion starts as the paper's does, Eq. (65): crank at its prescribed speed, rod straight and at rest in its frame;
only its stretch starts where the force holds it, else the force would strike it at time 0.
The paper gives neither the rod's section nor the filter of its Fig. 14: the section is the plant's, the filter a
fourth-order Butterworth low-pass run forwards and backwards, without lag.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants import Trajectory
from pliant.plants.core.parameters import require_count
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.steady_cycles import speed_scan, steady_cycle
from pliant.studies.figures.style import COLOURS, INK, panels, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CYCLES = 2
CUTOFF = 40.0  # [Hz], a third of the textbook rod's first frequency; the paper prints none
SAMPLES = 8000  # a cycle: 19 kHz at 144 rpm
RPM = 60 / (2 * np.pi)

ACROSS, ALONG = COLOURS[0], COLOURS[3]  # the paper's Fig. 14 has black and magenta


def textbook() -> SliderCrank:
    """The plant of the figures: three bending modes and one of stretching, 144 rpm, Q = 20 N."""
    return dataclasses.replace(SliderCrank.textbook(), modes=3, axial_modes=1)


def response(plant: SliderCrank | None = None, cycles: int = CYCLES, samples: int = SAMPLES) -> Trajectory:
    """The motion over some cycles from a straight rod at rest in its frame; `samples` a cycle."""
    plant = textbook() if plant is None else plant
    require_count("response", "cycles", cycles, 1, 100)
    require_count("response", "samples", samples, 100, 1_000_000)
    if plant.crank_speed is None or plant.crank_speed <= 0:
        raise ValueError(f"response.plant.crank_speed = {plant.crank_speed!r} must be > 0 [rad/s]")
    period = 2 * np.pi / plant.crank_speed
    x = steady_cycle(plant).x[0].copy()
    half, bent = plant.coordinates_slice.stop, plant.counts[0]
    x[1 : 1 + bent] = x[half + 1 : half + 1 + bent] = 0.0
    return plant.simulate(x, None, np.linspace(0.0, cycles * period, cycles * samples + 1), rtol=1e-8)


def low_pass(t: np.ndarray, y: np.ndarray, cutoff: float = CUTOFF) -> np.ndarray:
    """y (nt,) at equidistant times t (nt,) [s] without what is faster than `cutoff` [Hz], and without lag."""
    from scipy.signal import butter, sosfiltfilt

    rate = (len(t) - 1) / (t[-1] - t[0])
    if not 0 < cutoff < rate / 2:
        raise ValueError(f"low_pass.cutoff = {cutoff!r} must be > 0 and < {rate / 2:.6g} [Hz]")
    pad = min(len(y) - 1, int(3 * rate / cutoff))
    return sosfiltfilt(butter(4, cutoff, fs=rate, output="sos"), y, padlen=pad)


def _degrees(ax: Axes, motion: Trajectory) -> None:
    turns = motion["crank_angle"][-1] / (2 * np.pi)
    ax.set_xticks(90 * np.arange(round(4 * turns) + 1))
    ax.set_xlim(0, 360 * turns)
    ax.set_xlabel("crank angle [°]")


def _displacement(motion: Trajectory, plant: SliderCrank, name: str, title: str, colour: str) -> Figure:
    figure, (ax,) = panels(1, height=3.0)
    angle = np.degrees(motion["crank_angle"])
    ax.plot(angle, 1e6 * motion[name], color=colour, lw=0.9, label="from a straight rod")
    cycle = steady_cycle(plant)
    turns = round(angle[-1] / 360)
    steady = np.concatenate([np.degrees(cycle["crank_angle"]) + 360 * k for k in range(turns)])
    ax.plot(steady, 1e6 * np.tile(cycle[name], turns), "--", color=INK, lw=1.0, label="steady cycle")
    ax.set_ylabel("displacement [µm]")
    ax.set_title(title)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    _degrees(ax, motion)
    return figure


def _acceleration(motion: Trajectory, name: str, title: str, colour: str, cutoff: float) -> Figure:
    figure, (ax,) = panels(1, height=3.0)
    angle = np.degrees(motion["crank_angle"])
    ax.plot(angle, low_pass(motion.t, motion[name], cutoff), color=colour, lw=2.2, label=f"below {cutoff:g} Hz")
    ax.plot(angle, motion[name], color=INK, lw=0.6, label="as simulated")
    ax.set_ylabel("acceleration [m/s²]")
    ax.set_title(title)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    _degrees(ax, motion)
    return figure


@styled
def figure_6(motion: Trajectory, plant: SliderCrank) -> Figure:
    """Longitudinal elastic displacement of the rod's middle [µm]."""
    return _displacement(
        motion, plant, "mid_extension", "Figure 6: longitudinal elastic displacement of the rod's middle", ALONG
    )


@styled
def figure_7(motion: Trajectory, plant: SliderCrank) -> Figure:
    """Transversal elastic displacement of the rod's middle [µm]."""
    return _displacement(
        motion, plant, "mid_deflection", "Figure 7: transversal elastic displacement of the rod's middle", ACROSS
    )


@styled
def figure_8(motion: Trajectory, cutoff: float = CUTOFF) -> Figure:
    """Absolute acceleration of the rod's middle along the rod [m/s^2]."""
    title = "Figure 8: longitudinal acceleration of the rod's middle"
    return _acceleration(motion, "mid_acceleration_along", title, ALONG, cutoff)


@styled
def figure_9(motion: Trajectory, cutoff: float = CUTOFF) -> Figure:
    """Absolute acceleration of the rod's middle across the rod [m/s^2]."""
    title = "Figure 9: transversal acceleration of the rod's middle"
    return _acceleration(motion, "mid_acceleration", title, ACROSS, cutoff)


@styled
def figure_10(motion: Trajectory, cutoff: float = CUTOFF) -> Figure:
    """Both accelerations [m/s^2], filtered, in one picture; the paper's Fig. 14 is the measured one."""
    figure, (ax,) = panels(1, height=3.0)
    angle = np.degrees(motion["crank_angle"])
    for name, label, colour in (
        ("mid_acceleration", "transversal", ACROSS),
        ("mid_acceleration_along", "longitudinal", ALONG),
    ):
        ax.plot(angle, low_pass(motion.t, motion[name], cutoff), color=colour, lw=1.6, label=label)
    ax.set_ylabel("acceleration [m/s²]")
    ax.set_title(f"Figure 10: accelerations of the rod's middle below {cutoff:g} Hz")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    _degrees(ax, motion)
    return figure


def figures(plant: SliderCrank | None = None, *, cycles: int = CYCLES, cutoff: float = CUTOFF) -> dict[str, Figure]:
    """Figures 6 to 10 by name."""
    plant = textbook() if plant is None else plant
    motion = response(plant, cycles)
    return {
        "slider-crank-figure-06": figure_6(motion, plant),
        "slider-crank-figure-07": figure_7(motion, plant),
        "slider-crank-figure-08": figure_8(motion, cutoff),
        "slider-crank-figure-09": figure_9(motion, cutoff),
        "slider-crank-figure-10": figure_10(motion, cutoff),
    }


def resonant() -> SliderCrank:
    """A rod that its axial force shakes apart: crank 3 mm, slider 20 g, no force, damping 1 % of the first mode."""
    plant = SliderCrank.textbook()
    rod = dataclasses.replace(plant.rod, damping=plant.rod.damping / 2)
    return dataclasses.replace(plant, crank_radius=0.003, slider_mass=0.02, force=0.0, rod=rod, modes=1)


def first_tongue(plant: SliderCrank) -> tuple[float, float]:
    """Edges [rad/s] of the tongue at twice the first bending frequency, to first order in crank over rod length.

    The axial force makes the first mode's stiffness omega^2 (1 + eps cos W t), eps = 4 pi^2 (r/l)(m_s/m_rod + 1/2) at
    W = 2 omega; Mathieu's equation with damping zeta is unstable where |W/(2 omega) - 1| < sqrt((eps/4)^2 - zeta^2).
    NaN where damping closes the tongue. A constant force on the slider moves omega^2 by 1 - Q l^2/(pi^2 E I).
    """
    rod = plant.rod
    buckling = (np.pi / rod.length) ** 2 * rod.EI
    first = (np.pi / rod.length) ** 2 * np.sqrt(rod.EI / rod.linear_density * (1 - plant.force / buckling))
    eps = 4 * np.pi**2 * plant.crank_radius / rod.length * (plant.slider_mass / rod.mass + 0.5)
    room = (eps / 4) ** 2 - (rod.damping * first / 2) ** 2
    half = np.sqrt(room) if room >= 0 else np.nan
    return 2 * first * (1 - half), 2 * first * (1 + half)


@styled
def tongues(
    plant: SliderCrank | None = None, speeds: Any = None, progress: Callable[[float], None] | None = None
) -> Figure:
    """Floquet multipliers and growth over crank speed: where the axial force makes the rod unstable."""
    plant = resonant() if plant is None else plant
    first = plant.natural_frequencies(plant.state(0.0, 0.0), locked=("crank_angle",))[0]
    speeds = first * np.linspace(1.5, 2.5, 121) if speeds is None else np.asarray(speeds, dtype=float)
    scan = speed_scan(plant, speeds, progress=progress)
    figure, axes = panels(2, height=2.4, sharex=True)
    for column in np.abs(scan.multipliers).T:
        axes[0].plot(speeds / first, column, ".", color=COLOURS[0], ms=3)
    axes[0].axhline(1.0, color=INK, lw=0.8)
    axes[0].set_ylabel("size of Floquet multipliers")
    axes[0].set_title("Parametric resonance of the rod under its axial force")
    axes[1].plot(speeds / first, scan.growth, color=COLOURS[0])
    axes[1].axhline(0.0, color=INK, lw=0.8)
    axes[1].set_ylabel("growth rate [1/s]")
    axes[1].set_xlabel(f"crank speed over first bending frequency ({first * RPM:,.0f} rpm)")
    for ax in axes:
        for low, high in scan.tongues:
            ax.axvspan(low / first, high / first, color=COLOURS[1], alpha=0.2, lw=0)
        for edge in first_tongue(plant):
            if speeds[0] < edge < speeds[-1]:
                ax.axvline(edge / first, color=COLOURS[1], ls="--", lw=1.2)
    axes[0].plot([], [], color=COLOURS[1], alpha=0.3, lw=8, label="unstable")
    axes[0].plot([], [], "--", color=COLOURS[1], lw=1.2, label="theory, first order")
    axes[0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure
