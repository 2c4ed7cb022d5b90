"""Figures 3 to 5 of "On the dynamic modelling of flexible manipulators".

Figure 3    first frequency of the clamped beam with an offset payload over the payload's I_zz and I_xx
Figure 4    tip deflection in a spin-up to 50 rad/s, linear against stiffened, Timoshenko's theory
Figure 5    the same by Euler's and Bernoulli's
The paper gives neither chi and mu of its beam nor the profile of the spin-up: ours are stated here. Its text says that
the linear model shows the smaller deflections; it shows the larger ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import Beam, Material, SingleLinkArm, Trajectory
from pliant.plants.beams.offset_payload_roots import OffsetPayload
from pliant.studies.figures.style import COLOURS, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MASS, OFFSET, PRODUCT = 1.0, (0.05, 0.05, 0.05), 0.005  # Mt, a_i and I_xz of the paper's Figure 3
CHI, MU = 1.1, 0.05  # ours
SPEED = 50.0  # [rad/s], Figures 4 and 5
STEEL = Material(density=7800.0, E=210e9, G=81e9)


def first_root(I_xx: float, I_zz: float) -> float:
    """lambda_1 of Figure 3's beam; I_xx I_zz >= I_xz^2, else ValueError."""
    inertia = (I_xx, I_zz, PRODUCT)
    return float(OffsetPayload(mass=MASS, offset=OFFSET, inertia=inertia, chi=CHI, mu=MU).roots(1)[0])


@styled
def first_frequency(points: int = 25) -> Figure:
    """Figure 3: lambda_1^2 over I_zz and I_xx, each from 0.005 to 5."""
    moments = np.geomspace(PRODUCT, 1000 * PRODUCT, points)
    chosen = (0.005, 0.05, 0.2, 0.5, 2.0)
    surface = np.array([[first_root(x, z) for x in moments] for z in moments]) ** 2
    figure, (left, right) = panels(1, 2, height=3.6)
    filled = left.contourf(moments, moments, surface, levels=14, cmap="viridis")
    figure.colorbar(filled, ax=left, label=r"$\lambda_1^2$")
    left.set_yscale("log")
    left.set_ylabel(r"$I_{zz}$")
    left.set_title("First frequency, dimensionless")
    fine = np.geomspace(moments[0], moments[-1], 4 * points)
    for i, z in enumerate(chosen):
        curve = [first_root(x, z) ** 2 for x in fine]
        right.plot(fine, curve, color=COLOURS[i], label=f"$I_{{zz}}$ = {z:g}")
    right.set_ylabel(r"$\lambda_1^2$")
    right.set_title("Flat until torsion takes over")
    right.legend(loc="center left", bbox_to_anchor=(0.02, 0.43))
    for ax in (left, right):
        ax.set_xscale("log")
        ax.set_xlabel(r"$I_{xx}$")
    return figure


@dataclass(frozen=True)
class SpinUp:
    """One motion of Figures 4 and 5 and what it comes to."""

    motion: Trajectory
    largest: float  # tip deflection [m]
    residual: float  # largest tip deflection after the spin-up [m]
    frequency: float  # of the first mode at full speed [Hz]


def spin_up(theory: str, kinematics: str, *, time: float = 1.0, modes: int = 3, after: float = 1.0) -> SpinUp:
    """A steel strip, L = 1 m, h/L = 0.01, without payload, spun up to 50 rad/s in `time` [s].

    The hub's motion is prescribed: theta' = 50 (s - sin(2 pi s)/(2 pi)), s = t/time, as in Kane's benchmark.
    """
    strip = Beam.rectangular(1.0, width=0.05, depth=0.01, material=STEEL)
    arm = SingleLinkArm(link=strip, drive="motion", theory=theory, kinematics=kinematics, modes=modes)

    def acceleration(t: float) -> list[float]:
        return [SPEED / time * (1 - np.cos(2 * np.pi * t / time)) if t < time else 0.0]

    t = np.concatenate([np.linspace(0, time, 1001), np.linspace(time, time + after, 2001)[1:]])
    motion = arm.simulate(np.zeros(arm.nx), acceleration, t, rtol=1e-10)
    bent = np.abs(motion["tip_deflection"])
    at_speed = np.zeros(arm.nx)
    at_speed[arm.coordinates_slice.stop] = SPEED
    frequency = float(arm.natural_frequencies(at_speed)[0]) / (2 * np.pi)
    return SpinUp(motion, float(bent.max()), float(bent[t >= time].max()), frequency)


@styled
def spin_up_deflections(theory: str, *, times: tuple[float, ...] = (0.5, 1.0)) -> Figure:
    """Figure 4 ("timoshenko") or 5 ("euler-bernoulli"): tip deflection against time, one panel a spin-up time."""
    figure, axes = panels(len(times) + 1, height=1.9, sharex=True)
    for ax, time in zip(axes, times):
        for i, kinematics in enumerate(("linear", "stiffened")):
            found = spin_up(theory, kinematics, time=time, after=times[-1] + 0.8 - time)
            label = f"{kinematics}: {1e3 * found.largest:.1f} mm, then {found.frequency:.2f} Hz"
            ax.plot(found.motion.t, 1e3 * found.motion["tip_deflection"], ("-", "--")[i], color=COLOURS[i], label=label)
        ax.set_ylabel("tip deflection [mm]")
        ax.set_title(f"Spun up in {time:g} s")
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        axes[-1].plot(found.motion.t, found.motion["hub_angle_rate"], label=f"in {time:g} s")
    axes[-1].set_ylabel("hub rate [rad/s]")
    axes[-1].set_xlabel("time [s]")
    axes[-1].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    names = {"timoshenko": "Timoshenko beam", "euler-bernoulli": "Euler-Bernoulli beam"}
    figure.suptitle(f"{names[theory]}, 50 rad/s, h/L = 0.01, three modes", fontsize=10)
    return figure


def figures() -> dict[str, Figure]:
    """All three figures by file name."""
    return {
        "figure3_first_frequency": first_frequency(),
        "figure4_timoshenko_spin_up": spin_up_deflections("timoshenko"),
        "figure5_euler_bernoulli_spin_up": spin_up_deflections("euler-bernoulli"),
    }
