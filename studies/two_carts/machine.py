"""Two carts and a spring: the force acts on the first, the place of the second is read, and a blow hits it.

    m1 x1'' = k (x2 - x1) + u,   m2 x2'' = k (x1 - x2) + w,   y = x2,   m1 = m2 = 1 kg,  k = 1 N/m known to be 0.5 to 2

Nothing damps it, and sensor and actuator are on different bodies. First problem: after a blow of 1 N s the second cart
is at rest after about 15 s where k = 1, and the loop is stable for all 0.5 < k < 2, by inputs of reasonable size.

Source   Wie and Bernstein 1992, "Benchmark problems for robust control design", J. Guidance, Control, and Dynamics 15,
         set for the American Control Conference of 1990
"""

from __future__ import annotations

from functools import cache

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleTree, Joint, LinearModel, Plant, TreeBody

VARIED = ("bodies.0.mass", "bodies.1.mass", "bodies.1.joint.stiffness")
SETTLED, STIFFNESS = 15.0, (0.5, 2.0)  # [s] and [N/m]: what is asked
AWAY = 0.1  # [m] the second cart counts as at rest within it
BLOW = 1.0  # [N s]


def two_carts() -> FlexibleTree:
    """A tree of two sliding bodies; the input pushes the first, `tip_x` is where the second is [m]."""
    along = (1.0, 0.0, 0.0)
    first = TreeBody(name="cart1", joint=Joint(name="x1", kind="prismatic", axis=along), mass=1.0, inertia=1.0)
    spring = Joint(name="stretch", kind="prismatic", axis=along, stiffness=1.0, drive="none")
    second = TreeBody(name="cart2", joint=spring, mass=1.0, inertia=1.0)
    return FlexibleTree.serial([first, second], gravity=(0.0, 0.0, 0.0))


@cache
def varied() -> Plant:
    """The same with masses and stiffness as parameters."""
    return two_carts().vary(*VARIED)


@cache
def model(mass1: float = 1.0, mass2: float = 1.0, stiffness: float = 1.0) -> LinearModel:
    """About rest, exact. [kg], [kg], [N/m]"""
    return varied().linearize(np.zeros(4), np.zeros(1), p=np.array([mass1, mass2, stiffness]))


def blown(cart: int) -> np.ndarray:
    """The state (4,) after a blow on cart 1 or 2: [x1, stretch] = 0, and their rates."""
    return np.array([0.0, 0.0, BLOW, -BLOW]) if cart == 1 else np.array([0.0, 0.0, 0.0, BLOW])


SCENE = Scene(
    name="two-carts",
    about="bring two carts and the spring between them to rest after a blow on the far one",
    plant=two_carts(),
    start=(("x1", 0.0), ("x1_rate", 0.0), ("stretch_rate", 1.0)),
    goal=(("x1", 0.0),),
    start_at_rest=False,
    duration=20.0,
    dt=0.05,
    substeps=2,
    move_time=10.0,
    limits=(10.0,),
    weights=(("tip_x", 1.0),),
    effort=(("x1_force", 1.0),),
    observe=("tip_x",),
    compare=("tip_x",),
    tolerance=AWAY,
)
