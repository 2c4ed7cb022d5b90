"""Machines unlike those of `pliant study effectivity`, by seed: other sizes, loads, signs, starts and ends.

Each kind is a function of a generator of random numbers that gives a scene; `scene_of(seed)` takes them in turn.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from pliant.envs import scenes
from pliant.envs.scenes.scene import Scene
from pliant.plants import Beam, FlexibleSpacecraft, Material, Payload, TwoLinkArm
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.hub import Hub

BENT = 0.2  # of the length, at most, by the peak load as if it stood still
_ALUMINIUM = Material(density=2700.0, E=70e9, G=26e9)


def _strip(rng: Any, L: float, EI: float, damping: float) -> Beam:
    """A flat strip of density 1000 to 8000 kg/m^3, 1/40 to 1/300 of its length deep, of this bending stiffness."""
    depth = L / 10 ** rng.uniform(1.6, 2.5)
    width = depth * 10 ** rng.uniform(-0.3, 1.3)
    E = 12 * EI / (width * depth**3)
    beam = Beam(
        length=L,
        area=width * depth,
        I_z=width * depth**3 / 12,
        I_y=depth * width**3 / 12,
        J=width * depth**3 / 3,
        density=10 ** rng.uniform(3.0, 3.9),
        E=E,
        G=E / 2.6,
    )
    ratio = rng.choice([0.0, 10 ** rng.uniform(-3.0, -0.7)])
    return dataclasses.replace(beam, damping=float(damping * ratio * 2 / slowest(beam)))


def slowest(beam: Beam, tip: float = 0.0) -> float:
    """First frequency [rad/s], clamped, with a mass [kg] at the tip: by the static shape's energies."""
    return float(np.sqrt(3 * beam.E * beam.I_z / ((tip + 0.2357 * beam.mass) * beam.length**3)))


def _stiff_enough(mass: float, L: float, push: float, rng: Any) -> float:
    """E I [N m^2] with which a load m `push` at the tip bends by 0.002 to BENT of the length."""
    return mass * max(push, 1e-3) * L**2 / (3 * BENT * 10 ** rng.uniform(-2.0, 0.0))


def _tolerance(rng: Any, size: float) -> float:
    return float(size * 10 ** rng.uniform(-4.7, -1.7))


def link(rng: Any) -> Scene:
    own = scenes.get("single-link-slew")
    L = 10 ** rng.uniform(-1.3, 1.6)
    line = 10 ** rng.uniform(-1.0, 0.5) * L**2  # [kg/m]
    load = line * L * 10 ** rng.uniform(-1.5, 1.0)
    g = rng.choice([0.0, 9.81, -9.81, 1.62])
    turn, time_ = rng.uniform(0.2, 3.0) * rng.choice([-1, 1]), 10 ** rng.uniform(-0.5, 0.5) * np.sqrt(L) * 2
    push = 5.77 * abs(turn) * L / time_**2 + abs(g)
    beam = _strip(rng, L, _stiff_enough(load + line * L / 4, L, push, rng), 1.0)
    beam = dataclasses.replace(beam, density=line / beam.area)
    offset = (L * rng.uniform(-0.03, 0.08), 0.0, 0.0) if rng.uniform() < 0.4 else (0.0, 0.0, 0.0)
    plant = dataclasses.replace(
        own.plant,
        link=beam,
        payload=Payload(mass=load, inertia=load * (L * rng.uniform(0.0, 0.1)) ** 2, offset=offset),
        gravity=float(g),
        hub_inertia=float((load + line * L / 3) * L**2 * 10 ** rng.uniform(-2.0, 1.5)),
        hub_radius=float(L * rng.choice([0.0, rng.uniform(0.0, 0.3)])),
        hub_friction=0.0,
        kinematics=rng.choice(["linear", "stiffened", "strain"]).item(),
        modes=int(rng.integers(1, 4)),
    )
    begin = rng.uniform(-np.pi, np.pi)
    duration = time_ * rng.uniform(0.6, 1.8)
    compare = ("tip_x", "tip_y") if rng.uniform() < 0.7 else ("tip_deflection",)
    return dataclasses.replace(
        own,
        plant=plant,
        start=(("hub_angle", begin),),
        goal=(("hub_angle", begin + turn),),
        move_time=time_,
        duration=duration,
        dt=duration / int(rng.integers(60, 240)),
        compare=compare,
        tolerance=_tolerance(rng, L),
    )


@dataclasses.dataclass(frozen=True)
class UpAndDown:
    """Hub acceleration that is a sine: up to a speed and down again."""

    speed: float
    time: float

    def __call__(self, plant: Any, t: float) -> np.ndarray:
        return np.array([self.speed * np.pi / self.time * np.sin(2 * np.pi * t / self.time)])


def spun(rng: Any) -> Scene:
    own = scenes.get("spin-up")
    L = 10 ** rng.uniform(-1.0, 1.5)
    beam = _strip(rng, L, L**4, 1.0)
    slow = slowest(beam)
    speed, time_ = slow * rng.uniform(0.2, 2.5) * rng.choice([-1, 1]), 2 * np.pi / slow * rng.uniform(2.0, 8.0)
    while 2 * np.pi * abs(speed) / time_ * beam.mass * L**3 * L * 0.1 / (beam.E * beam.I_z) > BENT * L:
        time_ *= 1.3
    load = beam.mass * rng.choice([0.0, rng.uniform(0.0, 1.0)])
    plant = dataclasses.replace(
        own.plant,
        link=beam,
        payload=Payload(mass=load),
        hub_radius=float(L * rng.choice([0.0, rng.uniform(0.05, 0.5)])),
        basis="payload",
        modes=int(rng.integers(1, 4)),
    )
    duration = time_ * rng.uniform(0.7, 1.3)
    changes: dict[str, Any] = {"plant": plant, "drive": UpAndDown(speed, time_), "move_time": time_}
    return dataclasses.replace(
        own, duration=duration, dt=duration / 180, tolerance=_tolerance(rng, L), goal=own.goal, **changes
    )


def reach(rng: Any) -> Scene:
    own = scenes.get("two-link-reach")
    L = 10 ** rng.uniform(-1.0, 1.0, 1)[0] * np.array([1.0, 10 ** rng.uniform(-0.5, 0.4)])
    g, load = rng.choice([0.0, 9.81, -9.81]), float(10 ** rng.uniform(-1.5, 0.5) * L.sum() ** 2)
    joint, turn = load * 10 ** rng.uniform(-1.5, 0.7), rng.uniform(-1.5, 1.5, 2)
    time_ = 10 ** rng.uniform(-0.2, 0.6) * np.sqrt(L.sum()) * 2
    push = 5.77 * np.abs(turn).sum() * L.sum() / time_**2 + abs(g)
    links = []
    for k in (0, 1):
        mass = load * 2 + joint * (1 - k)
        made = _strip(rng, L[k], _stiff_enough(mass, L[k], push, rng), 1.0)
        links.append(dataclasses.replace(made, density=load * rng.uniform(0.05, 1.0) / (made.area * L[k])))
    plant: TwoLinkArm = dataclasses.replace(
        own.plant,
        link1=links[0],
        link2=links[1],
        payload=Payload(mass=load, inertia=float(load * (L[1] * rng.uniform(0, 0.1)) ** 2)),
        joint_mass=float(joint),
        gravity=float(g),
        hub_inertia=tuple(float(v) for v in load * L.sum() ** 2 * 10 ** rng.uniform(-2.5, 0.0, 2)),
        kinematics=rng.choice(["linear", "stiffened"]).item(),
        basis=rng.choice(["payload", "clamped-free", "polynomial"]).item(),
        modes=tuple(int(n) for n in rng.integers(1, 4, 2)),
    )
    begin = rng.uniform(-np.pi, np.pi, 2)
    ends = [tuple(zip(("theta1", "theta2"), (float(a) for a in at))) for at in (begin, begin + turn)]
    duration = time_ * rng.uniform(0.6, 1.5)
    return dataclasses.replace(
        own,
        plant=plant,
        start=ends[0],
        goal=ends[1],
        move_time=float(time_),
        duration=float(duration),
        dt=float(duration / 120),
        tolerance=_tolerance(rng, L.sum()),
    )


def drop(rng: Any) -> Scene:
    own = scenes.get("cantilever-drop")
    L, g = 10 ** rng.uniform(-1.3, 1.6), 9.81 * rng.choice([-1.0, 1.0])
    made = _strip(rng, L, 1.0, 1.0)
    heavy = 10 ** rng.uniform(-1.0, 0.5)  # weight L^2 / (E I)
    made = dataclasses.replace(made, E=made.mass * abs(g) * L**2 / (heavy * made.I_z))
    made = dataclasses.replace(made, G=made.E / 2.6, damping=float(rng.choice([0.0, 0.02, 0.2]) / slowest(made)))
    root = rng.choice(["clamped", "clamped", "hinged"]).item()
    plant = dataclasses.replace(
        own.plant,
        beam=made,
        gravity=(float(g * rng.choice([0.0, 0.5])), -float(g), 0.0),
        payload=Payload(mass=float(made.mass * rng.choice([0.0, rng.uniform(0.1, 2.0)]))),
        root=root,
        modes=int(rng.integers(2, 5)),
        basis="auto",
    )
    duration = 2 * np.pi / slowest(made) * rng.uniform(0.3, 0.8)
    return dataclasses.replace(
        own, plant=plant, duration=duration, dt=duration / 80, tolerance=_tolerance(rng, L), goal=()
    )


@dataclasses.dataclass(frozen=True)
class Kick:
    """A torque about each hub axis for a part of the time."""

    torque: tuple[float, float, float]
    until: float

    def __call__(self, plant: Any, t: float) -> np.ndarray:
        return np.array(self.torque) * np.sin(2 * np.pi * t / self.until) if t < self.until else np.zeros(3)


def booms(rng: Any) -> Scene:
    own = scenes.get("spacecraft-slew")
    mass, L = 10 ** rng.uniform(1.0, 3.0), 10 ** rng.uniform(0.3, 1.5)
    size = (mass / 200) ** (1 / 3) / 2
    made = _strip(rng, L, mass * L, 0.0)
    made = dataclasses.replace(made, density=mass * rng.uniform(0.005, 0.1) / (made.area * L))
    count, bodies = int(rng.integers(1, 4)), []
    for k in range(count):
        c, s = np.cos(2 * np.pi * k / count), np.sin(2 * np.pi * k / count)
        turned = ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))
        place = (size * c, size * s, 0.0)
        bodies.append(
            Appendage(position=place, orientation=turned, body=made, modes=(1, 1), damping=rng.choice([0, 0.01]))
        )
    inertia = mass * size**2 * 0.7
    hub = Hub(mass=mass, inertia=tuple(inertia * rng.uniform(0.8, 1.1, 3)))
    first = 2 * np.pi / slowest(made)
    until = first * rng.uniform(0.7, 4.0)
    whole = inertia + count * made.mass * L**2 / 3
    torque = tuple(float(v) for v in whole * rng.uniform(-0.3, 0.3, 3) * 2 * np.pi / until**2)
    plant = FlexibleSpacecraft(
        hub=hub,
        appendages=tuple(bodies),
        kinematics=rng.choice(["linear", "stiffened"]).item(),
        translation=bool(rng.integers(2)),
    )
    level = (("quaternion_0", 1.0),)
    return dataclasses.replace(
        own,
        plant=plant,
        start=level,
        goal=level,
        goal_at_rest=False,
        drive=Kick(torque, until),
        duration=1.3 * until,
        dt=1.3 * until / 150,
        limits=(1e6,) * 3,
        weights=(("body_rate_x", 1.0),),
        observe=("body_rate_x",),
        bounds=(),
        randomise=(),
        compare=("tip1_y", "tip1_z"),
        tolerance=_tolerance(rng, L) / 3,
    )


def crank(rng: Any) -> Scene:
    own = scenes.get("slider-crank-run", rpm=float(10 ** rng.uniform(1.8, 3.1)))
    speed = own.start[0][1]
    rod = Beam.rectangular(0.28, width=0.01, depth=10 ** rng.uniform(-2.8, -2.2), material=_ALUMINIUM)
    first = (np.pi / rod.length) ** 2 * np.sqrt(rod.E * rod.I_z / rod.linear_density)
    rod = dataclasses.replace(rod, damping=float(2 * rng.choice([0.001, 0.02, 0.2]) / first))
    mass, duration = 10 ** rng.uniform(-1.5, 0.3), 2 * np.pi / speed * rng.uniform(0.7, 1.6)
    plant = dataclasses.replace(own.plant, rod=rod, slider_mass=mass, crank_radius=rng.uniform(0.02, 0.09))
    own = dataclasses.replace(own, plant=plant, duration=duration, dt=duration / 150)
    bent = speed**2 * 0.05 * (mass * 0.3 + rod.mass) * rod.length**3 / (48 * rod.E * rod.I_z)
    return dataclasses.replace(own, tolerance=float(bent * 10 ** rng.uniform(-4.0, -1.0)))


KINDS = (link, spun, reach, drop, booms, crank)


def scene_of(seed: int) -> Scene:
    """The machine of this number, its kind by `seed` modulo six."""
    return KINDS[seed % len(KINDS)](np.random.default_rng([99, seed]))
