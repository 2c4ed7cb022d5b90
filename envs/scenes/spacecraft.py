"""Scenes of a free spacecraft with two flexible solar panels: a slew, one by reaction wheels, and a spin.

On the hub of FlexibleSpacecraft.textbook; see `spacecraft_parts` for the panels.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from pliant.envs.machines.spacecraft_parts import (
    AXES,
    FLAT,
    PYRAMID,
    UPRIGHT,
    WHEEL_MOMENTUM,
    WHEEL_TORQUE,
    panels,
    turned,
)
from pliant.plants import FlexibleSpacecraft, Plant
from pliant.plants.core.parameters import require_choice
from pliant.plants.integration.minimum_jerk import minimum_jerk
from pliant.plants.spacecraft_parts.appendage import Hinge

from .scene import Scene


def spacecraft_slew() -> Scene:
    """Turn a spacecraft by 60 degrees about z, rest to rest, in 120 s; control period 0.1 s.

    It starts at -60 degrees: the reference axes are those of the goal, and the attitude outputs the error (twice the
    vector of its quaternion, in rad where it is small). The panels stand upright, so that the turn bends them; the
    nominal torques turn a rigid spacecraft in the first 60 s along a minimum-jerk motion.

    | observation              | unit  |
    |--------------------------|-------|
    | attitude_x               | 1     |
    | attitude_y               | 1     |
    | attitude_z               | 1     |
    | body_rate_x              | rad/s |
    | body_rate_y              | rad/s |
    | body_rate_z              | rad/s |
    | tip1_z                   | m     |
    | tip2_z                   | m     |

    | action                   | unit  | at -1 | at 1 |
    |--------------------------|-------|-------|------|
    | torque_x                 | N m   | -2    | 2    |
    | torque_y                 | N m   | -2    | 2    |
    | torque_z                 | N m   | -2    | 2    |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | attitude_x               | 1     | 1      |
    | attitude_y               | 1     | 1      |
    | attitude_z               | 1     | 1      |
    | body_rate_x              | rad/s | 100    |
    | body_rate_y              | rad/s | 100    |
    | body_rate_z              | rad/s | 100    |
    | tip1_z                   | m     | 100    |
    | tip2_z                   | m     | 100    |
    | torque_x                 | N m   | 0.01   |
    | torque_y                 | N m   | 0.01   |
    | torque_z                 | N m   | 0.01   |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | body_rate_x              | rad/s | 0.1   |
    | body_rate_y              | rad/s | 0.1   |
    | body_rate_z              | rad/s | 0.1   |
    | tip1_z                   | m     | 0.2   |
    | tip2_z                   | m     | 0.2   |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -22.16 |
    | LQR                      | -22.28 |
    | zero actions             | -120   |
    | random actions           | -194.8 |
    """
    own = FlexibleSpacecraft.textbook()
    craft = dataclasses.replace(own, appendages=panels(UPRIGHT), kinematics="linear", translation=False)
    rates, tips = tuple(f"body_rate_{c}" for c in AXES), ("tip1_z", "tip2_z")
    attitude = tuple(f"attitude_{c}" for c in AXES)
    return Scene(
        name="spacecraft-slew",
        about="turn a spacecraft with two flexible panels by 60 degrees, rest to rest",
        plant=craft,
        start=turned(-60.0, "z"),
        goal=turned(0.0, "z"),
        start_at_rest=False,
        duration=120.0,
        move_time=60.0,
        dt=0.1,
        substeps=2,
        limits=(2.0, 2.0, 2.0),
        bounds=(*((n, 0.1) for n in rates), *((n, 0.2) for n in tips)),
        weights=(*((n, 1.0) for n in attitude), *((n, 100.0) for n in (*rates, *tips))),
        effort=tuple((f"torque_{c}", 0.01) for c in AXES),
        observe=(*attitude, *rates, *tips),
        randomise=(
            ("hub.inertia.2.2", 0.8, 1.2),
            ("appendages.0.stiffness_factor", 0.8, 1.2),
            ("appendages.1.stiffness_factor", 0.8, 1.2),
        ),
        start_spread=0.02,
        compare=("tip1_z",),
    )


def spacecraft_wheels() -> Scene:
    """Turn a spacecraft by 30 degrees about z by four reaction wheels, rest to rest, in 180 s; control period 0.2 s.

    As "spacecraft-slew", but wheels in a pyramid turn the hub by the torque that they take, within their torque and the
    momentum that they can store. The total momentum stays zero, whatever they do: they are at rest again when the hub
    is, but for a spin that they can share without turning it. The cost weighs neither. A star tracker, gyros and the
    wheels' tachometers are the plant's own `sensors()`. Nominal torques turn a rigid spacecraft in the first 90 s.

    | observation              | unit  |
    |--------------------------|-------|
    | attitude_x               | 1     |
    | attitude_y               | 1     |
    | attitude_z               | 1     |
    | body_rate_x              | rad/s |
    | body_rate_y              | rad/s |
    | body_rate_z              | rad/s |
    | wheel1_momentum          | N m s |
    | wheel2_momentum          | N m s |
    | wheel3_momentum          | N m s |
    | wheel4_momentum          | N m s |

    | action                   | unit  | at -1 | at 1 |
    |--------------------------|-------|-------|------|
    | wheel1_torque            | N m   | -0.2  | 0.2  |
    | wheel2_torque            | N m   | -0.2  | 0.2  |
    | wheel3_torque            | N m   | -0.2  | 0.2  |
    | wheel4_torque            | N m   | -0.2  | 0.2  |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | attitude_x               | 1     | 1      |
    | attitude_y               | 1     | 1      |
    | attitude_z               | 1     | 1      |
    | body_rate_x              | rad/s | 100    |
    | body_rate_y              | rad/s | 100    |
    | body_rate_z              | rad/s | 100    |
    | tip1_z                   | m     | 100    |
    | tip2_z                   | m     | 100    |
    | wheel1_torque            | N m   | 1      |
    | wheel2_torque            | N m   | 1      |
    | wheel3_torque            | N m   | 1      |
    | wheel4_torque            | N m   | 1      |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | tip1_z                   | m     | 0.2   |
    | tip2_z                   | m     | 0.2   |
    | wheel1_momentum          | N m s | 6     |
    | wheel2_momentum          | N m s | 6     |
    | wheel3_momentum          | N m s | 6     |
    | wheel4_momentum          | N m s | 6     |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -9.593 |
    | LQR                      | -9.594 |
    | zero actions             | -48.23 |
    | random actions           | -66.87 |
    """
    slew = spacecraft_slew()
    own = FlexibleSpacecraft.textbook()
    hub = dataclasses.replace(own.hub, wheels=PYRAMID)
    craft = dataclasses.replace(own, hub=hub, appendages=panels(UPRIGHT), kinematics="linear", translation=False)
    tips, momenta = ("tip1_z", "tip2_z"), tuple(f"wheel{k}_momentum" for k in (1, 2, 3, 4))
    return dataclasses.replace(
        slew,
        name="spacecraft-wheels",
        about="turn a spacecraft with two flexible panels by 30 degrees, by four reaction wheels",
        plant=craft,
        start=turned(-30.0, "z"),
        duration=180.0,
        move_time=90.0,
        dt=0.2,
        substeps=4,
        limits=(WHEEL_TORQUE,) * 4,
        bounds=(*((n, 0.2) for n in tips), *((n, WHEEL_MOMENTUM) for n in momenta)),
        effort=tuple((f"wheel{k}_torque", 1.0) for k in (1, 2, 3, 4)),
        observe=(*(n for n, _ in slew.weights if n not in tips), *momenta),
    )


def spacecraft_spin(axis: str = "z") -> Scene:
    """Keep a spacecraft spinning at 0.1 rad/s while its panels turn by 45 degrees, for 300 s; control period 0.5 s.

    Each panel turns about its own boom in the first 60 s. The spin starts with a nutation: 0.002
    rad/s about each other axis. `axis` ("x", "y", "z") may be given: z has the largest moment of inertia, x the
    smallest, and about y the free spin is unstable.

    | observation              | unit  |
    |--------------------------|-------|
    | body_rate_x              | rad/s |
    | body_rate_y              | rad/s |
    | body_rate_z - 0.1        | rad/s |
    | hinge1_1 - 0.785398163397 | rad   |
    | hinge2_1 - 0.785398163397 | rad   |
    | hinge1_1_rate            | rad/s |
    | hinge2_1_rate            | rad/s |
    | tip1_z                   | m     |
    | tip2_z                   | m     |

    | action                   | unit    | at -1  | at 1  |
    |--------------------------|---------|--------|-------|
    | torque_x                 | N m     | -2     | 2     |
    | torque_y                 | N m     | -2     | 2     |
    | torque_z                 | N m     | -2     | 2     |
    | hinge1_1_acceleration    | rad/s^2 | -0.005 | 0.005 |
    | hinge2_1_acceleration    | rad/s^2 | -0.005 | 0.005 |

    | cost of the deviation in | unit    | weight |
    |--------------------------|---------|--------|
    | body_rate_x              | rad/s   | 100    |
    | body_rate_y              | rad/s   | 100    |
    | body_rate_z              | rad/s   | 100    |
    | hinge1_1                 | rad     | 0.1    |
    | hinge2_1                 | rad     | 0.1    |
    | tip1_z                   | m       | 10     |
    | tip2_z                   | m       | 10     |
    | torque_x                 | N m     | 0.1    |
    | torque_y                 | N m     | 0.1    |
    | torque_z                 | N m     | 0.1    |
    | hinge1_1_acceleration    | rad/s^2 | 1000   |
    | hinge2_1_acceleration    | rad/s^2 | 1000   |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | body_rate_x              | rad/s | 0.3   |
    | body_rate_y              | rad/s | 0.3   |
    | body_rate_z              | rad/s | 0.3   |
    | tip1_z                   | m     | 0.3   |
    | tip2_z                   | m     | 0.3   |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -1.812 |
    | LQR                      | -1.812 |
    | zero actions             | -37.33 |
    | random actions           | -1544  |
    """
    require_choice("spacecraft-spin", "axis", axis, tuple(AXES))
    hinge = Hinge(axes=((1.0, 0.0, 0.0),), drive="motion")
    own = FlexibleSpacecraft.textbook()
    craft = dataclasses.replace(own, appendages=panels(FLAT, hinge), kinematics="stiffened", translation=False)
    rates, tips, hinges = tuple(f"body_rate_{c}" for c in AXES), ("tip1_z", "tip2_z"), ("hinge1_1", "hinge2_1")
    spin = (f"rate_{axis}", 0.1)
    return Scene(
        name="spacecraft-spin",
        about=f"keep a spacecraft spinning about {axis} while its panels turn",
        plant=craft,
        start=tuple(spin if spin[0] == f"rate_{c}" else (f"rate_{c}", 0.002) for c in AXES),
        nominal_start=(spin,),
        goal=(spin, *((n, np.pi / 4) for n in hinges)),
        start_at_rest=False,
        goal_at_rest=False,
        drive=Articulation(np.pi / 4, 60.0),
        duration=300.0,
        dt=0.5,
        substeps=5,
        limits=(2.0, 2.0, 2.0, 0.005, 0.005),
        bounds=(*((n, 0.3) for n in rates), *((n, 0.3) for n in tips)),
        weights=(*((n, 100.0) for n in rates), *((n, 0.1) for n in hinges), *((n, 10.0) for n in tips)),
        effort=(*((f"torque_{c}", 0.1) for c in AXES), *((f"{n}_acceleration", 1000.0) for n in hinges)),
        observe=(*rates, *hinges, *(f"{n}_rate" for n in hinges), *tips),
        randomise=(("hub.inertia.1.1", 0.9, 1.1), ("appendages.0.stiffness_factor", 0.8, 1.2)),
        start_spread=0.002,
        compare=("tip1_z",),
        tolerance=2e-4,
    )


@dataclass(frozen=True)
class Articulation:
    """Hinge accelerations, the last inputs, that turn every panel along a minimum-jerk motion; no torque on the hub."""

    angle: float  # [rad]
    time: float  # [s]

    def __call__(self, plant: Plant, t: float) -> np.ndarray:
        u = np.zeros(plant.nu)
        u[3:] = self.angle * minimum_jerk(t / self.time)[2] / self.time**2
        return u
