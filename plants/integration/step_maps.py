"""Fixed-step maps x(t) -> x(t + h), written symbolically, and the largest step at which each stays stable.

rk4          explicit, order 4; stable on the imaginary axis up to h |lambda| = 2 sqrt(2)
rk8          explicit, order 8 in twelve stages; stable on the imaginary axis up to h |lambda| = 5.96
midpoint     implicit midpoint, order 2, symplectic; stable for every decaying mode
rosenbrock   RODAS3, linearly implicit, order 3, L-stable: damps what is too stiff to resolve. Coefficients:
             Sandu et al., "Benchmarking stiff ODE solvers for atmospheric chemistry problems II", 1997
The input over a step is the parabola through its values at the step's start, middle and end; rk8 takes its value at
every stage.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_finite, shown
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.errors import StabilityLimitError
from pliant.plants.core.parameters import require_choice
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.runge_kutta_tableaux import TABLEAUS, Tableau
from pliant.plants.motions.observations import slopes_at_rows
from pliant.plants.native.single_point import OftenCalled

ROUNDED = 4 * np.finfo(float).eps  # of each state: what A^4 may be off, relative to |A|^4
SOLVED = 1e-8  # largest residual of the implicit midpoint rule, relative to the rates


@dataclass(frozen=True)
class Method:
    """A fixed-step method and its order. An explicit one has a step limit."""

    name: str
    order: int

    @property
    def tableau(self) -> Tableau | None:
        """Of an explicit method."""
        return TABLEAUS[self.name]() if self.name in TABLEAUS else None

    @property
    def input_times(self) -> tuple[float, ...]:
        """Fractions of a step at which it takes the input."""
        return tuple(TABLEAUS["rk8"]().c.tolist()) if self.name == "rk8" else (0.0, 0.5, 1.0)


METHODS = {
    m.name: m
    for m in (
        Method("rk4", 4),
        Method("rk8", 8),
        Method("midpoint", 2),
        Method("rosenbrock", 3),
    )
}


def _held(us: ca.SX, c: float) -> ca.SX:
    """The input at fraction c of the step: the parabola through its three values (columns of us)."""
    return us[:, 0] * (2 * c - 1) * (c - 1) + us[:, 1] * 4 * c * (1 - c) + us[:, 2] * c * (2 * c - 1)


@lru_cache(maxsize=64)
def step_map(plant: PlantLike, method: str) -> ca.Function:
    """(t, x, us, w, p, h) -> x(t + h), with us (nu, k) the input at the method's k input times."""
    require_choice("integrate", "method", method, tuple(METHODS))
    t, x, u, w, p = plant.symbols
    f = ca.Function("f", [t, x, u, w, p], [plant.expressions[0]])
    if method == "rk8":
        return TABLEAUS[method]().step(method, f)
    us, h = ca.SX.sym("us", plant.nu, 3), ca.SX.sym("h")
    arguments = [t, x, us, w, p, h]
    build = {"rk4": _rk4, "midpoint": _midpoint, "rosenbrock": _rosenbrock}[method]
    return build(plant, f, arguments)


def _rk4(plant: PlantLike, f: ca.Function, arguments: list[ca.SX]) -> ca.Function:
    t, x, us, w, p, h = arguments
    k1 = f(t, x, us[:, 0], w, p)
    k2 = f(t + h / 2, x + h / 2 * k1, us[:, 1], w, p)
    k3 = f(t + h / 2, x + h / 2 * k2, us[:, 1], w, p)
    k4 = f(t + h, x + h * k3, us[:, 2], w, p)
    after = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return ca.Function("rk4", arguments, ca.cse([after]))


def _midpoint(plant: PlantLike, f: ca.Function, arguments: list[ca.SX]) -> ca.Function:
    t, x, us, w, p, h = arguments
    k = ca.SX.sym("k", plant.nx)
    residual = k - f(t + h / 2, x + h / 2 * k, us[:, 1], w, p)
    slope = ca.Function("slope", [k, *arguments], ca.cse([residual]))
    solve = ca.rootfinder("solve", "newton", slope, {"abstol": 1e-11, "max_iter": 20, "error_on_fail": False})
    a = [ca.MX.sym(f"a{i}", *s.shape) for i, s in enumerate(arguments)]
    start = ca.Function("start", arguments, ca.cse([f(t, x, us[:, 0], w, p)]))
    found = solve(start(*a), *a)
    left = ca.mmax(ca.fabs(slope(found, *a)))
    solved = left <= SOLVED * (1 + ca.mmax(ca.fabs(found)))
    # An unsolved step gives NaN, which the caller reports.
    return ca.Function("midpoint", a, [ca.if_else(solved, a[1] + a[5] * found, np.nan)])


# RODAS3 in the transformed variables that need no matrix-vector products
_A = ((), (0.0,), (2.0, 0.0), (2.0, 0.0, 1.0))
_C = ((), (4.0,), (1.0, -1.0), (1.0, -1.0, -8 / 3))
_M = (2.0, 0.0, 1.0, 1.0)
_ALPHA = (0.0, 0.0, 1.0, 1.0)
_GAMMA = (0.5, 1.5, 0.0, 0.0)


def _rosenbrock(plant: PlantLike, f: ca.Function, arguments: list[ca.SX]) -> ca.Function:
    t, x, us, w, p, h = arguments
    pt, px, pu, pw, pp = plant.symbols
    fx, ft, fu = (ca.jacobian(plant.expressions[0], s) for s in (px, pt, pu))
    du = (-3 * us[:, 0] + 4 * us[:, 1] - us[:, 2]) / h
    J, drift = ca.substitute([fx, ft + fu @ du], [pt, pu], [t, us[:, 0]])
    J, drift = ca.substitute([J, drift], [px, pw, pp], [x, w, p])
    W = 2 / h * ca.SX.eye(plant.nx) - J
    U: list[ca.SX] = []
    stages = [f(t, x, us[:, 0], w, p)]
    inverse = ca.inv(ca.densify(W))
    for i in range(4):
        if i >= 2:
            at = x + sum((a * k for a, k in zip(_A[i], U) if a), ca.SX.zeros(plant.nx))
            stages.append(f(t + _ALPHA[i] * h, at, _held(us, _ALPHA[i]), w, p))
        else:
            stages.append(stages[0])
        rhs = stages[-1] + _GAMMA[i] * h * drift
        rhs += sum((c / h * k for c, k in zip(_C[i], U)), ca.SX.zeros(plant.nx))
        U.append(inverse @ rhs)
    after = x + sum((m * k for m, k in zip(_M, U) if m), ca.SX.zeros(plant.nx))
    return ca.Function("rosenbrock", arguments, ca.cse([after]))


@lru_cache(maxsize=64)
def stepper(plant: PlantLike, method: str) -> NumericFunction:
    """The step map of a plant as a numeric function, built once per plant and method; native if often called."""
    return OftenCalled(step_map(plant, method))


def _limit_of(z: complex, polynomial: np.ndarray, order: int) -> float:
    """The largest h with |R(h z)| <= 1 for all smaller h, of a mode that does not grow by itself."""
    towards = z / abs(z)
    along = polynomial * towards ** np.arange(len(polynomial))
    squared = np.real(np.convolve(along, np.conj(along)))
    squared[0] -= 1.0
    if abs(towards.real) < 1e-9:  # on the imaginary axis powers up to the order cancel exactly, and all odd ones
        squared[: order + 2] = squared[1::2] = 0.0
    lowest = int(np.argmax(squared != 0.0))
    roots = np.roots(squared[lowest:][::-1])
    real = roots[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0)].real
    return float(real.min()) / abs(z) if len(real) else np.inf


@lru_cache(maxsize=8)
def damped_within(method: str) -> float:
    """A radius of h lambda within which an explicit method lets no decaying mode grow: |R(z)| <= 1 in that half disc,
    as seen on a grid, less a tenth.
    """
    tableau = METHODS[method].tableau
    if tableau is None:
        return np.inf
    radii = np.linspace(0.0, 10.0, 201)[1:]
    z = radii[:, None] * np.exp(1j * np.linspace(0.5, 1.0, 46) * np.pi)
    grows = (np.abs(np.polyval(tableau.polynomial[::-1], z)) > 1 + 1e-10).any(axis=1)
    return 0.9 * float(radii[max(0, int(np.argmax(grows)) - 1)])


def step_limit(plant: PlantLike, x: Any, method: str = "rk4", *, u: Any = None, p: Any = None) -> float:
    """The largest stable step [s] of a method at state x (nx,), from the fastest mode of the linearised plant.

    Example
    -------
    >>> from pliant.plants import TwoLinkArm
    >>> arm = TwoLinkArm.textbook()
    >>> round(step_limit(arm, np.zeros(arm.nx)), 5)
    np.float64(0.00358)
    """
    return _slowest_limit(_modes(plant, x, method, u, p), METHODS[method])[0]


def _modes(plant: PlantLike, x: Any, method: str, u: Any, p: Any, t: float = 0.0) -> np.ndarray:
    """Eigenvalues [1/s] of the linearised plant; none for a method without limit."""
    require_choice("integrate", "method", method, tuple(METHODS))
    if isinstance(plant, type) or not hasattr(plant, "jacobians"):
        raise ValueError(f"step_limit.plant = {shown(plant)} must be a Plant")
    x = require_finite(f"{type(plant).__name__}.x", x, (plant.nx,))
    if METHODS[method].tableau is None:
        return np.zeros(0)
    for name, value, size in (("u", u, plant.nu), ("p", p, len(getattr(plant, "varied", ())))):
        if value is not None:
            require_finite(f"step_limit.{name}", value, (size,))
    slopes = plant.jacobians(x, u, p=p, t=t)[0]
    if not np.isfinite(slopes).all():
        raise ValueError(f"step_limit.x = {shown(x)}: the equations linearised there are not finite")
    return np.linalg.eigvals(slopes)


def _slowest_limit(poles: np.ndarray, method: Method) -> tuple[float, complex]:
    tableau, order = method.tableau, method.order
    found = [(np.inf, 0j)]
    if tableau is None:
        return found[0]
    polynomial, fastest = tableau.polynomial, np.abs(poles).max(initial=0.0)
    for pole in poles:
        if abs(pole) <= 1e-6 * fastest or (pole.real > 0 and abs(pole.imag) <= pole.real):
            continue
        # A vibration of a moving arm may grow a little as it turns: its limit is that of the steady vibration.
        steady = pole if pole.real <= 1e-9 * abs(pole) else 1j * abs(pole.imag)
        found.append((_limit_of(steady, polynomial, order), complex(pole)))
    return min(found, key=lambda pair: pair[0])


def check_step(
    plant: PlantLike, x: Any, method: str, step: float, *, u: Any = None, p: Any = None, t: float = 0.0
) -> None:
    """Raise StabilityLimitError when `step` [s] is past the method's limit at x."""
    poles = _modes(plant, x, method, u, p, t)
    # Of a pair one is enough, and what is damped for sure has its limit beyond this step.
    fast = poles[(step * np.abs(poles) > damped_within(method)) & (poles.imag >= 0)]
    limit, mode = _slowest_limit(fast, METHODS[method])
    if step > limit * (1 + 1e-9):
        raise StabilityLimitError(
            f"{method} with a step of {step:.4g} s is unstable for {plant.label} at t = {t:.4g} s: its mode at "
            f"{abs(mode) / (2 * np.pi):.4g} Hz (eigenvalue {mode:.4g} 1/s) needs a step of at most {limit:.4g} s; "
            'take a smaller step, fewer modes, or method="rosenbrock"',
            step,
            mode,
            limit,
        )


def doubtful(
    plant: PlantLike, x: np.ndarray, method: str, steps: np.ndarray, u: np.ndarray, p: np.ndarray, t: np.ndarray
) -> Any:
    """Which of the states x (n, nx), each with its step (n,), input (n, nu) and time t (n,), `check_step` has to look
    at; the others are within what is damped for sure.
    """
    if not len(x) or METHODS[method].tableau is None:
        return np.zeros(0, dtype=int)
    within = damped_within(method)
    slopes = slopes_at_rows(plant)((t[:, None], x, u, np.zeros(plant.nw), p), len(x))
    near = np.flatnonzero(~(steps * at_most(slopes) <= within))  # NaN is near
    if not near.size:
        return near
    slopes = slopes[near]
    sound = np.isfinite(slopes).all(axis=(1, 2))
    fastest = np.abs(np.linalg.eigvals(np.where(sound[:, None, None], slopes, 0.0))).max(axis=1)
    return near[~sound | (steps[near] * fastest > within)]


@np.errstate(over="ignore", invalid="ignore")
def at_most(A: np.ndarray) -> np.ndarray:
    """Bounds (n,) on the spectral radii of matrices (n, m, m), by the fourth root of one for A^4 and for what rounding
    may have taken from it; infinite or NaN where numbers do not hold them.
    """
    squared, rounded = np.matmul(A, A), ROUNDED * A.shape[-1]
    return np.asarray((_of_blocks(np.matmul(squared, squared)) + rounded * _of_blocks(A) ** 4) ** 0.25)


def _of_blocks(A: np.ndarray) -> np.ndarray:
    """max(a, d) + sqrt(b c) of the norms a, b, c, d of the four blocks, of positions and rates, say: a matrix has no
    larger spectral radius than that of its blocks' norms.
    """
    if not (k := A.shape[-1] // 2):
        return np.abs(A[:, 0, 0])
    blocks = np.sqrt(np.add.reduceat(np.add.reduceat(A * A, (0, k), axis=1), (0, k), axis=2))
    return np.asarray(np.maximum(blocks[:, 0, 0], blocks[:, 1, 1]) + np.sqrt(blocks[:, 0, 1] * blocks[:, 1, 0]))
