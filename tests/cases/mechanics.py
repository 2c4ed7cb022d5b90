"""What mechanics asks of a plant at a point.

Each check gives the share of what rounding and truncation allow, at most 1 where it holds, or None where it asks
nothing or the derivative is not known to LOOSE.

Derivatives are Richardson's of central differences; what they miss is derived from their last two columns (truncation)
and from the condition of the mass matrix (rounding).
"""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from random_plants import Drawn, dimension, rescaled, undamped
from scipy.spatial.transform import Rotation

from pliant.plants import LargeDeflectionBeam
from pliant.plants.core import parameters

EPS = np.finfo(float).eps
LOOSE = 1e-4
UNVARIED = ("gravity", "hub_friction", "joint_mass", "slider_mass", "force", "crank_inertia", "crank_friction")


def derivative(f: Any, h: float, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """(df/ds at 0, what it may be off by) of an array function of a number, which is rounded by `noise`."""
    first = [(f(s) - f(-s)) / (2 * s) for s in (h, h / 2, h / 4)]
    second = [(4 * b - a) / 3 for a, b in pairwise(first)]
    best = (16 * second[1] - second[0]) / 15
    return best, 2 * np.abs(best - second[1]) + 8 * noise / h


class Case:
    """A plant at a point, everything in the plant's own units."""

    def __init__(self, drawn: Drawn, rng: np.random.Generator) -> None:
        self.drawn, self.plant = drawn, drawn.plant
        self.x, (self.u, self.w) = drawn.state(rng), drawn.inputs(rng)
        self.t = 0.3 * drawn.unit[2]
        sizes = drawn.sizes
        self.sx, self.su, self.sw, self.sy = (
            sizes(s) for s in (self.plant.states, self.plant.inputs, self.plant.disturbances, self.plant.outputs)
        )
        self.sdx = self.sx / drawn.unit[2]
        self.energy = np.prod(drawn.unit ** dimension("J"))
        self.M = self.plant.mass_matrix(self.x)
        root = np.sqrt(np.abs(np.diag(self.M)))
        self.even = self.M / np.outer(root, root)
        self.condition = float(np.linalg.cond(self.even))
        self.dx = self.dynamics(self.x, self.u, self.w)

    def dynamics(self, x: Any, u: Any, w: Any, plant: Any = None) -> np.ndarray:
        return (plant or self.plant).dynamics(x, u, w=w, t=self.t)


def definite(c: Case, rng: Any) -> float:
    least = np.linalg.eigvalsh((c.even + c.even.T) / 2).min()
    return max(float(np.abs(c.even - c.even.T).max() / (100 * EPS * c.condition)), 2.0 if least <= 0 else 0.0)


def energy(c: Case, rng: Any) -> float | None:
    if not hasattr(c.plant, "kinetic"):
        return None
    v = c.x[len(c.x) // 2 :]
    parts = np.abs(v) @ np.abs(c.M) @ np.abs(v)
    return float(abs(c.plant.kinetic(c.x) - v @ c.M @ v / 2) / (1000 * EPS * parts + 1e-300))


def power(c: Case, rng: Any) -> float | None:
    if c.drawn.family == "craft" and c.plant.environment.orbit is not None:
        return None  # what turning axes put in is what the rate of the energy leaves
    put_in, lost = c.plant.power(c.x, c.u, w=c.w, t=c.t)
    if lost < 0:
        return np.inf
    step = 1e-3 / max(1e-9, float(np.abs(c.dx / c.sx).max()))
    heights = abs(c.plant.energy(c.x)) + c.energy  # elastic and kinetic energies cancel in neither
    rate, off = derivative(lambda s: np.array([c.plant.energy(c.x + s * c.dx)]), step, 8 * EPS * heights)
    size = abs(put_in) + abs(lost) + heights / c.drawn.unit[2]
    off = off[0] + 100 * EPS * c.condition * size
    return None if off > LOOSE * size else float(abs(put_in - lost - rate[0]) / off)


def idle(c: Case, rng: Any) -> float | None:
    """Nothing is put into a free spacecraft whose inputs are zero: what dampers and bearings lose is not among it."""
    plant = c.plant
    if c.drawn.family != "craft" or plant.environment != type(plant.environment)():
        return None
    if any(a.hinge.drive not in ("free", "torque") for a in plant.appendages):
        return None  # a spring whose rest angle is commanded holds energy of its own
    put_in, lost = plant.power(c.x, np.zeros(plant.nu), w=np.zeros(plant.nw))
    size = lost + (abs(plant.energy(c.x)) + c.energy) / c.drawn.unit[2]
    return float(abs(put_in) / (1000 * EPS * c.condition * size))


def jacobians(c: Case, rng: Any) -> float | None:
    blocks = c.plant.jacobians(c.x, c.u, w=c.w, t=c.t)
    worst, counted = 0.0, False
    for _ in range(3):
        a, b, e = (s * rng.uniform(-1, 1, len(s)) for s in (c.sx * np.where(c.x == 0, 1e-3, 1), c.su, c.sw))
        a *= np.minimum(1.0, np.abs(c.x) / c.sx + 1e-3)  # small where the state is
        for (X, U, W), f, scale in (
            (blocks[:3], c.dynamics, c.sdx),
            (blocks[3:], lambda x, u, w: c.plant.measure(x, u, w=w, t=c.t), c.sy),
        ):
            said = (X @ a + U @ b + W @ e) / scale

            def along(s: float, f: Any = f, scale: Any = scale, a: Any = a, b: Any = b, e: Any = e) -> np.ndarray:
                return f(c.x + s * a, c.u + s * b, c.w + s * e) / scale

            size = max(float(np.abs(along(0.0)).max(initial=0.0)), float(np.abs(said).max(initial=0.0)))
            found, off = derivative(along, 0.02, 10 * EPS * c.condition * size)
            off = off + 100 * EPS * c.condition * size
            if size and off.max() < LOOSE * size:
                counted, worst = True, max(worst, float(np.max(np.abs(said - found) / off)))
    return worst if counted else None


def scale(c: Case, rng: Any) -> float | None:
    by = 10 ** rng.uniform(-3, 3, 3)
    other = rescaled(c.plant, by)
    sx, su, sw, sy = (
        np.array([np.prod(by ** dimension(s.unit)) for s in group])
        for group in (c.plant.states, c.plant.inputs, c.plant.disturbances, c.plant.outputs)
    )
    x, u, w = c.x * sx, c.u * su, c.w * sw
    there = other.dynamics(x, u, w=w, t=c.t * by[2]) * by[2] / sx
    size = np.abs(c.dx / c.sdx).max()
    worst = np.abs((there - c.dx) / c.sdx).max() / (1000 * EPS * c.condition * size)
    y, seen = c.plant.measure(c.x, c.u, w=c.w, t=c.t), other.measure(x, u, w=w, t=c.t * by[2]) / sy
    size = np.abs(y / c.sy).max() + size
    return max(float(worst), float(np.abs((seen - y) / c.sy).max() / (1000 * EPS * c.condition * size)))


def mirrored(c: Case) -> Any:
    """The planar plant with y turned about, or None."""
    plant, family = c.plant, c.drawn.family
    if family == "large" and plant.planar:
        g = plant.gravity
        plant = replace(plant, gravity=(g[0], -g[1], g[2]))
    elif family in ("one", "two"):
        plant = replace(plant, gravity=-plant.gravity)
    else:
        return None
    load = plant.payload
    return replace(plant, payload=replace(load, offset=(load.offset[0], -load.offset[1], load.offset[2])))


def mirror(c: Case, rng: Any) -> float | None:
    other = mirrored(c)
    if other is None:
        return None
    signs = [
        np.array([1.0 if s.name.endswith("force_x") else -1.0 for s in g])
        for g in (c.plant.inputs, c.plant.disturbances)
    ]
    there = c.dynamics(-c.x, signs[0] * c.u, signs[1] * c.w, other)
    size = np.abs(c.dx / c.sdx).max()
    return float(np.abs((there + c.dx) / c.sdx).max() / (1000 * EPS * c.condition * size))


def reversal(c: Case, rng: Any) -> float | None:
    if getattr(c.plant, "crank_speed", None) is not None:
        return None
    plant = undamped(c.plant)
    n = len(c.M)
    if c.drawn.family == "craft":
        if c.plant.environment.orbit is not None:
            return None  # turning axes tell the way of time
        first = c.plant.layout.velocity.start if c.plant.translation else c.plant.layout.omega.start
    else:
        first = c.plant.nx - n
    back = np.where(np.arange(c.plant.nx) < first, c.x, -c.x)
    one, other = c.dynamics(c.x, c.u, c.w, plant), c.dynamics(back, c.u, c.w, plant)
    size = np.abs(one / c.sdx).max()
    apart = np.concatenate([one[:first] + other[:first], one[first:] - other[first:]]) / c.sdx
    return float(np.abs(apart).max() / (1000 * EPS * c.condition * size))


def momentum(c: Case, rng: Any) -> float | None:
    plant = c.plant
    if c.drawn.family != "craft" or not plant.translation or plant.environment != type(plant.environment)():
        return None
    u, w = c.u.copy(), np.zeros(plant.nw)
    at, hub = plant.layout, plant.hub
    R = Rotation.from_quat(c.x[at.quaternion], scalar_first=True).as_matrix()
    force, turn = np.zeros(3), np.zeros(3)
    if not hub.wheels and not hub.thrusters:
        turn = R @ u[at.hub_inputs]
    own = u[at.hub_inputs][len(hub.wheels) :]
    for thruster, push in zip(hub.thrusters, own):
        F = R @ (push * np.array(thruster.direction))
        force = force + F
        turn = turn + np.cross(c.x[at.position] + R @ np.array(thruster.position), F)
    dx = c.dynamics(c.x, u, w)
    step = 1e-3 / max(1e-9, float(np.abs(dx / c.sx).max()))
    both = lambda s: np.concatenate(plant.momentum(c.x + s * dx))  # noqa: E731
    unit = np.repeat([np.prod(c.drawn.unit ** dimension(k)) for k in ("N s", "N m s")], 3)
    size = np.abs(both(0.0) / unit).max() + 1
    rate, off = derivative(lambda s: both(s) / unit, step, 10 * EPS * size)
    moved = np.abs(dx / c.sdx).max() * np.abs(c.M).max() / (c.drawn.unit[1] * min(1, c.drawn.unit[0]) ** 2)
    off = off + 1000 * EPS * c.condition * moved / c.drawn.unit[2]
    return float(np.max(np.abs(rate - np.concatenate([force, turn]) / unit) / off))


def rates(c: Case, rng: Any) -> float | None:
    C, y = c.plant.jacobians(c.x, t=c.t)[3], c.plant.measure(c.x, t=c.t)
    row = {s.name: k for k, s in enumerate(c.plant.outputs)}
    dx, worst = c.plant.dynamics(c.x, t=c.t), None
    if getattr(c.plant, "crank_speed", None) is not None:
        return None  # its outputs depend on time
    for name, rate in c.plant.output_rates.items():
        size = np.abs(C[row[name]]) @ np.abs(dx) + abs(y[row[rate]]) + 1e-300
        worst = max(worst or 0.0, float(abs(C[row[name]] @ dx - y[row[rate]]) / (1000 * EPS * size)))
    return worst


def vary(c: Case, rng: Any) -> float | None:
    paths = [p for p in UNVARIED if hasattr(c.plant, p) and np.isscalar(getattr(c.plant, p)) and getattr(c.plant, p)]
    shaped = getattr(c.plant, "frame", "clamped") != "clamped" or getattr(c.plant, "axial_modes", 0)
    if getattr(c.plant, "basis", "") == "payload" or not paths or shaped:
        return None  # the shapes of a varied plant are those of its nominal numbers
    path = str(rng.choice(paths))
    value = parameters.get(c.plant, path) * rng.uniform(0.5, 1.5)
    rebuilt = c.dynamics(c.x, c.u, c.w, parameters.put(c.plant, path, value))
    there = c.plant.vary(path).dynamics(c.x, c.u, w=c.w, t=c.t, p=[value])
    size = np.abs(rebuilt / c.sdx).max()
    return float(np.abs((there - rebuilt) / c.sdx).max() / (1000 * EPS * c.condition * size))


def turned_about_z(v: np.ndarray, angle: float) -> np.ndarray:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], *v[2:]])


def rotation(c: Case, rng: Any) -> float | None:
    """All that is given in the world's axes turned with the plant: the accelerations stay."""
    plant, x, u, w, angle = c.plant, c.x.copy(), c.u.copy(), c.w.copy(), float(rng.uniform(-3, 3))
    if c.drawn.family == "craft":
        if plant.environment != type(plant.environment)():
            return None
        at, q, half = plant.layout, c.x[plant.layout.quaternion], angle / 2
        cos, sin = np.cos(half), np.sin(half)  # (cos, 0, 0, sin) times q
        x[at.quaternion] = [
            cos * q[0] - sin * q[3], cos * q[1] - sin * q[2], cos * q[2] + sin * q[1], cos * q[3] + sin * q[0],
        ]  # fmt: skip
        same = np.arange(at.omega.start, plant.nx)
        if plant.translation:
            x[at.position], x[at.velocity] = (turned_about_z(c.x[k], angle) for k in (at.position, at.velocity))
        w = np.zeros(plant.nw)
    elif c.drawn.family in ("one", "two") and not plant.gravity:
        x[0] += angle
        w, same = turned_about_z(c.w, angle), np.arange(plant.nx)
    elif c.drawn.family == "large" and plant.root != "clamped":
        x[0] += angle
        plant = replace(plant, gravity=tuple(float(v) for v in turned_about_z(np.array(plant.gravity), angle)))
        for values, signals in ((u, plant.inputs), (w, plant.disturbances)):
            if forces := [k for k, s in enumerate(signals) if s.name.startswith("tip_force")]:
                values[forces] = turned_about_z(values[forces], angle)
        same = np.arange(plant.nx)
    else:
        return None
    one, other = c.dynamics(c.x, c.u, w if c.drawn.family == "craft" else c.w), c.dynamics(x, u, w, plant)
    size = np.abs(one / c.sdx).max()
    return float(np.abs((one - other) / c.sdx)[same].max() / (1000 * EPS * c.condition * size))


def bases(c: Case, rng: Any) -> float | None:
    """The clamped link's lowest frequency is the same in every basis, and that of the beam of large deflections.

    Ritz frequencies fall with the number of shapes n; where their error falls at least as 1/n, it is at most twice the
    last change from two thirds of n. The beam's sections have rotary inertia, which takes I/(2 A) times the mean of the
    squared slopes over that of the squares: of a bare cantilever's first mode 4.65/L^2 (Blevins 1979), of a loaded one
    less.
    """
    arm = c.plant
    if c.drawn.family != "one" or arm.theory != "euler-bernoulli" or arm.frame != "clamped":
        return None
    arm = replace(arm, gravity=0.0, kinematics="linear", drive="torque", hub_radius=0.0)
    beam = LargeDeflectionBeam(beam=arm.link, payload=arm.payload, gravity=(0.0, 0.0, 0.0))
    found = []
    plain = not any(arm.payload.offset) and not arm.payload.inertia_z  # a moment at the tip bends no clamped-free shape
    for basis in ("payload", "clamped-free", "polynomial")[:: 1 if plain else 2]:
        made = [replace(arm, basis=basis, modes=n) for n in (4, 6)]
        found.append([m.natural_frequencies(locked=("hub_angle",))[0] for m in made])
    made = [replace(beam, modes=n) for n in (4, 6)]
    found.append([m.natural_frequencies()[0] for m in made])
    rotary = 1.1 * 4.65 / 2 * arm.link.I_z / arm.link.area / arm.link.length**2
    own = [2 * abs(a - b) + 1e-8 * b for a, b in found]
    own[-1] += rotary * found[-1][1]
    apart = [abs(a[1] - b[1]) for a in found for b in found]
    allowed = [a + b for a in own for b in own]
    return float(max(a / b for a, b in zip(apart, allowed)))
