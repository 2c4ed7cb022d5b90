"""Sampled linear laws on many linear models at once: mean cost, largest |z|.

States   z = [x; the last inputs, the oldest first; the law's s]. A reading sees the input that acts when it is taken
Cost     the scene's over the motion from its start, with each input off by PUSH of its limit in every period, and each
         reading by its sensor's deviation; what comes in every period counts as often as the motion has periods
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pliant.controllers.analysis.linear_laws import law_of
from pliant.controllers.base.goal_model import away
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.controllers.base.scene_protocol import CostedScene
from pliant.controllers.estimation.sensors import Sensor
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.riccati.late_inputs import late_period, past_of
from pliant.plants.core.signals import OwnsArrays, rows_by_name
from pliant.plants.linear.lti import LinearModel

from .box_models import PUSH
from .many_models import lyapunov

Array = np.ndarray
UNSTABLE = 50.0  # score of a law that some loop is not stable with, and
STEEP = 200.0  # what log |z| adds to it


class Valued(NamedTuple):
    """Of one law."""

    cost: float  # mean over the models, infinite where one is not stable
    radius: float
    score: float  # log of the cost, or a number that falls with the radius


@dataclass(frozen=True, eq=False)
class Loops(OwnsArrays):
    """Stacked over models and delays (m, ..)."""

    step: Array  # (m, nz, nz + nu)
    cost: Array  # (m, nz + nu, nz + nu)
    seen: Array  # (m, ns, nz)
    start: Array  # (m, nz)
    push: Array  # (nu, nu) covariance of the inputs' error, times the periods
    noise: Array  # (ns, ns) of the readings', times the periods

    def value(self, law: LQG) -> Valued:
        """Of a law whose filter begins with its own first estimate."""
        form = law_of(law)
        m, nz, nu = self.step.shape[0], self.step.shape[1], self.push.shape[0]
        ns, n = form.B.shape[1], len(form.A)
        u = -np.concatenate([form.D @ self.seen, np.broadcast_to(form.C, (m, nu, n))], axis=2)
        A, B = self.step[:, :, :nz], self.step[:, :, nz:]
        top = np.concatenate([A, np.zeros((m, nz, n))], axis=2) + B @ u
        low = np.concatenate([form.B @ self.seen, np.broadcast_to(form.A, (m, n, n))], axis=2)
        F = np.concatenate([top, low], axis=1)
        radius = float(np.abs(np.linalg.eigvals(F)).max())
        if not radius < 1:
            return Valued(np.inf, radius, UNSTABLE + STEEP * float(np.log(radius)))
        both = np.concatenate([np.broadcast_to(np.eye(nz, nz + n), (m, nz, nz + n)), u], axis=1)
        weight = np.swapaxes(both, 1, 2) @ self.cost @ both
        P = lyapunov(np.swapaxes(F, 1, 2), weight)
        first = np.zeros(n)
        begun = law.filter.begun
        first[: len(begun)] = begun
        z = np.hstack([self.start, np.tile(first, (m, 1))])
        errs = np.concatenate([B, np.zeros((m, n, nu))], axis=1)
        reads = np.concatenate([-B @ form.D, np.broadcast_to(form.B, (m, n, ns))], axis=1)
        drive = z[:, :, None] * z[:, None, :] + errs @ self.push @ np.swapaxes(errs, 1, 2)
        drive = drive + reads @ self.noise @ np.swapaxes(reads, 1, 2)
        mean = float(np.einsum("kij,kji->k", P, drive).mean())
        return Valued(mean, radius, float(np.log(mean)))


def loops_over(
    scene: CostedScene, sensors: Sequence[Sensor], models: Sequence[LinearModel], delays: Sequence[float]
) -> Loops:
    """All models with all delays [periods]."""
    past, nu = max(1, *(past_of(d) for d in delays)), scene.plant.nu
    reads = [sensor.output for sensor in sensors]
    parts = []
    for model in models:
        Q, R, N = weight_matrices("loops_over", model, dict(scene.weights), dict(scene.effort))
        _, C, D, _ = rows_by_name(model, reads)
        for delay in delays:
            one = late_period(model.A, model.B, Q, R, N, scene.dt, delay, past)
            seen = np.hstack([C, np.zeros((len(C), past * nu))])
            first = len(model.A) + (past - max(1, past_of(delay))) * nu
            seen[:, first : first + nu] += D
            start = np.concatenate([away(scene, model), np.zeros(past * nu)])
            parts.append((one.step, one.cost, seen, start))
    push = PUSH * np.array(scene.limits, dtype=float)
    noise = np.array([sensor.deviation(scene.dt) for sensor in sensors])
    step, cost, seen, start = (np.stack([part[i] for part in parts]) for i in range(4))
    return Loops(step, cost, seen, start, scene.steps * np.diag(push**2), scene.steps * np.diag(noise**2))
