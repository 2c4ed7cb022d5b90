"""Exudyn: geometrically exact beam elements in the plane, the implicit trapezoidal rule, joints as constraints.

Elements of three nodes stretch and shear. At the jumps of a held torque the rule takes the mean of both sides, so that
it keeps its order.
"""

from __future__ import annotations

import contextlib
import io
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .planar_machine import Machine
from .programs import BrokenDownError, Motion, Player, Setting


@dataclass(frozen=True)
class Solver:
    """Generalized alpha, which is the trapezoidal rule where nothing is damped (radius 1), and Newton's method."""

    radius: float = 1.0  # spectral, at infinite frequency
    tolerance: float = 1e-4  # of Newton's method, relative; the absolute one is 1e-6
    sparse: bool = False
    modified: bool = True  # keeps the Jacobian while it converges

    def __str__(self) -> str:
        rule = "trapezoidal rule" if self.radius == 1.0 else f"generalized alpha {self.radius:g}"
        newton = f"{'modified ' * self.modified}Newton to {self.tolerance:g}"
        return f"{rule}, {'sparse' if self.sparse else 'dense'}, {newton}"


@dataclass(frozen=True)
class Beams:
    """ObjectBeamGeometricallyExact2D, one thread, nothing written. `stiffer`: times the axial stiffness, and times the
    shear stiffness where the reference does not shear."""

    stiffer: float = 1.0

    peer = "Exudyn, geometrically exact beams"
    package = "exudyn"
    part = "elements"

    def why_not(self, machine: Machine) -> str:
        return ""

    def parts(self, machine: Machine) -> tuple[int, ...]:
        return 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32

    def solvers(self) -> tuple[Solver, ...]:
        return Solver(), Solver(radius=0.9)

    def beside(self, solver: Solver) -> tuple[Solver, ...]:
        looser = (replace(solver, tolerance=t, sparse=s) for t in (1e-3, 1e-4, 1e-5) for s in (False, True))
        return *(s for s in looser if s != solver), replace(solver, modified=False)

    def player(self, machine: Machine, setting: Setting) -> Player:
        watched = System(machine, setting, self.stiffer, True)

        def play() -> tuple[Motion, float]:
            seconds = watched.solve()
            return watched.motion(), seconds

        kept: list[System] = []

        def seconds() -> float:
            kept.extend([] if kept else [System(machine, setting, self.stiffer, False)])
            return kept[0].solve()

        return Player(play, seconds)


def library() -> Any:
    """Exudyn's fast module, without range checks; what it says of that on stdout is kept from there."""
    sys.exudynFast = True  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn as exu
    return exu


class System:
    """An assembled system; watched: with the tip's positions stored at the control times."""

    def __init__(self, machine: Machine, setting: Setting, stiffer: float, watched: bool) -> None:
        self.exu, self.machine, self.setting, self.watched = library(), machine, setting, watched
        self.stiffer = stiffer
        self.mbs = self.exu.SystemContainer().AddSystem()
        self.ground = self.mbs.AddObject(_item("ObjectGround")())
        self._build()
        self.mbs.Assemble()
        self.settings = self._settings()

    def _build(self) -> None:
        machine, at = self.machine, np.zeros(2)
        self.loads: list[list[int]] = []  # of each motor: on its link, and against it on the one before
        self.prescribed: int | None = None
        last = len(machine.links) - 1
        before: int | None = None
        for i, (link, angle) in enumerate(zip(machine.links, machine.angles)):
            along = np.array([np.cos(angle), np.sin(angle)])
            count = 2 * self.setting.parts + 1
            nodes = [
                self.mbs.AddNode(
                    _item("NodeRigidBody2D")(
                        referenceCoordinates=[*(at + link.length * k / (count - 1) * along), angle],
                    )
                )
                for k in range(count)
            ]
            for k in range(0, count - 1, 2):
                self._element(link, nodes[k : k + 3])
            self._join(i, nodes[0], before)
            self._body(nodes[0], 0.0, machine.hub_inertia[i])
            load = (machine.joint_mass, 0.0) if i < last else (machine.payload.mass, machine.payload.inertia_z)
            self._body(nodes[-1], *load)
            if before is None:
                self.first = nodes[0]
            at, before = at + link.length * along, nodes[-1]
            self.tip = nodes[-1]
        if self.watched:
            kinds = self.exu.OutputVariableType
            self.seen = self._sensor(self.tip, kinds.Position)
            self.moving = self._sensor(self.tip, kinds.Velocity)
            self.turned = self._sensor(self.first, kinds.Rotation)

    def _sensor(self, node: int, kind: Any) -> int:
        sensor = _item("SensorNode")(nodeNumber=node, outputVariableType=kind, storeInternal=True)
        return self.mbs.AddSensor(sensor)

    def _element(self, link: Any, nodes: list[int]) -> None:
        beam = _item("ObjectBeamGeometricallyExact2D")(
            nodeNumbers=nodes,
            length=link.length / self.setting.parts,
            massPerLength=link.linear_density,
            crossSectionInertia=link.density * link.I_z,
            bendingStiffness=link.EI,
            axialStiffness=self.stiffer * link.E * link.area,
            shearStiffness=(1.0 if self.machine.sheared else self.stiffer) * link.shear_stiffness,
            bendingDamping=link.damping * link.EI,
            axialDamping=link.damping * link.E * link.area,
            shearDamping=link.damping * link.shear_stiffness,
            includeReferenceRotations=True,
        )
        self._weigh(self.mbs.AddObject(beam))

    def _body(self, node: int, mass: float, inertia: float) -> None:
        if mass or inertia:
            body = _item("ObjectRigidBody2D")(mass=mass, inertia=inertia, nodeNumber=node)
            self._weigh(self.mbs.AddObject(body))

    def _weigh(self, body: int) -> None:
        if any(self.machine.gravity):
            marker = self.mbs.AddMarker(_item("MarkerBodyMass")(bodyNumber=body))
            load = _item("LoadMassProportional")(markerNumber=marker, loadVector=[*self.machine.gravity, 0.0])
            self.mbs.AddLoad(load)

    def _coordinate(self, node: int, k: int) -> int:
        return self.mbs.AddMarker(_item("MarkerNodeCoordinate")(nodeNumber=node, coordinate=k))

    def _join(self, i: int, node: int, before: int | None) -> None:
        """The root of a link to the ground or to the tip of the link before, with motor and friction."""
        constraint, machine = _item("CoordinateConstraint"), self.machine
        still = self.mbs.AddNode(_item("NodePointGround")())
        fixed = self._coordinate(still, 0)
        if before is None:
            for k in (0, 1):
                self.mbs.AddObject(constraint(markerNumbers=[fixed, self._coordinate(node, k)]))
        else:
            pins = [self.mbs.AddMarker(_item("MarkerNodePosition")(nodeNumber=n)) for n in (before, node)]
            self.mbs.AddObject(_item("ObjectJointRevolute2D")(markerNumbers=pins))
        own = self._coordinate(node, 2)
        other = fixed if before is None else self._coordinate(before, 2)
        if i == 0 and machine.root != "torque":
            held = self.mbs.AddObject(constraint(markerNumbers=[fixed, own]))
            if machine.root == "motion":
                self.prescribed = held
            return
        if machine.friction[i]:
            damper = _item("CoordinateSpringDamper")
            self.mbs.AddObject(damper(markerNumbers=[other, own], damping=machine.friction[i]))
        load = _item("LoadCoordinate")
        pair = [self.mbs.AddLoad(load(markerNumber=own, load=0.0))]
        if before is not None:
            pair.append(self.mbs.AddLoad(load(markerNumber=other, load=0.0)))
        self.loads.append(pair)

    def _settings(self) -> Any:
        exu, machine, setting = self.exu, self.machine, self.setting
        settings, kinds = exu.SimulationSettings(), exu.LinearSolverType
        settings.linearSolver.solverType = kinds.EigenSparse if setting.solver.sparse else kinds.EigenDense
        settings.parallel.numberOfThreads = 1
        settings.show.statistics = settings.show.computationTime = False
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = 1e-9 if self.watched else 1e9
        integration = settings.timeIntegration
        integration.numberOfSteps, integration.endTime = machine.steps * setting.substeps, machine.duration
        integration.verboseMode = integration.stepInformation = 0
        integration.adaptiveStep = False
        integration.generalizedAlpha.spectralRadius = setting.solver.radius
        integration.newton.useModifiedNewton = setting.solver.modified
        integration.newton.relativeTolerance, integration.newton.absoluteTolerance = setting.solver.tolerance, 1e-6
        return settings

    def _before_step(self) -> Callable[[Any, float], bool] | None:
        """Sets the torques, or the prescribed angle, at a step's end."""
        machine, k = self.machine, self.setting.substeps
        if self.prescribed is not None:
            at = np.linspace(0.0, machine.duration, machine.steps * k + 1)
            angle, rate = machine.root_motion
            period = np.minimum((np.arange(len(at)) // k), machine.steps - 1)
            s = at - period * machine.dt
            offsets = (
                angle[period] + rate[period] * s + machine.held[period, 0] * s**2 / 2 - machine.angles[0]
            ).tolist()
            held = self.prescribed

            def turn(mbs: Any, t: float) -> bool:
                mbs.SetObjectParameter(held, "offset", offsets[round(t / step)])
                return True

            step = machine.dt / k
            return turn
        if not self.loads:
            return None
        torque = np.repeat(machine.held, k, axis=0)
        nodal = np.concatenate([torque[:1], (torque[:-1] + torque[1:]) / 2, torque[-1:]]).tolist()
        pairs, step = self.loads, machine.dt / k

        def drive(mbs: Any, t: float) -> bool:
            for pair, value in zip(pairs, nodal[round(t / step)]):
                mbs.SetLoadParameter(pair[0], "load", value)
                for other in pair[1:]:
                    mbs.SetLoadParameter(other, "load", -value)
            return True

        drive(self.mbs, 0.0)
        return drive

    def solve(self) -> float:
        """Seconds of a motion from the start."""
        before = self._before_step()
        if before is not None:
            self.mbs.SetPreStepUserFunction(before)
        begin = time.perf_counter()
        with contextlib.redirect_stdout(io.StringIO()):  # a failure's hints
            try:
                self.mbs.SolveDynamic(self.settings)
            except self.exu.SolverError as failure:
                raise BrokenDownError("Newton's method fails: the steps are too long") from failure
        return time.perf_counter() - begin

    def motion(self) -> Motion:
        """What the sensors saw."""
        return self._stored(self.seen)[:, 1:3], self._stored(self.turned)[:, -1]

    def tip_rate(self) -> np.ndarray:
        """(nt, 2) [m/s]"""
        return self._stored(self.moving)[:, 1:3]

    def _stored(self, sensor: int) -> np.ndarray:
        """Time, then the values, at the control times."""
        return np.asarray(self.mbs.GetSensorStoredData(sensor))[:: self.setting.substeps]


def _item(name: str) -> Any:
    from exudyn import itemInterface

    return getattr(itemInterface, name)
