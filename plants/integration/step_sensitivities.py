"""One control period of a plant with its exact derivatives, over a batch: x+, dx+/dx, dx+/du of n RK4 steps.

The derivatives are those of the discrete map, not of the flow: S = [dx/dx0, dx/du] (nx, nx + nu) is carried through
every stage of the Runge-Kutta steps by the variational equation dS/dt = J [S; 0, 1], J = [df/dx, df/du]
(Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I", Section I.14). J is sparse and generated; the
product with S is a loop over its entries, each over the lanes. Stages of a horizon are lanes, not a chain.

Of a mechanical plant, M a = r, the slopes of the accelerations come by implicit differentiation,
da = M^-1 (dr - dM a): an eighth fewer operations than differentiating M^-1 r (7205 for 8303, two-link arm of 12
states). Directional derivatives of the rate, one for every column of S, would take 14 x 3458.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import Array, BatchKernel, as_dtype, random_points
from pliant.plants.native.compiler import CompileError
from pliant.plants.native.scalar_codegen import block_function
from pliant.plants.rounding.agreement import Reference, Trial
from pliant.plants.rounding.extended_evaluation import mover

from .batch_stepper import rate_function, telling_step
from .step_guard import require_steps

_STEPS = """
static const int ROW[] = {%(rows)s}, COLUMN[] = {%(columns)s};
static void carry(in_t j, in_t s, T (*restrict k)[W]) {
  memset(k, 0, NX * NC * sizeof *k);
  for (int e = 0; e < %(entries)d; e++) {
    if (COLUMN[e] >= NX) {
      LANES for (int l = 0; l < W; l++) k[ROW[e] * NC + COLUMN[e]][l] += j[e][l];
      continue;
    }
    in_t from = s + COLUMN[e] * NC;
    T (*restrict to)[W] = k + ROW[e] * NC;
    for (int c = 0; c < NC; c++) LANES for (int l = 0; l < W; l++) to[c][l] += j[e][l] * from[c][l];
  }
}
static const T PART[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}, REACH[] = {0.5, 0.5, 1.0};
RUN {
  BLOCK(t, 1); BLOCK(now, 1); BLOCK(x, NX); BLOCK(u, %(nu)d); BLOCK(w, %(nw)d); BLOCK(p, %(np)d);
  BLOCK(y, NX); BLOCK(sum, NX); BLOCK(k, NX); BLOCK(j, %(entries)d);
  BLOCK(big, NX * NC); BLOCK(ys, NX * NC); BLOCK(sums, NX * NC); BLOCK(ks, NX * NC);
  const T h = (T)s[0];
  EACH_BLOCK {
    LOAD(t, 0, 1); LOAD(x, 1, NX); LOAD(u, 2, %(nu)d); LOAD(w, 3, %(nw)d); LOAD(p, 4, %(np)d);
    memset(big, 0, sizeof big);
    for (int i = 0; i < NX; i++) for (int l = 0; l < W; l++) big[i * NC + i][l] = 1;
    for (long step = 0; step < n; step++) {
      memcpy(y, x, sizeof x); memcpy(sum, x, sizeof x); memcpy(now, t, sizeof t);
      memcpy(ys, big, sizeof big); memcpy(sums, big, sizeof big);
      for (int stage = 0; stage < 4; stage++) {
        slopes((in_t)now, (in_t)y, (in_t)u, (in_t)w, (in_t)p, k, j);
        carry((in_t)j, (in_t)ys, ks);
        add(NX, sum, PART[stage] * h, (in_t)k); add(NX * NC, sums, PART[stage] * h, (in_t)ks);
        if (stage == 3) break;
        ahead(NX, y, (in_t)x, REACH[stage] * h, (in_t)k); ahead(NX * NC, ys, (in_t)big, REACH[stage] * h, (in_t)ks);
        for (int l = 0; l < W; l++) now[0][l] = t[0][l] + REACH[stage] * h;
      }
      memcpy(x, sum, sizeof x); memcpy(big, sums, sizeof big);
      for (int l = 0; l < W; l++) t[0][l] += h;
    }
    STORE(x, 0, NX); STORE(big, 1, NX * NC);
  }
}
"""


def slopes_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p) -> dx/dt (nx,), J = [df/dx, df/du] (nx, nx + nu), sparse, as one SX function."""
    return ca.Function("slopes", list(plant.symbols), ca.cse([ca.densify(plant.expressions[0]), plant.slopes()]))


def sensitivity_source(slopes: ca.Function, dtype: np.dtype) -> str:
    """n RK4 steps of s[0] seconds, the input held: (t, x, u, w, p) -> (x+, [dx+/dx, dx+/du] row by row)."""
    rows, columns = slopes.sparsity_out(1).get_triplet()
    _, nx, nu, nw, np_ = (slopes.nnz_in(k) for k in range(5))
    try:
        code = block_function("slopes", slopes)
    except NotImplementedError as lacking:  # the virtual machine knows all operations
        raise CompileError(str(lacking)) from lacking
    body = _STEPS % {
        "rows": ", ".join(map(str, rows)),
        "columns": ", ".join(map(str, columns)),
        "entries": len(rows),
        "nu": nu,
        "nw": nw,
        "np": np_,
    }
    sizes = f"#define NX {nx}\n#define NC {nx + nu}\n"
    return kernel_templates.head(dtype) + sizes + code + kernel_templates.AHEAD + body


def sensitivity_reference(slopes: ca.Function, numeric_function: Callable[..., Any] = NumericFunction) -> Reference:
    """The same on the virtual machine, or as `numeric_function` has it."""
    numeric = numeric_function(
        ca.Function("slopes", slopes.sx_in(), [ca.densify(e) for e in slopes.call(slopes.sx_in())]), matrices=True
    )

    moved = mover(numeric_function)

    def rates(t: Array, x: Array, S: Array, *rest: Array) -> tuple[Array, Array]:
        rate, J = numeric(t, x, *rest, batch=len(x))
        nx = x.shape[1]
        change = moved(J[:, :, :nx] @ S)
        change[:, :, nx:] += J[:, :, nx:]
        return rate[:, :, 0], change

    def reference(t: Array, x: Array, u: Array, w: Array, p: Array, scalars: Any, count: int) -> Sequence[Array]:
        (batch, nx), h = x.shape, scalars[0]

        def ahead(y: Array, *parts: tuple[float, Array]) -> Array:
            for part, k in parts:
                y = moved(y + moved(h * part * k))
            return y

        S = np.tile(np.eye(nx, nx + u.shape[1]), (batch, 1, 1))
        for _ in range(count):
            k1, s1 = rates(t, x, S, u, w, p)
            k2, s2 = rates(t + h / 2, ahead(x, (0.5, k1)), ahead(S, (0.5, s1)), u, w, p)
            k3, s3 = rates(t + h / 2, ahead(x, (0.5, k2)), ahead(S, (0.5, s2)), u, w, p)
            k4, s4 = rates(t + h, ahead(x, (1.0, k3)), ahead(S, (1.0, s3)), u, w, p)
            x = ahead(x, (1 / 6, k1), (1 / 3, k2), (1 / 3, k3), (1 / 6, k4))
            S = ahead(S, (1 / 6, s1), (1 / 3, s2), (1 / 3, s3), (1 / 6, s4))
            t = t + h
        return [x, S.reshape(batch, -1)]

    return reference


@lru_cache(maxsize=16)
def sensitivity_kernel(plant: PlantLike, dtype: np.dtype) -> BatchKernel:
    """n RK4 steps of a plant with their derivatives: (t, x, u, w, p) -> (x+, [dx+/dx, dx+/du])."""
    slopes = slopes_function(plant)
    sizes = [slopes.nnz_in(k) for k in range(5)]

    def trials() -> list[Trial]:
        draw = partial(random_points, plant)
        h = telling_step(rate_function(plant), draw(np.random.default_rng(0)))
        return [Trial(partial(sensitivity_reference, slopes), draw, (h,), 2)]

    return BatchKernel(
        lambda: sensitivity_source(slopes, dtype),
        partial(sensitivity_reference, slopes),
        (sizes, [plant.nx, plant.nx * (plant.nx + plant.nu)]),
        trials,
        dtype,
        name=f"rk4 steps of {type(plant).__name__} ({plant.label}) with their derivatives",
        made=(sensitivity_kernel, (plant, dtype)),
    )


class StepSensitivities:
    """A control period of dt [s] in `substeps` RK4 steps, the input held, with its derivatives, over `batch` lanes.

    Raises StabilityLimitError where a substep is past RK4's limit at rest. `x_next` (batch, nx) and
    `S` (batch, nx, nx + nu) = [dx+/dx, dx+/du] hold the last results.
    """

    def __init__(
        self, plant: PlantLike, dt: float, *, substeps: int = 1, batch: int = 1, dtype: Any = np.float64
    ) -> None:
        dt, substeps, batch = require_steps("StepSensitivities", plant, dt, substeps, batch)
        self.plant, self.dt, self.batch, self.substeps = plant, dt, batch, substeps
        self.kernel = sensitivity_kernel(plant, as_dtype(dtype))
        self.work = self.kernel.workspace(batch)
        self.work.set(4, plant.nominal_parameters)
        nx, nc = plant.nx, plant.nx + plant.nu
        self.x_next, self.S = np.zeros((batch, nx)), np.zeros((batch, nx, nc))
        self._found = (
            self.work.outputs[0][:, :batch].T,
            self.work.outputs[1].reshape(nx, nc, -1)[:, :, :batch].transpose(2, 0, 1),
        )
        self._call = (dt / substeps,), substeps

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel.native

    def __call__(
        self, x: Array, u: Array, *, w: Any = None, p: Any = None, t: Any = None
    ) -> tuple[Array, Array, Array]:
        """(x+ (batch, nx), dx+/dx (batch, nx, nx), dx+/du (batch, nx, nu)), views of `x_next` and `S`.

        x (batch, nx), u (batch, nu); w, p, t shared or by row, None keeps the last. What is not finite is not refused.
        """
        for k, value in ((0, t), (1, x), (2, u), (3, w), (4, p)):
            if value is not None:
                self.work.set(k, value)
        self.work.run(*self._call)
        self.x_next[:], self.S[:] = self._found
        return self.x_next, self.S[:, :, : self.plant.nx], self.S[:, :, self.plant.nx :]
