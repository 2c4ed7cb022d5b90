"""A random scene by its number: what a claim about scenes is tested on, none of them shipped.

Five kinds, in turn: a single link slewed, a beam spun up, two links that reach, a cantilever let go, a spacecraft
turned. E I is drawn over two decades, log-uniformly, and so are damping and the tolerance, 1e-5 to 1e-2 of the reach;
payload (mass, inertia, offset), speed, gravity and the scene's own fields (kinematics, theory, modes) are drawn too.
Where the quasi-static deflection would be more than 0.35 of the length, all but the stiffness is drawn again, with less
payload and more time: nearly all scenes stay in the range of strains in which elastic beams hold.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.envs.machines.spacecraft_parts import DAMPING, LINE, ROOT, UPRIGHT, WIDTH, turned
from pliant.envs.scenes import registry
from pliant.envs.scenes.scene import Scene
from pliant.plants import Beam, Material, Payload, Plant
from pliant.plants.core.argument_gates import require_count
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_parts.appendage import Appendage

Draw = np.random.Generator
MOST_BENT = 0.35  # of the length, as a static load of the peak acceleration would
PERIODS = 150  # of control, in a motion
TOLERANCES = (-5.0, -2.0)  # powers of ten, of the reach


@dataclass(frozen=True)
class Drawn:
    """A scene, its kind in words, and what its modal data were made from."""

    kind: str
    scene: Scene
    line: Beam | None = None  # half a panel


def random_scene(seed: int) -> Drawn:
    """The scene of this number; its kind is `seed` modulo five.

    Example
    -------
    >>> drawn = random_scene(7)
    >>> drawn.kind, drawn.scene.tolerance
    """
    seed = require_count("random_scene", "seed", seed, 0, 2**32 - 1)
    kind, draw = KINDS[seed % len(KINDS)]
    made = draw(np.random.default_rng([13, seed]))
    return Drawn(kind, *made) if isinstance(made, tuple) else Drawn(kind, made)


def _single_link_slew(rng: Draw) -> Scene:
    own = registry.get("single-link-slew")
    EI, damping = _powers(rng, 0.7, 2.7), _powers(rng, -4.5, -3.0)
    for ease in _easier():
        L = rng.uniform(0.5, 1.5)
        link = _strip(rng, L, EI, damping)
        load = _payload(rng, L, rng.uniform(0.0, 2.0) * link.mass / ease)
        angle, time, gravity = rng.uniform(0.3, 2.0), rng.uniform(0.3, 2.0) * ease, rng.choice([0.0, 9.81])
        push = 5.77 * angle / time**2 * L + gravity
        if push * (load.mass / 3 + link.mass / 8) * L**3 / EI <= MOST_BENT * L:
            break
    plant = _with(
        own,
        link=link,
        payload=load,
        gravity=gravity,
        hub_inertia=_powers(rng, -1.5, 0.5),
        hub_friction=rng.choice([0.0, 0.05]),
        theory=rng.choice(["euler-bernoulli", "timoshenko"], p=[0.75, 0.25]).item(),
        kinematics=rng.choice(["linear", "stiffened", "strain"]).item(),
        modes=int(rng.integers(1, 4)),
    )
    return _of(rng, own, plant, L, time, 1.4 * time, goal=(("hub_angle", angle),))


def _spin_up(rng: Draw) -> Scene:
    EI, damping = _powers(rng, 2.5, 4.5), rng.choice([0.0, _powers(rng, -4.0, -2.5)])
    for ease in _easier():
        L = rng.uniform(2.0, 10.0)
        beam = _strip(rng, L, EI, damping, density=rng.uniform(1500.0, 4000.0))
        slowest = 3.516 * np.sqrt(EI / (beam.linear_density * L**4))  # clamped and free, at rest
        speed, time = slowest * rng.uniform(0.3, 2.0), 2 * np.pi / slowest * rng.uniform(1.5, 6.0) * ease
        load = _payload(rng, L, beam.mass * rng.uniform(0.0, 0.3)) if rng.uniform() < 0.4 else Payload()
        push = 2 * speed / time * L
        if push * (load.mass / 3 + beam.mass * 11 / 120) * L**3 / EI <= MOST_BENT * L:
            break
    own = registry.get("spin-up", speed=speed, time=time)
    basis = "payload" if load.mass else "clamped-free"
    plant = _with(own, link=beam, payload=load, modes=int(rng.integers(1, 4)), basis=basis)
    return _of(rng, own, plant, L, time, time + 2 * np.pi / slowest)


def _two_link_reach(rng: Draw) -> Scene:
    own = registry.get("two-link-reach")
    EI, damping = _powers(rng, 1.0, 3.0), _powers(rng, -4.5, -3.0)
    for ease in _easier():
        lengths = rng.uniform(0.4, 1.2, 2)
        links = [_strip(rng, L, EI * share, damping) for L, share in zip(lengths, (1.0, rng.uniform(0.3, 1.0)))]
        load, joint = _payload(rng, lengths[1], rng.uniform(0.1, 1.0) / ease), rng.uniform(0.0, 1.0) / ease
        turn, time, gravity = rng.uniform(-1.2, 1.2, 2), rng.uniform(0.6, 2.5) * ease, rng.choice([0.0, 9.81])
        reach = lengths.sum()
        push = 5.77 * np.abs(turn).sum() / time**2 * reach + gravity
        masses = (load.mass + joint + links[1].mass, load.mass)
        bent = [push * (m / 3 + b.mass / 8) * b.length**2 / (b.E * b.I_z) for m, b in zip(masses, links)]
        if max(bent) <= MOST_BENT:
            break
    plant = _with(
        own,
        link1=links[0],
        link2=links[1],
        payload=load,
        joint_mass=joint,
        gravity=gravity,
        kinematics=rng.choice(["linear", "stiffened"]).item(),
        modes=tuple(int(n) for n in rng.integers(1, 4, 2)),
    )
    start = (-np.pi / 2, 0.0) if gravity else tuple(rng.uniform(-1.5, 1.5, 2))
    goal = tuple((n, a + d) for n, a, d in zip(("theta1", "theta2"), start, turn))
    return _of(rng, own, plant, reach, time, 1.3 * time, start=tuple(zip(("theta1", "theta2"), start)), goal=goal)


def _cantilever_drop(rng: Draw) -> Scene:
    own = registry.get("cantilever-drop")
    L, EI, load = rng.uniform(1.0, 10.0), _powers(rng, 1.0, 3.0), _powers(rng, -1.0, 0.6)
    EI *= (L / 5.0) ** 2
    g = rng.uniform(1.6, 9.81)
    line = load * EI / (g * L**3)  # [kg/m]: weight L^2/(E I) is `load`
    area = _powers(rng, -5.0, -4.0) * L**2 / 5
    I = area * (L / rng.uniform(300.0, 900.0)) ** 2
    beam = Beam(length=L, area=area, I_y=I, I_z=I, J=2 * I, density=line / area, E=EI / I, G=EI / I / 2.6)
    slowest = 3.516 * np.sqrt(EI / (line * L**4))
    beam = dataclasses.replace(beam, damping=_powers(rng, -3.0, -1.3) * 2 / slowest)  # ratio: its half times slowest
    plant = _with(
        own,
        beam=beam,
        gravity=(0.0, -g, 0.0),
        payload=Payload(mass=line * L * rng.uniform(0.05, 0.5)) if rng.uniform() < 0.4 else Payload(),
        basis=rng.choice(["modes", "auto"]).item(),
        modes=int(rng.integers(2, 5)),
    )
    duration = 2 * np.pi / slowest * rng.uniform(0.4, 1.0)
    return _of(rng, own, plant, L, duration, duration)


def _spacecraft_slew(rng: Draw) -> tuple[Scene, Beam]:
    own = registry.get("spacecraft-slew")
    line = dataclasses.replace(LINE, E=LINE.E * _powers(rng, -1.0, 1.0))
    slowest = 3.516 * np.sqrt(line.E * line.I_y / (line.linear_density * line.length**4))
    time, angle = 2 * np.pi / slowest * rng.uniform(1.0, 5.0), rng.uniform(10.0, 90.0)
    panel = ModalData.panel(line, WIDTH, (int(rng.integers(2, 5)), 0))
    bodies = tuple(
        Appendage(
            position=tuple(ROOT * row[0] for row in mount),
            orientation=mount,
            body=panel,
            modes=int(rng.integers(1, 3)),
            damping=DAMPING,
        )
        for mount in UPRIGHT
    )
    kinematics = rng.choice(["linear", "stiffened"]).item()
    plant = _with(own, appendages=bodies, kinematics=kinematics)
    return _of(rng, own, plant, 1.0, time, 1.3 * time, start=turned(-angle, "z")), line


KINDS: tuple[tuple[str, Callable[[Draw], Any]], ...] = (
    ("single-link slew", _single_link_slew),
    ("spin-up", _spin_up),
    ("two-link reach", _two_link_reach),
    ("cantilever drop", _cantilever_drop),
    ("spacecraft slew", _spacecraft_slew),
)


def _with(own: Scene, **changes: Any) -> Plant:
    """The scene's plant with other parts."""
    plant: Any = own.plant
    found: Plant = dataclasses.replace(plant, **changes)
    return found


def _easier() -> Iterator[float]:
    """Factors that grow from draw to draw."""
    return (1.1**k for k in itertools.count())


def _powers(rng: Draw, low: float, high: float) -> float:
    """Log-uniform from 10^low to 10^high."""
    return float(10 ** rng.uniform(low, high))


def _strip(rng: Draw, L: float, EI: float, damping: float, density: float = 2700.0) -> Beam:
    """A strip of this bending stiffness, 1/60 to 1/200 of its length deep and half to twenty times as wide as deep."""
    depth = L / rng.uniform(60.0, 200.0)
    E = rng.uniform(50e9, 210e9)
    width = min(max(12 * EI / (E * depth**3), 0.5 * depth), 20 * depth)
    E = 12 * EI / (width * depth**3)
    material = Material(density=density, E=E, G=E / 2.6, damping=damping)
    return Beam.rectangular(L, width=width, depth=depth, material=material)


def _payload(rng: Draw, L: float, mass: float) -> Payload:
    offset = (L * rng.uniform(0.0, 0.05), 0.0, 0.0) if rng.uniform() < 0.3 else (0.0, 0.0, 0.0)
    return Payload(mass=mass, inertia=mass * (L * rng.uniform(0.01, 0.06)) ** 2, offset=offset)


def _of(rng: Draw, own: Scene, plant: Plant, size: float, move: float, duration: float, **goal: Any) -> Scene:
    """The scene with this plant, cut into control periods, its tolerance drawn."""
    dt = duration / PERIODS
    tolerance = float(10 ** rng.uniform(*TOLERANCES) * size)
    return dataclasses.replace(own, plant=plant, move_time=move, duration=duration, dt=dt, tolerance=tolerance, **goal)
