"""The elements of [A], [B], [C], Q as the paper prints them, beside those that its own Lagrange equations give.

Coordinates   the paper's: q^i_1..3 are absolute turns of appendage i in its axes (Eqs 2, 17), so every hinge has
              three freedoms; columns of p along inertial axes, which the zero columns in B and C need, rows of p
              along main-body axes, as printed
Read as       the evident dots over omega where dimensions ask for one, phi_3 of (4) and the lower triangle of (12)
corrected
Source        "Equations of Motion of Flexible Spacecraft", pages of Eqs (27)-(28) and the concluding [X]
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.quaternions import matrix_of, skew
from pliant.plants.modal_data.integrals import axial
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

from . import paper_integrals as paper
from .position_fields import E3, Body, Jet, RigidNominal, appendage_field, assemble, attitude, hub_field, small

Array = np.ndarray


@dataclass(frozen=True)
class Difference:
    """A printed block against the derived one: `largest` difference over nodes and elements, `scale` of the derived
    block.
    """

    block: str
    largest: float
    scale: float
    remark: str

    @property
    def agrees(self) -> bool:
        """Whether the printed block is right to rounding."""
        return self.largest <= 1e-9 * max(self.scale, 1.0)


REMARKS = {
    "A_im trans": "columns of p along main-body axes, in A_mm along inertial axes: printed A is not symmetric",
    "A_mm trans-trans": "the main body's own mass has columns along main-body axes",
    "B_ii damper": "g is twice the turn: half the curl is meant, else dampers count four times",
    "B_im damper": "as B_ii damper",
    "B_mi damper": "as B_ii damper",
    "B_mm damper": "as B_ii damper",
    "B_mi rot": "the factor 2 of 2 omega^i x R_j is missing",
    "B_mi trans": "the factor 2 is missing",
    "C_ii hinge": "the second-order turn (1/2) q x (q x r) is missing",
    "C_ii mixed": "the second-order term q x phi eta is missing",
    "C_ii spring": "sign of the hinge spring, and g is twice the turn",
    "C_im spring": "g and h are twice the turn",
    "C_mi spring": "sign, and g and h are twice the turn",
    "C_mm spring": "sign, and h is twice the turn",
    "C_im rot": "printed for j = 4..6; belongs to j = 1..3 and begins omega-dot x phi",
    "C_im trans": "printed where zero belongs",
    "C_mi rot": "must be omega-dot^i x R + omega^i x (omega^i x R), for all j",
    "C_mi trans": "omega^i x (omega^i x R) is missing; omega-dot for omega^i-dot",
    "C_mm rot-rot": "[X] diagonal, omega-dot x phi, and the second-order turns of hub and attachment point",
    "Q_m trans": "X-dot . (omega x x^) does not belong; omega-dot^i x d + omega^i x (omega^i x d) is missing",
}


def _absolute(
    craft: FlexibleSpacecraft, i: int, nominal: RigidNominal, R: Jet, own: list[int], qp: list[int]
) -> tuple[Body, Jet]:
    """Appendage i in absolute turns, and the jet of its axes."""
    relative = appendage_field(craft, i, nominal, R, own, qp)
    body, n = craft.appendages[i], craft.mode_counts[i]
    m, b = 4 + 3 * n, np.asarray(body.position, dtype=float)
    origin, wide = np.zeros((3, m)), np.zeros((3, m))
    origin[:, 0], wide[:, 1:4] = b, E3
    whole = relative.V
    turned = Jet(*(v[:, :, 1:4] for v in whole))  # the coefficient of r is the appendage's own rotation
    phi = [np.eye(m)[4 + 3 * k : 7 + 3 * k] for k in range(n)]
    J = [turned @ Jet.constant(small(k) @ wide) for k in range(3)] + [turned @ Jet.constant(f) for f in phi]
    J += [R @ Jet.constant(small(k) @ origin) for k in range(3)]
    J += [Jet.constant(np.outer(E3[k], np.eye(m)[0])) for k in range(3)]
    second = {(k, l): turned.value @ small(k, l) @ wide for k in range(3) for l in range(k, 3)}
    second |= {(k, 3 + l): turned.value @ small(k) @ phi[l] for k in range(3) for l in range(n)}
    first = 3 + n
    second |= {(first + k, first + l): R.value @ small(k, l) @ origin for k in range(3) for l in range(k, 3)}
    return Body(whole, J, second, relative.data, relative.Pi, own + qp), turned


class _Extended:
    """Modal data with the three rigid turns in front of the modes, in inertial axes."""

    def __init__(self, data: ModalData, C: Array) -> None:
        e, n = [skew(v) for v in E3], data.n
        count = 3 + n
        P = np.zeros((count, count, 3, 3))
        R = np.zeros((count, 3))
        for k in range(3):
            R[k] = e[k] @ data.first
            for l in range(3):
                P[k, l] = e[k] @ data.second @ e[l].T
            for l in range(n):
                P[k, 3 + l] = e[k] @ data.moments[l]
                P[3 + l, k] = P[k, 3 + l].T
        R[3:], P[3:, 3:] = data.R, data.overlaps
        self.mass = np.einsum("klii->kl", P)
        self.R = np.einsum("tij,kj->tki", C, R)
        self.Z = np.einsum("tij,klj->tkli", C, paper.Z(P))
        self.E = np.einsum("tij,kljm,tnm->tklin", C, paper.E(P), C)


def _hub_printed(craft: FlexibleSpacecraft, w: Array, dw: Array) -> tuple[Array, Array, Array]:
    """A, B and [X] (nt, 3, 3) of the rigid main body in principal axes; w and dw (nt, 3) in hub axes."""
    I = np.diag(np.array(craft.hub.inertia, dtype=float))
    A1, A2, A3 = I.sum() / 2 - I
    w1, w2, w3 = w.T
    d1, d2, d3 = dw.T
    X = np.array(
        [
            [w1**2 * (A2 + A3) - w2**2 * A2 - w3**2 * A3, -A3 * (d3 + w1 * w2), A2 * (d2 - w1 * w3)],
            [A3 * (d3 - w2 * w1), w2**2 * (A1 + A3) - w1**2 * A1 - w3**2 * A3, -A1 * (d1 + w2 * w3)],
            [-A2 * (d2 + w3 * w1), A1 * (d1 - w3 * w2), w3**2 * (A1 + A2) - w1**2 * A1 - w2**2 * A2],
        ]
    )
    return np.diag(I), skew(2 * w * np.array([A1, A2, A3])), X.transpose(2, 0, 1)


def differences(craft: FlexibleSpacecraft, nominal: RigidNominal | Any) -> tuple[Difference, ...]:
    """Every printed block against the derived one, at a nominal with velocity zero where the paper asks for X-dot.

    ValueError unless the kinematics are linear, the hub's axes are principal and every hinge has three freedoms.
    """
    inertia = np.array(craft.hub.inertia, dtype=float)
    if craft.kinematics != "linear" or np.abs(inertia - np.diag(np.diag(inertia))).max() > 0:
        raise ValueError(f"differences: kinematics = {craft.kinematics!r} must be 'linear', Hub.inertia principal")
    if any(a.hinge.n != 3 for a in craft.appendages):
        raise ValueError(f"differences: hinges have {[a.hinge.n for a in craft.appendages]} freedoms, must have 3 each")
    if not isinstance(nominal, RigidNominal):
        nominal = RigidNominal.of(craft, nominal)
    nt, counts = len(nominal.t), [3 + n for n in craft.mode_counts]
    ends = np.cumsum([0, *counts])
    own = [list(range(int(a), int(a) + c)) for a, c in zip(ends, counts)]
    q, p = [int(ends[-1]) + k for k in range(3)], [int(ends[-1]) + 3 + k for k in range(3)]
    R = attitude(nominal)
    pairs = [_absolute(craft, i, nominal, R, own[i], q + p) for i in range(len(own))]
    bodies = [hub_field(craft, nominal, R, q, p), *(body for body, _ in pairs)]
    A, B, C, Q = assemble(bodies, nt, p[-1] + 1)
    x = matrix_of(nominal.quaternion)  # columns are the main-body axes
    w, dw = (np.einsum("tij,tj->ti", x, v) for v in (nominal.omega, nominal.alpha))
    hub_A, hub_B, hub_X = _hub_printed(craft, nominal.omega, nominal.alpha)
    Am, Bm, Cm = (np.broadcast_to(v, (nt, 3, 3)).copy() for v in (hub_A, hub_B, hub_X))
    m = craft.hub.mass
    At = np.zeros((nt, 3, 3))
    Bt, Ct, Att = At.copy(), At.copy(), np.tile(m * E3, (nt, 1, 1))
    force = -m * np.einsum("ti,tij->tj", nominal.acceleration, x)
    found: dict[str, list[tuple[Array, Array]]] = {}

    def note(name: str, printed: Array, derived: Array) -> None:
        found.setdefault(name, []).append((np.broadcast_to(printed, derived.shape), derived))

    def cut(M: Array, rows: list[int], columns: list[int]) -> Array:
        block = M[:, rows][:, :, columns]
        return np.swapaxes(x, 1, 2) @ block if rows == p else block

    for i, body in enumerate(craft.appendages):
        turned = pairs[i][1]
        c, data = turned.value, bodies[i + 1].data
        assert data is not None
        e = _Extended(data, c)
        spin = turned.d @ np.swapaxes(c, 1, 2)
        wi = axial(-spin) / 2
        bend = turned.dd @ np.swapaxes(c, 1, 2) - spin @ spin
        dwi = axial(-bend) / 2
        arm = np.einsum("tij,j->ti", x, np.asarray(body.position, dtype=float))
        phi = np.stack([np.cross(x[:, :, k], arm) for k in range(3)], axis=1)  # phi_k(b^i), k = 1..3
        R_ = e.R
        hinge, bent, o = list(range(3)), list(range(3, counts[i])), own[i]
        note("A_ii", np.broadcast_to(e.mass, (nt, *e.mass.shape)), cut(A, o, o))
        note("A_im rot", np.einsum("tja,tka->tkj", phi, R_), cut(A, o, q))
        note("A_im trans", np.einsum("taj,tka->tkj", x, R_), cut(A, o, p))
        note("A_mi rot", np.einsum("tka,tla->tkl", phi, R_), cut(A, q, o))
        note("A_mi trans", np.einsum("tak,tla->tkl", x, R_), cut(A, p, o))
        note("B_ii", 2 * np.einsum("ta,tkla->tkl", wi, e.Z), cut(B, o, o))
        spun = np.cross(w[:, None], phi)
        note("B_im rot", 2 * np.einsum("tka,tja->tkj", R_, spun), cut(B, o, q))
        note("B_im trans", np.zeros((nt, counts[i], 3)), cut(B, o, p))
        swept = np.cross(wi[:, None], R_)
        note("B_mi rot", np.einsum("tka,tja->tkj", phi, swept), cut(B, q, o))
        note("B_mi trans", np.einsum("tak,tja->tkj", x, swept), cut(B, p, o))
        within = np.einsum("ta,tkla->tkl", dwi, e.Z) - np.einsum("ta,tklab,tb->tkl", wi, e.E, wi)
        block = cut(C, o, o)
        note("C_ii hinge", cut(within, hinge, hinge), cut(block, hinge, hinge))
        note("C_ii mixed", cut(within, hinge, bent), cut(block, hinge, bent))
        note("C_ii modes", cut(within, bent, bent), cut(block, bent, bent))
        note("C_im rot", np.zeros((nt, counts[i], 3)), cut(C, o, q))
        twice = np.cross(w[:, None], spun)
        note("C_im trans", np.einsum("tja,tka->tkj", spun + twice, R_), cut(C, o, p))
        note("C_mi rot", np.einsum("tka,tja->tkj", phi, swept)[:, :, :3], cut(C, q, o)[:, :, :3])
        note("C_mi trans", np.einsum("tak,tja->tkj", x, np.cross(dw[:, None], R_)), cut(C, p, o))
        Am += data.mass * np.einsum("tka,tja->tkj", phi, phi)
        At += data.mass * np.einsum("tak,tja->tkj", x, phi)
        Att += data.mass * np.swapaxes(x, 1, 2)
        Bm += 2 * data.mass * np.einsum("tka,tja->tkj", phi, spun)
        Bt += 2 * data.mass * np.einsum("tak,tja->tkj", x, spun)
        Cm += data.mass * np.einsum("tka,tja->tkj", phi, spun + twice)
        Ct += data.mass * np.einsum("tak,tja->tkj", x, np.cross(dw[:, None], phi) + twice)
        d = np.einsum("tij,j->ti", c, data.centre)
        place = nominal.acceleration + np.cross(dw, arm) + np.cross(w, np.cross(w, arm))
        force -= data.mass * np.einsum("ti,tij->tj", place + np.cross(wi, d), x)
        _springs(craft, i, x, c, note)
    note("A_mm rot-rot", Am, cut(A, q, q))
    note("A_mm trans-rot", At, cut(A, p, q))
    note("A_mm rot-trans", np.swapaxes(x @ At, 1, 2), cut(A, q, p))
    note("A_mm trans-trans", Att, cut(A, p, p))
    note("B_mm rot-rot", Bm, cut(B, q, q))
    note("B_mm trans-rot", Bt, cut(B, p, q))
    note("C_mm rot-rot", Cm, cut(C, q, q))
    note("C_mm trans-rot", Ct, cut(C, p, q))
    note("Q_m trans", force, np.einsum("tj,tjk->tk", Q[:, p], x))
    out = []
    for name, blocks in found.items():
        gaps = [float(np.abs(a - b).max(initial=0.0)) for a, b in blocks]
        scale = max(float(np.abs(b).max(initial=0.0)) for _, b in blocks)
        remark = "" if max(gaps) <= 1e-9 * max(scale, 1.0) else REMARKS.get(name, "")
        out.append(Difference(name, max(gaps), scale, remark))
    return tuple(out)


def _springs(craft: FlexibleSpacecraft, i: int, x: Array, c: Array, note: Any) -> None:
    """Hinge springs and dampers, dyads diagonal in appendage axes, unloaded in the nominal."""
    hinge = craft.appendages[i].hinge
    g, h = 2 * np.swapaxes(c, 1, 2), -2 * np.swapaxes(x, 1, 2)  # rows: curls of the turns, inertial axes
    for kind, values in (("damper", hinge.damping), ("spring", hinge.stiffness)):
        K = np.einsum("tij,j,tkj->tik", c, np.array(values, dtype=float), c)
        true_g, true_h = g / 2, h / 2
        for name, a, b, true_a, true_b, sign in (
            ("ii", g, g, true_g, true_g, -1),
            ("im", g, h, true_g, true_h, 1),
            ("mi", h, g, true_h, true_g, -1),
            ("mm", h, h, true_h, true_h, -1),
        ):
            printed = np.einsum("tka,tab,tjb->tkj", a, K, b) * (1 if kind == "damper" else sign)
            derived = np.einsum("tka,tab,tjb->tkj", true_a, K, true_b)
            note(f"{'B' if kind == 'damper' else 'C'}_{name} {kind}", printed, derived)
