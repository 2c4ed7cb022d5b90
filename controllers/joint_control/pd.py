"""Collocated proportional-derivative control, the baseline that a flexible machine does not make unstable.

u = u_ff(t) + Kp (r - y) + Kd (dr/dt - dy/dt)

y are the joints that the inputs drive, u_ff the rigid plant's inverse dynamics along the reference r. With positive
definite gains and no sampling, a collocated loop only takes energy out of the elastic modes, however many (Gevarter
1970, "Basic relations for control of flexible vehicles"). Sampled, Kd must stay below about 2 / dt of what turns at
once, the bare hub: that limit binds first where links are heavy and hubs are light, so `for_scene` chooses the gains
on the sampled loop. A shaper on the reference keeps the modes of the closed loop quiet too.

Where more inputs than joints drive these together, as four wheels a spacecraft, or none alone, the bracket is an
acceleration of each joint and `share` the least inputs that give it.

Guarantee   none once sampled: a continuous collocated PD is passive, its sampled one is not; delay ruins it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, final

import numpy as np
from scipy.optimize import minimize

from pliant.controllers.base.controller import reading, saturation
from pliant.controllers.base.joint_reference import (
    Follow,
    Joints,
    RestToRest,
    driven,
    motion_of,
    require_reference,
    values_of,
)
from pliant.controllers.base.scene_protocol import require_scene
from pliant.plants.core.argument_gates import (
    require_choice,
    require_finite,
    require_instance,
    require_names,
    require_number,
    require_seconds,
    shown,
)
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, read_only
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.conserved import conserved, moved
from pliant.plants.linear.lti import LinearModel

from .collocation import loop_eigenvalues, rigid_inertia, rigid_state, rows, sharing
from .computed_torque import inverse_dynamics
from .input_shaping import KINDS, light, shaper_for

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import CostedScene

SHAPED = 2  # modes of the closed loop that a shaper is made for
SLOWEST = 0.01  # least Kp / Kd, over 1 / dt: a joint comes home at that rate at least
STARTS = (0.03, 0.1, 0.3, 1.0)  # of the search for gains: Kd dt over the inertia that turns at once


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PD(OwnsArrays):
    """Made by `design` or `for_scene`; it reads the joints' positions, then their rates."""

    Kp: np.ndarray  # (n, n) of n joints, as many as inputs where `share` is None
    Kd: np.ndarray  # (n, n)
    joints: Joints
    reference: RestToRest | Follow
    u0: np.ndarray  # (nu,) held at the reference's end
    inverse: NumericFunction | None = None  # (positions and rates (2 nu,), accelerations (nu,)) -> u (nu,)
    limits: Any = None
    dt: float | None = None
    share: np.ndarray | None = None  # (nu, n) inputs for a unit of what Kp and Kd give each joint; None: one each
    conserved: tuple[str, ...] = ()  # what no input changes, as the momentum of a craft with wheels

    def __post_init__(self) -> None:
        n = len(require_instance("PD.joints", self.joints, Joints).positions)
        require_reference("PD", self.reference)
        if self.inverse is not None:
            require_instance("PD.inverse", self.inverse, NumericFunction)
        for name in ("Kp", "Kd"):
            object.__setattr__(self, name, read_only(f"PD.{name}", getattr(self, name), (n, n)))
        if self.share is not None:
            object.__setattr__(self, "share", read_only("PD.share", self.share, (-1, n)))
        nu = n if self.share is None else len(self.share)
        object.__setattr__(self, "u0", read_only("PD.u0", self.u0, (nu,)))
        object.__setattr__(self, "limits", saturation("PD", self.limits, [f"u{i + 1}" for i in range(nu)]))
        if len(self.reference.end) != n:
            raise ValueError(f"PD.reference has {len(self.reference.end)} positions, must have {n}")
        if self.dt is not None:
            object.__setattr__(self, "dt", require_seconds("PD.dt", self.dt))
        rest = np.concatenate([self.reference.end, np.zeros(n)])
        lack = self.u0 - (self.inverse(rest, np.zeros(n))[0] if self.inverse else 0.0)
        object.__setattr__(self, "_lack", lack)  # what holding the elastic plant takes beyond the rigid one

    @property
    def reads(self) -> tuple[str, ...]:
        """Names of what `act` reads: joints, then their rates."""
        return self.joints.positions + self.joints.rates

    @property
    def K(self) -> np.ndarray:
        """(nu, 2 n): u = .. - K y, for analysis of the loop."""
        own = np.hstack([self.Kp, self.Kd])
        return own if self.share is None else self.share @ own

    @classmethod
    def design(
        cls,
        plant: Plant,
        x0: Any,
        u0: Any,
        *,
        bandwidth: float,
        damping: float = 0.7,
        reference: RestToRest | Follow | None = None,
        at: Joints | None = None,
        limits: Any = None,
        dt: float | None = None,
    ) -> PD:
        """Kp = bandwidth^2 J, Kd = 2 damping bandwidth J with J the rigid inertia at the equilibrium (x0, u0).

        bandwidth [rad/s]; reference: None holds x0; at: names of positions and rates, one an input, None: the plant's
        joints; limits: (lowest, highest), or {input: (lowest, highest)}.
        """
        bandwidth = require_number("PD.bandwidth", bandwidth, "positive", "rad/s")
        damping = require_number("PD.damping", damping, "positive")
        require_instance("PD.design: plant", plant, Plant)
        x0, u0 = require_finite("PD.x0", x0, (plant.nx,)), require_finite("PD.u0", u0, (plant.nu,))
        if reference is not None:
            require_reference("PD", reference)
        at = driven(plant) if at is None else _named(plant, at)
        if _shared(plant, at):
            share, J = sharing(plant.ladder()[0].linearize(rigid_state(plant, x0), u0), at.rates), np.eye(len(at.rates))
        else:
            share, J = None, rigid_inertia(plant, x0, u0, at.rates)
        gains = bandwidth**2 * J, 2 * damping * bandwidth * J
        return cls._made(plant, x0, u0, *gains, at, reference, limits, dt, share)

    @classmethod
    def for_scene(cls, scene: CostedScene, *, shape: str | None = None) -> PD:
        """Along the rigid motion of the scene, rest to rest in its move_time; `shape` ("zv", "zvd", ..) shapes that.

        A gain Kp and Kd for each joint, such that the sampled loop about the goal decays fastest. PliantError where
        none is found that is stable.
        """
        require_scene("PD.for_scene", scene)
        if shape is not None:
            require_choice("PD.for_scene", "shape", shape, KINDS)
        plant, (x, u), high = scene.plant, scene.target, np.array(scene.limits)
        at, model = driven(plant), plant.linearize(x, u)
        share = sharing(plant.ladder()[0].linearize(rigid_state(plant, x), u), at.rates) if _shared(plant, at) else None
        Kp, Kd = fastest_decay(model, at, scene.dt, share)
        law = cls._made(plant, x, u, Kp, Kd, at, motion_of(scene, at), (-high, high), scene.dt, share)
        law = replace(law, conserved=conserved(model).names)
        return law if shape is None else law.shaped(model, shape)

    @classmethod
    def _made(
        cls,
        plant: Plant,
        x0: Any,
        u0: Any,
        Kp: np.ndarray,
        Kd: np.ndarray,
        at: Joints,
        reference: RestToRest | Follow | None,
        limits: Any,
        dt: float | None,
        share: np.ndarray | None = None,
    ) -> PD:
        held = values_of(plant, x0, u0, at.positions)
        rigid = {s.name for s in plant.ladder()[0].states}
        return cls(
            Kp=Kp,
            Kd=Kd,
            joints=at,
            reference=RestToRest(held, held, 1.0) if reference is None else reference,
            u0=require_finite("PD.u0", u0, (plant.nu,)),
            inverse=inverse_dynamics(plant, at) if rigid == set(at.positions + at.rates) else None,
            limits=saturation("PD", limits, [s.name for s in plant.inputs]),
            dt=dt,
            share=share,
        )

    def shaped(self, model: LinearModel, kind: str = "zvd") -> PD:
        """This law with its reference shaped for the two slowest lightly damped modes of its loop around `model`.

        Modes slower than the motion itself are left out. ValueError where the reference is not from rest to rest.
        """
        require_instance("PD.shaped: model", model, LinearModel)
        require_choice("PD.shaped", "kind", kind, KINDS)
        if not isinstance(self.reference, RestToRest):
            raise ValueError("PD.shaped needs a reference from rest to rest, not one that goes on moving")
        values = loop_eigenvalues(model, self.K, self.reads, self.dt)
        modes = [s for s in light(values) if abs(s) * self.reference.time > 2 * np.pi][:SHAPED]
        return replace(self, reference=replace(self.reference, shaper=shaper_for(modes, kind))) if modes else self

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from positions and rates y (2 nu,) at time t [s]."""
        n = len(self.joints.positions)
        y = reading("PD.y", y, 2 * n)
        r, dr, ddr = self.reference(t)
        push = self.Kp @ (r - y[:n]) + self.Kd @ (dr - y[n:])
        u = self._lack + (push if self.share is None else self.share @ push)  # type: ignore[attr-defined]
        if self.inverse is not None:
            u += self.inverse(np.concatenate([r, dr]), ddr)[0]
        return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])


def _named(plant: Plant, at: Any) -> Joints:
    """Joints from their names, positions and rates."""
    if not isinstance(at, (tuple, list)) or len(at) != 2:
        raise ValueError(f"PD.at = {shown(at)} must be Joints, or a pair of the names of positions and of rates")
    known = tuple(s.name for s in plant.states + plant.outputs)
    found = Joints(*(require_names(f"PD.at[{i}]", names, known, "state or output") for i, names in enumerate(at)))
    if len(found.positions) != len(found.rates) or not found.positions:
        raise ValueError(f"PD.at = {shown(found)} must name as many rates as positions, one at least")
    return found


def _shared(plant: Plant, at: Joints) -> bool:
    """Whether inputs drive joints together: fewer joints than inputs, or those that the plant says are shared."""
    together = tuple(j.rate for j in plant.shared_joints)
    return len(at.rates) < plant.nu or (at.rates == together and len(plant.joints) < plant.nu)


def fastest_decay(
    model: LinearModel, at: Joints, dt: float, inputs: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Diagonal Kp, Kd (n, n) whose loop, held over dt [s], decays fastest about the model's equilibrium.

    Found by the simplex method from several starts. PliantError where the best loop still grows.
    """
    n = len(at.positions)
    model = moved(model, rows(model, at.positions + at.rates))
    one_each = np.eye(n) if inputs is None else inputs
    sampled, S = model.discretize(dt), rows(model, at.positions + at.rates)
    reach = rows(model, at.rates) @ model.B @ one_each
    largest = np.maximum(np.abs(reach).max(axis=1, keepdims=True), np.finfo(float).tiny)  # each of its own unit
    if np.linalg.matrix_rank(reach / largest) < n:
        places = ", ".join(at.positions)
        raise PliantError(f"PD: no input accelerates each of {places}, must be one that a motor drives")
    hub = np.abs(np.diag(np.linalg.inv(reach)))

    def gains(logs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        home, Kd = np.exp(logs).reshape(2, n)
        return (home + SLOWEST / dt) * Kd, Kd

    def growth(logs: np.ndarray) -> float:
        K = one_each @ np.hstack([np.diag(gain) for gain in gains(logs)])
        radius = np.abs(np.linalg.eigvals(sampled.A - sampled.B @ K @ S)).max()
        return float(np.log(radius) / dt)

    found = []
    for share in STARTS:
        Kd = share / dt * hub
        start = np.log(np.concatenate([np.full(n, share / dt / 4), Kd]))
        found.append(minimize(growth, start, method="Nelder-Mead", options={"maxfev": 200 * n}))
    best = min(found, key=lambda result: result.fun)
    if not best.fun < 0:
        raise PliantError(
            f"PD: no gains found whose loop about the goal is stable at dt = {dt:g} s (the best grows at "
            f"{best.fun:.3g} 1/s); sample faster, or give more hub inertia"
        )
    Kp, Kd = gains(best.x)
    return np.diag(Kp), np.diag(Kd)
