"""The adjoint of one control period of a plant, over a batch: slopes in x+ taken back to slopes in x and u.

The map is n RK4 steps, x+ = F(x, u), as `StepSensitivities` has it. Where only (dF/dx)' lambda and (dF/du)' lambda are
asked for, dF/dx need not be formed: backward through the stages of each step (Hager, "Runge-Kutta methods in optimal
control and the transformed adjoint system", Numer. Math. 87, 2000, for any tableau; of RK4's

    m4 = J(y4)' h/6 lambda                 m3 = J(y3)' (h/3 lambda + h m4)
    m2 = J(y2)' (h/3 lambda + h/2 m3)      m1 = J(y1)' (h/6 lambda + h/2 m2)

and lambda <- lambda + m1 + m2 + m3 + m4), J(y)' s is one product with the transposed Jacobian of the rate, by reverse
differentiation: about as many operations as two and a half rates, where J and its product with dx/dx0 take nine
(two-link arm of 12 states). The stages y are computed anew, forward, and kept for the way back.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.integration.batch_stepper import rate_function, telling_step
from pliant.plants.integration.step_guard import require_steps
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import Array, BatchKernel, as_dtype, random_points
from pliant.plants.native.compiler import CompileError
from pliant.plants.native.scalar_codegen import block_function
from pliant.plants.rounding.agreement import Reference, Trial
from pliant.plants.rounding.extended_evaluation import mover

_STEPS = """
static const T PART[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}, REACH[] = {0.0, 0.5, 0.5, 1.0};
#define STAGE(step, stage) (out[2] + (((step) * 4 + (stage)) * NX) * ld + b)
RUN {
  BLOCK(t, 1); BLOCK(now, 1); BLOCK(x, NX); BLOCK(u, NU); BLOCK(w, %(nw)d); BLOCK(p, %(np)d);
  BLOCK(y, NX); BLOCK(sum, NX); BLOCK(k, NX); BLOCK(lambda, NX); BLOCK(after, NX); BLOCK(pushed, NU);
  BLOCK(felt, NX); BLOCK(m, NX); BLOCK(g, NU);
  const T h = (T)s[0];
  EACH_BLOCK {
    LOAD(t, 0, 1); LOAD(x, 1, NX); LOAD(u, 2, NU); LOAD(w, 3, %(nw)d); LOAD(p, 4, %(np)d); LOAD(lambda, 5, NX);
    for (long step = 0; step < n; step++) {
      memcpy(y, x, sizeof x); memcpy(sum, x, sizeof x);
      for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < NX; i++) memcpy(STAGE(step, stage) + i * ld, y[i], sizeof y[i]);
        if (stage == 3 && step == n - 1) break;
        for (int l = 0; l < W; l++) now[0][l] = t[0][l] + h * (step + REACH[stage]);
        rate((in_t)now, (in_t)y, (in_t)u, (in_t)w, (in_t)p, k);
        add(NX, sum, PART[stage] * h, (in_t)k);
        if (stage < 3) ahead(NX, y, (in_t)x, REACH[stage + 1] * h, (in_t)k);
      }
      memcpy(x, sum, sizeof x);
    }
    memset(pushed, 0, sizeof pushed);
    for (long step = n - 1; step >= 0; step--) {
      memcpy(after, lambda, sizeof after);
      for (int stage = 3; stage >= 0; stage--) {
        for (int i = 0; i < NX; i++) LANES for (int l = 0; l < W; l++) felt[i][l] = PART[stage] * h * after[i][l];
        if (stage < 3) add(NX, felt, REACH[stage + 1] * h, (in_t)m);
        for (int i = 0; i < NX; i++) memcpy(y[i], STAGE(step, stage) + i * ld, sizeof y[i]);
        for (int l = 0; l < W; l++) now[0][l] = t[0][l] + h * (step + REACH[stage]);
        back((in_t)now, (in_t)y, (in_t)u, (in_t)w, (in_t)p, (in_t)felt, m, g);
        add(NX, lambda, 1, (in_t)m); add(NU, pushed, 1, (in_t)g);
      }
    }
    STORE(lambda, 0, NX); STORE(pushed, 1, NU);
  }
}
"""


def back_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p, s) -> J_x' s (nx,), J_u' s (nu,) of the rate, as one SX function."""
    rate, (_, x, u, _, _) = ca.densify(plant.expressions[0]), plant.symbols
    s = ca.SX.sym("s", plant.nx)
    slope = ca.densify(ca.jtimes(rate, ca.vertcat(x, u), s, True))
    return ca.Function("back", [*plant.symbols, s], ca.cse([slope[: plant.nx], slope[plant.nx :]]))


def adjoint_source(rate: ca.Function, back: ca.Function, dtype: np.dtype) -> str:
    """n RK4 steps of s[0] seconds backward: (t, x, u, w, p, lambda) -> (slopes in x, slopes in u, stages)."""
    _, nx, nu, nw, np_, _ = (back.nnz_in(k) for k in range(6))
    try:
        code = block_function("rate", rate) + block_function("back", back)
    except NotImplementedError as lacking:  # the virtual machine knows all operations
        raise CompileError(str(lacking)) from lacking
    body = _STEPS % {"nw": nw, "np": np_}
    sizes = f"#define NX {nx}\n#define NU {nu}\n"
    return kernel_templates.head(dtype) + sizes + code + kernel_templates.AHEAD + body


def adjoint_reference(
    rate: ca.Function, back: ca.Function, numeric_function: Callable[..., Any] = NumericFunction
) -> Reference:
    """The same on the virtual machine, or as `numeric_function` has it."""
    forward, backward, moved = numeric_function(rate), numeric_function(back), mover(numeric_function)

    def ahead(y: Array, part: float, k: Array) -> Array:
        return moved(y + moved(part * k))

    def reference(
        t: Array, x: Array, u: Array, w: Array, p: Array, felt: Array, scalars: Any, count: int
    ) -> Sequence[Array]:
        h, batch = scalars[0], len(x)
        stages = []
        for step in range(count):
            now = t + step * h
            k1 = forward(now, x, u, w, p, batch=batch)[0]
            y2 = ahead(x, h / 2, k1)
            k2 = forward(now + h / 2, y2, u, w, p, batch=batch)[0]
            y3 = ahead(x, h / 2, k2)
            k3 = forward(now + h / 2, y3, u, w, p, batch=batch)[0]
            y4 = ahead(x, h, k3)
            stages.append((now, x, y2, y3, y4))
            if step < count - 1:
                k4 = forward(now + h, y4, u, w, p, batch=batch)[0]
                x = ahead(ahead(ahead(ahead(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4)
        pushed = np.zeros_like(u)
        for now, y1, y2, y3, y4 in reversed(stages):
            m4, g4 = backward(now + h, y4, u, w, p, moved(h / 6 * felt), batch=batch)
            m3, g3 = backward(now + h / 2, y3, u, w, p, ahead(moved(h / 3 * felt), h, m4), batch=batch)
            m2, g2 = backward(now + h / 2, y2, u, w, p, ahead(moved(h / 3 * felt), h / 2, m3), batch=batch)
            m1, g1 = backward(now, y1, u, w, p, ahead(moved(h / 6 * felt), h / 2, m2), batch=batch)
            for m, g in ((m4, g4), (m3, g3), (m2, g2), (m1, g1)):
                felt, pushed = moved(felt + m), moved(pushed + g)
        return [felt, pushed, np.concatenate([y for _, *parts in stages for y in parts], axis=1)]

    return reference


@lru_cache(maxsize=16)
def adjoint_kernel(plant: PlantLike, substeps: int, dtype: np.dtype) -> BatchKernel:
    """At most `substeps` RK4 steps backward: (t, x, u, w, p, lambda) -> (slopes in x, slopes in u, stages)."""
    rate, back = rate_function(plant), back_function(plant)

    def draw(rng: np.random.Generator) -> list[Array]:
        points = random_points(plant, rng)
        return [*points, rng.uniform(-1.0, 1.0, points[1].shape)]

    def trials() -> list[Trial]:
        h = telling_step(rate, random_points(plant, np.random.default_rng(0)))
        return [Trial(partial(adjoint_reference, rate, back), draw, (h,), min(2, substeps))]

    return BatchKernel(
        lambda: adjoint_source(rate, back, dtype),
        partial(adjoint_reference, rate, back),
        ([back.nnz_in(k) for k in range(6)], [plant.nx, plant.nu, 4 * substeps * plant.nx]),
        trials,
        dtype,
        name=f"rk4 steps of {type(plant).__name__} ({plant.label}) backward",
        made=(adjoint_kernel, (plant, substeps, dtype)),
    )


class StepAdjoints:
    """The adjoint of a control period of dt [s] in `substeps` RK4 steps, the input held, over `batch` lanes.

    Raises StabilityLimitError where a substep is past RK4's limit at rest. With lambda (batch, nx), slopes of a number
    in x+, it gives that number's slopes in x and in u, as `StepSensitivities` does by lambda' [dx+/dx, dx+/du].
    """

    def __init__(
        self, plant: PlantLike, dt: float, *, substeps: int = 1, batch: int = 1, dtype: Any = np.float64
    ) -> None:
        dt, substeps, batch = require_steps("StepAdjoints", plant, dt, substeps, batch)
        self.plant, self.dt, self.batch, self.substeps = plant, dt, batch, substeps
        self.kernel = adjoint_kernel(plant, substeps, as_dtype(dtype))
        self.work = self.kernel.workspace(batch)
        self.work.set(4, plant.nominal_parameters)
        self._call = (dt / substeps,), substeps

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel.native

    def __call__(
        self, x: Array, u: Array, slope: Array, *, w: Any = None, p: Any = None, t: Any = None
    ) -> tuple[Array, Array]:
        """((dx+/dx)' slope (batch, nx), (dx+/du)' slope (batch, nu)), views that the next call writes over.

        x (batch, nx) and u (batch, nu) at the period's start, slope (batch, nx); w, p, t shared or by row, None keeps
        the last. What is not finite is not refused.
        """
        for k, value in ((0, t), (1, x), (2, u), (3, w), (4, p), (5, slope)):
            if value is not None:
                self.work.set(k, value)
        self.work.run(*self._call)
        return self.work.get(0), self.work.get(1)
