"""A spatial arm of two flexible links, its axes not parallel, by Exudyn's kinematic tree of rigid segments.

    python tests/campaigns/spatial_arm_exudyn.py

Plays the arm of `tests/cases/spatial_arm.py` with Exudyn (https://github.com/jgerstmayr/EXUDYN, `ObjectKinematicTree`):
a link of N springs is half a segment, N - 1 whole ones and another half; at each spring three hinges, about x, y, z and
about z, y, x in turn, for otherwise their order adds up to an error of the first order. What remains is of the second:
the distance to the tree falls to a quarter from N to 2 N, and extrapolation (Richardson) takes it away. Writes
tests/reference/spatial_arm.json and compares the tree. `known_to`: how far coarser segments and longer steps move what
is extrapolated. Exit status 1 where the tree is farther off than LIMIT.

Exudyn's geometrically exact beams are no reference here: with 8, 16 and 32 elements a link they are 2.0, 0.23 and 2.8
mm from the tree, for Newton's method reaches no residuals small enough for the turns of short elements, which drift.
"""

import json
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "cases"))

import spatial_arm as arm  # noqa: E402

SPRINGS, STEPS = 16, 1000  # of the finest links; of generalized alpha
LIMIT = 1e-3  # of the largest deflection
SAMPLES = 20
HINGES = (exu.JointType.RevoluteX, exu.JointType.RevoluteY, exu.JointType.RevoluteZ)


class Chain:
    """Rigid links one after the other, each by its hinge: (kind, turn and place before it, stiffness)."""

    def __init__(self) -> None:
        self.kinds, self.turns, self.places, self.stiffness = list[Any](), list[Any](), list[Any](), list[float]()
        self.mass, self.centres, self.inertia = list[float](), list[Any](), list[Any]()

    def add(self, kind: Any, turn: Any = None, place: Any = (0, 0, 0), stiffness: float = 0.0) -> int:
        """A hinge, what it carries yet without mass."""
        self.kinds.append(kind)
        self.turns.append(np.eye(3) if turn is None else turn)
        self.places.append(np.array(place, dtype=float))
        self.stiffness.append(stiffness)
        self.mass.append(0.0)
        self.centres.append(np.zeros(3))
        self.inertia.append(np.zeros((3, 3)))
        return len(self.kinds) - 1

    def carry(self, mass: float, centre: Any, inertia: Any) -> None:
        """On the last link, besides what it carries."""
        both = self.mass[-1] + mass
        middle = (self.mass[-1] * self.centres[-1] + mass * np.array(centre)) / both
        J = self.inertia[-1] + inertia
        for m, at in ((self.mass[-1], self.centres[-1]), (mass, np.array(centre))):
            d = at - middle
            J = J + m * (d @ d * np.eye(3) - np.outer(d, d))
        self.mass[-1], self.centres[-1], self.inertia[-1] = both, middle, J


def piece(beam: Any, h: float) -> tuple[float, Any, Any]:
    """Mass, centre and inertia of a length h along x."""
    m = beam.density * beam.area * h
    across = [beam.density * second * h + m * h**2 / 12 for second in (beam.I_y, beam.I_z)]
    return m, np.array([h / 2, 0, 0]), np.diag([beam.density * beam.polar_moment * h, *across])


def built(springs: int) -> tuple[Chain, list[int], list[tuple[int, list[float]]]]:
    """The arm, its driven hinges, and (link, place on it) of both ends."""
    chain, driven, ends, place = Chain(), list[int](), list[tuple[int, list[float]]](), np.zeros(3)
    for beam, axis, turn in zip(arm.BEAMS, arm.AXES, arm.TURNS, strict=True):
        h, B = beam.length / springs, arm.aligned(axis)
        driven.append(chain.add(HINGES[2], turn @ B, place))
        m, centre, J = piece(beam, h / 2)
        chain.carry(m, B.T @ centre, B.T @ J @ B)
        back, place = B.T, B.T @ np.array([h / 2, 0, 0])
        for s in range(springs):
            k = (beam.GJ / h, beam.E * beam.I_y / h, beam.E * beam.I_z / h)
            order = (0, 1, 2) if s % 2 == 0 else (2, 1, 0)
            for step, i in enumerate(order):
                first = {"turn": back, "place": place} if step == 0 else {}
                chain.add(HINGES[i], stiffness=k[i], **first)
            length = h if s < springs - 1 else h / 2
            chain.carry(*piece(beam, length))
            back, place = np.eye(3), np.array([length, 0, 0])
        ends.append((len(chain.kinds) - 1, place.tolist()))
    chain.carry(arm.MASS, place, arm.INERTIA * np.eye(3))
    return chain, driven, ends


def played(springs: int, steps: int) -> dict[str, np.ndarray]:
    """Positions of both links' ends (SAMPLES + 1, 3) [m]."""
    chain, driven, ends = built(springs)
    n, mbs = len(chain.kinds), exu.SystemContainer().AddSystem()
    zero = [0.0] * n
    node = mbs.AddNode(items.NodeGenericODE2(referenceCoordinates=zero, initialCoordinates=zero,
                                             initialCoordinates_t=zero, numberOfODE2Coordinates=n))  # fmt: skip

    def drive(system: Any, t: float, item: int, q: Any, v: Any) -> np.ndarray:
        force = np.zeros(n)
        force[driven] = arm.torques(t)
        return force

    tree = items.ObjectKinematicTree(
        nodeNumber=node, jointTypes=chain.kinds, linkParents=list(range(-1, n - 1)),
        jointTransformations=exu.Matrix3DList(chain.turns), jointOffsets=exu.Vector3DList(chain.places),
        linkInertiasCOM=exu.Matrix3DList(chain.inertia), linkCOMs=exu.Vector3DList(chain.centres),
        linkMasses=chain.mass, jointPositionOffsetVector=zero, jointVelocityOffsetVector=zero,
        jointPControlVector=chain.stiffness, jointDControlVector=zero, forceUserFunction=drive,
    )  # fmt: skip
    body, kind = mbs.AddObject(tree), exu.OutputVariableType.Position
    seen = [
        mbs.AddSensor(items.SensorKinematicTree(objectNumber=body, linkNumber=link, localPosition=at,
                                                outputVariableType=kind, storeInternal=True))
        for link, at in ends
    ]  # fmt: skip
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, arm.SECONDS
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.newton.relativeTolerance = 1e-9
    settings.timeIntegration.newton.absoluteTolerance = 1e-11
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = arm.SECONDS / SAMPLES
    if not mbs.SolveDynamic(settings):
        sys.exit(f"Exudyn's Newton method fails with {springs} springs, {steps} steps")
    return {f"end{i + 1}": mbs.GetSensorStoredData(s)[:, 1:] for i, s in enumerate(seen)}


def apart(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> float:
    """[m]."""
    return max(float(np.abs(a[name] - b[name]).max()) for name in a)


if __name__ == "__main__":
    found = {n: played(n, STEPS) for n in (SPRINGS // 4, SPRINGS // 2, SPRINGS)}
    levels = list(found.values())
    coarse, best = ({name: b[name] + (b[name] - a[name]) / 3 for name in b} for a, b in pairwise(levels))
    steps = apart(played(SPRINGS // 2, 2 * STEPS), levels[1])
    t, tree, size = arm.played(arm.FINEST)
    for n, one in found.items():
        print(f"{n:3d} springs a link: {apart(one, tree):.2g} m from the tree")
    known, gap = apart(coarse, best) + steps, apart(best, tree)
    print(f"Exudyn is known to {known:.2g} m; the tree is {gap:.2g} m = {gap / size:.2g} of the largest deflection off")
    told = {
        "source": f"Exudyn {exu.__version__}, ObjectKinematicTree, rigid segments with {SPRINGS // 2} and {SPRINGS} "
        f"springs a link, extrapolated, {STEPS} steps of generalized alpha; tests/campaigns/spatial_arm_exudyn.py",
        "known_to": known,
        "springs": {str(n): apart(one, best) for n, one in found.items()},
        "t": t.tolist(),
        **{name: np.round(values, 8).tolist() for name, values in best.items()},
    }
    text = json.dumps(told).replace('"t":', '\n"t":').replace('"end', '\n"end')
    (TESTS / "reference" / "spatial_arm.json").write_text(text + "\n")
    sys.exit(gap > LIMIT * size)
