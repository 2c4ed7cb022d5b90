"""Exudyn's beam elements on the scene cantilever-drop, and a search for its fastest settings within an error.

Its errors of space and of time have opposite signs: the fastest settings lie where they happen to cancel. Settings are
called settled where halving the step keeps the error too.
"""

from __future__ import annotations

import contextlib
import dataclasses
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from harness.sampling import Sampler, time_of
from harness.tip_error import COARSE, END, FINE, TIMES, Array, away, between, checked

from peers import peers
from pliant.plants import LargeDeflectionBeam


@dataclass(frozen=True)
class Elements:
    """Exudyn: 3-node geometrically exact elements in the plane, trapezoidal rule, modified Newton."""

    elements: int
    steps: int
    sparse: bool
    tolerance: float = 1e-4  # of the Newton iteration, relative; the absolute one is 1e-6

    def __str__(self) -> str:
        algebra = "sparse" if self.sparse else "dense"
        step = 1e3 * END / self.steps
        return f"{self.elements} elements, {self.steps} steps of {step:.3g} ms, {algebra}, Newton to {self.tolerance:g}"


SEARCHED = {
    COARSE: [(n, k) for n in (3, 4, 5, 6, 7, 8) for k in (200, 220, 240, 260, 300, 350, 400, 500)],
    FINE: [(n, k) for n in (10, 11, 12, 13, 14, 16) for k in (1200, 1300, 1400, 1500, 1600, 1800, 2000, 2500, 3000)],
}
SETTLED = {
    COARSE: [(n, k) for n in (6, 7, 8, 9, 10) for k in (350, 400, 450, 500)],
    FINE: [(n, k) for n in (20, 22, 24, 28) for k in (2500, 3000, 3500, 4000, 5000)],
}


def _settings(exu: Any, chosen: Elements, watched: bool) -> Any:
    settings = exu.SimulationSettings()
    kinds = exu.LinearSolverType
    settings.linearSolver.solverType = kinds.EigenSparse if chosen.sparse else kinds.EigenDense
    settings.parallel.numberOfThreads = 1
    settings.displayStatistics = settings.displayComputationTime = False
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 1e-9 if watched else 1e9
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = chosen.steps, END
    integration.verboseMode = integration.stepInformation = 0
    integration.adaptiveStep = False
    integration.generalizedAlpha.spectralRadius = 1.0
    integration.newton.useModifiedNewton = True
    integration.newton.relativeTolerance, integration.newton.absoluteTolerance = chosen.tolerance, 1e-6
    return settings


def _model(chosen: Elements, watched: bool) -> tuple[Any, Any, list[int]]:
    """The assembled system, its settings and the sensors of the tip's displacement and velocity."""
    exu = peers.exudyn()
    from exudyn.beams import GenerateBeamElementsAlongLine
    from exudyn.itemInterface import ObjectBeamGeometricallyExact2D, SensorNode

    plant = LargeDeflectionBeam.textbook()
    own, sensors = plant.beam, []
    system = exu.SystemContainer().AddSystem()
    template = ObjectBeamGeometricallyExact2D(
        nodeNumbers=[0, 0, 0],
        massPerLength=own.density * own.area,
        crossSectionInertia=own.density * own.I_z,
        bendingStiffness=own.E * own.I_z,
        axialStiffness=own.E * own.area,
        shearStiffness=own.G * own.area,
    )
    made = GenerateBeamElementsAlongLine(
        system,
        [0, 0, 0],
        [own.length, 0, 0],
        chosen.elements,
        template,
        gravity=list(plant.gravity),
        groundConstraintsStart=[1, 1, 1],
    )
    if watched:
        kinds = exu.OutputVariableType
        for kind in (kinds.Displacement, kinds.Velocity):
            sensor = SensorNode(nodeNumber=made["nodes"][-1], outputVariableType=kind, storeInternal=True)
            sensors.append(system.AddSensor(sensor))
    system.Assemble()
    return system, _settings(exu, chosen, watched), sensors


@cache
def tip(chosen: Elements) -> Array:
    """u and v (601, 2) [m]; NaN where Exudyn gives up."""
    exu = peers.exudyn()
    system, settings, sensors = _model(chosen, True)
    with contextlib.redirect_stdout(sys.stderr):
        try:
            system.SolveDynamic(settings)
        except exu.SolverError:
            return np.full((len(TIMES), 2), np.nan)
    moved, rate = (np.asarray(system.GetSensorStoredData(s)) for s in sensors)
    return between(moved[:, 0], moved[:, 1:3], rate[:, 1:3])


@cache
def truth() -> Array:
    """Of the extensible, shearable beam, (601, 2)."""
    return checked(tip(Elements(40, 24_000, True, 1e-6)), "M1_timoshenko")


def error(chosen: Elements) -> float:
    """Of Exudyn's run [m]."""
    return away(tip(chosen), truth())


def _seconds(chosen: Elements) -> float:
    """The quickest of three solves."""
    system, settings, _ = _model(chosen, False)
    found = []
    for _ in range(3):
        begin = time.perf_counter()
        system.SolveDynamic(settings)
        found.append(time.perf_counter() - begin)
    return min(found)


@cache
def best(allowed: float, settled: bool) -> Elements:
    """Exudyn's fastest settings within the error; settled: with half the step too."""

    def within(chosen: Elements) -> bool:
        halved = dataclasses.replace(chosen, steps=2 * chosen.steps)
        return error(chosen) <= allowed and (not settled or error(halved) <= allowed)

    def fastest(tried: Iterable[Elements], most: int) -> list[Elements]:
        return sorted((e for e in tried if within(e)), key=_seconds)[:most]

    grid = (SETTLED if settled else SEARCHED)[allowed]
    first = fastest((Elements(n, k, n > 11) for n, k in grid), 3)
    variants = [
        dataclasses.replace(e, sparse=sparse, tolerance=tolerance)
        for e in first
        for sparse in (False, True)
        for tolerance in (1e-3, 1e-4, 1e-5)
    ]
    found = fastest(variants, 1)
    if not found:
        raise FloatingPointError(f"no setting within {allowed:g} m")
    return found[0]


def solver(allowed: float, settled: bool) -> Sampler:
    """One solve from the start at rest."""
    system, settings, _ = _model(best(allowed, settled), False)
    return time_of(lambda: system.SolveDynamic(settings))
