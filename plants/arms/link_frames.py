"""Reference frames of a bent link on a hub: the line from which its deflection is measured.

clamped         the tangent of the link at the hub: the frame turns with the hub
pinned          the line from the hub's axis through the mass centre of link and payload
pinned-pinned   the line from the hub's axis through the tip

The frame stands at angle theta_f = theta_c + a . q_c from where the hub's tangent would be at theta_c, with a from the
first moment or the tip of the clamped shapes; deflections are w_f = w_c - (R + x) a . q_c. Each frame has its own
modes q_f: those of the loaded link with that frame held, the hub's inertia turning at the root. The clamped frame keeps
the shapes of its basis.

Source   "On the dynamic modelling of flexible manipulators", section 2, Eq (1)
Valid    an exact change of coordinates; a payload's transverse offset shifts no line
"""

from __future__ import annotations

from typing import Protocol

import casadi as ca
import numpy as np

from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.imports import linalg

FRAMES = ("clamped", "pinned", "pinned-pinned")


class ClampedArm(Protocol):
    """What a frame is made from: an arm in the clamped frame, free to turn, in numbers."""

    @property
    def link(self) -> Beam: ...
    @property
    def hub_radius(self) -> float: ...
    @property
    def payload(self) -> Payload: ...
    @property
    def elastic(self) -> ElasticLink: ...
    @property
    def nx(self) -> int: ...
    def mass_matrix(self, x: np.ndarray) -> np.ndarray: ...


def to_clamped(held: ClampedArm, frame: str) -> np.ndarray:
    """S (1 + n, 1 + n): [hub_angle; q_c] = S [frame_angle; q_f], constant; numbers only."""
    n = held.nx // 2 - 1
    if frame == "clamped" or n == 0:
        return np.eye(1 + n)
    a = turn(held, frame)
    shift = np.eye(1 + n)
    shift[0, 1:] = -a
    M = (shift.T @ held.mass_matrix(np.zeros(held.nx)) @ shift)[1:, 1:]
    q = ca.SX.sym("q", n)
    K = np.array(ca.evalf(ca.hessian(held.elastic.strain_energy(q), q)[0]))
    _, modes = linalg.eigh(K, M)
    L, R, basis = held.link.length, held.hub_radius, held.elastic.basis
    # int (phi - (R + x) a)^2 over the link, from the integrals of the basis
    cross = np.outer(R * basis.first + L * basis.moment, a)
    square = basis.mass - cross - cross.T + (R**2 + R * L + L**2 / 3) * np.outer(a, a)
    modes /= np.sqrt(np.einsum("ik,ij,jk->k", modes, square, modes))
    modes *= np.where(a @ modes > 0, -1.0, 1.0)  # positive slope at the hub
    return shift @ linalg.block_diag(1.0, modes)


def turn(arm: ClampedArm, frame: str) -> np.ndarray:
    """a (n,) [rad/m]: how far the frame's line is turned from the hub's tangent by each clamped shape."""
    L, R, basis, load = arm.link.length, arm.hub_radius, arm.elastic.basis, arm.payload
    if frame == "pinned-pinned":
        return basis.tip / (R + L)
    along, m = load.offset[0], arm.link.mass
    across = m * basis.first + load.mass * (basis.tip + along * basis.tip_slope / L)
    return across / (m * (R + L / 2) + load.mass * (R + L + along))
