"""Machines that are trees, by seed: any parents, joints, welds, stations, springs and beams, every motion damped."""

import dataclasses

import numpy as np

from pliant.plants import FlexibleTree, beams
from pliant.plants.beams.payload import Payload
from pliant.plants.multibody_parts.joint import Joint
from pliant.plants.multibody_parts.tree_body import TreeBody


def random_tree(seed: int, bodies: int = 4) -> FlexibleTree:
    """No joint is driven: each has a spring and a damper; gravity along any direction."""
    rng = np.random.default_rng(seed)
    names, made = ["base"], []
    for k in range(int(rng.integers(1, bodies + 1))):
        axis = rng.normal(size=3)
        kind = ("revolute", "revolute", "prismatic", "fixed")[rng.integers(4)] if k else "revolute"
        joint = Joint(
            name=f"j{k}",
            kind=kind,
            axis=tuple(axis / np.linalg.norm(axis)),
            position=tuple(0.2 * rng.normal(size=3)),
            rotation=tuple(rng.uniform(-2, 2, 3)),
            station=float(rng.choice([0.4, 1.0])),
            turned=bool(rng.integers(2)),
            damping=float(10 ** rng.uniform(-1, 0.5)),
            stiffness=float(10 ** rng.uniform(1.5, 3.0) if kind == "prismatic" else 10 ** rng.uniform(-1.0, 2.0)),
            drive="none",
        )
        beam = None
        if rng.integers(2):
            sides = {"width": rng.uniform(0.02, 0.05), "depth": rng.uniform(0.005, 0.012)}
            beam = beams.Beam.rectangular(rng.uniform(0.4, 0.9), **sides, material=beams.ALUMINIUM)
            beam = dataclasses.replace(beam, damping=float(10 ** rng.uniform(-4, -2.5)))
        modes = tuple(int(n) for n in rng.integers(0, (3, 3, 2, 1)))
        body = {"mass": float(rng.uniform(0.2, 1.0)), "centre": tuple(0.2 * rng.normal(size=3)), "inertia": 0.02}
        made.append(
            TreeBody(name=f"b{k}", joint=joint, parent=names[rng.integers(len(names))], beam=beam, modes=modes, **body)
        )
        names.append(f"b{k}")
    down = rng.normal(size=3)
    return FlexibleTree(
        bodies=tuple(made),
        payload=Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0)),
        tip=names[rng.integers(1, len(names))],
        gravity=tuple(9.81 * down / np.linalg.norm(down)),
        kinematics=("linear", "stiffened")[seed % 2],
    )
