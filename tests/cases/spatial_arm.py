"""The spatial arm with two flexible links that Exudyn played too: its data, and the tree's motion."""

import numpy as np

from pliant.plants import Beam, FlexibleTree, Frame, Joint, Payload, TreeBody, beams

PLASTIC = beams.Material(density=1200.0, E=3.5e9, G=1.3e9)
BEAMS = (
    Beam.rectangular(1.0, width=0.012, depth=0.02, material=PLASTIC),
    Beam.rectangular(0.8, width=0.014, depth=0.01, material=PLASTIC),
)
RPY = ((0.0, 0.0, 0.0), (0.3, 0.0, 0.5))  # how each link stands in the axes of what carries it, its joint at zero
AXES = ((0.0, 0.0, 1.0), (0.0, 0.8, 0.6))  # in those axes
TORQUES = (1.2, -0.2)  # [N m] at the joints, times sin^2(pi t): what starts smoothly excites no fast mode
MASS, INERTIA = 0.05, 1e-5  # of the payload
SECONDS = 1.0
FINEST = (4, 4, 3, 0)


def turn(rpy):
    """R (3, 3) of roll, pitch (zero) and yaw."""
    (cr, _, cy), (sr, _, sy) = np.cos(rpy), np.sin(rpy)
    return np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])


TURNS = tuple(turn(rpy) for rpy in RPY)


def aligned(axis):
    """R (3, 3) whose third column is the axis."""
    axis = np.array(axis)
    first = np.cross([1.0, 0.0, 0.0], axis)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


def torques(t):
    """At both joints [N m]."""
    return np.array(TORQUES) * np.sin(np.pi * t) ** 2


def tree(modes, kinematics="strain"):
    """The arm."""
    bodies = [
        TreeBody(name=f"link{k}", joint=Joint(name=f"j{k}", axis=axis, rotation=rpy), beam=beam, modes=modes)
        for k, axis, rpy, beam in zip((1, 2), AXES, RPY, BEAMS, strict=True)
    ]
    frames = (Frame(name="end1", body="link1"),)
    payload = Payload(mass=MASS, inertia=INERTIA)
    return FlexibleTree.serial(bodies, kinematics=kinematics, gravity=(0, 0, 0), frames=frames, payload=payload)


def played(modes, kinematics="strain", samples=20, **options):
    """(t, {end1, end2: positions (nt, 3) [m]}, the largest deflection [m])."""
    own, t = tree(modes, kinematics), np.linspace(0.0, SECONDS, samples + 1)
    motion = own.simulate(np.zeros(own.nx), torques, t, **({"rtol": 1e-7} | options))
    ends = {"end1": "end1", "end2": "tip"}
    found = {name: np.column_stack([motion[f"{place}_{axis}"] for axis in "xyz"]) for name, place in ends.items()}
    bent = np.array([motion[name] for name in own.deflections])
    return t, found, float(np.abs(bent).max())
