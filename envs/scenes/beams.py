"""Scenes of slender beams: one that is let go, one that is spun up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.plants import Beam, LargeDeflectionBeam, Plant, SingleLinkArm

from .nominal_inputs import let_go
from .scene import Scene


def cantilever_drop() -> Scene:
    """Let go a straight 10 m cantilever under gravity, for 3 s; control period 0.05 s.

    A tip force may soften the fall to its hanging rest. The beam of
    "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Section 5.

    | observation              | unit  |
    |--------------------------|-------|
    | tip_u - hanging          | m     |
    | tip_v - hanging          | m     |
    | tip_u_rate               | m/s   |
    | tip_v_rate               | m/s   |

    | action                   | unit  | at -1 | at 1 |
    |--------------------------|-------|-------|------|
    | tip_force_x              | N     | -5    | 5    |
    | tip_force_y              | N     | -5    | 5    |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | tip_u                    | m     | 1      |
    | tip_v                    | m     | 1      |
    | tip_u_rate               | m/s   | 0.1    |
    | tip_v_rate               | m/s   | 0.1    |
    | tip_force_x              | N     | 0.1    |
    | tip_force_y              | N     | 0.1    |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | tip_u_rate               | m/s   | 60    |
    | tip_v_rate               | m/s   | 60    |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -10.51 |
    | LQR                      | -10.62 |
    | zero actions             | -31.89 |
    | random actions           | -40.22 |
    """
    return Scene(
        name="cantilever-drop",
        about="let go a straight 10 m cantilever under gravity",
        plant=LargeDeflectionBeam.textbook(),
        start=(),
        goal=(),
        start_at_rest=False,
        drive=let_go,
        duration=3.0,
        dt=0.05,
        substeps=5,
        limits=(5.0, 5.0),
        bounds=(("tip_u_rate", 60.0), ("tip_v_rate", 60.0)),
        weights=(("tip_u", 1.0), ("tip_v", 1.0), ("tip_u_rate", 0.1), ("tip_v_rate", 0.1)),
        effort=(("tip_force_x", 0.1), ("tip_force_y", 0.1)),
        observe=("tip_u", "tip_v", "tip_u_rate", "tip_v_rate"),
        randomise=(("beam.density", 0.9, 1.1),),
        tolerance=3e-3,
    )


def spin_up(speed: float = 6.0, time: float = 15.0) -> Scene:
    """Spin a hub with a 10 m beam up to a speed in 15 s and watch the tip lag, for 20 s; control period 0.02 s.

    The Kane-Ryan-Banerjee benchmark.
    The nominal hub acceleration is speed / time (1 - cos(2 pi t / time)); `speed` [rad/s] and `time` [s] may be given.

    | observation              | unit  |
    |--------------------------|-------|
    | hub_angle_rate - speed   | rad/s |
    | tip_deflection           | m     |
    | tip_deflection_rate      | m/s   |

    | action                   | unit    | at -1 | at 1 |
    |--------------------------|---------|-------|------|
    | hub_acceleration         | rad/s^2 | -2    | 2    |

    | cost of the deviation in | unit    | weight |
    |--------------------------|---------|--------|
    | hub_angle_rate           | rad/s   | 1      |
    | tip_deflection           | m       | 10     |
    | tip_deflection_rate      | m/s     | 1      |
    | hub_acceleration         | rad/s^2 | 1      |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | tip_deflection           | m     | 3     |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -103.2 |
    | LQR                      | -105.4 |
    | zero actions             | -720   |
    | random actions           | -1412  |
    """
    beam = Beam(length=10.0, area=4e-4, I_y=2e-7, I_z=2e-7, J=4e-7, density=3000.0, E=7e10, G=2.8e10, damping=0.0)
    return Scene(
        name="spin-up",
        about=f"spin a hub with a 10 m beam up to {speed:g} rad/s",
        plant=SingleLinkArm(link=beam, kinematics="stiffened", basis="clamped-free", modes=2, drive="motion"),
        start=(),
        goal=(("hub_angle_rate", speed),),
        start_at_rest=False,
        goal_at_rest=False,
        drive=SmoothSpinUp(speed, time),
        duration=time + 5.0,
        limits=(2.0,),
        bounds=(("tip_deflection", 3.0),),
        weights=(("hub_angle_rate", 1.0), ("tip_deflection", 10.0), ("tip_deflection_rate", 1.0)),
        effort=(("hub_acceleration", 1.0),),
        observe=("hub_angle_rate", "tip_deflection", "tip_deflection_rate"),
        randomise=(("link.E", 0.9, 1.1),),
        compare=("tip_deflection",),
        tolerance=5e-3,
    )


@dataclass(frozen=True)
class SmoothSpinUp:
    """Hub acceleration speed / time (1 - cos(2 pi t / time)), then none."""

    speed: float  # [rad/s] at the end
    time: float  # [s] until then

    def __call__(self, plant: Plant, t: float) -> np.ndarray:
        turned = 1.0 - np.cos(2 * np.pi * t / self.time) if t < self.time else 0.0
        return np.array([self.speed / self.time * turned])
