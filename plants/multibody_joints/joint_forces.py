"""Springs, stops, damping and dry friction in a joint: forces on its speeds, energies, losses.

About one axis or along it the spring's energy is k (q - rest)^2/2. Of a turn in space by the angle theta it is
k (1 - cos theta), that for small angles: smooth, the same of a quaternion and its negative. A stop has k d^2/2 with
d = (z + sqrt(z^2 + width^2))/2, z how far the coordinate is beyond it; of a turn in space by more than `upper`
z = (cos upper - cos theta)/sin upper, which is theta - upper near there. Dry friction is f v/sqrt(|v|^2 + rate^2),
of several speeds together along their direction.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from pliant.plants.core.casadi_functions import entries
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.multibody_parts.joint import Joint, Sliding

from .freedoms import SHIFTS, Slot, freedoms

Sides = list[tuple[Any, Any]]  # (dz by the coordinate, z) of each stop


def _nothing(k: Any) -> bool:
    return not is_symbolic(k) and k == 0


def _rubbed(part: Joint | Sliding, v: ca.SX) -> ca.SX:
    """Damping and dry friction of speeds (n,)."""
    return part.damping * v + part.friction * v / ca.sqrt(ca.dot(v, v) + part.friction_rate**2)


def _lost(part: Joint | Sliding, v: ca.SX) -> ca.SX:
    """Rayleigh's function of that."""
    dry = ca.sqrt(ca.dot(v, v) + part.friction_rate**2) - part.friction_rate
    return part.damping * ca.dot(v, v) / 2 + part.friction * dry


def _stopped(part: Joint | Sliding, z: Any) -> Any:
    """dV/dz of a stop."""
    root = ca.sqrt(z**2 + part.stop_width**2)
    return part.stop_stiffness * (z + root) ** 2 / (4 * root)


def _pressed(part: Joint | Sliding, z: Any) -> Any:
    """V of a stop."""
    return part.stop_stiffness * ((z + ca.sqrt(z**2 + part.stop_width**2)) / 2) ** 2 / 2


def _beyond(part: Joint | Sliding, q: Any) -> Sides:
    """Of one coordinate."""
    if _nothing(part.stop_stiffness):
        return []
    found = [(1.0, q - part.upper)] if part.upper is not None else []
    return found + ([(-1.0, part.lower - q)] if part.lower is not None else [])


def _turned_beyond(joint: Joint, q: ca.SX) -> Sides:
    """Of a quaternion."""
    if _nothing(joint.stop_stiffness) or joint.upper is None:
        return []
    c, s, turn = ca.cos(joint.upper), ca.sin(joint.upper), q[1:]
    return [(2 * q[0] * turn / s, (c - 1 + 2 * ca.dot(turn, turn)) / s)]


def _one(joint: Joint, q: ca.SX, v: ca.SX) -> ca.SX:
    force = joint.stiffness * (q - joint.rest) + _rubbed(joint, v)
    return force + sum((side * _stopped(joint, z) for side, z in _beyond(joint, q)), ca.SX(0))


def _ball(joint: Joint, q: ca.SX, v: ca.SX) -> ca.SX:
    force = 2 * joint.stiffness * q[0] * q[1:] + _rubbed(joint, v)
    return force + sum((by * _stopped(joint, z) for by, z in _turned_beyond(joint, q)), ca.SX.zeros(3))


def _slid(part: Sliding | None, q: ca.SX, v: ca.SX) -> ca.SX:
    if part is None:
        return ca.SX.zeros(v.shape[0])
    force = part.stiffness * q + _rubbed(part, v)
    held = [sum((side * _stopped(part, z) for side, z in _beyond(part, q[i])), ca.SX(0)) for i in range(q.shape[0])]
    return force + ca.vertcat(*held)


def _parts(slot: Slot, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """(shifts and their rates, the turn and its) of a joint that has several freedoms."""
    nv, shifts = len(freedoms(slot.joint)), SHIFTS.get(slot.joint.kind, 0)
    turn = 4 if slot.turn is not None else 1
    return (
        entries(q, slice(slot.q, slot.q + shifts)),
        entries(v, slice(slot.v, slot.v + shifts)),
        entries(q, slice(slot.q + shifts, slot.q + shifts + turn)),
        entries(v, slice(slot.v + shifts, slot.v + nv)),
    )


def forces(slot: Slot, q: ca.SX, v: ca.SX) -> ca.SX:
    """On the joint's speeds, against the motion; q and v of the whole tree."""
    shift, rate, turn, spin = _parts(slot, q, v)
    turned = _one(slot.joint, turn, spin) if slot.turn is None else _ball(slot.joint, turn, spin)
    return ca.vertcat(_slid(slot.joint.sliding, shift, rate), turned)


def stored(slot: Slot, q: ca.SX) -> ca.SX:
    """Energy [J] of spring and stops, zero where all coordinates are zero and nothing is turned."""
    joint, part = slot.joint, slot.joint.sliding
    shift, _, turn, _ = _parts(slot, q, ca.SX.zeros(q.shape[0]))
    V = ca.SX(0)
    if part is not None:
        V += part.stiffness * ca.dot(shift, shift) / 2
        for i in range(shift.shape[0]):
            V += _over(part, _beyond(part, shift[i]), _beyond(part, 0.0))
    if slot.turn is None:
        V += joint.stiffness * ((turn - joint.rest) ** 2 - joint.rest**2) / 2
        return V + _over(joint, _beyond(joint, turn), _beyond(joint, 0.0))
    V += 2 * joint.stiffness * ca.dot(turn[1:], turn[1:])
    return V + _over(joint, _turned_beyond(joint, turn), _turned_beyond(joint, ca.SX(ca.DM([1, 0, 0, 0]))))


def _over(part: Joint | Sliding, there: Sides, at_zero: Sides) -> ca.SX:
    """Of stops, over that at zero."""
    pairs = zip(there, at_zero, strict=True)
    return sum((_pressed(part, z) - _pressed(part, z0) for (_, z), (_, z0) in pairs), ca.SX(0))


def lost(slot: Slot, v: ca.SX) -> ca.SX:
    """Rayleigh's function [W]: half the power lost to damping."""
    joint, part, n = slot.joint, slot.joint.sliding, len(freedoms(slot.joint))
    shifts = SHIFTS.get(joint.kind, 0)
    D = _lost(joint, entries(v, slice(slot.v + shifts, slot.v + n)))
    return D if part is None else D + _lost(part, entries(v, slice(slot.v, slot.v + shifts)))
