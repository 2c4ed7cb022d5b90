"""Two masses and a spring, a force on the first, as the tests of tubes play them."""

import numpy as np

from pliant.controllers import DisturbanceSet, TubeMPC
from pliant.plants import LinearModel

DT, LIMIT = 0.1, 0.45
SPRING, DAMPER = 4.0, 0.05
MODEL = LinearModel.from_matrices(
    [
        [0, 0, 1, 0],
        [0, 0, 0, 1],
        [-SPRING, SPRING, -DAMPER, DAMPER],
        [SPRING, -SPRING, DAMPER, -DAMPER],
    ],
    [[0], [0], [1.0], [0]],
    states=["p1", "p2", "v1", "v2"],
    inputs=["F"],
)
HELD = MODEL.discretize(DT)
PUSH = DisturbanceSet.box([0.0, 0.0, 0.01, 0.01], [5e-4, 5e-4, 1e-3, 1e-3])
Q, R = np.diag([1.0, 1.0, 0.1, 0.1]), [[0.1]]
GIVEN = {"dt": DT, "limits": (-1.0, 1.0), "bounds": {"v2": (-LIMIT, LIMIT)}}


def tube(**options):
    return TubeMPC.design(MODEL, Q, R, PUSH, **{**GIVEN, **options})


def play(law, start, seed, steps=60, late=0):
    """Largest |v2|, largest |F|, and whether the first plan kept its limits, under disturbances of the set's corners:
    drawn anew each period, the same for a while, or with the speed. F acts `late` periods after it is asked for."""
    rng = np.random.default_rng(seed)
    x, corners = np.array(start, dtype=float), PUSH.points[0]
    law.reset()
    speed = force = 0.0
    first, w, way = False, corners[0], [np.zeros(1)] * late
    for k in range(steps):
        e = PUSH.noise * rng.choice([-1.0, 1.0], 4)
        way.append(law.act(k * DT, x + e))
        u = way.pop(0)
        first = first or (k == 0 and law.record.violations == 0)
        if seed % 3 == 0 or (seed % 3 == 1 and k % 7 == 0):
            w = corners[rng.integers(len(corners))]
        elif seed % 3 == 2:
            w = max(corners, key=lambda one: one @ np.sign([0, 0, x[3], x[3]]))
        x = HELD.A @ x + HELD.B @ u + w
        speed, force = max(speed, abs(x[3])), max(force, abs(u[0]))
    return speed, force, first
