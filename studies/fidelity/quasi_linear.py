"""The motion of a fine model from that of a simple one, without simulating it: Newton's method on the whole motion.

The simple motion is embedded in the fine model's states, x = E x_s. What it lacks of being a motion of the fine model,
c(t) = f(x, u) - dx/dt, drives the fine model's linear model along it,

    d(delta)/dt = A(t) delta + c(t),   delta(0) = x_f(0) - E x_s(0),

and x + delta is a better motion: the error of the simple one, to first order. Newton's method goes on from there until
it settles; it says that it does not where it does not. Each part of a control period is one step of Gauss's method of
order four, collocation at two points: implicit, so that modes too fast for the nodes follow their load, and without
damping of its own.

Source   R. E. Bellman, R. E. Kalaba, "Quasilinearization and Nonlinear Boundary-Value Problems" (1965); E. Hairer,
         G. Wanner, "Solving Ordinary Differential Equations II" (1996), IV.5
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.signals import GAUSS
from pliant.plants.validity.ranges import in_words, left

from .motion_nodes import MotionNodes

Array = np.ndarray
BUTCHER = np.array(
    [[1 / 4, 1 / 4 - np.sqrt(3) / 6], [1 / 4 + np.sqrt(3) / 6, 1 / 4]]
)  # of Gauss's method of order four
MOST_PASSES = 8
RELINEARISED = 3  # passes that make a new A; later ones keep it, and ..
NEAR = 30.0  # .. those after a change of less than this many times what is wanted
SLOWEST = 0.3  # of a pass's change is what the next one changes, with the linear model kept, at least so it is told
BEYOND = 1e9  # of a state: nothing moves so
FAR = 3.0  # times what the first pass changes: a pass that changes more runs away
SHRINKS = 0.7  # a pass that changes more than this share of what the last one changed does not settle


class NotSettled(PliantError):
    """Newton's method left the motions that it can follow; the message says where."""


class CorrectedMotion:
    """A motion of `fine` that comes nearer to one with every pass.

    x, rate (2 m, nx): the motion and its derivative at the Gauss points of the nodes; at_ends (m + 1, nx): it at the
    ends of parts; x0 (nx,): where the fine model starts. columns: which outputs are compared; outputs (nt, n) are those
    at the control times, after as many passes as made.
    """

    def __init__(
        self, fine: Plant, nodes: MotionNodes, x: Array, rate: Array, at_ends: Array, x0: Array, columns: list[int]
    ) -> None:
        self.fine, self.nodes, self.columns = fine, nodes, columns
        self._tangent: Plant = fine.newton
        self.u, self.t = nodes.inputs[nodes.gauss], nodes.all[nodes.gauss]
        self.x, self.rate, self.at_ends = x, rate, at_ends
        self._start = x0 - at_ends[0]
        self.passes, self.changes = 0, list[float]()
        self.outputs = self._measured()

    @classmethod
    def from_simple(
        cls, fine: Plant, simple: Plant, motion: Trajectory, nodes: MotionNodes, x0: Array, columns: list[int]
    ) -> Self:
        """From the motion of a simpler plant at all nodes."""
        E, at = fine.embedding(simple), nodes.gauss
        assert motion.dx is not None
        return cls(fine, nodes, motion.x[at] @ E.T, motion.dx[at] @ E.T, motion.x[nodes.ends] @ E.T, x0, columns)

    def refined(self, fine: Plant, nodes: MotionNodes, x0: Array, columns: list[int]) -> CorrectedMotion:
        """The same motion for another fine model, or at more nodes, whose parts lie within its own: between its nodes
        what collocation has there, a slope straight through the two Gauss points of a part, and the integral of that.
        """
        E, n = fine.embedding(self.fine), self.x.shape[1]
        if nodes.parts == self.nodes.parts:
            return CorrectedMotion(fine, nodes, self.x @ E.T, self.rate @ E.T, self.at_ends @ E.T, x0, columns)
        begins = self.nodes.all[self.nodes.ends]
        part = np.clip(np.searchsorted(begins, nodes.all, side="right") - 1, 0, len(self.nodes.h) - 1)
        share = ((nodes.all - begins[part]) / self.nodes.h[part])[:, None]
        slopes = self.rate.reshape(-1, 2, n)[part]
        tilt = (slopes[:, 1] - slopes[:, 0]) / (GAUSS[1] - GAUSS[0])
        rate = slopes[:, 0] + tilt * (share - GAUSS[0])
        moved = share * (slopes[:, 0] - tilt * GAUSS[0]) + tilt * share**2 / 2
        x = self.at_ends[part] + self.nodes.h[part][:, None] * moved
        at = nodes.gauss
        return CorrectedMotion(fine, nodes, x[at] @ E.T, rate[at] @ E.T, x[nodes.ends] @ E.T, x0, columns)

    def settle(self, within: float) -> float:
        """Pass after pass until one changes the outputs by at most `within`; what they may still err by.

        NotSettled where passes do not shrink, or the motion leaves what the fine model can be evaluated at.
        """
        while self.passes < MOST_PASSES:
            before = self.outputs
            self.step(anew=self.passes < RELINEARISED and (not self.changes or self.changes[-1] > NEAR * within))
            change = float(np.abs(self.outputs - before).max())
            late = self.passes > 2 and change > SHRINKS * self.changes[-1]
            if change > within and (late or (self.changes and change > FAR * self.changes[0])):
                raise NotSettled(f"pass {self.passes} still changes the outputs by {change:.3g}")
            self.changes.append(change)
            if self.passes > 1 and change <= within:
                share = min(max(change / max(self.changes[-2], 1e-300), SLOWEST), SHRINKS)
                return change * share / (1 - share)
        raise NotSettled(f"{MOST_PASSES} passes do not settle: the last changed the outputs by {self.changes[-1]:.3g}")

    def step(self, anew: bool = True) -> None:
        """One pass, with the linear model made anew or that of the last."""
        if anew:
            self._linearise()
        n = self.x.shape[1]
        c = self._rates(self.x) - self.rate
        delta, at_gauss = self._steps.response(c.reshape(-1, 2, n), self._start)
        moved = at_gauss.reshape(-1, n)
        self.at_ends = self.at_ends + delta
        self.x, self.rate = self.x + moved, self.rate + np.einsum("kij,kj->ki", self._A, moved) + c
        self._start = np.zeros(n)
        self.passes += 1
        self.outputs = self._measured()

    def _linearise(self) -> None:
        """A (2 m, nx, nx), at the accelerations of the motion as it is."""
        self._A: Array = self._tangent.state_jacobians_along(self._motion(self._tangent))
        if not np.isfinite(self._A).all():
            raise NotSettled("the linear model along the motion is not finite")
        n = self.x.shape[1]
        self._steps = _Collocation(self._A.reshape(-1, 2, n, n), self.nodes.h)

    def _motion(self, plant: Plant) -> Trajectory:
        y = np.zeros((len(self.t), plant.ny))  # unused
        return Trajectory.from_arrays(self.t, self.x, self.u, plant=plant, y=y, dx=self.rate)

    def _rates(self, x: Array) -> Array:
        if not (np.abs(x) < BEYOND).all():
            raise NotSettled("the corrected motion runs away")
        return np.asarray(self.fine.dynamics(x, self.u, t=self.t))

    def _measured(self) -> Array:
        at = self.at_ends[self.nodes.control]
        if not (np.abs(at) < BEYOND).all():
            raise NotSettled("the corrected motion runs away")
        found: Any = self.fine.measure(at, self.nodes.held, t=self.nodes.times)
        return np.asarray(found[:, self.columns])

    def judged(self) -> str:
        """Which ranges of the fine model its own motion leaves, in words."""
        at, u, t = self.at_ends[self.nodes.control], self.nodes.held, self.nodes.times
        motion = Trajectory.from_arrays(t, at, u, plant=self.fine, dx=self.fine.dynamics(at, u, t=t))
        return "; ".join(in_words(found.to_json()) for found in left(self.fine, motion))


class _Collocation:
    """d(delta)/dt = A delta + c over steps h (m,), A (m, 2, n, n) at the Gauss points of each.

    K_i = A_i (delta + h sum_j a_ij K_j) + c_i at both points, delta + h (K_1 + K_2)/2 at the end.
    """

    def __init__(self, A: Array, h: Array) -> None:
        m, _, n, _ = A.shape
        left = -h[:, None, None, None, None] * BUTCHER[:, :, None, None] * A[:, :, None]  # (m, 2, 2, n, n)
        left[:, [0, 1], [0, 1]] += np.eye(n)
        self.h = h
        self._solve = np.linalg.inv(left.transpose(0, 1, 3, 2, 4).reshape(m, 2 * n, 2 * n))
        self._own = self._solve @ A.reshape(m, 2 * n, n)  # K of delta alone
        self._onward = np.eye(n) + h[:, None, None] / 2 * (self._own[:, :n] + self._own[:, n:])

    def response(self, c: Array, start: Array) -> tuple[Array, Array]:
        """delta (m + 1, n) at the ends, (m, 2, n) at the Gauss points, from `start` (n,) under c (m, 2, n)."""
        m, _, n = c.shape
        pushed = np.einsum("kij,kj->ki", self._solve, c.reshape(m, 2 * n))
        push = self.h[:, None] / 2 * (pushed[:, :n] + pushed[:, n:])
        delta = [start]
        for k in range(m):
            delta.append(self._onward[k] @ delta[k] + push[k])
        ends = np.array(delta)
        K = (np.einsum("kij,kj->ki", self._own, ends[:-1]) + pushed).reshape(m, 2, n)
        return ends, ends[:-1, None] + self.h[:, None, None] * np.einsum("ij,kjn->kin", BUTCHER, K)
