"""Physics' motion by Newton's method on the whole of it: more nodes, then more shapes, until what each still changes is
a small part of the tolerance.

Each motion begins where the last one ended. One that does not settle is found window by window of its time; shapes are
then added at few nodes, and nodes come last.
"""

from __future__ import annotations

import numpy as np

from pliant.plants import MassMatrixError, Plant, PliantError
from pliant.studies.common.reference_motions import Motions

from .fine_model import between_control_times, compared, start_of
from .known_physics import KNOWN, ROUNDING, PhysicsMotion, largest
from .motion_nodes import MotionNodes
from .quasi_linear import CorrectedMotion, NotSettled
from .time_windows import window_by_window

Array = np.ndarray
ROUGH = 5.0  # times what is wanted: physics is simulated where nodes leave more
GAINS = 5.0  # what twice the parts change over what they err by; 15 of order four, less while modes are coarse
EASILY = 100.0  # times better than asked: half as many parts do as well
MOST_PARTS = 16  # of a control period
WINDOWED = 4  # parts of it at which shapes are added where a motion is found window by window, ..
MORE_PARTS = 32  # .. and the most there, as what takes windows is sensitive
MOST_SHAPES = 6  # more than physics has by itself
RTOL = 1e-8  # of the cheap motion, and of physics where it is simulated


class Search:
    """More nodes, then more shapes; each motion begins where the last one ended."""

    def __init__(self, motions: Motions, tolerance: float, first: int = 0) -> None:
        self.first = first
        self.motions, self.scene = motions, motions.scene
        self.simple = motions.ladder[0]
        self.tolerance, self.within = tolerance, KNOWN * tolerance
        self.motion: CorrectedMotion | None = None
        self.settled = set[Plant]()  # models of which a motion has
        self.windows = False  # whether one took windows of time: then those of richer models begin with them

    def corrected(self) -> tuple[PhysicsMotion, CorrectedMotion]:
        """What is known, and the motion. NotSettled, MassMatrixError."""
        more, lost = self.first, ""
        coarse, passes, parts = self._begun(more)
        self.within = max(self.within, ROUNDING * largest(coarse))
        if self.windows:  # nodes come last: each motion of so many would be dear
            found, time = coarse, float("inf")
        else:
            found, passes, parts, time = self._in_time(more, coarse, parts)
        physics, shapes, last = self.scene.plant.physics, 0.0, float("inf")
        if EASILY * time <= self.within:
            parts //= 2  # twice as many have shown that these do
        while more < MOST_SHAPES and physics(more + 1) != physics(more):
            before = self.motion
            try:
                richer, passes = self._outputs(more + 1, parts)
            except PliantError as failure:
                if not isinstance(failure, MassMatrixError) and "exact rotations" in physics(more).effects:
                    raise  # a simulation may go on
                self.motion, lost = before, f"; not with a shape more: {failure}"
                if more == self.first:
                    shapes = largest(found - self._poorer())
                break
            shapes, found, more = largest(richer - found), richer, more + 1
            if shapes <= self.within or shapes > last:
                break
            last = shapes
        if physics(more + 1) == physics(more):  # no more are known of
            shapes *= physics(more).left_out
        if more > self.first or self.windows:  # the shapes that were added are the fastest
            found, passes, parts, time = self._in_time(more, found, parts)
        if time > ROUGH * self.within:
            raise NotSettled(f"{parts} parts of a control period leave an error of {time:.3g}")
        motion = self.motion
        assert motion is not None
        how = f"{motion.fine.label}, from the motion of {self.simple.label}{lost}"
        return PhysicsMotion(found, motion.fine, passes, time, shapes, how, motion=motion), motion

    def _begun(self, more: int) -> tuple[Array, float, int]:
        """(outputs, what passes leave, parts) of the first motion: of one part a period, where that will do."""
        try:
            coarse, passes = self._outputs(more, 1)
            if not self.windows:
                return coarse, passes, 1
        except NotSettled:
            self.motion = None
        return *self._outputs(more, WINDOWED), WINDOWED

    def _poorer(self) -> Array:
        """The outputs with a shape fewer: what the last shape did bounds, as a rule, what those beyond do."""
        plant, motion = self.scene.plant.physics(self.first - 1), self.motion
        if plant == self.scene.plant.physics(self.first):
            raise NotSettled("its mass matrix is lost with a shape more, and it has none fewer")
        assert motion is not None
        return self._settled(from_simple(self.motions, plant, motion.nodes))[0].outputs

    def _in_time(self, more: int, coarse: Array, parts: int) -> tuple[Array, float, int, float]:
        """(outputs, what passes leave, parts, error) with so many parts of a period that the error is within."""
        while True:
            parts *= 2
            found, passes = self._outputs(more, parts)
            time = largest(found - coarse) / GAINS
            if time <= self.within or parts >= (MORE_PARTS if self.windows else MOST_PARTS):
                return found, passes, parts, time
            coarse = found

    def _outputs(self, more: int, parts: int) -> tuple[Array, float]:
        """The outputs with `more` shapes, and what Newton's method leaves."""
        fine = self.scene.plant.physics(more)
        nodes = MotionNodes(self.scene.times, self.motions.held, parts)
        if self.motion is None:
            self.motion = from_simple(self.motions, fine, nodes)
        else:
            self.motion = self.motion.refined(fine, nodes, start_of(self.motions, fine), compared(self.motions, fine))
        self.motion, left = self._settled(self.motion)
        return self.motion.outputs, left

    def _settled(self, motion: CorrectedMotion) -> tuple[CorrectedMotion, float]:
        """A motion that has settled, and what it leaves: as a whole, where that fails after one window by window."""
        again = self.windows and motion.fine not in self.settled
        try:
            if again:
                motion = self._in_windows(motion)
            left = motion.settle(self.within)
        except (NotSettled, MassMatrixError) as failure:
            if again:
                raise
            try:
                motion = self._in_windows(motion)
                left = motion.settle(self.within)
            except PliantError:
                raise failure from None
            self.windows = True
        self.settled.add(motion.fine)
        return motion, left

    def _in_windows(self, motion: CorrectedMotion) -> CorrectedMotion:
        """The motion of the same model at the same nodes found anew, window by window."""
        fine, start = motion.fine, start_of(self.motions, motion.fine)
        return window_by_window(fine, self.simple, motion.nodes, start, motion.columns, self.within)


def from_simple(motions: Motions, fine: Plant, nodes: MotionNodes) -> CorrectedMotion:
    """The motion of `fine` from that of the cheapest variant, before the first pass."""
    simple = motions.ladder[0]
    motion = between_control_times(simple, motions.run(simple, rtol=RTOL, atol=RTOL / 100), nodes)
    if motion is None:
        motion = motions.at_nodes(simple, nodes.inputs, nodes.all, rtol=RTOL, atol=RTOL / 100)
    return CorrectedMotion.from_simple(fine, simple, motion, nodes, start_of(motions, fine), compared(motions, fine))
