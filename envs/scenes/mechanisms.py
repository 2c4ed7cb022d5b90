"""Scenes of mechanisms with an elastic link."""

from __future__ import annotations

import dataclasses

import numpy as np

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
