"""Scenes of elastic robot arms that go from rest to rest."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from pliant.plants import Payload, SingleLinkArm, TwoLinkArm

from .scene import Scene


def single_link_slew() -> Scene:
    """Slew a steel link with a 1 kg payload by one radian, rest to rest, in 3 s; control period 0.02 s.

    | observation              | unit  |
    |--------------------------|-------|
    | hub_angle - 1            | rad   |
    | hub_angle_rate           | rad/s |
    | tip_deflection           | m     |
    | tip_deflection_rate      | m/s   |

    | action                   | unit  | at -1 | at 1 |
    |--------------------------|-------|-------|------|
    | hub_torque               | N m   | -40   | 40   |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | hub_angle                | rad   | 10     |
    | hub_angle_rate           | rad/s | 0.1    |
    | tip_deflection           | m     | 100    |
    | tip_deflection_rate      | m/s   | 0.1    |
    | hub_torque               | N m   | 0.002  |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | tip_deflection           | m     | 0.3   |
    | hub_angle_rate           | rad/s | 12    |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -3.511 |
    | LQR                      | -3.511 |
    | zero actions             | -30    |
    | random actions           | -77.33 |
    """
    arm = SingleLinkArm.textbook()
    arm = dataclasses.replace(
        arm,
        link=dataclasses.replace(arm.link, damping=2e-4),
        hub_friction=0.05,
        payload=Payload(mass=1.0, inertia=0.001),
    )
    return Scene(
        name="single-link-slew",
        about="turn a steel link with a 1 kg payload by one radian, rest to rest",
        plant=arm,
        start=(("hub_angle", 0.0),),
        goal=(("hub_angle", 1.0),),
        duration=3.0,
        limits=(40.0,),
        bounds=(("tip_deflection", 0.3), ("hub_angle_rate", 12.0)),
        weights=(
            ("hub_angle", 10.0),
            ("hub_angle_rate", 0.1),
            ("tip_deflection", 100.0),
            ("tip_deflection_rate", 0.1),
        ),
        effort=(("hub_torque", 2e-3),),
        observe=("hub_angle", "hub_angle_rate", "tip_deflection", "tip_deflection_rate"),
        randomise=(("payload.mass", 0.7, 1.3), ("link.E", 0.9, 1.1)),
        start_spread=0.1,
    )


def two_link_reach() -> Scene:
    """Lift a 0.5 kg payload with two elastic links under gravity, in 3 s; control period 0.02 s.

    The links sag by a tenth of their length, so their shortening counts: without it the tip is 14 mm off.

    | observation              | unit  |
    |--------------------------|-------|
    | theta1 - -0.9            | rad   |
    | theta2 - 0.6             | rad   |
    | theta1_rate              | rad/s |
    | theta2_rate              | rad/s |
    | tip1_deflection - sag    | m     |
    | tip2_deflection - sag    | m     |
    | tip1_deflection_rate     | m/s   |
    | tip2_deflection_rate     | m/s   |

    | action                   | unit  | at -1 | at 1 |
    |--------------------------|-------|-------|------|
    | tau1                     | N m   | -40   | 40   |
    | tau2                     | N m   | -15   | 15   |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | theta1                   | rad   | 10     |
    | theta2                   | rad   | 10     |
    | theta1_rate              | rad/s | 0.1    |
    | theta2_rate              | rad/s | 0.1    |
    | tip1_deflection_rate     | m/s   | 0.1    |
    | tip2_deflection_rate     | m/s   | 0.1    |
    | tau1                     | N m   | 0.002  |
    | tau2                     | N m   | 0.002  |

    | ends beyond              | unit  | bound |
    |--------------------------|-------|-------|
    | tip1_deflection          | m     | 0.4   |
    | tip2_deflection          | m     | 0.4   |
    | theta1_rate              | rad/s | 15    |
    | theta2_rate              | rad/s | 25    |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -2.45  |
    | LQR                      | -2.482 |
    | zero actions             | -28.09 |
    | random actions           | -369.7 |
    """
    arm = TwoLinkArm.textbook()
    damped = dataclasses.replace(arm.link1, damping=2e-4)
    arm = dataclasses.replace(
        arm,
        link1=damped,
        link2=damped,
        hub_inertia=(0.1, 0.02),
        joint_friction=(0.2, 0.1),
        kinematics="stiffened",
        basis="payload",
    )
    return Scene(
        name="two-link-reach",
        about="lift a 0.5 kg payload point to point with two elastic links under gravity",
        plant=arm,
        start=(("theta1", -np.pi / 2), ("theta2", 0.0)),
        goal=(("theta1", -0.9), ("theta2", 0.6)),
        duration=3.0,
        limits=(40.0, 15.0),
        bounds=(
            ("tip1_deflection", 0.4),
            ("tip2_deflection", 0.4),
            ("theta1_rate", 15.0),
            ("theta2_rate", 25.0),
        ),
        weights=(
            ("theta1", 10.0),
            ("theta2", 10.0),
            ("theta1_rate", 0.1),
            ("theta2_rate", 0.1),
            ("tip1_deflection_rate", 0.1),
            ("tip2_deflection_rate", 0.1),
        ),
        effort=(("tau1", 2e-3), ("tau2", 2e-3)),
        observe=(
            "theta1",
            "theta2",
            "theta1_rate",
            "theta2_rate",
            "tip1_deflection",
            "tip2_deflection",
            "tip1_deflection_rate",
            "tip2_deflection_rate",
        ),
        randomise=(("payload.mass", 0.7, 1.3),),
        start_spread=0.1,
    )


def _changed(scene: Scene, suffix: str, about: str, **changes: Any) -> Scene:
    return dataclasses.replace(scene, name=f"{scene.name}-{suffix}", about=about, **changes)


def single_link_gentle() -> Scene:
    """The slew, but the tip may bend by 10 mm in place of 300: LQR's first torque bends it by 16 mm.

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -3.621 |
    | LQR                      | -127.4 |
    | zero actions             | -30    |
    | random actions           | -119.3 |
    """
    bounds = (("tip_deflection", 0.01), ("hub_angle_rate", 12.0))
    return _changed(single_link_slew(), "gentle", "the slew with a tip that may bend by 10 mm", bounds=bounds)


def two_link_weak() -> Scene:
    """The reach with an elbow motor of 10 N m in place of 15: holding the goal takes 8.3.

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -2.646 |
    | LQR                      | -2.941 |
    | zero actions             | -28.09 |
    | random actions           | -343   |
    """
    return _changed(
        two_link_reach(), "weak", "the reach with an elbow motor of 10 N m in place of 15", limits=(40.0, 10.0)
    )
