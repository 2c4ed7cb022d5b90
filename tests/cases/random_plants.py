"""Plants by seed: each field is drawn on its own, half the time at its default, so that every pair of fields is met.

Everything is drawn in the plant's own units (length and mass of a beam of it, time of that beam's first frequency), in
which a state of order one is as large as the plant may be expected to hold.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from pliant.plants import (
    FlexibleSpacecraft,
    LargeDeflectionBeam,
    Material,
    Payload,
    SingleLinkArm,
    SliderCrank,
    TwoLinkArm,
)
from pliant.plants.beams import Beam
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel

BENT = 2e-3  # deflection drawn, of the length; a stage of reduction that is definite near zero alone gets NEAR
NEAR = 1e-6
BASE = {"kg": (0, 1, 0), "m": (1, 0, 0), "s": (0, 0, 1), "rad": (0, 0, 0), "1": (0, 0, 0), "A": (0, 0, 0)}
BASE |= {"N": (1, 1, -2), "J": (2, 1, -2), "W": (2, 1, -3), "Pa": (-1, 1, -2), "T": (0, 1, -2)}


def dimension(unit: str) -> np.ndarray:
    """Exponents of (length, mass, time) of a unit such as "kg m^2" or "N m s/rad"."""
    total = np.zeros(3)
    over, *under = unit.split("/")
    for sign, part in ((1, over), *((-1, each) for each in under)):
        for word in part.split():
            name, power = re.fullmatch(r"([A-Za-z]+|1)(?:\^(\d+))?", word).groups()
            total += sign * int(power or 1) * np.array(BASE[name])
    return total


def rescaled(thing: Any, by: np.ndarray) -> Any:
    """A plant, or part of one, with every quantity in units by (length, mass, time) larger."""
    return with_quantities(thing, lambda name, unit, value: value * float(np.prod(by ** dimension(unit))))


def undamped(thing: Any) -> Any:
    """A plant without damping and friction anywhere."""
    lossy = ("damping", "friction")
    return with_quantities(thing, lambda name, unit, value: 0.0 if name.endswith(lossy) else value)


def with_quantities(thing: Any, rule: Callable[[str, str, float], float]) -> Any:
    """A plant, or part of one, whose physical quantities are what the rule makes of (name, unit, value)."""
    if isinstance(thing, tuple):
        return tuple(with_quantities(each, rule) for each in thing)
    if not is_dataclass(thing):
        return thing

    def new(name: str, unit: str | None, value: Any) -> Any:
        if unit is None or value is None:
            return with_quantities(value, rule)
        return tuple(new(name, unit, v) for v in value) if isinstance(value, tuple) else rule(name, unit, value)

    units = {
        f.name: f.metadata.get("unit", "rad/s" if f.name == "crank_speed" else None) for f in fields(thing) if f.init
    }
    return replace(thing, **{name: new(name, unit, getattr(thing, name)) for name, unit in units.items()})


@dataclass(frozen=True)
class Drawn:
    """A plant, its beam's units of (length, mass, time), and the fields that are not at their defaults."""

    family: str
    plant: Any
    unit: np.ndarray
    changed: tuple[str, ...]

    def sizes(self, signals: Any) -> np.ndarray:
        """The unit of each signal."""
        return np.array([np.prod(self.unit ** dimension(s.unit)) for s in signals])

    def state(self, rng: np.random.Generator) -> np.ndarray:
        plant = self.plant
        near = NEAR if getattr(plant, "reduction", "") == "rigid-inertia" else BENT
        lengths = np.array([s.unit.startswith("m") and not s.name.startswith(("pos", "vel")) for s in plant.states])
        x = np.where(lengths, near, 0.5) * self.sizes(plant.states) * rng.uniform(-1, 1, plant.nx)
        if self.family == "craft":
            q = rng.normal(size=4)
            x[plant.layout.quaternion] = q / np.linalg.norm(q)
            x[plant.layout.wheels] *= 0.01
        return x

    def inputs(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """u (nu,) and w (nw,)."""
        u = 0.1 * self.sizes(self.plant.inputs) * rng.uniform(-1, 1, self.plant.nu)
        return u, 0.1 * self.sizes(self.plant.disturbances) * rng.uniform(-1, 1, self.plant.nw)


def beam(rng: np.random.Generator, damped: bool) -> Beam:
    length, slender = 10 ** rng.uniform(-0.7, 1.3), rng.uniform(0.004, 0.04)
    stuff = Material(density=10 ** rng.uniform(3, 4), E=10 ** rng.uniform(9.5, 11.5), G=10 ** rng.uniform(9.2, 11.0))
    depth = slender * length
    made = (
        Beam.rectangular(length, width=depth * rng.uniform(0.3, 3), depth=depth, material=stuff),
        Beam.circular(length, depth, material=stuff),
        Beam.tube(length, outer=depth, inner=depth * rng.uniform(0.3, 0.9), material=stuff),
    )[rng.integers(3)]
    return replace(made, damping=10 ** rng.uniform(-4, -2) * units_of(made)[2]) if damped else made


def units_of(made: Beam) -> np.ndarray:
    mass = made.density * made.area
    return np.array([made.length, mass * made.length, np.sqrt(mass * made.length**4 / (made.E * made.I_z)) / 3.516])


def payload(rng: np.random.Generator, L: float, m: float, flat: bool) -> Payload:
    mass, inertia = m * 10 ** rng.uniform(-2, 1), 0.0
    if rng.integers(2):
        inertia = mass * L**2 * 10 ** rng.uniform(-5, -2)
    place = L * rng.uniform(-0.1, 0.1, 3) * (rng.integers(2), rng.integers(2), 0 if flat else rng.integers(2))
    if not flat and rng.integers(2):
        turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        main = mass * L**2 * 10 ** rng.uniform(-4, -2) * rng.uniform(1.0, 1.5, 3)
        full = turn @ np.diag(main) @ turn.T
        inertia = tuple(tuple(float(v) for v in row) for row in (full + full.T) / 2)
    return Payload(mass=mass, inertia=inertia, offset=tuple(float(v) for v in place))


def draw(seed: int) -> Drawn:
    """The plant of a seed."""
    rng = np.random.default_rng(seed)
    family = ("one", "two", "large", "crank", "craft")[seed % 5]
    main = beam(rng, bool(rng.integers(2)))
    L, m, t = units_of(main)
    pick = lambda *values: values[rng.integers(len(values))]  # noqa: E731
    log = lambda low, high: float(10 ** rng.uniform(low, high))  # noqa: E731
    torque, spin = m * L**2 / t**2, m * L**2 / t
    if family == "one":
        base = SingleLinkArm(link=main, modes=pick(1, 2, 3))
        ways = {
            "hub_inertia": lambda: m * L**2 * log(-2, 1),
            "hub_radius": lambda: L * rng.uniform(0, 0.5),
            "hub_friction": lambda: spin * log(-3, 0),
            "payload": lambda: payload(rng, L, m, True),
            "gravity": lambda: L / t**2 * rng.uniform(-1, 1),
            "kinematics": lambda: pick("rigid", "linear", "strain"),
            "theory": lambda: "timoshenko",
            "basis": lambda: pick("clamped-free", "polynomial"),
            "frame": lambda: pick("pinned", "pinned-pinned"),
            "drive": lambda: "motion",
        }
    elif family == "two":
        other = beam(rng, bool(rng.integers(2)))
        other = replace(other, length=L * rng.uniform(0.3, 2), E=main.E, area=main.area, density=main.density)
        other = replace(other, I_z=main.I_z * log(-1, 1), I_y=main.I_y)
        base = TwoLinkArm(link1=main, link2=other, gravity=0.0, modes=(pick(0, 1, 2), pick(1, 2)))
        ways = {
            "joint_mass": lambda: m * log(-2, 1),
            "payload": lambda: payload(rng, L, m, True),
            "hub_inertia": lambda: (m * L**2 * log(-3, 0), m * L**2 * log(-3, 0)),
            "joint_friction": lambda: (spin * log(-3, 0), spin * log(-3, 0)),
            "gravity": lambda: L / t**2 * rng.uniform(-1, 1),
            "tip_slope": lambda: False,
            "reduction": lambda: pick("rigid-inertia", "rigid-coupling", "rigid"),
            "kinematics": lambda: pick("stiffened", "strain"),
            "basis": lambda: pick("payload", "polynomial"),
        }
    elif family == "large":
        base = LargeDeflectionBeam(beam=main, gravity=(0.0, 0.0, 0.0), modes=pick(1, 2, 3))
        if rng.integers(2):
            base = replace(base, planar=False, modes=pick(1, 2), twists=pick(0, 1, 2, 3))
        ways = {
            "root": lambda: pick("hinged", "driven"),
            "gravity": lambda: tuple(L / t**2 * rng.uniform(-1, 1, 3)),
            "payload": lambda: payload(rng, L, m, base.planar),
            "basis": lambda: pick("polynomial", "modes"),
            "kinematics": lambda: "substructured",
        }
    elif family == "crank":
        base = SliderCrank(
            crank_radius=L * rng.uniform(0.05, 0.5), rod=main, slider_mass=m * log(-1, 1), modes=pick(1, 2)
        )
        ways = {
            "force": lambda: m * L / t**2 * rng.uniform(-1, 1),
            "crank_speed": lambda: rng.uniform(0.05, 0.5) / t,
            "crank_inertia": lambda: m * L**2 * log(-2, 1),
            "crank_friction": lambda: spin * log(-3, 0),
            "slider_friction": lambda: m / t * log(-3, 0),
            "gravity": lambda: L / t**2 * rng.uniform(-1, 1),
            "kinematics": lambda: pick("rigid", "linear"),
            "basis": lambda: "frame-elements",
            "axial_modes": lambda: 1,
        }
    else:
        base, ways = craft(rng, main, L, m, t, torque)
    chosen = [name for name in ways if rng.integers(2)]
    for taken, barred in (("drive", "frame"), ("basis", "axial_modes")):  # which do not go together
        if {taken, barred} <= set(chosen):
            chosen.remove((taken, barred)[rng.integers(2)])
    drawn = {name: ways[name]() for name in chosen}
    if drawn.get("kinematics") == "strain" and drawn.pop("frame", None):  # refused together
        chosen.remove("frame")
    made = replace(base, **drawn)
    if family == "large" and made.kinematics == "substructured":
        made = replace(made, segments=pick(1, 2, 3), frame=pick("mean-axis", "chord", "tangent"), modes=pick(1, 2))
    return Drawn(family, made, np.array([L, m, t]), tuple(chosen))


def unit_vector(rng: np.random.Generator) -> tuple[float, ...]:
    v = rng.standard_normal(3)
    return tuple(float(k) for k in v / np.linalg.norm(v))


def craft(rng, main: Beam, L: float, m: float, t: float, torque: float) -> tuple[Any, dict]:
    """A hub and up to five appendages of random hinges, bodies, orientations and surfaces."""

    def inertia(size: float) -> tuple:
        turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        full = turn @ np.diag(size * rng.uniform(1.0, 1.6, 3)) @ turn.T
        return tuple(tuple(float(v) for v in row) for row in (full + full.T) / 2)

    def surface(**more: Any) -> Surface:
        specular = rng.uniform(0, 1)
        rest = {"specular": specular, "diffuse": rng.uniform(0, 1 - specular), "both": bool(rng.integers(2))}
        return Surface(area=L**2 * rng.uniform(0, 1), normal=unit_vector(rng), **rest, **more)

    def appendage() -> Appendage:
        n = int(rng.choice([0, 0, 1, 2]))
        first = unit_vector(rng)
        second = np.cross(first, unit_vector(rng))
        axes = (first, tuple(float(v) for v in second / np.linalg.norm(second)))[:n]
        hinge = Hinge(
            axes=axes,
            stiffness=tuple(torque * 10 ** rng.uniform(-2, 0, n)),
            damping=tuple(rng.integers(2) * torque * t * 10 ** rng.uniform(-3, -1, n)),
            drive=str(rng.choice(["free", "torque", "angle"])),
        )
        flat = bool(rng.integers(2))
        body = replace(main, length=L * rng.uniform(0.5, 1.5))
        return Appendage(
            position=tuple(L * rng.uniform(-0.3, 0.3, 3)),
            body=body,
            orientation=tuple(rng.standard_normal(4)),
            modes=int(rng.integers(0, 3)) if flat else (int(rng.integers(0, 2)), int(rng.integers(0, 3))),
            hinge=hinge,
            damping=float(rng.integers(2) * rng.uniform(0, 0.05)),
            surface=surface() if rng.integers(2) else None,
        )

    hub = Hub(mass=m * 10 ** rng.uniform(0, 1.5), inertia=inertia(m * L**2 * 10 ** rng.uniform(0, 1.5)))
    if rng.integers(2):
        wheel = m * L**2 * 10 ** rng.uniform(-3, -2)
        wheels = tuple(
            Wheel(axis=unit_vector(rng), inertia=wheel, friction=float(rng.integers(2)) * 1e-2 * wheel / t)
            for _ in range(rng.integers(1, 5))
        )
        hub = replace(hub, wheels=wheels)
    if rng.integers(2):
        place = tuple(L * rng.uniform(-0.3, 0.3, 3))
        hub = replace(hub, thrusters=(Thruster(position=place, direction=unit_vector(rng)),))
    if rng.integers(2):
        hub = replace(hub, surfaces=(surface(centre=tuple(L * rng.uniform(-0.2, 0.2, 3))),))
    base = FlexibleSpacecraft(hub=hub, appendages=tuple(appendage() for _ in range(rng.integers(0, 6))))

    def environment() -> Environment:
        parts: dict[str, Any] = {}
        if rng.integers(2):
            parts["orbit"] = Orbit(rate=0.01 / t, radius=1e5 * L, gravity=bool(rng.integers(2)))
        if rng.integers(2):
            parts["sun"] = Sun(direction=unit_vector(rng), pressure=1e-3 * m / (L * t**2))
        if rng.integers(2):
            parts["torque"] = tuple(0.01 * torque * rng.uniform(-1, 1, 3))
        if rng.integers(2):
            field = 0.1 * m / t**2
            parts |= {"dipole": tuple(0.1 * L**2 * rng.uniform(-1, 1, 3)), "magnetic_field": (field, 0.0, -field)}
        return Environment(**parts)

    ways = {
        "kinematics": lambda: str(rng.choice(["rigid", "linear"])),
        "translation": lambda: False,
        "environment": environment,
    }
    return base, ways
