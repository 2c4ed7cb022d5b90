"""Rigid computed torque, the naive rival: the inverse dynamics of the rigid plant, as if nothing bent.

u such that the rigid plant at the measured joints has the acceleration  a_ref + Kd (dr/dt - dy/dt) + Kp (r - y),
Kp = bandwidth^2, Kd = 2 damping bandwidth. On a rigid machine the error decays by that equation exactly.

Guarantee   none for a plant that bends.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, final

import casadi as ca
import numpy as np

from pliant.controllers.base.controller import reading, saturation
from pliant.controllers.base.joint_reference import Follow, Joints, RestToRest, joints, motion_of, require_reference
from pliant.controllers.base.scene_protocol import require_scene
from pliant.plants.core.argument_gates import require_instance, require_number, require_seconds
from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, index

from .collocation import accelerations

PATIENCE = 5.0  # bandwidth times the time of the motion, as a rigid arm would be tuned

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import CostedScene
    from pliant.plants.dynamics.plant import Plant


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ComputedTorque(OwnsArrays):
    """Made by `design` or `for_scene`; it reads the joints' positions, then their rates."""

    inverse: NumericFunction  # (positions and rates (2 nu,), accelerations (nu,)) -> u (nu,)
    reference: RestToRest | Follow
    joints: Joints
    bandwidth: float  # [rad/s]
    damping: float
    limits: Any = None
    dt: float | None = None

    def __post_init__(self) -> None:
        for name in ("bandwidth", "damping"):
            value = require_number(f"ComputedTorque.{name}", getattr(self, name), "positive")
            object.__setattr__(self, name, value)
        if self.dt is not None:
            object.__setattr__(self, "dt", require_seconds("ComputedTorque.dt", self.dt))
        require_instance("ComputedTorque.inverse", self.inverse, NumericFunction)
        require_reference("ComputedTorque", self.reference)
        require_instance("ComputedTorque.joints", self.joints, Joints)
        if len(self.reference.end) != len(self.joints.positions):
            raise ValueError(
                f"ComputedTorque.reference has {len(self.reference.end)} positions, must have "
                f"{len(self.joints.positions)}"
            )
        inputs = [f"u{i + 1}" for i in range(len(self.joints.positions))]
        object.__setattr__(self, "limits", saturation("ComputedTorque", self.limits, inputs))

    @property
    def reads(self) -> tuple[str, ...]:
        """Names of what `act` reads: joints, then their rates."""
        return self.joints.positions + self.joints.rates

    @classmethod
    def design(
        cls,
        plant: Plant,
        reference: RestToRest | Follow,
        *,
        bandwidth: float,
        damping: float = 1.0,
        limits: Any = None,
        dt: float | None = None,
    ) -> ComputedTorque:
        """On the rigid variant of any plant whose states are one joint an input, and their rates.

        PliantError where its states are others, a spacecraft's quaternion or a beam without joints, or where the inputs
        do not move them one by one at the reference's start.
        bandwidth [rad/s]; damping [-]; limits (nu, 2) [N m]; dt [s].
        """
        require_reference("ComputedTorque", reference)
        at = joints(plant)
        names, inverse = [s.name for s in plant.inputs], inverse_dynamics(plant, at)
        accelerations(plant, dict(zip(at.positions, reference(0.0)[0])), np.zeros(plant.nu), at.rates)
        return cls(
            inverse=inverse,
            reference=reference,
            joints=at,
            bandwidth=bandwidth,
            damping=damping,
            limits=saturation("ComputedTorque", limits, names),
            dt=dt,
        )

    @classmethod
    def for_scene(cls, scene: CostedScene, *, bandwidth: float | None = None, damping: float = 1.0) -> ComputedTorque:
        """Along the rigid motion of the scene. bandwidth [rad/s], None: 5 / move_time. damping: a ratio [-]."""
        require_scene("ComputedTorque.for_scene", scene)
        at, high = joints(scene.plant), np.array(scene.limits)
        return cls.design(
            scene.plant,
            motion_of(scene, at),
            bandwidth=PATIENCE / scene.move_time if bandwidth is None else bandwidth,
            damping=damping,
            limits=(-high, high),
            dt=scene.dt,
        )

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from positions and rates y (2 nu,) at time t [s]."""
        n = len(self.joints.positions)
        y = reading("ComputedTorque.y", y, 2 * n)
        r, dr, ddr = self.reference(t)
        wanted = ddr + 2 * self.damping * self.bandwidth * (dr - y[n:]) + self.bandwidth**2 * (r - y[:n])
        u = self.inverse(y, wanted)[0]
        if not isfinite(u.sum()):
            raise PliantError(f"ComputedTorque: at {y} the rigid plant's inputs do not reach its accelerations")
        return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])


def inverse_dynamics(plant: Plant, at: Joints) -> NumericFunction:
    """u (nu,) of the rigid variant from joints and rates (2 nu,) and accelerations (nu,)."""
    rigid = plant.ladder()[0]
    t, x, u, w, p = rigid.symbols
    names = at.positions + at.rates
    if {s.name for s in rigid.states} != set(names):
        raise PliantError(
            f"computed torque needs a rigid plant whose states are {names}, not {tuple(s.name for s in rigid.states)}"
        )
    places = [index(rigid.states, name, "state") for name in names]
    state, wanted = ca.SX.sym("state", len(names)), ca.SX.sym("wanted", len(at.rates))
    acceleration = rigid.expressions[0][places[len(at.positions) :]]
    push, free = ca.jacobian(acceleration, u), ca.substitute(acceleration, u, ca.SX.zeros(plant.nu))
    found = ca.solve(push, wanted - free)
    order = np.argsort(places).tolist()
    quiet = ca.SX.zeros(rigid.nw), ca.SX(rigid.nominal_parameters)
    for symbol, value in zip((t, x, w, p), (ca.SX(0), state[order], *quiet)):
        found = ca.substitute(found, symbol, value)
    return function("inverse", [state, wanted], [found])
