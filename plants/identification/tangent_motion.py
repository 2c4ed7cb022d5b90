"""A motion with its exact sensitivities: x(t) and dx(t)/d(theta), theta the varied parameters and unknown start states.

A lane carries the state and one tangent s = dx/d(theta_j), by the variational equation (Hairer, Norsett, Wanner,
"Solving Ordinary Differential Equations I", Section I.14)

    dx/dt = f(t, x, u, w, p),    ds/dt = df/dx s + df/dp d,    s(0) = dx(0)/d(theta_j),    d = dp/d(theta_j),

the right-hand side by automatic differentiation along (s, d). Runge-Kutta steps of the pair are the derivatives of the
Runge-Kutta steps of x: what is differentiated is the discrete motion, exactly, and not the flow. Eight lanes cost as
much as one, and many samples are one native call. Between two samples the input is held, or joins them linearly,
u(t) = u + du (t - t0). The method is of order 8 (Dormand and Prince): estimates that are sure to 1e-6 ask for motions
that are surer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.runge_kutta_tableaux import TABLEAUS
from pliant.plants.core.signals import index
from pliant.plants.integration.batch_stepper import telling_step
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import Array, BatchKernel, NativeFunction, Workspace, random_points
from pliant.plants.native.kernel_loader import Kernel
from pliant.plants.native.thread_pool import available
from pliant.plants.rosenbrock.plant_functions import rate_function
from pliant.plants.rounding.agreement import Reference, Trial, of_function
from pliant.plants.rounding.extended_evaluation import mover

METHOD = "rk8"
AT_ONCE = 256  # samples of one native call, after which it is looked at whether the motion is still of finite numbers
SAME = 1e-9  # relative difference of intervals that are one
MOST_STEPS = 5_000_000  # of one motion
DOUBLE = np.dtype(float)


def tangent_function(plant: PlantLike) -> ca.Function:
    """(t, [x; s], [u; du; t0], w, [p; d]) -> [dx/dt; ds/dt] as one SX function."""
    t, x, u, w, p = plant.symbols
    s, d = ca.SX.sym("s", plant.nx), ca.SX.sym("d", len(plant.varied))
    du, t0 = ca.SX.sym("du", plant.nu), ca.SX.sym("t0")
    rate = ca.Function("rate", list(plant.symbols), [ca.cse(plant.expressions[0])])
    moving = rate(t, x, u + du * (t - t0), w, p)
    change = ca.jtimes(moving, ca.vertcat(x, p), ca.vertcat(s, d))
    pair = ca.cse([ca.densify(ca.vertcat(moving, change))])
    return ca.Function("tangent", [t, ca.vertcat(x, s), ca.vertcat(u, du, t0), w, ca.vertcat(p, d)], pair)


def tangent_points(plant: PlantLike, rng: np.random.Generator) -> list[Array]:
    """Points (n, m) at which the kernel is compared."""
    t, x, u, w, p = random_points(plant, rng)
    s, du, d = (rng.uniform(-1.0, 1.0, a.shape) for a in (x, u, p))
    return [t, np.vstack([x, s]), np.vstack([u, du, t]), w, np.vstack([p, d])]


_SAMPLES = """
ENTRY(samples) {
  BLOCK(t, 1); BLOCK(z, NX); BLOCK(u, %(nu)d); BLOCK(w, %(nw)d); BLOCK(p, %(np)d);
  EACH_BLOCK {
    LOAD(z, 1, NX); LOAD(w, 3, %(nw)d); LOAD(p, 4, %(np)d);
    for (long i = 0; i < n; i++) {
      memcpy(t[0], in[0] + i * ld + b, sizeof t[0]);
      for (int k = 0; k < %(nu)d; k++) memcpy(u[k], in[2] + (i * %(nu)d + k) * ld + b, sizeof u[k]);
      march(z, t, (in_t)u, (in_t)w, (in_t)p, (T)s[0], (long)s[1]);
      for (int k = 0; k < NX; k++) memcpy(out[0] + (i * NX + k) * ld + b, z[k], sizeof z[k]);
    }
  }
}
"""


def samples_source(tangent: ca.Function) -> str:
    """`run`: n steps of s[0] seconds. `samples`: n samples of s[1] steps each, t (n), u (n nu) -> [x; s] (n 2 nx)."""
    sizes = {key: tangent.nnz_in(k) for k, key in ((2, "nu"), (3, "nw"), (4, "np"))}
    return kernel_templates.explicit_source(tangent, TABLEAUS[METHOD](), DOUBLE) + _SAMPLES % sizes


def samples_reference(tangent: ca.Function, numeric: Callable[..., Any] = NumericFunction) -> Reference:
    """count samples of scalars[1] steps of scalars[0] seconds on the virtual machine, or as `numeric` has it."""
    rate, moved, tableau, nu = numeric(tangent), mover(numeric), TABLEAUS[METHOD](), tangent.nnz_in(2)

    def reference(t: Array, z: Array, u: Array, w: Array, p: Array, scalars: Any, count: int) -> Sequence[Array]:
        (h, steps), found = scalars, []
        for sample in range(count):
            now, held = t[:, sample : sample + 1], u[:, sample * nu : (sample + 1) * nu]
            for _ in range(int(steps)):
                slopes: list[Array] = []
                for i in range(len(tableau.b) + 1):
                    at = z
                    for j, a in tableau.stage(i).items():
                        at = moved(at + moved(h * a * slopes[j]))
                    if i < len(tableau.b):
                        slopes.append(rate(now + float(tableau.c[i]) * h, at, held, w, p, batch=len(z))[0])
                z, now = at, now + h
            found.append(z)
        return [np.concatenate(found, axis=1)]

    return reference


@lru_cache(maxsize=16)
def tangent_kernel(plant: PlantLike) -> BatchKernel:
    """Motions of a plant's state and one tangent a lane, AT_ONCE samples a call; see `samples_source`."""
    tangent = tangent_function(plant)
    _, nz, nu, nw, n_p = (tangent.nnz_in(k) for k in range(5))

    def drawn(rng: np.random.Generator) -> list[Array]:
        t, z, u, w, p = tangent_points(plant, rng)
        return [np.vstack([t, t]), z, np.vstack([u, u]), w, p]

    def trials() -> list[Trial]:
        h = telling_step(rate_function(plant), random_points(plant, np.random.default_rng(0)))
        rates = Trial(of_function(tangent), partial(tangent_points, plant), entry="rates")
        return [rates, Trial(partial(samples_reference, tangent), drawn, (h, 1.0), 2, entry="samples")]

    return BatchKernel(
        lambda: samples_source(tangent),
        partial(samples_reference, tangent),
        ([AT_ONCE, nz, AT_ONCE * nu, nw, n_p], [AT_ONCE * nz]),
        trials,
        DOUBLE,
        name=f"{METHOD} motions of {type(plant).__name__} ({plant.label}) with tangents of its parameters",
        made=(tangent_kernel, (plant,)),
    )


@lru_cache(maxsize=16)
def measured_function(plant: PlantLike, signals: tuple[str, ...]) -> NumericFunction:
    """(t, x, u, w, p) -> the named outputs or states y (n, 1), dy/dx (n, nx), dy/dp (n, np); native where had."""
    _, x, _, _, p = plant.symbols
    known = plant.states + plant.outputs
    everything = ca.vertcat(x, plant.expressions[1])
    y = ca.cse(everything[[index(known, name, "state or output") for name in signals]])
    results = [ca.densify(e) for e in (y, ca.jacobian(y, x), ca.jacobian(y, p))]
    made = ca.Function("measured", list(plant.symbols), ca.cse(results))
    return NativeFunction(made, partial(random_points, plant), matrices=True)


class TangentMotion:
    """Motions of one plant with as many tangents as are asked for."""

    def __init__(self, plant: PlantLike) -> None:
        self.plant, self.kernel = plant, tangent_kernel(plant)
        self._work: dict[int, Workspace] = {}

    def __call__(
        self,
        t: Array,
        x0: Array,
        u: Array,
        w: Array,
        p: Array,
        seeds: Array,
        directions: Array,
        *,
        step: float,
        hold: str = "zero-order",
    ) -> tuple[Array, Array]:
        """x (nt, nx) and its tangents (nt, m, nx) at the times t (nt,) [s], in steps of order 8, at most `step` [s].

        x0 (nx,), u (nt, nu), w (nw,), p (np,); of each of m tangents seeds (m, nx) are dx(0)/d(theta), directions
        (m, np) dp/d(theta). From where the motion is no longer of finite numbers on, all is NaN.
        """
        nx, m = self.plant.nx, max(1, len(seeds))
        work = self._work.setdefault(m, self.kernel.workspace(m))
        z = work.inputs[1]
        z[:nx], z[nx:] = x0[:, None], 0.0
        z[nx:, : len(seeds)] = seeds.T
        work.inputs[3][:] = w[:, None]
        work.inputs[4][:] = 0.0
        work.inputs[4][: len(p)] = p[:, None]
        work.inputs[4][len(p) :, : len(seeds)] = directions.T
        found = np.full((len(t), 2 * nx, m), np.nan)
        found[0] = z[:, :m]
        with np.errstate(all="ignore"):
            self._march(work, t, u, step, hold, found)
        return found[:, :nx, 0], found[:, nx:, : len(seeds)].transpose(0, 2, 1)

    def _march(self, work: Workspace, t: Array, u: Array, step: float, hold: str, found: Array) -> None:
        intervals = np.diff(t)
        slopes = np.diff(u, axis=0) / intervals[:, None] if hold == "linear" else np.zeros_like(u[1:])
        held = np.hstack([u[:-1], slopes, t[:-1, None]])
        (now, z, given), m = work.inputs[:3], found.shape[2]
        kernel = work.kernel.kernel
        own = Kernel(kernel.path, DOUBLE, kernel.lanes, "samples") if kernel else None

        def on_the_virtual_machine(scalars: Sequence[float], count: int, threads: int) -> None:
            (rows,) = work.kernel.reference(*[a[:, :m].T.astype(float) for a in work.inputs], scalars, count)
            work.outputs[0][: rows.shape[1], :m] = rows.T

        run: Callable[..., None] = own.bind(work.inputs, work.outputs) if own else on_the_virtual_machine
        threads = min(available(), work.padded // work.kernel.lanes)
        for a, b in evenly_spaced(intervals):
            length = float(intervals[a:b].mean())
            steps = max(1, int(np.ceil(length / step - SAME)))
            n = b - a
            now[:n] = t[a:b, None]
            given[: n * held.shape[1]] = held[a:b].reshape(-1, 1)
            run((length / steps, steps), n, threads)
            rows = work.outputs[0].reshape(AT_ONCE, len(z), -1)[:n]
            z[:] = rows[-1]
            found[a + 1 : b + 1] = rows[:, :, :m]
            if not np.isfinite(z).all():
                found[a + 1 :] = np.nan
                return


def evenly_spaced(intervals: Array) -> list[tuple[int, int]]:
    """Ranges of at most AT_ONCE intervals of one length."""
    found, a = [], 0
    while a < len(intervals):
        part = intervals[a : a + AT_ONCE]
        other = np.flatnonzero(np.abs(part - part[0]) > SAME * part[0])
        b = a + (int(other[0]) if len(other) else len(part))
        found.append((a, b))
        a = b
    return found
