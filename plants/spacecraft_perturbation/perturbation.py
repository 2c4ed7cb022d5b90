"""The paper's perturbation model of a flexible spacecraft: [A] x'' + [B] x' + [C] x = Q about a nominal rigid motion.

The position field of a body is V z, z = (1, r, phi_1 .. phi_n), Pi = int z z^T dm once for each body, <U, W> = tr(U
Pi W^T):

    A_ab = sum <J_a, J_b>      B_ab = 2 sum <J_a, J_b'> + dampers
    C_ab = sum <J_a, J_b''> + sum <d2V/dx_a dx_b, V''> + springs      Q_a = -sum <J_a, V''>

with J_a = dV/dx_a and ' the total time derivative along the nominal; products of truncated Taylor series in time
give all of them. The second derivatives of V are what the paper's linear W (Eqs 2-3) leaves out: without them C is
wrong wherever the nominal accelerates.

Unknowns   x = [hinges and modes of each appendage, q (turn of the hub, hub axes), p (position, inertial axes)]
Source     "Equations of Motion of Flexible Spacecraft", Eqs (1)-(28); printed elements that differ:
           `printed_equations.differences`
Loads      hinge springs and dampers and the strain are in; environment and inputs are not: they belong to the
           plant's own model
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.signals import Signal
from pliant.plants.linear.second_order import SecondOrderModel
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.validity.ranges import left_along, tell

from .position_fields import Body, RigidNominal, appendage_field, assemble, attitude, hub_field, states_of

__all__ = ["RigidNominal", "SecondOrderModel", "perturbation"]

Array = np.ndarray


def perturbation(craft: FlexibleSpacecraft, nominal: RigidNominal | Any) -> SecondOrderModel:
    """The paper's model of `craft` about a rigid nominal (a RigidNominal, or a trajectory of the plant's states).

    The shortening of stiffened kinematics enters C_ii as geometric stiffness -<g_kl, V''>. Warns (ValidityWarning) of
    a nominal that leaves a range of the craft's `validity`, as the spin that linear kinematics bear. ValueError for
    varied parameters, wheels or an orbit, which the paper's model does not have.
    """
    if craft.varied or craft.hub.wheels or craft.environment.orbit is not None:
        raise ValueError("perturbation: the paper's model has no varied parameters, wheels or orbit axes")
    if any(a.hinge.drive == "motion" for a in craft.appendages):
        raise ValueError('perturbation: hinges with drive = "motion" are prescribed, the paper\'s are unknowns')
    if not isinstance(nominal, RigidNominal):
        nominal = RigidNominal.of(craft, nominal)
    _check(craft, nominal)
    tell(craft, left_along(craft, nominal.t, states_of(craft, nominal)), stacklevel=2, what="the nominal")
    own: list[list[int]] = []
    signals: list[Signal] = []
    parts: list[tuple[str, tuple[int, ...]]] = []
    for i, body in enumerate(craft.appendages):
        count = body.hinge.n + craft.mode_counts[i]
        own.append(list(range(len(signals), len(signals) + count)))
        at = craft.layout
        first = at.quaternion.stop
        places = [k - first for s in (at.hinges[i], at.modes[i]) for k in range(s.start, s.stop)]
        signals += [craft.coordinates[k] for k in places]
        parts.append((str(i + 1), tuple(own[-1])))
    n = len(signals) + 6
    q, p = [n - 6, n - 5, n - 4], [n - 3, n - 2, n - 1]
    signals += [Signal(f"q_{c}", "rad") for c in "xyz"] + [Signal(f"p_{c}", "m") for c in "xyz"]
    parts.append(("m", tuple(q + p)))
    R = attitude(nominal)
    bodies = [hub_field(craft, nominal, R, q, p)]
    bodies += [appendage_field(craft, i, nominal, R, own[i], q + p) for i in range(len(own))]
    A, B, C, Q = assemble(bodies, len(nominal.t), n)
    for i, shape in enumerate(bodies[1:]):
        _strain(craft, i, shape, nominal, own[i], B, C, Q)
    return SecondOrderModel(nominal.t, A, B, C, Q, tuple(signals), tuple(parts))


def _check(craft: FlexibleSpacecraft, nominal: RigidNominal) -> None:
    for name in ("angles", "angle_rates", "angle_accelerations"):
        widths = tuple(a.shape[1] for a in getattr(nominal, name))
        want = tuple(a.hinge.n for a in craft.appendages)
        if widths != want and (widths or any(want)):
            raise ValueError(f"RigidNominal.{name} has columns {widths}, must have {want} (the hinges' freedoms)")


def _strain(
    craft: FlexibleSpacecraft, i: int, body: Body, nominal: RigidNominal, own: list[int], B: Array, C: Array, Q: Array
) -> None:
    """Springs, dampers, modal stiffness and, stiffened, the work of the inertia forces on the shortening."""
    appendage, n, data = craft.appendages[i], craft.mode_counts[i], body.data
    assert data is not None
    nh = appendage.hinge.n
    turns, bent = own[:nh], own[nh:]
    K, D = np.array(appendage.hinge.stiffness, dtype=float), np.array(appendage.hinge.damping, dtype=float)
    C[:, turns, turns] += K
    B[:, turns, turns] += D
    if nh:
        Q[:, turns] -= nominal.angles[i] * K + nominal.angle_rates[i] * D
    if not n:
        return
    ratio = 2 * appendage.damping * np.sqrt(np.diag(data.stiffness) * np.diag(data.modal_mass))
    pair = np.ix_(range(len(nominal.t)), bent, bent)
    C[pair] += appendage.stiffness_factor * data.stiffness
    B[pair] += data.damping + np.diag(ratio)
    if craft.kinematics == "stiffened":
        felt = _axes(body, nh) @ body.V.dd  # in appendage axes: acceleration of the field (1, r, ..)
        C[pair] -= np.einsum("ti,kli->tkl", felt[:, :, 0], data.shortening)
        moments = (data.shortening_moments + data.shortening_moments.swapaxes(0, 1)) / 2
        C[pair] -= np.einsum("tij,klji->tkl", felt[:, :, 1:4], moments)


def _axes(body: Body, nh: int) -> Array:
    """Inertial axes to appendage axes (nt, 3, 3), from the field of the first mode."""
    J = body.J[nh].value
    return np.swapaxes(J[:, :, 4:7], 1, 2)
