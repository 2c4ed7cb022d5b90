"""Beams and sliders in space, nothing of them aligned, which the tests of trees share."""

import dataclasses

from pliant.plants import Beam, FlexibleTree, Frame, Joint, Payload, TreeBody, beams

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
SHORT = Beam.rectangular(0.8, width=0.03, depth=0.01, material=beams.ALUMINIUM)


def space_tree(kinematics="stiffened", **changes):
    """Two beams and a slider in space, nothing of it aligned; a frame half-way along the first beam."""
    bodies = (
        TreeBody(name="upper", joint=Joint(name="j1"), mass=0.3, inertia=0.01, beam=STRIP, modes=(2, 1, 1, 1)),
        TreeBody(
            name="fore",
            joint=Joint(name="j2", axis=(0.0, 0.6, 0.8), position=(0.01, 0.02, 0.0), rotation=(0.3, 0.2, 0.1)),
            mass=0.2,
            inertia=0.01,
            beam=SHORT,
            beam_rotation=(0.1, -0.4, 0.2),
            modes=(1, 2, 1, 0),
        ),
        TreeBody(
            name="slide",
            joint=Joint(name="j3", kind="prismatic", axis=(0.8, -0.6, 0.0), rotation=(0.0, 0.5, 0.0)),
            mass=0.2,
            centre=(0.1, 0.0, 0.02),
            inertia=((0.002, 0.0, 0.0), (0.0, 0.003, 1e-4), (0.0, 1e-4, 0.002)),
        ),
        TreeBody(
            name="branch",
            parent="upper",
            joint=Joint(name="j4", axis=(-1.0, 0.0, 0.0), station=0.5, position=(0.0, 0.05, 0.0)),
            mass=0.1,
            centre=(0.0, 0.1, 0.0),
            inertia=0.001,
        ),
    )
    options = {"tip": "slide", "payload": Payload(mass=0.2, inertia=0.001, offset=(0.02, 0.01, 0.0))}
    frames = (Frame(name="middle", body="upper", station=0.5, position=(0.0, 0.01, 0.0)),)
    made = FlexibleTree.serial(bodies[:3], kinematics=kinematics, frames=frames, loads=("tip", "middle"), **options)
    made = dataclasses.replace(made, bodies=(*made.bodies, bodies[3]))
    return dataclasses.replace(made, **changes)
