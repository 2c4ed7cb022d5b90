"""Commented starts of one's own: a plant with its scene, a scene that changes another."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

from pliant.envs.scenes import registry
from pliant.plants.core.argument_gates import shown
from pliant.plants.dynamics.plant import Plant
from pliant.plants.files import toml_text
from pliant.plants.tables import machine_files, plant_types

from . import plant_scene
from .scene_tables import to_tables

PLANT = '''"""A crane: a trolley on a rail, and a load that hangs from it on a stiff rope. Change it into your machine.

    pliant --with @file@.py check @Type@               what is wrong with it, in words
    pliant --with @file@.py report @name@.toml         everything about its scene in one folder
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant import plants
from pliant.plants import LagrangianPlant, Signal
from pliant.plants.core.parameters import quantity, validate


@plants.register  # scene files name it: type = "@Type@"
@dataclass(frozen=True, kw_only=True)
class @Type@(LagrangianPlant):
    """Equations of motion from energies: d/dt(dT/dv) - dT/dq + dV/dq + dD/dv = Q, q the coordinates, v = dq/dt."""

    trolley: float = quantity("kg", "positive", 20.0)  # unit, range, default; `pliant --set trolley=25`
    load: float = quantity("kg", "positive", 5.0, uncertain=True)  # robustness studies vary it
    rope: float = quantity("m", "positive", 3.0)
    rail_friction: float = quantity("N s/m", "nonnegative", 2.0)
    air_friction: float = quantity("N m s/rad", "nonnegative", 0.5)

    def __post_init__(self):
        validate(self)

    coordinates = property(lambda self: (Signal("trolley_x", "m"), Signal("sway", "rad")))  # and "trolley_x_rate", ..
    inputs = property(lambda self: (Signal("force", "N"),))
    disturbances = property(lambda self: (Signal("wind", "N"),))
    outputs = property(lambda self: (Signal("load_x", "m"), Signal("load_y", "m")))
    label = property(lambda self: "stiff rope")  # the fidelity in a few words

    def place(self, q):
        """Where the load is [m]: symbols in, symbols out, so cos and sin are CasADi's."""
        return ca.vertcat(q[0] + self.rope * ca.sin(q[1]), -self.rope * ca.cos(q[1]))

    def kinetic_energy(self, q, v):
        return 0.5 * self.trolley * v[0] ** 2 + 0.5 * self.load * ca.sumsqr(ca.jtimes(self.place(q), q, v))

    def potential_energy(self, q):
        return self.load * 9.81 * self.place(q)[1]

    def dissipation(self, q, v):
        return 0.5 * self.rail_friction * v[0] ** 2 + 0.5 * self.air_friction * v[1] ** 2  # half the power lost

    def generalized_force(self, t, q, v, u, w):
        return ca.vertcat(u[0] + w[0], self.rope * ca.cos(q[1]) * w[0])  # one for each coordinate

    def output(self, t, x, u, w):
        return self.place(x)

    def outline(self, x, points=30):
        """Lines (links, points, 2) [m] for pictures, root first."""
        end = [x[0] + self.rope * np.sin(x[1]), -self.rope * np.cos(x[1])]
        return np.linspace([x[0], 0.0], end, points)[None]
'''
PLANT_SCENE = """# A scene: what is to be done with a machine. Every command takes this file in place of a scene's name.
# What a key means, and what may stand in it: docs/own_scene.md

name = "@name@"  # words of a-z and 0-9 joined by "-"
about = "move a load by two metres, rest to rest"
duration = 8.0  # [s]
dt = 0.05  # [s], the control period
move_time = 5.0  # [s], of the nominal motion from start to goal
observe = ["trolley_x", "trolley_x_rate", "sway", "sway_rate"]  # what an environment and a controller see
compare = ["load_x", "load_y"]  # outputs whose error tells models apart ..
tolerance = 1e-3  # .. and how large it may be, in their unit
start_spread = 0.1  # of each coordinate of `start` where episodes are randomised

[plant]
type = "@Type@"
load = 5.0

[limits]  # largest |input|, for each
force = 100.0

[start]  # coordinates of a rest; joints that are not named are at 0, what no input drives (sway) is in equilibrium
trolley_x = 0.0

[goal]
trolley_x = 2.0

[weights]  # cost: dt times weight times (signal - its value at the goal)^2, summed
load_x = 10.0
sway = 1.0

[effort]  # the same of inputs
force = 1e-4

[bounds]  # beyond, an episode ends
sway = 1.0

[randomise]  # parameters of the plant, least and greatest factor
load = [0.7, 1.3]
"""


def plant_start(name: str) -> dict[str, str]:
    """{file: text} of a plant called `name` ("crane", "two-mass") and its scene. ValueError for a bad name."""
    registry.require_name("new plant: NAME", name)
    words = {"file": name.replace("-", "_"), "name": name, "Type": "".join(w.capitalize() for w in name.split("-"))}
    filled = [re.sub(r"@(\w+)@", lambda found: words[found[1]], text) for text in (PLANT, PLANT_SCENE)]
    return {f"{words['file']}.py": filled[0], f"{name}.toml": filled[1]}


def scene_start(name: str, base: str = "two-link-reach") -> dict[str, str]:
    """{file: text} of a scene that changes `base`, all that the base says in comments. ValueError for bad names.

    base: a scene's name; a scene's file, which is written anew; or what a first scene is made of: a type of plants, a
    robot's URDF file, or a machine's TOML file as `FlexibleTree.to_toml` writes it.
    """
    registry.require_name("new scene: NAME", name)
    if machine_files.is_machine(base):
        return {f"{name}.toml": plant_scene.written(plant_scene.first_scene(name, machine_files.read(base)))}
    if registry.is_file(base):
        copied = dataclasses.replace(registry.get(base), name=name)
        return {f"{name}.toml": toml_text.dumps(to_tables(copied), f"{name}: as {base} was")}
    if base in plant_types.names():
        return {f"{name}.toml": plant_scene.written(plant_scene.first_scene(name, _made(base)))}
    if base not in registry.names():
        raise ValueError(
            f"new scene: --base {shown(base)} must be one of {', '.join(registry.names())}; or a scene's file, "
            f"a machine's file (.urdf, .toml), or a type of plants, {', '.join(plant_types.names())}"
        )
    scene = registry.get(base)
    units = {s.name: s.unit for s in (*scene.plant.states, *scene.plant.outputs, *scene.plant.inputs)}
    own: dict[str, Any] = {
        key: value for key, value in to_tables(scene).items() if key not in ("name", "about", "motion")
    }
    plant = own.pop("plant")
    lines = [
        "# A scene that changes another. Take the # away from what is to differ; docs/own_scene.md has every key.",
        f'\nname = "{name}"',
        f'about = "{scene.about}"',
        f'base = "{base}"  # all that this file does not say is as there',
    ]
    heading = ""
    for line in toml_text.dumps(own).splitlines():
        heading = line if line.startswith("[") else heading
        unit = units.get(line.split(" = ")[0], "") if " = " in line else ""
        said = f"of its square [({unit})^2]" if heading in ("[weights]", "[effort]") else f"[{unit}]"
        lines.append(f"# {line}" + (f"  # {said}" if unit else "") if line else "")
    lines += ["", "# [parameters]  # of the plant, by dotted names", *_numbers(plant)]
    return {f"{name}.toml": "\n".join(lines) + "\n"}


def _made(kind: str) -> Plant:
    """A plant of this type with its own defaults, or its textbook's."""
    of = plant_types.named("new scene: --base", kind)
    try:
        return getattr(of, "textbook", of)()
    except TypeError as missing:
        raise ValueError(f"new scene: --base {kind} must have a default for every field: {missing}") from None


def _numbers(table: dict[str, Any], path: str = "") -> list[str]:
    """The plant's numbers as commented lines, those of lists of parts and of long lists left out."""
    found = []
    for key, value in table.items():
        if isinstance(value, dict):
            found += _numbers(value, f"{path}{key}.")
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            name = f'"{path}{key}"' if path else key
            found.append(f"# {name} = {value!r}")
    return found
