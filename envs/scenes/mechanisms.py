"""Scenes of mechanisms: an elastic rod in a crank, a gear that gives, a hanging rod."""

from __future__ import annotations

import dataclasses

import numpy as np

from pliant.envs.machines import trees
from pliant.plants import SliderCrank

from .nominal_inputs import let_go
from .scene import Scene


def slider_crank_run(rpm: float = 144.0) -> Scene:
    """Run a slider-crank with an elastic rod at its speed for 1 s and watch the rod bend; control period 0.005 s.

    "Elastodynamic Analysis of a Mechanism with Flexible Links": 144 rpm, Q = 20 N, r = 55 mm, l = 280 mm. The paper
    does not give the rod's section; SliderCrank.textbook() says which is taken. `rpm` may be given.

    | observation                | unit  |
    |----------------------------|-------|
    | crank_angle_rate - speed   | rad/s |
    | mid_deflection             | m     |

    | action                     | unit    | at -1 | at 1 |
    |----------------------------|---------|-------|------|
    | crank_acceleration         | rad/s^2 | -50   | 50   |

    | cost of the deviation in   | unit    | weight |
    |----------------------------|---------|--------|
    | crank_angle_rate           | rad/s   | 1      |
    | mid_deflection             | m       | 1e+08  |
    | crank_acceleration         | rad/s^2 | 0.001  |

    | ends beyond                | unit  | bound |
    |----------------------------|-------|-------|
    | mid_deflection             | m     | 0.01  |

    | policy                   | return    |
    |--------------------------|-----------|
    | bound: no law is better  | -0.0099   |
    | LQR                      | -0.0099   |
    | zero actions             | -0.009901 |
    | random actions           | -2.428    |
    """
    speed = rpm * np.pi / 30.0
    return Scene(
        name="slider-crank-run",
        about=f"run a slider-crank with an elastic rod at {rpm:g} rpm",
        plant=dataclasses.replace(SliderCrank.textbook(), crank_speed=speed),
        start=(("crank_angle_rate", speed),),
        goal=(("crank_angle_rate", speed),),
        start_at_rest=False,
        goal_at_rest=False,
        drive=let_go,
        duration=1.0,
        dt=0.005,
        substeps=20,
        limits=(50.0,),
        bounds=(("mid_deflection", 0.01),),
        weights=(("crank_angle_rate", 1.0), ("mid_deflection", 1e8)),
        effort=(("crank_acceleration", 1e-3),),
        observe=("crank_angle_rate", "mid_deflection"),
        randomise=(("slider_mass", 0.8, 1.2),),
        compare=("mid_deflection",),
        tolerance=2e-7,
    )


def flexible_joint_slew() -> Scene:
    """Turn a bar with a payload by one radian through a gear that gives, in 2 s; control period 0.02 s.

    The motor turns a hundred times as far; only its torque acts, and the bar swings on the gear.

    | observation       | unit  |
    |-------------------|-------|
    | joint - 1         | rad   |
    | joint_rate        | rad/s |
    | joint_motor - 100 | rad   |
    | joint_motor_rate  | rad/s |

    | action             | unit | at -1 | at 1 |
    |--------------------|------|-------|------|
    | joint_motor_torque | N m  | -0.8  | 0.8  |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | joint                    | rad   | 10     |
    | joint_rate               | rad/s | 0.3    |
    | joint_motor_torque       | N m   | 1      |

    | ends beyond | unit  | bound |
    |-------------|-------|-------|
    | joint_rate  | rad/s | 12    |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -2.705 |
    | LQR                      | -2.705 |
    | zero actions             | -20    |
    | random actions           | -43.71 |
    """
    return Scene(
        name="flexible-joint-slew",
        about="turn a bar with a payload by one radian through a gear that gives",
        plant=trees.flexible_joint(),
        start=(("joint", 0.0),),
        goal=(("joint", 1.0),),
        duration=2.0,
        substeps=4,
        limits=(0.8,),
        bounds=(("joint_rate", 12.0),),
        weights=(("joint", 10.0), ("joint_rate", 0.3)),
        effort=(("joint_motor_torque", 1.0),),
        observe=("joint", "joint_rate", "joint_motor", "joint_motor_rate"),
        randomise=(("payload.mass", 0.7, 1.3),),
        start_spread=0.1,
        compare=("tip_x", "tip_y"),
    )


def crane_swing() -> Scene:
    """Move 200 kg on a hanging rod that bends by 3 m, to rest again, for 10 s; control period 0.05 s.

    Nothing drives the swing but the trolley.

    | observation           | unit  |
    |-----------------------|-------|
    | trolley - 3           | m     |
    | trolley_rate          | m/s   |
    | swing                 | rad   |
    | swing_rate            | rad/s |
    | rod_deflection_z      | m     |
    | rod_deflection_z_rate | m/s   |

    | action        | unit | at -1 | at 1 |
    |---------------|------|-------|------|
    | trolley_force | N    | -600  | 600  |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | trolley                  | m     | 1      |
    | trolley_rate             | m/s   | 0.1    |
    | swing                    | rad   | 10     |
    | swing_rate               | rad/s | 1      |
    | rod_deflection_z_rate    | m/s   | 1      |
    | trolley_force            | N     | 1e-05  |

    | ends beyond      | unit | bound |
    |------------------|------|-------|
    | swing            | rad  | 0.6   |
    | rod_deflection_z | m    | 0.4   |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -12.42 |
    | LQR                      | -12.43 |
    | zero actions             | -90    |
    | random actions           | -188.2 |
    """
    return Scene(
        name="crane-swing",
        about="move a trolley with 200 kg on a hanging rod that bends, and bring the load to rest",
        plant=trees.crane(),
        start=(("trolley", 0.0),),
        goal=(("trolley", 3.0),),
        duration=10.0,
        dt=0.05,
        substeps=3,
        move_time=4.0,
        limits=(600.0,),
        bounds=(("swing", 0.6), ("rod_deflection_z", 0.4)),
        weights=(
            ("trolley", 1.0),
            ("trolley_rate", 0.1),
            ("swing", 10.0),
            ("swing_rate", 1.0),
            ("rod_deflection_z_rate", 1.0),
        ),
        effort=(("trolley_force", 1e-5),),
        observe=("trolley", "trolley_rate", "swing", "swing_rate", "rod_deflection_z", "rod_deflection_z_rate"),
        randomise=(("payload.mass", 0.7, 1.3),),
        spreads=(("trolley", 0.1),),
        compare=("tip_x", "tip_z"),
    )
