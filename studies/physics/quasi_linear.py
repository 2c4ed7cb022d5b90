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

from typing import Self, cast

import numpy as np

from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.signals import GAUSS
from pliant.plants.motions.time_limit import check_time

from .block_collocation import BUTCHER, BlockCollocation, HeldModel
from .fine_model import BEYOND, jacobians, lacking, masses, outputs, trajectory
from .motion_nodes import MotionNodes

Array = np.ndarray
MOST_PASSES = 16
BLOCKS = 48  # of the motion, over each of which one A is held, at first; ..
MORE = 4  # .. times as many where passes shrink slowly
SLOW = 0.25  # of a pass's change that the next one still changes
NEAR = 30.0  # times what is wanted: after a change of less, the linear model is kept
AT_ONCE = 0.01  # of what is wanted: where a motion that goes on changes by less, its first pass is its last
SLOWEST = 0.3  # of a pass's change is what the next one changes, with the linear model kept, at least so it is told
FAR = 3.0  # times what the first pass changes: a pass that changes more runs away
SHRINKS = 0.7  # a pass that changes more than this share of what the last one changed does not settle


class NotSettled(PliantError):
    """Newton's method left the motions that it can follow; the message says where."""


class CorrectedMotion:
    """A motion of `fine` that comes nearer to one with every pass.

    begin (nx,), rate (2 m, nx): where the motion begins and its derivative at the Gauss points of the nodes, which make
    x (2 m, nx) at these points and at_ends (m + 1, nx) by the method's own quadrature. x0 (nx,): where the fine model
    starts. columns: which of [y; x] are compared; outputs (nt, n) are those at the control times, after passes made.
    model: the linear model that passes begin with; None: its own. goes_on: from one that had settled. blocks: of the
    motion, over each of which one A is held at first; None: BLOCKS.
    """

    def __init__(
        self,
        fine: Plant,
        nodes: MotionNodes,
        begin: Array,
        rate: Array,
        x0: Array,
        columns: list[int],
        model: HeldModel | None = None,
        goes_on: bool = False,
        blocks: int | None = None,
    ) -> None:
        self.fine, self.nodes, self.columns = fine, nodes, columns
        self.u, self.t = nodes.inputs[nodes.gauss], nodes.all[nodes.gauss]
        self.rate, slopes = rate, rate.reshape(len(nodes.h), 2, len(begin))
        steps = nodes.h[:, None] * slopes.mean(axis=1)
        self.at_ends = begin + np.vstack([np.zeros(len(begin)), np.cumsum(steps, axis=0)])
        inner = nodes.h[:, None, None] * np.einsum("ij,kjn->kin", BUTCHER, slopes)
        self.x = (self.at_ends[:-1, None] + inner).reshape(rate.shape)
        self._start = x0 - begin
        self.passes, self.changes = 0, list[float]()
        self._first, self._blocks = blocks, min(blocks or BLOCKS, len(nodes.h))
        self._goes_on = goes_on
        self._own = False  # whether its linear model is about the motion as it is
        self._model, self._steps = model, cast(BlockCollocation | None, None)
        self.outputs = self._measured()

    @classmethod
    def from_simple(
        cls, fine: Plant, simple: Plant, motion: Trajectory, nodes: MotionNodes, x0: Array, columns: list[int]
    ) -> Self:
        """From the motion of a simpler plant at all nodes."""
        E = fine.embedding(simple)
        assert motion.dx is not None
        return cls(fine, nodes, motion.x[0] @ E.T, motion.dx[nodes.gauss] @ E.T, x0, columns)

    def refined(self, fine: Plant, nodes: MotionNodes, x0: Array, columns: list[int]) -> Self:
        """The same motion for another fine model, or at other nodes: between its own what collocation has there, a
        slope straight through the two Gauss points of a part. A model of the same states begins with its linear model.
        """
        E, n = fine.embedding(self.fine), self.x.shape[1]
        alike = len(E) == n and bool((np.eye(n) == E).all())
        model, rate = self._model if alike else None, self.rate
        if nodes.parts != self.nodes.parts:
            begins, at = self.nodes.all[self.nodes.ends], nodes.all[nodes.gauss]
            part = np.clip(np.searchsorted(begins, at, side="right") - 1, 0, len(self.nodes.h) - 1)
            share = ((at - begins[part]) / self.nodes.h[part])[:, None]
            slopes = self.rate.reshape(-1, 2, n)[part]
            rate = slopes[:, 0] + (slopes[:, 1] - slopes[:, 0]) * (share - GAUSS[0]) / (GAUSS[1] - GAUSS[0])
        return type(self)(fine, nodes, self.at_ends[0] @ E.T, rate @ E.T, x0, columns, model, True, self._first)

    def settle(self, within: float) -> float:
        """Pass after pass until one changes the outputs by at most `within`; what they may still err by.

        Where that fails with one linear model over many parts, it begins again with one for each part. Where that fails
        too, a PliantError: NotSettled where passes do not shrink, else what the fine model cannot be evaluated at.
        """
        begun = {name: getattr(self, name) for name in ("x", "rate", "at_ends", "outputs", "_start")}
        try:
            return self._settled(within)
        except PliantError:
            if self._blocks >= len(self.nodes.h):
                raise
        self.__dict__.update(begun, passes=0, changes=[], _model=None, _steps=None, _own=False)
        self._blocks = len(self.nodes.h)
        return self._settled(within)

    def _settled(self, within: float) -> float:
        while self.passes < MOST_PASSES:
            finest = self._finest
            self.step(self._anew(within))
            change = self.changes[-1]
            if change > within and self.passes > 1:
                late = self.passes > 3 and change > SHRINKS * self.changes[-2] and finest
                if late or change > FAR * self.changes[0]:
                    raise NotSettled(f"pass {self.passes} still changes the outputs by {change:.3g}")
            if self.passes > 1 and change <= within:
                share = min(max(change / max(self.changes[-2], 1e-300), SLOWEST), SHRINKS)
                return change * share / (1 - share)
            if self._goes_on and change <= AT_ONCE * within:
                return change * SHRINKS / (1 - SHRINKS)
        raise NotSettled(f"{MOST_PASSES} passes do not settle: the last changed the outputs by {self.changes[-1]:.3g}")

    @property
    def _finest(self) -> bool:
        """Whether each part has its own A, about the motion as it was a pass ago."""
        return self._own and self._blocks >= len(self.nodes.h)

    def _anew(self, within: float) -> bool:
        """Whether the next pass takes a linear model about the motion as it is: where there is none, where the first
        pass has moved it far, and where passes shrink slowly, then of more blocks.
        """
        if self._model is None:
            return True
        if not self.changes or self.changes[-1] <= NEAR * within:
            return False
        if len(self.changes) == 1:
            return True
        if self.changes[-1] <= SLOW * self.changes[-2]:
            return False
        if self._own:
            self._blocks = min(MORE * self._blocks, len(self.nodes.h))
        return True

    def step(self, anew: bool = True) -> None:
        """One pass, with the linear model made anew or that of the last. TooLong where its time is over."""
        check_time()
        model = self._linearise() if anew or self._model is None else self._model
        if self._steps is None:
            self._steps = model.over(self.nodes.all[self.nodes.ends])
        n = self.x.shape[1]
        if not (np.abs(self.x) < BEYOND).all():
            raise NotSettled("the corrected motion runs away")
        c = lacking(self.fine, self.t, self.x, self.u, self.rate, self._inverse(model))
        delta, moved, slopes = self._response(c.reshape(-1, 2, n), self._steps)
        self.at_ends = self.at_ends + delta
        self.x, self.rate = self.x + moved.reshape(-1, n), self.rate + slopes.reshape(-1, n)
        self._start = np.zeros(n)
        self.passes += 1
        before, self.outputs = self.outputs, self._measured()
        self.changes.append(float(np.abs(self.outputs - before).max()))

    def _response(self, c: Array, steps: BlockCollocation) -> tuple[Array, Array, Array]:
        """What c (m, 2, nx) makes of the motion: at the ends, at the Gauss points and of the slopes there."""
        return steps.response(c, self._start)

    def lacked_by(self, plant: Plant) -> Array:
        """What this motion lacks of being one of another plant of the same states, (m, 2, nx), as a pass takes it."""
        c = lacking(plant, self.t, self.x, self.u, self.rate, self._inverse(self.model))
        return c.reshape(-1, 2, self.x.shape[1])

    @property
    def model(self) -> HeldModel:
        """The linear model of its last pass."""
        return self._model if self._model is not None else self._linearise()

    def collocation(self) -> BlockCollocation:
        """Of that model over the parts."""
        return self.model.over(self.nodes.all[self.nodes.ends])

    def _inverse(self, model: HeldModel) -> Array | None:
        """The inverse mass matrix (2 m, n, n) that each Gauss point's linear model is held with, if any."""
        if model.mass is None:
            return None
        return np.repeat(model.inverse_mass[model.blocks(self.nodes.all[self.nodes.ends])], 2, axis=0)

    def _linearise(self) -> HeldModel:
        """A of each block, in its middle, at the accelerations of the motion as it is."""
        ends = self.nodes.all[self.nodes.ends]
        edges = np.round(np.linspace(0, len(ends) - 1, self._blocks + 1)).astype(int)
        at = 2 * ((edges[:-1] + edges[1:] - 1) // 2)  # the first Gauss point of the part in the middle
        x, rate, t = ((values[at] + values[at + 1]) / 2 for values in (self.x, self.rate, self.t))
        u = self.u[at]
        M = masses(self.fine, t, x, u)
        if M is not None and not np.isfinite(M).all():
            raise NotSettled("the mass matrix along the motion is not finite")
        A = jacobians(self.fine, t, x, u, rate, M)
        if not np.isfinite(A).all():
            raise NotSettled("the linear model along the motion is not finite")
        made = HeldModel(ends[edges], A, M)
        self._model, self._steps, self._own = made, None, True
        return made

    def _measured(self) -> Array:
        at = self.at_ends[self.nodes.control]
        if not (np.abs(at) < BEYOND).all():
            raise NotSettled("the corrected motion runs away")
        y = outputs(self.fine, self.nodes.times, at, self.nodes.held, self.columns)
        return np.hstack([y, at])[:, self.columns]

    def trajectory(self) -> Trajectory:
        """The motion at the control times."""
        return trajectory(self.fine, self.nodes.times, self.at_ends[self.nodes.control], self.nodes.held)
