"""A scene's control period as a batch kernel: what the single and the vector environment both run."""

from __future__ import annotations

from functools import lru_cache, partial
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.integration.batch_stepper import rate_function
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import BatchKernel, random_points
from pliant.plants.rounding.agreement import Trial, of_function

from .control_period import LARGEST, on_virtual_machine, parts, reference, reference_drift, require_time_shown

Array = np.ndarray
T, X, ACTION, REF, W, P = range(6)  # inputs of the kernel
X_NEXT, OBS, COST, MARGIN, SOUND = range(5)  # its outputs


@lru_cache(maxsize=32)
def control_kernel(scene: Scene, dtype: np.dtype) -> BatchKernel:
    """(t, x, action, ref, w, p) -> (x_next, [obs; reach], cost, margin, sound), called with scalars (h,) and the
    substeps.
    """
    require_time_shown(scene)
    rate = rate_function(scene.varied_plant)
    drive, score, sense = parts(scene)
    ref = reference(scene)
    limits = scene.limits

    def draw(rng: np.random.Generator) -> list[Array]:
        t, x, _, w, p = random_points(scene.varied_plant, rng)
        action = rng.uniform(-1.5, 1.5, (scene.plant.nu, t.shape[1]))
        return [t, x, action, np.tile(ref[:, None], t.shape[1]), w, p]

    def draw_rates(rng: np.random.Generator) -> list[Array]:
        t, x, action, _, w, p = draw(rng)
        return [t, x, action * np.reshape(limits, (-1, 1)), w, p]

    def draw_unsound(rng: np.random.Generator) -> list[Array]:
        points = draw(rng)
        for lane in range(points[X].shape[1]):  # one state after the other, too large or no number
            points[X][lane % len(points[X]), lane] = np.nan if lane % 2 else 4 * LARGEST
        return points

    def trials() -> list[Trial]:
        written = partial(on_virtual_machine, scene)
        period = Trial(written, draw, (scene.dt / scene.substeps,), 2)
        unsound = Trial(written, draw_unsound, period.scalars, 0, outputs=(SOUND,))  # before any step
        start = Trial(written, draw, period.scalars, 0, times=8)  # of a period, before any step: no rates to wait for
        return [Trial(of_function(rate), draw_rates, entry="rates"), period, start, unsound]

    return BatchKernel(
        lambda: kernel_templates.control_step_source(rate, drive, score, sense, dtype, LARGEST),
        partial(on_virtual_machine, scene),
        (
            [1, rate.nnz_in(1), scene.plant.nu, len(ref), rate.nnz_in(3), rate.nnz_in(4)],
            [rate.nnz_in(1), sense.nnz_out(0), 1, 1, 1],
        ),
        trials,
        dtype,
        name=f"the control period of scene {scene.name!r}",
        made=(control_kernel, (scene, dtype)),
    )


class ControlStep:
    """The arrays of `lanes` environments and the control period on them.

    x, action, ref, w, p are input arrays (n, lanes) to write into; obs (no, lanes), cost (lanes,) and reach (lanes,)
    outputs to read: reach above 1 says that the plant's kinematics do not hold there (`reach_function`).
    The state is advanced in place. With `alike` the arrays are whole vectors whose columns the caller keeps alike.
    With `plain` observations are the signals themselves, not what they are off the goal; with `goal`, the same scene on
    another plant, the goal is that scene's.
    """

    def __init__(
        self,
        scene: Scene,
        lanes: int,
        dtype: np.dtype,
        threads: int,
        alike: bool = False,
        plain: bool = False,
        goal: Scene | None = None,
    ) -> None:
        self._made: tuple[Any, ...] = scene, lanes, dtype, threads, alike, plain, goal
        self.scene = scene
        self.kernel = control_kernel(scene, dtype)
        self.work = self.kernel.workspace(lanes)
        self.threads = threads
        self._scalars, self._count = (scene.dt / scene.substeps,), scene.substeps
        work = self.work
        self.lanes = work.padded if alike else lanes
        inputs, outputs = ([a[:, : self.lanes] for a in group] for group in (work.inputs, work.outputs))
        self.t, self.x, self.action, self.ref, self.w, self.p = inputs
        self._after, seen, (self.cost,), (self._margin,), (self._sound,) = outputs
        self.obs, self.reach = seen[:-1], seen[-1]
        self._padded = [a for a in work.inputs if work.padded > self.lanes]
        self._ref, self._drift = goal_path(scene if goal is None else goal)
        if plain:
            self._ref[: len(scene.observe)] = self._drift[: len(scene.observe)] = 0.0
        work.set(REF, self._ref[:, 0])
        work.set(P, scene.varied_plant.nominal_parameters)
        work.set(X, scene.initial[0])

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel.native

    def __getstate__(self) -> tuple[Any, list[Array]]:
        return self._made, [a.copy() for a in (*self.work.inputs, *self.work.outputs)]

    def __setstate__(self, state: tuple[Any, list[Array]]) -> None:
        made, arrays = state
        self.__init__(*made)  # type: ignore[misc]
        for array, value in zip((*self.work.inputs, *self.work.outputs), arrays):
            array[:] = value

    def aim(self, lanes: Array, references: Array) -> None:
        """From now on the goals of the lanes (k,) are those of the references (k, nr); of goals that do not move."""
        self.ref[:, lanes] = references.T

    def begin(self, done: int | Array) -> None:
        """Say how many periods (lanes,) of the episode are over: where the goal moves, it is where it then is.

        The cost is charged against the goal at the period's start, the observation shown against that at its end.
        """
        if not self._drift.any():
            return
        n, dt = len(self.scene.observe), self.scene.dt
        self.t[:] = done * dt
        self.ref[:n] = self._ref[:n] + self._drift[:n] * (np.asarray(done) + 1) * dt
        self.ref[n:] = self._ref[n:] + self._drift[n:] * np.asarray(done) * dt

    def run(self) -> tuple[Array, Array]:
        """Advance all lanes; returns (diverged, out of bounds), both (lanes,) bool.

        A diverged lane's x and obs are not to be used: the caller starts that lane again.
        """
        for array in self._padded:
            array[:, self.lanes :] = array[:, :1]
        self.work.run(self._scalars, self._count, self.threads)
        self.x[:] = self._after
        return self._sound == 0, self._margin < 0


def goal_path(scene: Scene) -> tuple[Array, Array]:
    """(ref, d(ref)/dt), (nr, 1) each, of the scene's own goal."""
    return reference(scene)[:, None].copy(), reference_drift(scene)[:, None].copy()
