"""The algebraic Riccati equation in even units, refined, and how far its gain is known.

States and inputs are scaled by powers of two that follow from the problem alone (`even_units`), time by its fastest
rate: whatever units it comes in, SciPy's QZ method gets the same problem to a factor of two. What that leaves is taken
off by Newton steps (Kleinman 1968) on a residual in extended precision. At last every entry of the data is moved by a
rounding: what that does to the gain, to first order, is how far any method can know it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.errors import PliantError
from pliant.plants.linear.even_units import even_units, input_units

Array = np.ndarray
LARGEST_RESIDUAL = 1e-6  # of a Riccati equation, against its largest term
LARGEST_DOUBT = 1e-6  # of a gain, against the largest of its row in even units
NEWTON_STEPS = 6  # at most, each from a stabilising gain
DOUBLINGS = 50  # at most
PROBES = 2  # random roundings of the data
EPS = float(np.finfo(float).eps)


class Problem(NamedTuple):
    """x'Qx + u'Ru + 2 x'Nu under dx/dt = A x + B u, or x+ = A x + B u."""

    A: Array  # (nx, nx)
    B: Array  # (nx, nu)
    Q: Array  # (nx, nx)
    R: Array  # (nu, nu)
    N: Array  # (nx, nu)

    def scaled(self, x: Array, u: Array) -> Problem:
        """In units x (nx,) of the states and u (nu,) of the inputs."""
        A, B, Q, R, N = self
        ix, xx = 1 / x[:, None], x[:, None]
        return Problem(ix * A * x, ix * B * u, xx * Q * x, u[:, None] * R * u, xx * N * u)

    def lean(self) -> Array:
        """R^-1 N' (nu, nx): u = v - lean x has no cross weight."""
        return np.asarray(sla.solve(self.R, self.N.T, assume_a="pos"))

    def units(self) -> tuple[Array, Array]:
        """Even units of the states (nx,) and inputs (nu,), powers of two."""
        u = input_units(self.R)
        even = self.scaled(np.ones(len(self.A)), u)
        reach = sla.solve_triangular(np.linalg.cholesky(even.R), even.B.T, lower=True)
        return even_units(even.A - even.B @ even.lean(), (reach**2).sum(axis=0), np.diagonal(even.Q)), u


class Refined(NamedTuple):
    """A solution and what is wrong with it."""

    residual: float  # against the largest term
    P: Array  # (nx, nx)
    K: Array  # (nu, nx)
    poles: Array  # (nx,) of the closed loop
    decay: float  # of the slowest one

    @property
    def sound(self) -> bool:
        return self.residual <= LARGEST_RESIDUAL and self.decay > 0


def solve_riccati(A: Array, B: Array, Q: Array, R: Array, N: Array, dt: float | None) -> tuple[Array, Array]:
    """P (nx, nx) and K (nu, nx) of a checked problem; PliantError where the equation is not solved."""
    problem = Problem(A, B, Q, R, N)
    x, u = problem.units()
    return solve_even(problem.scaled(x, u), x, u, dt)


def solve_even(even: Problem, x: Array, u: Array, dt: float | None, *, doubted: bool = True) -> tuple[Array, Array]:
    """P and K in the units given, of a problem scaled by x (nx,) and u (nu,).

    doubted: whether a gain that rounding of the data moves is refused; not where it is a start for roots of the data.
    """
    pace = 1.0
    if dt is None:  # time in units of the fastest rate; with it the inputs', so that R stays as it is
        A, B, Q, R, N = even
        fastest = max(float(np.abs(M).max(initial=0.0)) for M in (A, Q, B @ np.linalg.solve(R, B.T)))
        pace = float(np.exp2(np.round(np.log2(fastest) / 2))) if fastest > 0 else 1.0
        even = Problem(A / pace**2, B / pace, Q / pace**2, R, N / pace)
    P, K = _solved(even, dt)
    doubt, slowest = _doubt(even, P, K, dt) if doubted else (0.0, 0j)
    if not doubt <= LARGEST_DOUBT:
        slowest = slowest * pace**2 if dt is None else slowest
        raise PliantError(
            f"the gain is known only to {doubt:.2g} of itself, must be {LARGEST_DOUBT:g}: so far a rounding of A, B, Q "
            f"and R moves it; the closed loop's slowest pole is {slowest:.4g}; change Q and R so that it decays "
            "faster, or give the model without what is lost in rounding"
        )
    return P / x[:, None] / x, u[:, None] * (pace * K) / x


def _solved(even: Problem, dt: float | None) -> tuple[Array, Array]:
    """P and K from SciPy's method; where that does not solve the equation, from doubling."""
    A, B, Q, R, N = even
    best: Refined | None = None
    said = "no solution was found"
    try:
        first = (sla.solve_continuous_are if dt is None else sla.solve_discrete_are)(A, B, Q, R, s=N)
        best = _refined(even, first, dt)
    except (np.linalg.LinAlgError, ValueError) as error:  # ValueError: eigenvalues that it could not reorder
        said = str(error)
    if best is None or not best.sound:
        doubled = _doubled(even, dt)
        other = best if doubled is None else _refined(even, doubled, dt)
        best = other if best is None or (other is not None and other.sound) else best
    if best is None:
        raise PliantError(f"the Riccati equation was not solved ({said}): change Q and R")
    if not best.residual <= LARGEST_RESIDUAL:
        raise PliantError(
            f"the Riccati equation is solved only to a relative residual of {best.residual:.2g}, must be "
            f"{LARGEST_RESIDUAL:g}: change Q and R"
        )
    if best.decay <= 0:
        worst = best.poles[np.argmax(best.poles.real if dt is None else np.abs(best.poles))]
        raise PliantError(f"the closed loop does not decay: a pole is {worst:.4g}; change Q and R")
    return best.P, best.K


def _doubled(even: Problem, dt: float | None) -> Array | None:
    """The cost to go over 2^j steps until it stays (Anderson 1978); None where it does not.

    Continuous time first becomes discrete by a Cayley transform (Chu, Fan and Lin 2005), at twice the fastest rate.
    """
    lean = even.lean()
    F, G, H = even.A - even.B @ lean, even.B @ np.linalg.solve(even.R, even.B.T), even.Q - even.N @ lean
    if dt is None:
        one = np.eye(len(F))
        pace = 2 * max(float(np.linalg.norm(M, 1)) for M in (F, G, H))
        back = np.linalg.inv(F - pace * one)
        W = np.linalg.inv((F - pace * one).T + H @ back @ G)
        F, G, H = one + 2 * pace * W.T, 2 * pace * back @ G @ W, 2 * pace * W @ H @ back
    for _ in range(DOUBLINGS):
        with np.errstate(over="ignore", invalid="ignore"):  # grows where there is no solution
            middle = np.linalg.solve(np.eye(len(F)) + G @ H, np.hstack([F, G @ F.T]))
            more = F.T @ H @ middle[:, : len(F)]
            F, G, H = F @ middle[:, : len(F)], G + F @ middle[:, len(F) :], H + more
        if not all(np.isfinite(M).all() for M in (F, G, H)):
            return None
        G, H = (G + G.T) / 2, (H + H.T) / 2
        if np.abs(more).max(initial=0.0) <= EPS * np.abs(H).max(initial=0.0):
            return H
    return None


def _refined(even: Problem, first: Array, dt: float | None) -> Refined:
    """The step of Newton's method with the smallest residual."""
    P: Array = np.asarray(first).astype(np.longdouble)
    best: Refined | None = None
    size = float(np.abs(first).max(initial=0.0)) or 1.0
    for _ in range(NEWTON_STEPS + 1):
        P = (P + P.T) / 2
        K, residual, relative = _residual(even, P, dt)
        closed = even.A - even.B @ K
        poles = np.linalg.eigvals(closed)
        decay = -poles.real.max() if dt is None else 1 - np.abs(poles).max()
        stalled = best is not None and relative > best.residual / 2
        if best is None or relative < best.residual:
            best = Refined(relative, P.astype(float), K, poles, float(decay))
        if stalled or relative == 0 or decay <= 0:
            break
        step = _lyapunov(closed, residual, dt)
        P = P + step
        if np.abs(step).max(initial=0.0) <= EPS / 4 * size:
            break
    assert best is not None
    return best


def _residual(even: Problem, P: Array, dt: float | None) -> tuple[Array, Array, float]:
    """The gain that P gives, the residual of its Riccati equation, and that relative to the largest term.

    -G'H^-1 G is -G'K - K'G + K'H K to second order in the rounding of K.
    """
    A, B, Q, R, N = (M.astype(np.longdouble) for M in even)
    PA, PB = P @ A, P @ B
    if dt is None:
        terms, H, G = [A.T @ P + PA, Q], R, PB.T + N.T
    else:
        terms, H, G = [A.T @ PA, -P, Q], R + B.T @ PB, B.T @ PA + N.T
    K = sla.solve(H.astype(float), G.astype(float), assume_a="pos")
    fed = G.T @ K
    terms.append(K.T @ (H @ K) - fed - fed.T)
    largest = max(float(np.abs(term).max(initial=0.0)) for term in terms)
    residual: Any = sum(terms)
    return K, residual.astype(float), float(np.abs(residual).max(initial=0.0)) / (largest or 1.0)


def _lyapunov(closed: Array, weight: Array, dt: float | None) -> Array:
    """X with closed'X + X closed = -weight (Bartels and Stewart 1972), or X = closed'X closed + weight (Smith 1968).

    Without a word where a pole is at the boundary: the residual and the doubt tell.
    """
    if dt is None:
        T, U = sla.schur(closed.T)
        X, scale, _ = sla.lapack.dtrsyl(T, T, -U.T @ weight @ U, tranb="T")
        return np.asarray(U @ (X / scale) @ U.T)
    X, F = weight, closed
    for _ in range(DOUBLINGS):
        more = F.T @ X @ F
        X, F = X + more, F @ F
        if np.abs(more).max(initial=0.0) <= EPS / 4 * np.abs(X).max(initial=0.0):
            break
    return np.asarray(X)


def _doubt(even: Problem, P: Array, K: Array, dt: float | None) -> tuple[float, complex]:
    """How far the gain moves, against the largest of its row, where each entry of the data is off by a rounding of
    random sign, and the slowest pole."""
    A, B, _, R, _ = even
    closed, rng, worst = A - B @ K, np.random.default_rng(0), 0.0
    row = np.abs(K).max(axis=1, keepdims=True)
    for _ in range(PROBES):
        dA, dB, dQ, dR, dN = (EPS * M * rng.choice([-1.0, 1.0], size=M.shape) for M in even)
        dQ, dR = (dQ + dQ.T) / 2, (dR + dR.T) / 2
        PA, PB = (P @ dA, P @ dB) if dt is None else (closed.T @ P @ dA, closed.T @ P @ dB)
        moved = PA - (PB + dN) @ K
        dP = _lyapunov(closed, moved + moved.T + dQ + K.T @ dR @ K, dt)
        if dt is None:
            H, G = R, dB.T @ P + B.T @ dP + dN.T - dR @ K
        else:
            H, G = R + B.T @ P @ B, dB.T @ P @ closed + B.T @ (P @ (dA - dB @ K) + dP @ closed) + dN.T - dR @ K
        dK = np.linalg.solve(H, G)
        worst = max(worst, float((np.abs(dK) / np.where(row > 0, row, np.inf)).max(initial=0.0)))
    poles = np.linalg.eigvals(closed).astype(complex)
    return worst, complex(poles[np.argmax(poles.real if dt is None else np.abs(poles))])
