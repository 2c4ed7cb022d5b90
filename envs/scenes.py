"""The named scenes. Each docstring tables what the scene's environment shows, takes and charges.

An observation is a signal less its value at the goal ("sag": what gravity bends there; "hanging": where the beam
hangs at rest; "speed": the goal's own); the reward is minus the sum, over the rows of the cost, of the control period
times weight times deviation from the goal squared.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.plants import Beam, LargeDeflectionBeam, Payload, Plant, SingleLinkArm, SliderCrank, TwoLinkArm
from pliant.plants.parameters import require_choice

from .scene import Scene, minimum_jerk

__all__ = ["SCENES", "Scene", "get", "minimum_jerk", "names"]


def _single_link_slew() -> Scene:
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


def _two_link_reach() -> Scene:
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


def _let_go(plant: Plant, t: float) -> np.ndarray:
    return np.zeros(plant.nu)


def _cantilever_drop() -> Scene:
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
    """
    return Scene(
        name="cantilever-drop",
        about="let go a straight 10 m cantilever under gravity",
        plant=LargeDeflectionBeam.textbook(),
        start=(),
        goal=(),
        start_at_rest=False,
        drive=_let_go,
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


def _spin_up(speed: float = 6.0, time: float = 15.0) -> Scene:
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


def _slider_crank_run(rpm: float = 144.0) -> Scene:
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
        drive=_let_go,
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


SCENES: Mapping[str, Callable[..., Scene]] = {
    "single-link-slew": _single_link_slew,
    "two-link-reach": _two_link_reach,
    "cantilever-drop": _cantilever_drop,
    "spin-up": _spin_up,
    "slider-crank-run": _slider_crank_run,
}


def names() -> tuple[str, ...]:
    """The names of all scenes."""
    return tuple(SCENES)


@lru_cache
def _own(name: str) -> Scene:
    """One scene a name, so that what is built from it is built once."""
    return SCENES[name]()


def get(name: str, **overrides: Any) -> Scene:
    """A scene by name; keywords are its own ("spin-up": speed) or override its fields (limits=(80.0, 30.0))."""
    require_choice("scenes", "name", name, names())
    own = inspect.signature(SCENES[name]).parameters
    fields = {f.name for f in dataclasses.fields(Scene)}
    for key in overrides:
        require_choice("scenes.get", "keyword", key, sorted(fields | set(own)))
    built = {key: value for key, value in overrides.items() if key in own}
    for key, value in built.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < np.inf:
            raise ValueError(f"scene {name!r}: {key} = {value!r} must be a number > 0")
    scene = SCENES[name](**built) if built else _own(name)
    changed = {key: value for key, value in overrides.items() if key not in own}
    return dataclasses.replace(scene, **changed) if changed else scene
