"""The scene of a spacecraft that points at the Earth while its panels follow the sun."""

from __future__ import annotations

import numpy as np

from pliant.envs.machines.spacecraft_parts import ALONG_Y, AXES, panels
from pliant.plants import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft_parts.hub import Hub, Wheel

from .nominal_inputs import let_go
from .scene import Scene


def spacecraft_orbit() -> Scene:
    """Point a spacecraft at the Earth while its panels follow the sun, for 11424 s; control period 6 s.

    These are two orbits. Reference axes are the orbit's: x along the velocity, z to the Earth. It starts 5 degrees off
    about each axis. The hub is long and its pitch inertia the largest, so that the gravity gradient holds it without
    control (Lagrange's region); three wheels turn it. The panels, along y, turn relative to the hub at the orbital
    rate: the goal of hinge1_1 and hinge2_1 moves by 0.0011 rad/s one way and the other from its value at the start,
    and so does what deviations are measured from.

    | observation              | unit  |
    |--------------------------|-------|
    | attitude_x               | 1     |
    | attitude_y               | 1     |
    | attitude_z               | 1     |
    | body_rate_x              | rad/s |
    | body_rate_y - -0.0011    | rad/s |
    | body_rate_z              | rad/s |
    | hinge1_1                 | rad   |
    | hinge2_1                 | rad   |
    | hinge1_1_rate - 0.0011   | rad/s |
    | hinge2_1_rate - -0.0011  | rad/s |
    | wheel1_momentum          | N m s |
    | wheel2_momentum          | N m s |
    | wheel3_momentum          | N m s |

    | action                   | unit    | at -1  | at 1  |
    |--------------------------|---------|--------|-------|
    | wheel1_torque            | N m     | -0.02  | 0.02  |
    | wheel2_torque            | N m     | -0.02  | 0.02  |
    | wheel3_torque            | N m     | -0.02  | 0.02  |
    | hinge1_1_acceleration    | rad/s^2 | -1e-05 | 1e-05 |
    | hinge2_1_acceleration    | rad/s^2 | -1e-05 | 1e-05 |

    | cost of the deviation in | unit    | weight |
    |--------------------------|---------|--------|
    | attitude_x               | 1       | 1      |
    | attitude_y               | 1       | 1      |
    | attitude_z               | 1       | 1      |
    | body_rate_x              | rad/s   | 1000   |
    | body_rate_y              | rad/s   | 1000   |
    | body_rate_z              | rad/s   | 1000   |
    | hinge1_1                 | rad     | 0.1    |
    | hinge2_1                 | rad     | 0.1    |
    | wheel1_momentum          | N m s   | 0.001  |
    | wheel2_momentum          | N m s   | 0.001  |
    | wheel3_momentum          | N m s   | 0.001  |
    | wheel1_torque            | N m     | 100    |
    | wheel2_torque            | N m     | 100    |
    | wheel3_torque            | N m     | 100    |
    | hinge1_1_acceleration    | rad/s^2 | 1e+08  |
    | hinge2_1_acceleration    | rad/s^2 | 1e+08  |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | attitude_x               | 1     | 1     |
    | attitude_y               | 1     | 1     |
    | attitude_z               | 1     | 1     |
    | wheel1_momentum          | N m s | 4     |
    | wheel2_momentum          | N m s | 4     |
    | wheel3_momentum          | N m s | 4     |

    | policy                   | return |
    |--------------------------|--------|
    | LQR                      | -4.876 |
    | zero actions             | -164.2 |
    | random actions           | -46330 |
    """
    rate = 1.1e-3
    plate = Surface(area=12.0, normal=(0.0, 0.0, 1.0), specular=0.1, diffuse=0.1, both=True)
    hinge = Hinge(axes=((1.0, 0.0, 0.0),), drive="motion")
    wheels = tuple(Wheel(axis=tuple(float(i == k) for i in range(3)), inertia=0.01) for k in range(3))  # type: ignore[arg-type]
    craft = FlexibleSpacecraft(
        hub=Hub(mass=1000.0, inertia=(1000.0, 1600.0, 700.0), wheels=wheels),
        appendages=panels(ALONG_Y, hinge, plate, known=2),
        kinematics="linear",
        translation=False,
        environment=Environment(orbit=Orbit(rate=rate), sun=Sun(direction=(0.0, 0.0, -1.0))),
    )
    attitude, rates = tuple(f"attitude_{c}" for c in AXES), tuple(f"body_rate_{c}" for c in AXES)
    momenta, turns = tuple(f"wheel{k}_momentum" for k in (1, 2, 3)), (("hinge1_1", rate), ("hinge2_1", -rate))
    hinges, off = tuple(n for n, _ in turns), np.sin(np.deg2rad(2.5))
    still = (*((f"{n}_rate", v) for n, v in turns), ("rate_y", -rate))
    return Scene(
        name="spacecraft-orbit",
        about="point a spacecraft at the Earth while its panels follow the sun, for two orbits",
        plant=craft,
        start=(("quaternion_0", 1.0), *((f"quaternion_{k}", float(off)) for k in (1, 2, 3)), *still),
        nominal_start=still,
        goal=still,
        goal_rates=turns,
        start_at_rest=False,
        goal_at_rest=False,
        drive=let_go,
        duration=11424.0,
        dt=6.0,
        substeps=8,
        limits=(0.02, 0.02, 0.02, 1e-5, 1e-5),
        bounds=(*((n, 1.0) for n in attitude), *((n, 4.0) for n in momenta)),
        weights=(
            *((n, 1.0) for n in attitude),
            *((n, 1000.0) for n in rates),
            *((n, 0.1) for n in hinges),
            *((n, 0.001) for n in momenta),
        ),
        effort=(*((f"wheel{k}_torque", 100.0) for k in (1, 2, 3)), *((f"{n}_acceleration", 1e8) for n in hinges)),
        observe=(*attitude, *rates, *hinges, *(f"{n}_rate" for n in hinges), *momenta),
        randomise=(
            ("appendages.0.stiffness_factor", 0.8, 1.2),
            ("hub.inertia.0.0", 0.95, 1.05),
            ("hub.inertia.2.2", 0.95, 1.05),
        ),
        start_spread=0.02,
        spreads=(*((n, 0.0) for n, _ in still),),
        compare=("attitude_y",),
    )
