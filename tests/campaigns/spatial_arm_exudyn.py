"""A spatial arm of two flexible links, its axes not parallel, by Exudyn's geometrically exact beams in space.

    python tests/campaigns/spatial_arm_exudyn.py

Plays the arm of `tests/cases/spatial_arm.py` on two grids with Exudyn (https://github.com/jgerstmayr/
EXUDYN, `ObjectBeamGeometricallyExact`, two nodes an element), extrapolates the error of second order of the elements,
writes tests/reference/spatial_arm.json and compares the tree with it. Exit status 1 where the tree is farther from it
than 1e-3 of the largest deflection.
"""

import json
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.rigidBodyUtilities import RotationMatrix2RotationVector

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "cases"))

import spatial_arm as arm  # noqa: E402

PARTS, STEPS = (16, 32), 1000
SAMPLES = 20


def section(beam: Any) -> Any:
    """Stiffness, mass and turning inertia of a section, x along the beam."""
    found = exu.BeamSection()
    found.massPerLength = beam.density * beam.area
    polar, y, z = beam.density * beam.polar_moment, beam.density * beam.I_y, beam.density * beam.I_z
    found.inertia = np.diag([polar, y, z])
    shear = beam.shear_stiffness
    found.stiffnessMatrix = np.diag([beam.E * beam.area, shear, shear, beam.GJ, beam.E * beam.I_y, beam.E * beam.I_z])
    return found


def played(parts: int, steps: int) -> dict[str, np.ndarray]:
    """Positions of both links' ends (SAMPLES + 1, 3) [m]."""
    mbs = exu.SystemContainer().AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    at, R, before, ends, loads = np.zeros(3), np.eye(3), None, [], []
    for i, beam in enumerate(arm.BEAMS):
        turn = arm.TURNS[i]
        B = arm.aligned(arm.AXES[i])
        R_own = R @ turn
        rotation = RotationMatrix2RotationVector(R_own)
        nodes = []
        for k in range(parts + 1):
            where = at + beam.length * k / parts * R_own[:, 0]
            node = items.NodeRigidBodyRotVecLG(referenceCoordinates=[*where, *rotation])
            nodes.append(mbs.AddNode(node))
        for first, second in pairwise(nodes):
            element = items.ObjectBeamGeometricallyExact(
                nodeNumbers=[first, second], length=beam.length / parts, sectionData=section(beam)
            )
            mbs.AddObject(element)
        own = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
        if before is None:
            other = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=ground, localPosition=list(at)))
        else:
            other = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=before))
        hinge = items.ObjectJointRevoluteZ(
            markerNumbers=[other, own], rotationMarker0=R.T @ R_own @ B if before is not None else R_own @ B,
            rotationMarker1=B,
        )  # fmt: skip
        mbs.AddObject(hinge)
        loads.append(torque(mbs, own, np.array(arm.AXES[i]), i))
        if before is not None:
            loads.append(torque(mbs, other, -R.T @ R_own @ np.array(arm.AXES[i]), i))
        at, R, before = at + beam.length * R_own[:, 0], R_own, nodes[-1]
        ends.append(nodes[-1])
    load = items.ObjectRigidBody(
        physicsMass=arm.MASS, physicsInertia=[arm.INERTIA] * 3 + [0.0] * 3, nodeNumber=ends[-1]
    )
    mbs.AddObject(load)
    kind = exu.OutputVariableType.Position
    seen = [mbs.AddSensor(items.SensorNode(nodeNumber=n, outputVariableType=kind, storeInternal=True)) for n in ends]
    mbs.Assemble()

    def drive(system: Any, t: float) -> bool:
        own = arm.torques(t)
        for load, axis, i in loads:
            system.SetLoadParameter(load, "loadVector", list(own[i] * axis))
        return True

    mbs.SetPreStepUserFunction(drive)
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, arm.SECONDS
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.timeIntegration.newton.useModifiedNewton = False
    settings.timeIntegration.newton.relativeTolerance, settings.timeIntegration.newton.absoluteTolerance = 1e-12, 1e-6
    settings.timeIntegration.verboseMode = 0
    settings.linearSolverType = exu.LinearSolverType.EigenSparse
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = arm.SECONDS / SAMPLES
    if not mbs.SolveDynamic(settings):
        sys.exit(f"Exudyn's Newton method fails with {parts} elements, {steps} steps")
    return {f"end{i + 1}": mbs.GetSensorStoredData(s)[:, 1:] for i, s in enumerate(seen)}


def torque(mbs: Any, marker: int, axis: np.ndarray, joint: int) -> tuple[int, np.ndarray, int]:
    """(a torque about an axis that turns with the marker, the axis, its joint)."""
    return mbs.AddLoad(items.LoadTorqueVector(markerNumber=marker, bodyFixed=True, loadVector=[0, 0, 0])), axis, joint


if __name__ == "__main__":
    coarse, fine = played(PARTS[0], STEPS), played(PARTS[1], STEPS)
    slower = played(PARTS[0], 2 * STEPS)
    exact = {name: fine[name] + (fine[name] - coarse[name]) / 3 for name in fine}
    known = max(np.abs(exact[n] - fine[n]).max() for n in fine) / 3
    in_time = max(np.abs(slower[n] - coarse[n]).max() for n in fine)
    t, tree, size = arm.played(arm.FINEST)
    gap = max(np.abs(exact[n] - tree[n]).max() for n in exact)
    print(f"grids apart by {3 * known:.2g} m, steps by {in_time:.2g} m; the tree by {gap:.2g} m = {gap / size:.2g} of")
    apart = max(np.abs(fine[n] - tree[n]).max() for n in exact)
    print(f"its largest deflection, {size:.3g} m; from the fine grid as it is {apart:.2g} m")
    told = {
        "source": f"Exudyn {exu.__version__}, ObjectBeamGeometricallyExact, {PARTS[0]} and {PARTS[1]} elements a link "
        f"extrapolated by their order 2, {STEPS} steps of generalized alpha; tests/campaigns/spatial_arm_exudyn.py",
        "known_to": known + in_time,
        "t": t.tolist(),
        **{name: np.round(values, 8).tolist() for name, values in exact.items()},
    }
    (TESTS / "reference" / "spatial_arm.json").write_text(json.dumps(told, indent=1) + "\n")
    sys.exit(gap > 1e-3 * size)
