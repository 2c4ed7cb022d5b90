"""The motion of a fine model with a law in the loop, from that of a simple one: Newton's method on the closed loop.

What the motion x under inputs u lacks drives the linear model closed with the law's own linear form, so that what an
open loop would not bear is carried by the closed loop's transition:

    d(delta)/dt = A delta + B du_k + c(t),        from control time k to the next,
    du_k = law(z)_k - u_k - (C s_k + D dz_k),     s_k+1 = A_law s_k + B_law dz_k,    dz_k = H_k delta(t_k)

Every pass plays the law itself on what it would read, z, so that a motion that has settled is one of the loop however
near its linear form is. That is `law_of`'s where the law has one (gains, LQG), else by differences of `act`.

Source   as quasi_linear; B. D. O. Anderson, J. B. Moore, "Optimal Control: Linear Quadratic Methods" (1990), 2.3
"""

from __future__ import annotations

from typing import Self

import numpy as np

from pliant.controllers.analysis.linear_laws import LinearLaw, law_of, linearised
from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.signals import index
from pliant.studies.common.reference_motions import ClosedMotions, Sampled

from .block_collocation import BlockCollocation, HeldModel
from .fine_model import lacking, outputs
from .motion_nodes import MotionNodes
from .quasi_linear import CorrectedMotion, NotSettled

Array = np.ndarray
STEP = 1e-6  # of differences, against the size of what is varied, or 1


def linear_form(law: Sampled, reading: Array) -> LinearLaw:
    """Of a law at the scene's control times, about a reading (nz,) where it has none of its own."""
    try:
        found = law_of(law.law)
    except PliantError:
        found = linearised(law.law, reading)
    if found.delay or (found.dt is None and len(found.A)):
        raise NotSettled("a law whose readings are late, or whose states are continuous, is not corrected")
    return found


class ClosedMotion(CorrectedMotion):
    """A CorrectedMotion whose inputs are a law's; `nodes.held` (nt, nu) are those of the motion as it is."""

    law: Sampled
    linear: LinearLaw
    reads: list[int]  # which of [y; x]

    @classmethod
    def of_loop(
        cls, fine: Plant, motions: ClosedMotions, motion: Trajectory, nodes: MotionNodes, x0: Array, columns: list[int]
    ) -> Self:
        """From the motion of the scene's own plant in the same loop at all nodes."""
        E = fine.embedding(motions.simple)
        assert motion.dx is not None
        return cls(fine, nodes, motion.x[0] @ E.T, motion.dx[nodes.gauss] @ E.T, x0, columns)._with(motions.law, None)

    def _with(self, law: Sampled, linear: LinearLaw | None) -> Self:
        known = (*self.fine.outputs, *self.fine.states)
        names = {s.name for s in known}
        if missing := [name for name in law.reads if name not in names]:
            raise PliantError(f"the law reads {missing[0]}, which {self.fine.label} does not have")
        self.law, self.reads = law, [index(known, name, "output or state") for name in law.reads]
        self.linear = linear_form(law, self._readings(self._control)[0]) if linear is None else linear
        return self

    def refined(self, fine: Plant, nodes: MotionNodes, x0: Array, columns: list[int]) -> Self:
        """The same for another fine model, or at other nodes, under the inputs as they are."""
        nodes = MotionNodes(nodes.times, self.nodes.held, nodes.parts)
        return super().refined(fine, nodes, x0, columns)._with(self.law, self.linear)

    @property
    def _control(self) -> Array:
        """States at the control times (nt, nx)."""
        return self.at_ends[self.nodes.control]

    def _readings(self, x: Array) -> Array:
        """What the law reads (nt, nz) at the control times, under the inputs that acted before."""
        held = self.nodes.held
        before = np.vstack([np.zeros_like(held[:1]), held[:-1]])
        y = outputs(self.fine, self.nodes.times, x, before, self.reads)
        return np.hstack([y, x])[:, self.reads]

    def _asked(self, z: Array) -> Array:
        """What the law itself gives (nt, nu) on readings (nt, nz), one after another."""
        self.law.reset()
        return np.array([self.law.act(float(t), row.copy()) for t, row in zip(self.nodes.times, z)])

    def _reading_slopes(self, z: Array) -> Array:
        """H (nt, nz, nx) by differences."""
        x = self._control
        found = np.empty((len(x), z.shape[1], x.shape[1]))
        for i in range(x.shape[1]):
            h = STEP * max(float(np.abs(x[:, i]).max()), 1.0)
            moved = x.copy()
            moved[:, i] += h
            found[:, :, i] = (self._readings(moved) - z) / h
        return found

    def _input_slopes(self, c: Array, model: HeldModel) -> Array:
        """B (m, 2, nx, nu) by differences: rates are linear in the inputs of most machines."""
        inverse, n = self._inverse(model), self.x.shape[1]
        found = np.empty((*c.shape, self.u.shape[1]))
        for k in range(self.u.shape[1]):
            h = STEP * max(float(np.abs(self.u[:, k]).max()), 1.0)
            moved = self.u.copy()
            moved[:, k] += h
            more = lacking(self.fine, self.t, self.x, moved, self.rate, inverse)
            found[..., k] = (more.reshape(-1, 2, n) - c) / h
        return found

    def _response(self, c: Array, steps: BlockCollocation) -> tuple[Array, Array, Array]:
        assert self._model is not None
        z = self._readings(self._control)
        lacks = self._asked(z) - self.nodes.held
        H, law, parts = self._reading_slopes(z), self.linear, self.nodes.parts
        B = self._input_slopes(c, self._model)
        s, du = np.zeros(len(law.A)), np.empty_like(lacks)

        def inputs(period: int, delta: Array) -> Array:
            nonlocal s
            dz = H[period] @ delta
            du[period] = lacks[period] - (law.C @ s + law.D @ dz)
            s = law.A @ s + law.B @ dz
            return du[period]

        found = steps.closed_response(c, B, self._start, parts, inputs)
        inputs(len(du) - 1, found[0][-1])
        self.nodes = MotionNodes(self.nodes.times, self.nodes.held + du, parts)
        self.u = self.nodes.inputs[self.nodes.gauss]
        return found
