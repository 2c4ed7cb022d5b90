"""A body given by its modes, in the floating frame of its attachment point: `deformed_body`'s energy.

A point stands at p = r + sum phi_k eta_k - (1/2) sum g_kl eta_k eta_l, the last ("stiffened") where it is known; a node
has turned by sum psi_k eta_k. Forces are d'Alembert's of that motion of its points, so that momentum and energy hold
with any number of modes.

Source   "Equations of Motion of Flexible Spacecraft", Eqs (2)-(13)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.signals import Signal
from pliant.plants.modal_data.deformed_body import Deformed, constant
from pliant.plants.modal_data.inertial_forces import inertial_forces
from pliant.plants.modal_data.modal_fields import ModalFields
from pliant.plants.multibody_parts.joint import Frame, Joint
from pliant.plants.multibody_parts.spatial import Inertia, Motion, Wrench, upper
from pliant.plants.multibody_parts.tree_beam import Section

from .elastic_body import ElasticBody, Place


def modal_signals(n: int) -> list[Signal]:
    """Amplitudes."""
    return [Signal(f"eta{k + 1}", "m") for k in range(n)]


def place_on(data: ModalFields, body: str, part: Joint | Frame) -> str:
    """The node of a body's modal data where a joint or a frame hangs; ValueError where they do not have it."""
    try:
        node = data.node(part.node)
    except ValueError as error:
        raise ValueError(f"{type(part).__name__} {part.name!r} on body {body!r}: {error}") from error
    if isinstance(part, Joint) and part.turned and node.turns is None:
        raise ValueError(
            f"Joint.node = {part.node!r} of joint {part.name!r} has no turns in the modal data of body {body!r}: name "
            "a node that has them, or turned=False"
        )
    return part.node


@dataclass(frozen=True, eq=False)
class ModalBody(ElasticBody):
    """The modes of `data`, their stiffness times `factor`, with a damping `ratio` besides their own."""

    data: ModalFields
    stiffened: bool
    factor: Any = 1.0
    ratio: Any = 0.0

    @property
    def n(self) -> int:
        return self.data.n

    def deformed(self, eta: ca.SX) -> Deformed:
        """Its moments."""
        return Deformed.of(self.data, eta, self.stiffened)

    def inertia(self, eta: ca.SX) -> Inertia:
        found = self.deformed(eta)
        return Inertia(ca.SX(found.mass), ca.densify(found.S), upper(ca.densify(found.P)))

    def coupling(self, eta: ca.SX) -> list[Wrench]:
        found = self.deformed(eta)
        R, Y = ca.densify(found.R), ca.densify(found.Y)
        return [Wrench(R[:, k], Y[:, k]) for k in range(self.n)]

    def mass(self, eta: ca.SX) -> ca.SX:
        return ca.densify(self.deformed(eta).m)

    def inertial(self, motion: Motion, U: ca.SX, eta: ca.SX, rate: ca.SX) -> tuple[Wrench, ca.SX]:
        still = ca.SX.zeros(self.n)
        load = inertial_forces(self.data, eta, rate, still, motion.omega, motion.a, motion.alpha, self.stiffened)
        return Wrench(load[:3], load[3:6]), load[6:]

    def section(self, place: Place, eta: ca.SX, rate: ca.SX) -> Section:
        node, n = self.data.node(str(place)), self.n
        shapes, turns = constant(node.shapes.T), constant(node.turns.T if node.turns is not None else np.zeros((3, n)))
        shift, moved, bias, T = constant(node.position), shapes @ eta, ca.SX.zeros(3), shapes
        if self.stiffened and node.shortening is not None and n:
            for c in range(3):
                g = constant(node.shortening[:, :, c])
                pulled = g @ eta
                moved[c] -= ca.dot(eta, pulled) / 2
                bias[c] = -ca.dot(rate, g @ rate)
                T = ca.vertcat(T[:c, :], T[c, :] - pulled.T, T[c + 1 :, :])
        T = ca.sparsify(ca.vertcat(T, turns))
        return Section(ca.densify(shift + moved), T[:3, :] @ rate, bias, T[3:, :] @ eta, T[3:, :] @ rate, T)

    @cached_property
    def _damping(self) -> ca.SX:
        own = np.sqrt(np.diag(self.data.stiffness) * np.diag(self.data.modal_mass))
        return constant(self.data.damping) + self.ratio * constant(np.diag(2 * own))

    def resistance(self, eta: ca.SX, rate: ca.SX) -> ca.SX:
        return self.factor * (constant(self.data.stiffness) @ eta) + self._damping @ rate

    def strain_energy(self, eta: ca.SX) -> ca.SX:
        return self.factor * ca.dot(eta, constant(self.data.stiffness) @ eta) / 2

    def dissipation(self, rate: ca.SX) -> ca.SX:
        return ca.dot(rate, self._damping @ rate) / 2

    def readings(self, eta: ca.SX, rate: ca.SX) -> list[ca.SX]:
        shapes = constant(self.data.tip_shapes.T)
        return [*ca.vertsplit(ca.densify(shapes @ eta)), *ca.vertsplit(ca.densify(shapes @ rate))]

    def line(self, eta: ca.SX, points: int) -> ca.SX:
        """The outline as the data have it."""
        moved = ca.SX(ca.DM(self.data.outline.T))
        for k, shape in enumerate(self.data.outline_shapes):
            moved += ca.DM(shape.T) * eta[k]
        return moved
