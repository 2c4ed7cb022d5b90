"""Flexible spacecraft: a rigid hub with any number of hinged flexible appendages.

States   x = [position, quaternion, hinge angles, eta, velocity, body rates, hinge rates, eta rates, wheel momenta];
         position and velocity of the hub's mass centre in reference axes (inertial, or the orbit's), quaternion
         scalar first from body to reference axes, rates of the hub relative to inertial space in its own axes
Inputs   wheel torques on the hub [N m], thrusts [N] (three torques [N m] without either), then hinge inputs
Outputs  attitude (twice the quaternion's vector: the rotation vector when small), body rates, each appendage's tip
         deflection
Valid    nonlinear in the motion of hub and hinges, linear in the elastic coordinates ("stiffened": with the
         second-order shortening)
Source   "Equations of Motion of Flexible Spacecraft", corrected; see `perturbation` for its linear model
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Self

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.parameters import quantities, require_choice, validate
from pliant.plants.core.quaternions import matrix
from pliant.plants.core.signals import Joint, Sensed, Signal, Unfelt, index, names
from pliant.plants.dynamics.mechanical import MechanicalPlant
from pliant.plants.dynamics.residual_jacobians import Differentiated
from pliant.plants.modal_data.modal_data import ModalData

from . import layout as equations
from .appendage import Appendage, Hinge, constant
from .eigenaxis import slew
from .environment import Environment, Orbit, Sun, Surface
from .hub import Hub, Thruster, Wheel

if TYPE_CHECKING:
    from pliant.plants.core.trajectory import Trajectory
    from pliant.plants.linear.lti import LinearModel
    from pliant.plants.linear.ltv import LTVModel

__all__ = [
    "Appendage",
    "Environment",
    "FlexibleSpacecraft",
    "Hinge",
    "Hub",
    "ModalData",
    "Orbit",
    "Sun",
    "Surface",
    "Thruster",
    "Wheel",
]
KINEMATICS = ("rigid", "linear", "stiffened")
Attitude = Literal["rotation", "quaternion"]
ATTITUDES = ("rotation", "quaternion")
UNIT = 1e-3  # how far from 1 the norm of a quaternion that is given may be
AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class FlexibleSpacecraft(MechanicalPlant):
    """M(theta, eta) (a, alpha, theta'', eta'') + bias = loads; d(quaternion)/dt = Xi omega / 2; d(position)/dt =
    velocity.
    """

    hub: Hub
    appendages: tuple[Appendage, ...] = ()
    kinematics: str = "stiffened"
    translation: bool = True  # False: position and velocity are no states; the hub still moves with the loads
    environment: Environment = field(default_factory=Environment)

    def __post_init__(self) -> None:
        validate(self)
        require_choice("FlexibleSpacecraft", "kinematics", self.kinematics, KINEMATICS)
        if not isinstance(self.hub, Hub):
            raise ValueError(f"FlexibleSpacecraft.hub = {self.hub!r} must be a Hub")
        if not isinstance(self.appendages, (tuple, list)) or not all(isinstance(a, Appendage) for a in self.appendages):
            raise ValueError(f"FlexibleSpacecraft.appendages = {self.appendages!r} must be a tuple of Appendage")
        if not isinstance(self.environment, Environment):
            raise ValueError(f"FlexibleSpacecraft.environment = {self.environment!r} must be an Environment")
        require_choice("FlexibleSpacecraft", "translation", self.translation, (True, False))
        object.__setattr__(self, "appendages", tuple(self.appendages))

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

    # --- what stands where ---------------------------------------------------------------------------------------
    @cached_property
    def mode_counts(self) -> tuple[int, ...]:
        """Elastic coordinates of each appendage."""
        own = self.nominal
        return tuple(0 if self.kinematics == "rigid" else a.data.n for a in own.appendages)

    @cached_property
    def layout(self) -> equations.Layout:
        """Where states and inputs stand in x and u."""
        own = self.nominal
        return equations.Layout.of(own)

    @cached_property
    def deviations(self) -> tuple[Signal, ...]:
        """The states of its linear models, see `spacecraft_linear`."""
        place = tuple(Signal(f"p_{c}", "m") for c in AXES if self.translation)
        y = (*place, *(Signal(f"q_{c}", "rad") for c in AXES), *self.coordinates)
        return y + tuple(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in y) + self.states[self.layout.wheels]

    def nominal_data(self, i: int) -> ModalData:
        """Modal data of appendage i, those in use."""
        own = self.nominal
        return own.appendages[i].data

    @property
    def coordinates_slice(self) -> slice:
        """Position, attitude, hinge angles, elastic coordinates."""
        return slice(0, self.layout.quaternion.stop + len(self.coordinates))

    @cached_property
    def coordinates(self) -> tuple[Signal, ...]:
        """Hinge angles, then elastic coordinates."""
        named = list(enumerate(self.appendages, start=1))
        angles = [Signal(f"hinge{i}_{j + 1}", "rad") for i, a in named for j in range(a.hinge.n)]
        modes = [Signal(f"eta{i}_{k + 1}", "m") for (i, _), n in zip(named, self.mode_counts) for k in range(n)]
        return (*angles, *modes)

    @cached_property
    def states(self) -> tuple[Signal, ...]:
        moved = self.translation
        position = tuple(Signal(f"position_{c}", "m") for c in AXES if moved)
        velocity = tuple(Signal(f"velocity_{c}", "m/s") for c in AXES if moved)
        quaternion = tuple(Signal(f"quaternion_{k}", "1") for k in range(4))
        body = tuple(Signal(f"rate_{c}", "rad/s") for c in AXES)
        speeds = tuple(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in self.coordinates)
        wheels = tuple(Signal(f"wheel{k + 1}_momentum", "N m s") for k in range(len(self.hub.wheels)))
        return position + quaternion + self.coordinates + velocity + body + speeds + wheels

    @cached_property
    def inputs(self) -> tuple[Signal, ...]:
        found = [Signal(f"wheel{k + 1}_torque", "N m") for k in range(len(self.hub.wheels))]
        found += [Signal(f"thrust{k + 1}", "N") for k in range(len(self.hub.thrusters))]
        found = found or [Signal(f"torque_{c}", "N m") for c in AXES]
        kinds = {"torque": ("torque", "N m"), "angle": ("command", "rad"), "motion": ("acceleration", "rad/s^2")}
        for i, a in enumerate(self.appendages, start=1):
            if a.hinge.drive != "free":
                word, unit = kinds[a.hinge.drive]
                found += [Signal(f"hinge{i}_{j + 1}_{word}", unit) for j in range(a.hinge.n)]
        return tuple(found)

    @cached_property
    def disturbances(self) -> tuple[Signal, ...]:
        """Force on the hub's mass centre in reference axes, torque in hub axes."""
        return tuple(Signal(f"force_{c}", "N") for c in AXES) + tuple(Signal(f"disturbance_{c}", "N m") for c in AXES)

    @cached_property
    def outputs(self) -> tuple[Signal, ...]:
        found = [Signal(f"attitude_{c}", "1") for c in AXES] + [Signal(f"body_rate_{c}", "rad/s") for c in AXES]
        for i in range(1, len(self.appendages) + 1):
            found += [Signal(f"tip{i}_{c}", "m") for c in AXES]
        return tuple(found)

    # --- what the library asks of a plant ------------------------------------------------------------------------
    @cached_property
    def rates(self) -> dict[str, str]:
        return {s.name: f"{s.name}_rate" for s in self.coordinates}

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """Of its linear models too."""
        at, n = self.layout, (len(self.deviations) - len(self.hub.wheels)) // 2
        own = (*names(self.states[at.velocity]), *names(self.states[at.omega]))
        return (*own, *names(self.deviations[n : 2 * n]))

    @cached_property
    def prescribed(self) -> tuple[str, ...]:
        slots = zip(self.appendages, self.layout.hinges, strict=True)
        return tuple(s.name for a, at in slots if a.hinge.drive == "motion" for s in self.states[at])

    @property
    def lockable(self) -> tuple[str, ...]:
        """None: what a goal names turns the whole, which stays free."""
        return ()

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """A torque, or a wheel about a hub axis, and the attitude about that axis; a hinge's input and its angle."""
        at, found = self.layout, []
        for s, axis in zip(self.inputs[at.hub_inputs], self.hub.axes, strict=True):
            if axis is not None:
                found.append(Joint(s.name, f"attitude_{axis}", f"body_rate_{axis}"))
        for inputs, hinges in zip(at.hinge_inputs, at.hinges, strict=True):
            for s, angle in zip(self.inputs[inputs], names(self.states[hinges])):
                found.append(Joint(s.name, angle, self.rates[angle]))
        return tuple(found)

    def sensors(self) -> tuple[Sensed, ...]:
        """Star tracker, gyro, tachometers of the wheels, encoders of the hinges; not the place."""
        stars = (Sensed("star tracker", name, "rad") for name in self.attitude_outputs)
        gyros = (Sensed("fibre-optic gyro", s.name) for s in self.outputs[3:6])
        wheels = zip(self.states[self.layout.wheels], self.hub.wheels, strict=True)
        speeds = (Sensed("tachometer", s.name, scale=float(wheel.inertia)) for s, wheel in wheels)
        angles = (Sensed("encoder", s.name) for at in self.layout.hinges for s in self.states[at])
        return (*stars, *gyros, *speeds, *angles)

    @property
    def tips(self) -> tuple[str, ...]:
        """The outputs that are components of the tips' deflections."""
        return names(self.outputs[6:])

    @property
    def attitude_states(self) -> tuple[str, ...]:
        return names(self.states[self.layout.quaternion])

    @property
    def attitude_outputs(self) -> tuple[str, ...]:
        return names(self.outputs[:3])

    @property
    def uncertain(self) -> tuple[str, ...]:
        own = tuple(enumerate(self.appendages))
        parts = (f"appendages.{i}.{path}" for i, a in own for path in quantities(a, uncertain=True))
        return (*quantities(self, uncertain=True), *parts)

    @property
    def unfelt(self) -> Unfelt:
        """Place and attitude, in the plant's states or in deviations; hinges in given motion; wheels at a speed."""
        place = (*(f"p_{c}" for c in AXES), *names(self.states[self.layout.position]))
        given = (*self.prescribed, *(self.rates[name] for name in self.prescribed))
        turn = tuple(f"q_{c}" for c in AXES)
        return Unfelt((place, self.attitude_states, turn), given, names(self.states[self.layout.wheels]))

    @property
    def drawn_as(self) -> str:
        return "spacecraft"

    def rest_to_rest(self, begin: np.ndarray, end: np.ndarray, time: float) -> Callable[[float], np.ndarray]:
        """A turn about one axis fixed in the body (an eigenaxis slew), hinges as at `begin`; see `eigenaxis`."""
        return slew(self, begin, end, time)

    @property
    def label(self) -> str:
        bodies = f"{len(self.appendages)} appendages"
        place = "" if self.translation else ", rotation only"
        if self.kinematics == "rigid":
            return f"rigid, {bodies}{place}"
        return f"{self.kinematics}, {bodies}, {sum(self.mode_counts)} modes{place}"

    def ladder(self) -> tuple[Self, ...]:
        """Rigid, then one mode of each appendage, its own, and all that its modal data hold; linear and stiffened."""
        few = tuple(dataclasses.replace(a, modes=None, body=a.data.slowest(min(1, a.data.n))) for a in self.appendages)
        all_modes = tuple(
            dataclasses.replace(a, modes=None) if isinstance(a.body, ModalData) else a for a in self.appendages
        )
        sets = [few] if any(a.data.n > 1 for a in self.appendages) else []
        sets.append(self.appendages)
        if any(a.data.n > b.data.n for a, b in zip(all_modes, self.appendages)):
            sets.append(all_modes)
        steps = [dataclasses.replace(self, kinematics="rigid")]
        for kinematics in ("linear", "stiffened"):
            steps += [dataclasses.replace(self, kinematics=kinematics, appendages=bodies) for bodies in sets]
        return tuple(steps)

    def state(self, values: Mapping[str, float] | None = None, **named: float) -> np.ndarray:
        """x (nx,) with these states by name; the others at rest with body and reference axes aligned."""
        x = np.zeros(self.nx)
        x[self.layout.quaternion.start] = 1.0
        for name, value in {**(values or {}), **named}.items():
            x[index(self.states, name, "state")] = value
        return x

    # --- equations -----------------------------------------------------------------------------------------------
    def ode(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        return equations.rate(self, t, x, u, w)[0]

    @cached_property
    def _motion(self) -> tuple[ca.SX, ca.SX]:
        """(dx/dt, smallest pivot of the mass matrix): the pivot is positive where the matrix is definite."""
        return equations.rate(self.symbolic, *self.symbols[:4])

    def _lost_at(self, x: np.ndarray) -> str:
        return (
            ": an appendage has no inertia about one of its hinge's axes, or two of these are parallel there, "
            f"at x = {x}"
        )

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        at, found = self.layout, [2 * x[self.layout.quaternion][1:], x[self.layout.omega]]
        for i, a in enumerate(self.appendages):
            eta = x[at.modes[i]]
            found.append(constant(a.data.tip_shapes[: eta.shape[0]].T) @ eta if eta.shape[0] else ca.SX.zeros(3))
        return ca.vertcat(*found)

    def _differentiated(self) -> Differentiated:
        return equations.differentiated(self)

    @cached_property
    def _conserved(self) -> NumericFunction:
        return function("conserved", list(self.symbols), list(equations.conserved(self.symbolic, self.symbols[1])))

    @cached_property
    def _residual(self) -> NumericFunction:
        return equations.residual_function(self)

    def energy(self, x: Any, *, p: Any = None) -> Any:
        """Kinetic and strain energy [J], a scalar or (B,): of the motion in the reference axes, or without
        translation of that about the whole's mass centre.
        """
        values, batch = self._arguments(x, p=p)
        return self._conserved(*values, batch=batch)[0][..., 0]

    def momentum(self, x: Any, *, p: Any = None) -> tuple[Any, Any]:
        """Linear [N s] and angular momentum about the reference origin [N m s], (3,) or (B, 3), in reference axes.

        Without translation: zero, and the angular momentum about the whole's mass centre.
        """
        values, batch = self._arguments(x, p=p)
        _, linear, angular = self._conserved(*values, batch=batch)
        return linear, angular

    @cached_property
    def _powers(self) -> tuple[ca.SX, ca.SX]:
        return equations.power(self.symbolic, *self.symbols[:4])

    def residual(self, x: Any, a: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> np.ndarray:
        """M a + bias - loads (6 + n,) at any accelerations a = [hub (hub axes), body rates', hinges, modes] (6 +
        n,).
        """
        values, batch = self._arguments(x, u, w, p, t)
        return self._residual(*values, np.asarray(a, dtype=float), batch=batch)[0]

    def mass_matrix(self, x: Any, *, p: Any = None) -> np.ndarray:
        """M (6 + n, 6 + n): hub translation and rotation in hub axes, hinges, modes."""
        values, batch = self._arguments(x, p=p)
        n = 6 + len(self.coordinates)
        zero = np.zeros(n) if batch is None else np.zeros((batch, n))
        return self._residual(*values, zero, batch=batch)[1]

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[np.ndarray, np.ndarray]:
        """A rest point as in Plant.equilibrium; attitude and position are held, at zero turn where they are not
        named.
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
        from .linearisation import natural_frequencies

        return natural_frequencies(self, self.state() if x0 is None else x0, p)

    # --- linear models -------------------------------------------------------------------------------------------
    def linearize(
        self, x0: Any, u0: Any = None, *, w: Any = None, p: Any = None, t: float = 0.0, attitude: Attitude = "rotation"
    ) -> LinearModel:
        """The linear model at (x0, u0). attitude "rotation": deviations are [p, q, hinges, eta] and their rates, see
        `spacecraft_linear`; "quaternion": the plant's own states, as for any plant.
        """
        require_choice("linearize", "attitude", attitude, ATTITUDES)
        if attitude == "quaternion":
            self.check_state(np.asarray(x0, dtype=float))
            return super().linearize(x0, u0, w=w, p=p, t=t)
        from .linearisation import linearize

        return linearize(self, x0, u0, w, p, t)

    def linearize_along(self, nominal: Trajectory, *, p: Any = None, attitude: Attitude = "rotation") -> LTVModel:
        """The time-varying model about any nominal motion of this plant's states, as `linearize`."""
        require_choice("linearize_along", "attitude", attitude, ATTITUDES)
        if attitude == "quaternion":
            return super().linearize_along(nominal, p=p)
        from .linearisation import linearize_along

        return linearize_along(self, nominal, p)

    def _accelerations(self, nominal: Trajectory, p: Any) -> np.ndarray:
        from .linearisation import nominal_accelerations

        return nominal_accelerations(self, nominal, p)

    def jump_map(
        self, x: np.ndarray, P: np.ndarray, *, after: np.ndarray, p: Any = None, t: float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """As of any plant, in this one's deviations [y, dy/dt, wheels]."""
        from .linearisation import jump_in_deviations

        return jump_in_deviations(self, x, after, super().jump_map(x, P, after=after, p=p, t=t), t)

    def feedback_model(self, x0: Any, u0: Any = None, *, p: Any = None) -> LinearModel:
        """The linear model in signals: attitude outputs for the quaternion, rates relative to inertial space.

        Where the attitude turns at (x0, u0) it is left out; ValueError where the rest feels it.
        """
        from .feedback_model import feedback_model

        return feedback_model(self, x0, u0, p)

    def check_state(self, x: np.ndarray) -> None:
        """Raise ValueError where the quaternion of x (..., nx) is not of unit length."""
        norm = np.atleast_1d(np.linalg.norm(x[..., self.layout.quaternion], axis=-1))
        worst = float(norm[np.argmax(np.abs(norm - 1))])
        if not abs(worst - 1) <= UNIT:
            raise ValueError(f"FlexibleSpacecraft.x: the quaternion has norm {worst:.6g}, must be 1; see `state`")

    def consistent(self, x: np.ndarray) -> np.ndarray:
        """x (..., nx) with a unit quaternion: no turn where it is zero."""
        x, s = np.array(x, dtype=float), self.layout.quaternion
        x[..., s.start] += (x[..., s] == 0).all(axis=-1)
        x[..., s] /= np.linalg.norm(x[..., s], axis=-1, keepdims=True)
        return x

    def turn(self, x: Any) -> np.ndarray:
        """R (3, 3), hub axes to reference axes, at a state x (nx,)."""
        return np.array(ca.DM(matrix(ca.SX(ca.DM(np.asarray(x)[self.layout.quaternion])))))

    def outline(self, x: np.ndarray, points: int = 30) -> list[np.ndarray]:
        """Lines (m, 3) [m] of the appendages in reference axes at a state x (nx,), for drawing; m is their data's."""
        return equations.outline(self, np.asarray(x, dtype=float))
