"""Exudyn on classical planar beams whose sources print curves only: writes tests/reference/classical_beams.json.

Run      python benchmarks/peers/exudyn_classical.py   (some minutes; needs exudyn)
Beams    the free flying spaghetti and the spin-up of J. C. Simo and L. Vu-Quoc, "On the dynamics of flexible beams
         under large overall motions - the plane case: part II", J. Appl. Mech. 53 (1986), 855-863
Settings 3-node geometrically exact elements in the plane, trapezoidal rule, full Newton. Each number stands beside that
         of half the elements and of twice the step: what is left falls by 4 to 16 with the next halving
"""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

PAGE = Path(__file__).parents[2] / "tests" / "reference" / "classical_beams.json"

SPAGHETTI = {
    "L_m": 10.0, "EA_N": 1e4, "kGA_N": 1e4, "EI_N_m2": 500.0, "rhoA_kg_m": 1.0, "rhoI_kg_m": 10.0,
    "root_m": [0.0, 8.0], "tip_m": [6.0, 0.0], "force_x_N": 8.0, "moment_N_m": -80.0, "until_s": 2.5,
}  # fmt: skip
SPIN_UP = {
    "L_m": 10.0, "EA_N": 2.8e7, "kGA_N": 1e7, "EI_N_m2": 1.4e4, "rhoA_kg_m": 1.2, "rhoI_kg_m": 6e-4,
    "speed_rad_s": 6.0, "time_s": 15.0,
}  # fmt: skip


def made(exu: Any, given: dict[str, Any], start: list[float], end: list[float], elements: int) -> tuple[Any, list[int]]:
    """A beam between two places, and its nodes."""
    from exudyn.beams import GenerateBeamElementsAlongLine
    from exudyn.itemInterface import ObjectBeamGeometricallyExact2D

    system = exu.SystemContainer().AddSystem()
    template = ObjectBeamGeometricallyExact2D(
        nodeNumbers=[0, 0, 0],
        massPerLength=given["rhoA_kg_m"],
        crossSectionInertia=given["rhoI_kg_m"],
        bendingStiffness=given["EI_N_m2"],
        axialStiffness=given["EA_N"],
        shearStiffness=given["kGA_N"],
    )
    return system, GenerateBeamElementsAlongLine(system, [*start, 0], [*end, 0], elements, template)["nodes"]


def solved(exu: Any, system: Any, nodes: list[int], end: float, step: float, within: float = 1e-8) -> np.ndarray:
    """Times, then displacements x, y of these nodes and rotation: (nt, 1 + 3 k)."""
    from exudyn.itemInterface import SensorNode

    kind = exu.OutputVariableType.Coordinates
    sensors = [
        system.AddSensor(SensorNode(nodeNumber=node, outputVariableType=kind, storeInternal=True)) for node in nodes
    ]
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.parallel.numberOfThreads = 1
    settings.displayStatistics = settings.displayComputationTime = False
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 2.5
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = round(end / step), end
    integration.verboseMode = integration.stepInformation = 0
    integration.adaptiveStep = False
    integration.generalizedAlpha.spectralRadius = 1.0
    integration.newton.useModifiedNewton = False
    integration.newton.relativeTolerance, integration.newton.absoluteTolerance = 1e-8, within
    with contextlib.redirect_stdout(sys.stderr):
        system.SolveDynamic(settings)
    found = [np.asarray(system.GetSensorStoredData(s)) for s in sensors]
    return np.column_stack([found[0][:, 0], *[f[:, 1:4] for f in found]])


def spaghetti(exu: Any, given: dict[str, Any], elements: int, step: float) -> list[list[float]]:
    """Rows of time and the places of root, middle and tip [s, m]."""
    from exudyn.itemInterface import Force, MarkerNodePosition, MarkerNodeRigid, Torque

    system, nodes = made(exu, given, given["root_m"], given["tip_m"], elements)
    until, half = given["until_s"], step / 2

    def on(t: float) -> float:
        """Half at the end, so that the trapezoidal rule passes on the whole impulse."""
        return 1.0 if t < until - half else 0.5 if t < until + half else 0.0

    place = system.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    turn = system.AddMarker(MarkerNodeRigid(nodeNumber=nodes[-1]))
    F, M = np.array([given["force_x_N"], 0, 0]), np.array([0, 0, given["moment_N_m"]])
    system.AddLoad(Force(markerNumber=place, loadVector=F, loadVectorUserFunction=lambda _, t, __: list(F * on(t))))
    system.AddLoad(Torque(markerNumber=turn, loadVector=M, loadVectorUserFunction=lambda _, t, __: list(M * on(t))))
    ends = [nodes[0], nodes[len(nodes) // 2], nodes[-1]]
    data = solved(exu, system, ends, 10.0, step)
    root, tip = (np.array(given[k]) for k in ("root_m", "tip_m"))
    starts = np.array([root, (root + tip) / 2, tip])
    rows = []
    for row in data:
        places = starts + row[1:].reshape(3, 3)[:, :2]
        rows.append([float(row[0]), *places.ravel().tolist()])
    return rows[1:]


def spin_up(exu: Any, given: dict[str, Any], elements: int, step: float) -> list[list[float]]:
    """Rows of time and the tip's displacement along and across the turning root [s, m]."""
    from exudyn.itemInterface import CoordinateConstraint, MarkerNodeCoordinate, NodePointGround

    system, nodes = made(exu, given, [0.0, 0.0], [given["L_m"], 0.0], elements)
    ground = system.AddNode(NodePointGround())
    fixed = system.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for k in range(3):
        free = system.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
        extra = {"offsetUserFunction": lambda _, t, __, ___: turn(given, t)} if k == 2 else {}
        system.AddObject(CoordinateConstraint(markerNumbers=[fixed, free], **extra))
    data = solved(exu, system, [nodes[-1]], 20.0, step, 1e-5)
    rows = []
    for t, x, y, _ in data[1:]:
        c, s = np.cos(turn(given, t)), np.sin(turn(given, t))
        place = np.array([given["L_m"] + x, y])
        rows.append([float(t), float(c * place[0] + s * place[1] - given["L_m"]), float(c * place[1] - s * place[0])])
    return rows


def turn(given: dict[str, Any], t: float) -> float:
    """Angle of the root [rad]."""
    T, speed = given["time_s"], given["speed_rad_s"]
    if t >= T:
        return float(speed * (t - T / 2))
    return float(speed / T * (t**2 / 2 + (T / (2 * np.pi)) ** 2 * (np.cos(2 * np.pi * t / T) - 1)))


def case(run: Callable[..., Any], given: dict[str, Any], elements: int, step: float, words: str) -> dict[str, Any]:
    """A case with what changes where elements or steps are coarser."""
    import exudyn as exu

    rows = np.array(run(exu, given, elements, step))
    coarse = np.array(run(exu, given, elements // 2, step)), np.array(run(exu, given, elements, 2 * step))
    return {
        "about": words,
        "parameters": given,
        "elements": elements,
        "step_s": step,
        "largest_change_half_the_elements": float(np.abs(rows - coarse[0]).max()),
        "largest_change_twice_the_step": float(np.abs(rows - coarse[1]).max()),
        "rows": rows.tolist(),
    }


def main() -> None:
    """Write the page."""
    import exudyn as exu

    soft = SPAGHETTI | {"EI_N_m2": 100.0}
    columns = "t, root x, y, middle x, y, tip x, y"
    page = {
        "about": f"Classical planar beams by Exudyn {exu.__version__}; settings and convergence beside each. SI. "
        "Made by benchmarks/peers/exudyn_classical.py.",
        "spaghetti": case(spaghetti, SPAGHETTI, 40, 1e-3, f"Free flying spaghetti, EI = 500; rows {columns}."),
        "soft_spaghetti": case(spaghetti, soft, 40, 1e-3, f"The same, EI = 100; rows {columns}."),
        "spin_up": case(spin_up, SPIN_UP, 24, 5e-4, "Spin-up; rows t, tip along, tip across the turning root."),
    }
    PAGE.write_text(json.dumps(page, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
