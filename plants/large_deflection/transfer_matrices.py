"""Accelerations of a chain of sub-beams by transfer matrices: work that grows with their number, not with its cube.

Each sub-beam i has its own coordinates Y = [frame origin (2), frame angle, q_i] and M Y'' = L_in^T Q_in - L_out^T Q_out
+ Q0, with L the Jacobians of its ends' position and rotation R. Eliminating Y'' gives z_out = U z_in for the state
vector z = [R''; Q; 1] of an end, Q = [force, moment] passed along the chain. The product of the U, with what the root
and the tip prescribe, gives the ends' forces; a second sweep gives the Y''.

Source   "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Eqs (29)-(39), in
         the plane. L' in (30)-(31) and Q0 are derived here by differentiation, not taken from the printed matrices.
Valid    the product: few sub-beams, for its rounding error grows fast with their number
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.core.parameters import require_choice
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.exact_rotations.quadrature import Array, points

from .large_beam import LargeDeflectionBeam
from .sub_beam_chain import Chain


def _turn(angle: ca.SX) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))


METHODS = ("sweep", "product")
LOST = 1e-6  # of the largest force: what the product may leave at the tip


class TransferMatrices(OwnsArrays):
    """The recursion for one plant with kinematics "substructured"."""

    def __init__(self, plant: LargeDeflectionBeam) -> None:
        require_instance("TransferMatrices.plant", plant, LargeDeflectionBeam)
        require_choice("TransferMatrices", "plant.kinematics", plant.kinematics, ("substructured",))
        if plant.varied:
            raise ValueError(f"TransferMatrices: plant.varied = {plant.varied} must be empty")
        self.plant = plant

    @cached_property
    def chain(self) -> Chain:
        """The plant's sub-beams."""
        shapes = self.plant.shapes
        assert isinstance(shapes, Chain)
        return shapes

    @cached_property
    def _sub_beam(self) -> ca.Function:
        """(Y, Y') -> M, Q0, and of both ends R, R', L, L' Y'."""
        plant, chain, shapes = self.plant, self.chain, self.chain.shapes
        beam, g = plant.beam, ca.DM(plant.gravity[:2])
        length, offset = beam.length / chain.segments, shapes.offset(chain.frame)
        Y, rate = ca.SX.sym("Y", 3 + chain.modes), ca.SX.sym("rate", 3 + chain.modes)
        origin, angle, q = Y[:2], Y[2], Y[3:]
        at = points(plant.point_count)
        slope = ca.DM(shapes(at.xi, 1) - offset) @ q

        def position(xi: Array) -> ca.SX:
            """Positions (2, k) of the axis."""
            reach = ca.DM(at.cumulative(xi))
            across = ca.dot(ca.DM(shapes(0.0)[0]), q) + reach @ slope
            along = ca.DM(xi) - reach @ (slope**2) / 2
            return origin + length * _turn(angle) @ ca.horzcat(along, across).T

        z, weight = np.polynomial.legendre.leggauss(len(at.xi) + 1)
        xi, weight = (1 + z) / 2, weight / 2
        r = position(xi)
        speed = ca.jtimes(ca.vec(r), Y, rate).reshape(r.shape)
        line = beam.linear_density * length
        T = line * ca.sum2(ca.sum1(speed**2) @ ca.DM(weight)) / 2
        fine = points(4 * chain.modes + 12)
        turning = rate[2] + ca.DM(shapes(fine.xi, 1) - offset) @ rate[3:]
        T += beam.density * beam.I_z * length * ca.dot(ca.DM(fine.weight), turning**2) / 2
        curvature = shapes(fine.xi, 2)
        K = beam.EI / length * curvature.T @ (fine.weight[:, None] * curvature)
        V = ca.bilin(ca.DM(K), q, q) / 2 - line * ca.dot(g, r @ ca.DM(weight))
        momentum = ca.gradient(T, rate)
        Q0 = ca.gradient(T - V, Y) - ca.jtimes(momentum, Y, rate)
        Q0[3:] -= beam.damping * ca.DM(K) @ rate[3:]
        out = [ca.jacobian(momentum, rate), Q0]
        for end in (0.0, 1.0):
            rotation = angle + ca.dot(ca.DM(shapes(end, 1)[0] - offset), q)
            R = ca.vertcat(position(np.array([end])), rotation)
            L = ca.jacobian(R, Y)
            out += [R, L @ rate, L, ca.jtimes(L @ rate, Y, rate)]
        return ca.Function("sub_beam", [Y, rate], ca.cse([ca.densify(e) for e in out]))

    @cached_property
    def _load(self) -> ca.Function:
        """Tip (R'', rate of rotation, rotation) -> [force, moment] that the payload takes: (H, h) of H R'' + h."""
        load, angle, rate = self.plant.payload, ca.SX.sym("angle"), ca.SX.sym("rate")
        ox, oy = (
            (ca.DM(load.offset[:2]).T @ _turn(angle).T)[0, 0],
            (ca.DM(load.offset[:2]).T @ _turn(angle).T)[0, 1],
        )
        J = ca.vertcat(ca.horzcat(1, 0, -oy), ca.horzcat(0, 1, ox))
        H = load.mass * J.T @ J
        H[2, 2] += load.inertia_z
        h = load.mass * J.T @ (-(rate**2) * ca.vertcat(ox, oy) - ca.DM(self.plant.gravity[:2]))
        return ca.Function("load", [angle, rate], [H, h])

    def _from_input_end(self, R: Array, rate: Array, q: Array, v: Array) -> tuple[Array, Array]:
        """(Y, Y') of a sub-beam whose input end stands at R and moves at `rate` (3,)."""
        shapes, length = self.chain.shapes, self.plant.beam.length / self.chain.segments
        start, slope = shapes(0.0)[0], shapes(0.0, 1)[0] - shapes.offset(self.chain.frame)
        angle, turning = R[2] - slope @ q, rate[2] - slope @ v
        across = np.array([-np.sin(angle), np.cos(angle)])
        along = np.array([np.cos(angle), np.sin(angle)])
        origin = R[:2] - length * across * (start @ q)
        speed = rate[:2] - length * (across * (start @ v) - along * turning * (start @ q))
        return np.concatenate([origin, [angle], q]), np.concatenate([speed, [turning], v])

    def acceleration(self, x: Any, u: Any = None, *, w: Any = None, method: str = "sweep") -> Array:
        """q'' (n,) at a state x (nx,), input u (nu,) and disturbance w (nw,): the same as the plant's own.

        method "product" multiplies the transfer matrices as in Eq (39), which loses a digit or more for each; "sweep"
        carries the relation of force and acceleration along in their place (Riccati's form) and loses none.
        ValueError for a batch of states.
        """
        require_choice("TransferMatrices.acceleration", "method", method, METHODS)
        plant, chain = self.plant, self.chain
        (_, x, u, w, _), batch = plant._arguments(x, u, w)
        if batch is not None:
            raise ValueError(f"acceleration takes one state ({plant.nx},), not a batch of {batch}")
        q, v = x[: chain.n], x[chain.n :]
        R, rate = np.zeros(3), np.zeros(3)
        if chain.rotating:
            R[2], rate[2] = q[0], v[0]
        links = []
        for i in range(chain.segments):
            own = chain.columns(i)
            found = self._sub_beam(*self._from_input_end(R, rate, q[own], v[own]))
            M, Q0, _, _, L_in, bias_in, R, rate, L_out, bias_out = (np.asarray(e) for e in found)
            R, rate = R.ravel(), rate.ravel()
            links.append(_Link(M, Q0, (L_in, L_out), (bias_in.ravel(), bias_out.ravel())))
        H, h = (np.asarray(e) for e in self._load(R[2], rate[2]))
        tip = H, h.ravel() - np.append(w if plant.root == "driven" else u, 0.0)
        start, passed = self._march(links, tip, u) if method == "product" else self._sweep(links, tip, u)
        a = np.zeros(chain.n)
        a[: chain.rotating] = start[2]
        for i, link in enumerate(links):
            a[chain.columns(i)] = (link.response @ np.concatenate([passed[i], passed[i + 1], [1.0]]))[3:]
        return a

    def _root(self, u: Array) -> tuple[Array, list[int], list[int]]:
        """R'' (3,) as far as the root prescribes it, and which of its R'' and of its Q are free."""
        known = np.zeros(3)
        if self.plant.root == "driven":
            known[2] = u[0]
        return (known, [2], [0, 1]) if self.plant.root == "hinged" else (known, [], [0, 1, 2])

    def _march(self, links: list[_Link], tip: tuple[Array, Array], u: Array) -> tuple[Array, list[Array]]:
        """R'' of the root and Q at every joint, by Eq (39): the product of the transfer matrices."""
        whole = np.eye(7)
        for link in links:
            whole = link.transfer @ whole
        moving, turning, held = self._root(u)
        z = np.concatenate([moving, np.zeros(3), [1.0]])
        free = turning + [3 + k for k in held]
        condition = whole[3:6] - tip[0] @ whole[:3]
        z[free] = np.linalg.lstsq(condition[:, free], tip[1] - condition @ z, rcond=None)[0]
        start, passed = z[:3], [z[3:6]]
        for link in links:
            z = link.transfer @ z
            passed.append(z[3:6])
        left = np.abs(z[3:6] - tip[0] @ z[:3] - tip[1]).max()
        largest = max(np.abs(Q).max() for Q in passed)
        if not left <= LOST * largest:
            raise PliantError(
                f"the product of {len(links)} transfer matrices has lost its digits: the tip's force is off by "
                f'{left:.3g} where {largest:.3g} is passed on; use method="sweep", or fewer sub-beams'
            )
        return start, passed

    def _sweep(self, links: list[_Link], tip: tuple[Array, Array], u: Array) -> tuple[Array, list[Array]]:
        """The same without the product: Q = H R'' + h at every joint, from the tip to the root, then back."""
        relations = [tip]
        for link in reversed(links):
            relations.append(link.carried(*relations[-1]))
        H, h = relations[-1]
        a, turning, _ = self._root(u)
        if turning:
            a[turning] = -(h[turning] + H[turning] @ a) / H[turning, turning]
        start, passed = a.copy(), [H @ a + h]
        for link, (H, h) in zip(links, reversed(relations[:-1])):
            a = link.output_end(passed[-1], H, h)
            passed.append(H @ a + h)
        return start, passed


class _Link:
    """One sub-beam: Y'' = response [Q_in; Q_out; 1], and what its ends do."""

    def __init__(self, M: Array, Q0: Array, L: tuple[Array, Array], bias: tuple[Array, Array]) -> None:
        self.response = np.linalg.solve(M, np.column_stack([L[0].T, -L[1].T, Q0]))
        self.ends = [Lk @ self.response for Lk in L]  # R'' of the ends, (3, 7)
        for end, given in zip(self.ends, bias):
            end[:, 6] += given

    @property
    def transfer(self) -> Array:
        """U (7, 7) of Eqs (33)-(38)."""
        start, end = self.ends
        E1 = np.block([[np.zeros((3, 3)), start[:, 3:6]], [-np.eye(3), end[:, 3:6]]])
        E2 = np.block([[np.eye(3), -start[:, :3]], [np.zeros((3, 3)), -end[:, :3]]])
        U = np.eye(7)
        U[:6] = np.linalg.solve(E1, np.column_stack([E2, -np.concatenate([start[:, 6], end[:, 6]])]))
        return U

    def output_end(self, Q: Array, H: Array, h: Array) -> Array:
        """R'' of the output end where Q (3, ..) enters and H R'' + h leaves."""
        end = self.ends[1]
        given = end[:, :3] @ Q + end[:, 3:6] @ h + end[:, 6]
        return np.linalg.solve(np.eye(3) - end[:, 3:6] @ H, given)

    def carried(self, H: Array, h: Array) -> tuple[Array, Array]:
        """(H, h) of the input end from those of the output end."""
        start, end = self.ends
        inverse = np.linalg.inv(np.eye(3) - end[:, 3:6] @ H)
        through = start[:, 3:6] @ H @ inverse
        mobility = start[:, :3] + through @ end[:, :3]
        drift = start[:, 6] + start[:, 3:6] @ h + through @ (end[:, 3:6] @ h + end[:, 6])
        H = np.linalg.inv(mobility)
        return H, -H @ drift
