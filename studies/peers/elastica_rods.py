"""PyElastica: one Cosserat rod through all links, explicit steps of position Verlet.

Elements are those of `rigid_segments`, so that curvature sits in the middle of a link's parts; a joint is a node at
which the rod does not resist bending. Kelvin and Voigt's damping is a couple between elements. Shear waves across a
thin section set the step: a rod that is softer in shear and along its axis than the link, and has more rotary inertia,
may take longer ones, which is searched too.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from .planar_machine import Machine
from .programs import BrokenDownError, Motion, Player, Setting
from .rigid_segments import segments

ACROSS = 0  # the director along z, about which all turns


@dataclass(frozen=True)
class Softened:
    """Shear and axial stiffness over this, the sections' rotary inertia times it."""

    by: float = 1.0

    def __str__(self) -> str:
        return f"shear and axial stiffness / {self.by:g}, rotary inertia x {self.by:g}" if self.by != 1.0 else ""


class Rods:
    """CosseratRod under PositionVerlet, a call a step, as its own `integrate` makes them."""

    peer = "PyElastica, Cosserat rod"
    package = "elastica"
    part = "bending nodes"

    def why_not(self, machine: Machine) -> str:
        return ""

    def parts(self, machine: Machine) -> tuple[int, ...]:
        return 3, 4, 6, 8, 12, 16, 24, 32

    def solvers(self) -> tuple[Softened, ...]:
        return Softened(3.0), Softened(10.0), Softened(30.0), Softened(100.0), Softened(300.0)

    def beside(self, solver: Softened) -> tuple[Softened, ...]:
        return ()

    def player(self, machine: Machine, setting: Setting) -> Player:
        def play() -> tuple[Motion, float]:
            return _Rod(machine, setting).motion()

        _Rod(machine, setting).one_step()  # what Numba compiles on the way is no part of a run
        return Player(play, lambda: play()[1])


class _Rod:
    """The rod in a collection of systems, at its start."""

    def __init__(self, machine: Machine, setting: Setting) -> None:
        import elastica

        self.ea, self.machine, self.setting, self.period = elastica, machine, setting, 0
        self.rod = self._made()

        class Systems(
            elastica.BaseSystemCollection,
            elastica.Constraints,
            elastica.Forcing,
        ):
            pass

        self.systems = Systems()
        self.systems.append(self.rod)
        if any(machine.gravity):
            weight = np.array([*machine.gravity, 0.0])
            self.systems.add_forcing_to(self.rod).using(elastica.GravityForces, acc_gravity=weight)
        self._load()
        self._hold()
        self.systems.finalize()

    def _made(self) -> Any:
        machine, n, soft = self.machine, self.setting.parts + 1, self.setting.solver.by
        links = machine.links
        lengths = np.array([s.length for s in segments(machine, n - 1)])
        angles = np.repeat(machine.angles, n)
        along = np.array([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
        nodes = np.concatenate([np.zeros((3, 1)), np.cumsum(along * lengths, axis=1)], axis=1)
        rod = self.ea.CosseratRod.straight_rod(
            len(lengths),
            nodes[:, 0],
            along[:, 0],
            np.array([0.0, 0.0, 1.0]),
            lengths.sum(),
            0.01 * links[0].length,
            links[0].density,
            youngs_modulus=links[0].E,
            shear_modulus=links[0].G,
            position=nodes,
            directors=self._directors(angles),
        )
        rod.mass[:] = 0.0
        for i, link in enumerate(links):
            at = slice(i * n, (i + 1) * n)
            rod.mass[at] += link.linear_density * lengths[at] / 2
            rod.mass[i * n + 1 : (i + 1) * n + 1] += link.linear_density * lengths[at] / 2
            rod.shear_matrix[0, 0, at] = rod.shear_matrix[1, 1, at] = link.shear_stiffness / soft
            rod.shear_matrix[2, 2, at] = link.E * link.area / soft
            inner, part = slice(i * n, (i + 1) * n - 1), link.length / (n - 1)
            over = rod.rest_voronoi_lengths[inner]  # kappa is the turn over this, the curvature the turn over a part
            inertia = soft * link.density * link.I_z * lengths[at]
            inertia[0] += machine.hub_inertia[i]
            inertia[-1] += machine.payload.inertia_z if i == len(links) - 1 else 0.0
            for k in range(3):
                rod.bend_matrix[k, k, inner] = link.EI * over / part
                rod.mass_second_moment_of_inertia[k, k, at] = inertia
                rod.inv_mass_second_moment_of_inertia[k, k, at] = 1 / inertia
            if i:
                rod.bend_matrix[:, :, i * n - 1] = 0.0
                rod.mass[i * n] += machine.joint_mass
        rod.mass[-1] += machine.payload.mass
        return rod

    @staticmethod
    def _directors(angles: np.ndarray) -> np.ndarray:
        """(3, 3, elements): rows along z, across and along the element."""
        c, s, still = np.cos(angles), np.sin(angles), np.zeros_like(angles)
        return np.array([[still, still, still + 1], [s, -c, still], [c, s, still]])

    def _load(self) -> None:
        """Motors, friction at the joints, damping of the links."""
        own, machine, n = self, self.machine, self.setting.parts + 1
        motors = list(range(len(machine.links))) if machine.root == "torque" else []
        damped = any(link.damping for link in machine.links)
        couple = self.rod.bend_matrix[ACROSS, ACROSS] / self.rod.rest_voronoi_lengths
        for i, link in enumerate(machine.links):
            couple[i * n : (i + 1) * n - 1] *= link.damping

        class Load(self.ea.NoForces):  # type: ignore[name-defined]
            def apply_torques(self, system: Any, time: float = 0.0) -> None:
                torques, turning = system.external_torques[ACROSS], system.omega_collection[ACROSS]
                for i in motors:
                    at = i * n
                    before = turning[at - 1] if i else 0.0
                    torque = machine.held[own.period, i] - machine.friction[i] * (turning[at] - before)
                    torques[at] += torque
                    if i:
                        torques[at - 1] -= torque
                if damped:
                    moment = couple * np.diff(turning)
                    torques[:-1] += moment
                    torques[1:] -= moment

        if motors or damped:
            self.systems.add_forcing_to(self.rod).using(Load)

    def _hold(self) -> None:
        own, machine, free = self, self.machine, self.machine.root == "torque"
        angle, rate = machine.root_motion

        class Root(self.ea.ConstraintBase):  # type: ignore[name-defined]
            def constrain_values(self, system: Any, time: float) -> None:
                system.position_collection[:, 0] = 0.0
                if not free:
                    k = own.period
                    s = time - k * machine.dt
                    turned = angle[k] + (rate[k] + own.pushed(k) * s / 2) * s
                    c, s = np.cos(turned), np.sin(turned)
                    system.director_collection[1:, :2, 0] = ((s, -c), (c, s))

            def constrain_rates(self, system: Any, time: float) -> None:
                system.velocity_collection[:, 0] = 0.0
                if not free:
                    k = own.period
                    system.omega_collection[ACROSS, 0] = rate[k] + own.pushed(k) * (time - k * machine.dt)

        self.systems.constrain(self.rod).using(Root)

    def pushed(self, k: int) -> float:
        """Acceleration of a prescribed root [rad/s^2]."""
        return float(self.machine.held[k, 0]) if self.machine.root == "motion" else 0.0

    def one_step(self) -> None:
        """The first."""
        with np.errstate(all="ignore"):
            step = np.float64(self.machine.dt / self.setting.substeps)
            self.ea.PositionVerlet().step(self.systems, np.float64(0.0), step)

    def motion(self) -> tuple[Motion, float]:
        """From the start."""
        machine, k, stepper = self.machine, self.setting.substeps, self.ea.PositionVerlet()
        tips, angles = [self.rod.position_collection[:2, -1].copy()], [machine.angles[0]]
        step, seconds, t = np.float64(machine.dt / k), 0.0, np.float64(0.0)
        reach = sum(link.length for link in machine.links)
        with np.errstate(all="ignore"):
            for self.period in range(machine.steps):
                begin = time.perf_counter()
                t = np.float64(self.period * machine.dt)
                for _ in range(k):
                    t = stepper.step(self.systems, t, step)
                seconds += time.perf_counter() - begin
                tips.append(self.rod.position_collection[:2, -1].copy())
                if not np.abs(tips[-1]).max() < 2.0 * reach:
                    raise BrokenDownError("the steps are too long")
                along = self.rod.director_collection[2, :2, 0]
                angles.append(np.arctan2(along[1], along[0]))
        return (np.array(tips), np.unwrap(angles)), seconds
