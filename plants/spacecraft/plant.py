"""Flexible spacecraft: a rigid hub with any number of hinged flexible appendages.

States   x = [position, quaternion, hinge angles, eta, velocity, body rates, hinge rates, eta rates, wheel momenta];
         position and velocity of the hub's mass centre in reference axes (inertial, or the orbit's), quaternion
         scalar first from body to reference axes, rates of the hub relative to inertial space in its own axes
Inputs   wheel torques on the hub [N m], thrusts [N] (three torques [N m] without either), then hinge inputs
Outputs  attitude (twice the quaternion's vector: the rotation vector when small), body rates, each appendage's tip
         deflection
Valid    nonlinear in the motion of hub and hinges, linear in the elastic coordinates ("stiffened": with the
         second-order shortening): slopes of appendages up to 0.3 rad, see `ranges`
Source   "Equations of Motion of Flexible Spacecraft", corrected; see `spacecraft_perturbation` for its linear model
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import real_array, require_finite
from pliant.plants.core.casadi_functions import NumericFunction, built_once, function
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics import arguments
from pliant.plants.dynamics.mechanical import BalancedPlant
from pliant.plants.dynamics.residual_jacobians import Differentiated
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.hub import Hub
from pliant.plants.validity.appendages import of_appendage
from pliant.plants.validity.ranges import Range

from . import energies, equations, forces, linearisation
from .contract import SpacecraftContract
from .jacobian_blocks import differentiated, residual_function


@dataclass(frozen=True, kw_only=True)
class FlexibleSpacecraft(SpacecraftContract, BalancedPlant):
    """M(theta, eta) (a, alpha, theta'', eta'') + bias = loads; d(quaternion)/dt = Xi omega / 2; d(position)/dt =
    velocity.
    """

    @classmethod
    def textbook(cls) -> Self:
        """A 500 kg hub with two 5 m booms along +-x, each with two modes out of plane and one in plane.

        Made to be checked by hand: rho A = 2 kg/m, EI = 100 N m^2 out of plane and 400 in plane, root 1 m off the
        centre.
        """
        boom = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
        turned = ((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
        right = Appendage(position=(1.0, 0.0, 0.0), body=boom, modes=(1, 2))
        left = Appendage(position=(-1.0, 0.0, 0.0), orientation=turned, body=boom, modes=(1, 2))
        return cls(hub=Hub(mass=500.0, inertia=(200.0, 150.0, 180.0)), appendages=(right, left))

    def ode(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        return equations.rate(self, t, x, u, w)[0]

    def coordinate_rates(self, x: ca.SX) -> ca.SX:
        return equations.coordinate_rates(self.symbolic, x)

    @property
    def speed_count(self) -> int:
        return self.nx - self.layout.velocity.start

    @property
    def driven(self) -> dict[int, int]:
        """Rates of hinges in given motion."""
        at, found = self.layout, dict[int, int]()
        for body, hinges, inputs in zip(self.appendages, at.hinge_rates, at.hinge_inputs, strict=True):
            if body.hinge.drive == "motion":
                first = hinges.start - at.velocity.start
                found |= {first + j: inputs.start + j for j in range(hinges.stop - hinges.start)}
        return found

    def balance(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        return forces.balance(self, t, x, u, w, a)

    @built_once
    def _motion(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, smallest pivot of the mass matrix): the pivot is positive where the matrix is definite."""
        return equations.rate(self.symbolic, *self.symbols[:4])

    def _lost_at(self, x: np.ndarray) -> str:
        return (
            ": an appendage has no inertia about one of its hinge's axes, or two of these are parallel there, "
            f"at x = {x}"
        )

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """Small slopes of each appendage; without stiffening also the shortening and the spin that it leaves out."""
        at, found = self.layout, list[Range]()
        for i, body in enumerate(self.appendages):
            theta, rate = x[at.hinges[i]], x[at.hinge_rates[i]]
            C = body.turn(theta)
            omega = C.T @ x[at.omega] + body.hinge_rates(theta) @ rate
            root, stiffened = C.T @ ca.vertcat(*body.position), self.kinematics == "stiffened"
            data, eta, name = self.nominal_data(i), x[at.modes[i]], f"appendage {i + 1}"
            found += of_appendage(name, data, eta, omega, root, body.stiffness_factor, stiffened)
        return tuple(found)

    def _differentiated(self) -> Differentiated:
        return differentiated(self)

    @built_once
    def _conserved(self) -> NumericFunction:
        return function("conserved", list(self.symbols), list(energies.conserved(self.symbolic, self.symbols[1])))

    @built_once
    def _residual(self) -> NumericFunction:
        return residual_function(self)

    def energy(self, x: Any, *, p: Any = None) -> Any:
        """Kinetic and strain energy [J], a scalar or (B,): of the motion in the reference axes, or without
        translation of that about the whole's mass centre.
        """
        values, batch = self._arguments(x, p=p)
        return arguments.told(self, "energy", self._conserved(*values, batch=batch)[:1], values[1])[0][..., 0]

    def momentum(self, x: Any, *, p: Any = None) -> tuple[Any, Any]:
        """Linear [N s] and angular momentum about the reference origin [N m s], (3,) or (B, 3), in reference axes.

        Without translation: zero, and the angular momentum about the whole's mass centre.
        """
        values, batch = self._arguments(x, p=p)
        _, linear, angular = self._conserved(*values, batch=batch)
        arguments.told(self, "momentum", [linear, angular], values[1])
        return linear, angular

    @built_once
    def _powers(self) -> tuple[ca.SX, ca.SX]:
        return energies.power(self.symbolic, *self.symbols[:4])

    def residual(self, x: Any, a: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> np.ndarray:
        """M a + bias - loads (6 + n,) at any accelerations a = [hub (hub axes), body rates', hinges, modes] (6 +
        n,).
        """
        values, batch = self._arguments(x, u, w, p, t)
        a = real_array("FlexibleSpacecraft.a", a)
        size = (6 + len(self.coordinates),)
        a = require_finite("FlexibleSpacecraft.a", a, size if batch is None or a.ndim == 1 else (batch, *size))
        found = self._residual(*values, a, batch=batch)
        return arguments.told(self, "residual", found, values[1])[0]

    def mass_matrix(self, x: Any, *, p: Any = None) -> np.ndarray:
        """M (6 + n, 6 + n): hub translation and rotation in hub axes, hinges, modes. In [kg], [kg m] and [kg m^2]."""
        values, batch = self._arguments(x, p=p)
        n = 6 + len(self.coordinates)
        zero = np.zeros(n) if batch is None else np.zeros((batch, n))
        return arguments.told(self, "mass_matrix", self._residual(*values, zero, batch=batch)[1:], values[1])[0]

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[np.ndarray, np.ndarray]:
        """A rest point as in Plant.equilibrium; attitude and position are held, at zero turn where they are not
        named. `fixed`, `guess` and `named` as there. The state (nx,) and the inputs (nu,).
        """
        held = {f"quaternion_{k}": float(k == 0) for k in range(4)}
        held |= {s.name: 0.0 for s in self.states[:3] if self.translation}
        return super().equilibrium({**held, **(fixed or {}), **named}, guess=guess, p=p)

    def natural_frequencies(self, x0: Any = None, *, locked: tuple[str, ...] = (), p: Any = None) -> np.ndarray:
        """Undamped natural frequencies [rad/s] of the free spacecraft at rest at x0, ascending, without rigid-body
        modes. ValueError where `locked` is not empty.
        """
        if locked:
            raise ValueError(f"FlexibleSpacecraft.natural_frequencies: locked = {locked} must be (): it is free")
        return linearisation.natural_frequencies(self, self.state() if x0 is None else x0, p)

    def _accelerations(self, nominal: Trajectory, p: Any) -> np.ndarray:
        return linearisation.nominal_accelerations(self, nominal, p)
