"""What regulators and filters claim, on random plants, against solutions by other ways.

    python tests/campaigns/regulators.py --count 2000

lqr       K and P, continuous and sampled: structured doubling (Chu, Fan, Lin and Wang 2005), the cost of a sampled step
          by Gauss's quadrature of matrix exponentials; the cost claimed by a rollout
kalman    gain and covariance by doubling of the dual equation; the variance claimed by Monte Carlo with the filter's
          own gain: the sum over independent lanes of e'P^-1 e is chi-square
tvlqr     gains and costs of a finite horizon as one dense least-squares problem
mpc       the first move and the plan within limits of the inputs: bounded least squares (Stark and Parker 1995)
funnel    from random states inside, `TVLQR.act` played on its model: no input beyond its limit, the law after the end
          included, and the state stays inside
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import by_seed
import numpy as np
import scipy.linalg as sla
from dense_solutions import (
    continuous,
    discrete,
    doubled_precisely,
    filtered,
    quadrature,
    random_steps,
    stacked,
)
from random_loops import Wrong, held, modes
from scipy.optimize import lsq_linear
from scipy.stats import chi2

from pliant.controllers import LQR, MPC, TVLQR, Kalman, Sensor, riccati
from pliant.plants import LinearModel, LTVModel, PliantError

Array = Any
KINDS = ("lqr", "kalman", "tvlqr", "mpc", "funnel")
SAME = 1e-6  # of the largest of a gain, of the standard deviations of a covariance: what doubling itself keeps
LANES, SAMPLES = 300, 40
CHANCE = 1e-3 / 10_000  # that one test of a variance fails though it is right: of 10 000 tests, one run in a thousand
LEAST = 1e-6  # of a limit: how far past it a plan, or an input inside the funnel, may be (KEPT of least_distance_qp.py)


def away(found: Array, right: Array, scale: Array | None = None) -> float:
    size = np.abs(right).max() if scale is None else scale
    return float((np.abs(found - right) / np.where(size > 0, size, 1.0)).max(initial=0.0))


def near(found: Array, right: Array, words: str, scale: Array | None = None) -> None:
    off = away(found, right, scale)
    if not off <= SAME:
        raise Wrong(f"{words} off by {off:.2g}")


def rounded(rng, M: Array) -> Array:
    """Every entry off by a rounding; symmetric where M is."""
    near_by = M * (1 + np.finfo(float).eps * rng.choice([-1.0, 1.0], size=M.shape))
    return (near_by + near_by.T) / 2 if M.ndim == 2 and M.shape == M.T.shape and (M == M.T).all() else near_by


def solved(rng, found: tuple[Array, Array], solve: Any, given: tuple[Array, ...], tall: bool) -> None:
    """Gain and covariance against solve(*given); where doubling lacks digits, in 50 of them, and to what a rounding of
    what is given moves. tall: the gain's rows are states."""

    def off(gain: Array, P: Array, right: tuple[Array, Array]) -> float:
        size = np.sqrt(np.diag(right[1]))
        unit = np.abs(right[0] / size[:, None]).max(axis=0) * size[:, None] if tall else np.abs(right[0]).max()
        return max(away(gain, right[0], unit), away(P, right[1], np.outer(size, size)))

    if off(*found, solve(*given)) <= SAME:
        return
    right = solve(*given, doubled_precisely)
    moved = off(*solve(*(rounded(rng, M) for M in given), doubled_precisely), right)
    worst = off(*found, right)
    if not worst <= max(SAME, 30 * moved):
        raise Wrong(f"gain or covariance off by {worst:.2g}, rounding moves it by {moved:.2g}")


def plant(rng, growing: bool = True) -> tuple[Array, Array, float]:
    """A, B, dt: a rigid body less, as many as there are inputs can be held by."""
    while True:
        A, _ = modes(rng)
        rate = np.linalg.eigvals(A)
        if len(A) <= 6 and (growing or rate.real.max() <= 0):
            break
    B = rng.standard_normal((len(A), int(rng.integers(1, 4))))
    T = np.linalg.qr(rng.standard_normal(A.shape))[0]
    return T @ A @ T.T, B, float(10 ** rng.uniform(-1, 0.3) / max(np.abs(rate).max(), 0.3))


def root_weight(rng, n: int) -> Array:
    root = rng.standard_normal((n, n)) + np.eye(n)
    return root @ root.T / n


def lqr(rng) -> str:
    A, B, dt = plant(rng)
    n, nu = B.shape
    Q, R = root_weight(rng, n), 10 ** rng.uniform(-2, 2) * (root_weight(rng, nu) + np.eye(nu))
    model = LinearModel.from_matrices(A, B)
    if rng.random() < 0.5:
        law = LQR.design(model, Q, R)
        solved(rng, (law.K, law.P), continuous, (A, B, Q, R), False)
        E, rolled = sla.expm(0.1 * dt * (A - B @ law.K)), 0.0
        M = quadrature(A - B @ law.K, np.zeros((n, 0)), Q + law.K.T @ R @ law.K, 0.1 * dt)
    else:
        law, (E, G) = LQR.design(model, Q, R, dt=dt), held(A, B, dt)
        M = quadrature(A, B, sla.block_diag(Q, R), dt)
        solved(rng, (law.K, law.P), discrete, (E, G, M[:n, :n], M[n:, n:], M[:n, n:]), False)
        wide = np.vstack([np.eye(n), -law.K])
        E, M = E - G @ law.K, wide.T @ M @ wide
    rolled = np.zeros((n, n))
    for _ in range(60):  # the sum over 2^60 steps
        rolled, E, M = M, E @ E, M + E.T @ M @ E
        if np.abs(M - rolled).max() <= 1e-15 * np.abs(M).max():
            break
    x = rng.standard_normal(n)
    if abs(x @ M @ x - law.cost_to_go(x)) > 1e-5 * law.cost_to_go(x):
        raise Wrong(f"a cost of {x @ M @ x:.8g} was told as {law.cost_to_go(x):.8g}")
    return "lqr"


def kalman(rng) -> str:
    A, B, dt = plant(rng, growing=False)
    n, nu = B.shape
    ny = int(rng.integers(1, 4))
    C = rng.standard_normal((ny, n))
    noise, density = 10 ** rng.uniform(-4, 0, ny), 10 ** rng.uniform(-3, 1, nu)
    white = bool(rng.random() < 0.5)
    model = LinearModel.from_matrices(A, B, C)
    sensors = [Sensor("other", name, "", noise=float(s)) for name, s in zip(model.output_names, noise)]
    W = dict(zip(model.input_names, density.tolist()))
    law = Kalman.design(model, sensors, W, dt=dt, noise="white" if white else "held")
    E, G = held(A, B, dt)
    drive = G @ np.diag(density / dt) @ G.T
    if white:  # the integral of e^(As) B W B' e^(A's)
        drive = quadrature(A.T, np.zeros((n, 0)), B @ np.diag(density) @ B.T, dt)
    claim = law.gains[-1]
    solved(rng, (claim.L, claim.P), filtered, (E, C, drive, noise), True)
    return monte_carlo(rng, law, (E, G, C), drive, noise)


def monte_carlo(rng, law: Kalman, plant_: tuple[Array, Array, Array], drive: Array, noise: Array) -> str:
    """Lanes that start with an error of the claimed covariance: it must stay that."""
    E, G, C = plant_
    claim, n = law.gains[-1], len(E)
    x, u = rng.standard_normal((n, LANES)), rng.standard_normal((SAMPLES, G.shape[1]))
    value, vector = np.linalg.eigh(drive)
    push, spread = (
        vector * np.sqrt(np.maximum(value, 0.0)),
        np.linalg.cholesky(claim.P + 1e-14 * np.diag(np.diag(claim.P))),
    )
    seen = x - spread @ rng.standard_normal((n, LANES))
    law.reset()
    law.k, law._x = 0, seen[:, 0].copy()  # one lane by the filter itself
    for k in range(SAMPLES):
        x = E @ x + (G @ u[k])[:, None] + push @ rng.standard_normal((n, LANES))
        y = C @ x + noise[:, None] * rng.standard_normal((len(C), LANES))
        seen = E @ seen + (G @ u[k])[:, None]
        seen = seen + claim.L @ (y - C @ seen)
        law.step(y[:, 0], u[k])
    near(law.estimate, seen[:, 0], "the filter's own step", np.abs(x[:, 0]).max() + 1)
    error = x - seen
    whole = float((sla.solve_triangular(spread, error, lower=True) ** 2).sum())
    tests = [("all", whole, n * LANES)]
    tests += [(f"state {i + 1}", float(error[i] @ error[i] / claim.P[i, i]), LANES) for i in range(n)]
    for name, sum_, degrees in tests:
        low, high = chi2.ppf([CHANCE / 2, 1 - CHANCE / 2], degrees)
        if not low <= sum_ <= high:
            raise Wrong(f"variance of {name}: {sum_ / degrees:.4g} of what is claimed, {degrees} degrees of freedom")
    return "kalman"


def tvlqr(rng) -> str:
    T, n, nu = int(rng.integers(1, 13)), int(rng.integers(1, 6)), int(rng.integers(1, 4))
    A, B, c, weight = random_steps(rng, T, n, nu)
    end = root_weight(rng, n) + 0.1 * np.eye(n)
    x, u = slice(0, n), slice(n, n + nu)
    terms = {"q": weight[:, x, -1], "s": weight[:, u, -1], "r": weight[:, -1, -1]}
    made = riccati.dtvlqr(A, B, weight[:, x, x], weight[:, u, u], weight[:, x, u], c, end=end, **terms)
    M, F = stacked(A, B, c, weight, end)
    best = -np.linalg.lstsq(M, F, rcond=None)[0]
    near(np.column_stack([-made.K[0], -made.k[0]]), best[:nu], "the first gain")
    rest = M @ best + F
    z = np.append(rng.standard_normal(n), 1.0)
    cost = float(z @ rest.T @ rest @ z)
    if abs(made.cost_to_go(0, z[:n]) - cost) > SAME * cost:
        raise Wrong(f"a cost of {cost:.8g} was told as {made.cost_to_go(0, z[:n]):.8g}")
    state, U = z[:n], best @ z
    for k in range(T):
        near(-made.K[k] @ state - made.k[k], U[k * nu : (k + 1) * nu], f"input {k}", np.abs(U).max())
        state = A[k] @ state + B[k] @ U[k * nu : (k + 1) * nu] + c[k]
    return "tvlqr"


def mpc(rng) -> str:
    A, B, dt = plant(rng)
    n, nu = B.shape
    E, G = held(A, B, dt)
    Q, R, N = (
        root_weight(rng, n),
        10 ** rng.uniform(-2, 1) * (root_weight(rng, nu) + np.eye(nu)),
        int(rng.integers(2, 11)),
    )
    high = 10 ** rng.uniform(-1.5, 0.5, nu)
    law = MPC.design(LinearModel.from_matrices(E, G, dt=dt), Q, R, horizon=N, limits=(-high, high))
    P = discrete(E, G, Q, R, np.zeros((n, nu)))[1]
    weight = sla.block_diag(Q, R, 1e-300)
    M, F = stacked(*(np.repeat(V[None], N, axis=0) for V in (E, G, np.zeros(n), weight)), P)
    said = "mpc, within the limits"
    for x in rng.standard_normal((3, n)):
        law.reset()
        u = law.act(0.0, x)
        best = lsq_linear(M * np.tile(high, N), -F[:, :n] @ x, (-1, 1), method="bvls", tol=1e-14, max_iter=500)
        own = np.tile(high, N) * best.x
        if law.record.limited:
            said, planned = "mpc, at its limits", law.plan.inputs().ravel()
            costs = [float(np.square(M @ U + F[:, :n] @ x).sum()) for U in (planned, own)]
            if costs[0] > costs[1] * (1 + 1e-8) or (np.abs(planned) > np.tile(high, N) * (1 + LEAST)).any():
                raise Wrong(f"a plan of cost {costs[0]:.10g}, {costs[1]:.10g} is the least")
            near(u, planned[:nu], "the first move of its plan", high)
            if costs[1] > costs[0] * (1 + 1e-9):  # of plants that grow far over the horizon
                said = "mpc, better than least squares"
                continue
        near(u, own[:nu], "the first move", high)
    return said


def funnel(rng) -> str:
    A, B, dt = plant(rng)
    (n, nu), T = B.shape, int(rng.integers(5, 30))
    t, z = dt * np.arange(T + 1), np.zeros
    swing = rng.standard_normal(A.shape) * 0.3 * np.abs(A).max()
    wave = np.sin(np.linspace(0, rng.uniform(0, 4), T + 1))[::-1] * rng.integers(2)
    path = A + wave[:, None, None] * swing
    tile = [np.tile(M, (T + 1, 1, 1)) for M in (B, z((n, 0)), np.eye(n), z((n, nu)), z((n, 0)))]
    x, u = z((T + 1, n)), 0.5 * np.sin(np.linspace(0, 3, T + 1))[:, None] * rng.uniform(-1, 1, nu)
    names = [f"x{i + 1}" for i in range(n)]
    rows = {"c": z((T + 1, n)), "x": x, "u": u, "w": z((T + 1, 0)), "y": x}
    inputs = [f"u{i + 1}" for i in range(nu)]
    ltv = LTVModel(t, path, *tile, **rows, states=names, inputs=inputs, disturbances=(), outputs=names)
    Q, R, last = np.eye(n), 10 ** rng.uniform(-1, 1) * np.eye(nu), LinearModel.from_matrices(path[-1], B)
    hold = LQR.design(last, Q, R, dt=dt)
    law = TVLQR.design(ltv, Q, R, end=hold.P, hold=(hold.K, x[-1], u[-1]), limits=(-np.ones(nu), np.ones(nu)))
    step, found = riccati.sampled_along(ltv, Q, R), law.funnel
    E, G = held(path[-1], B, dt)
    said = "funnel, of no width"
    for _ in range(20):
        k = int(rng.integers(T + 1))
        if not 0 < found.level[k] < np.inf:
            continue
        value, vector = np.linalg.eigh(found.P[k])
        way = rng.standard_normal(n)
        way *= np.sqrt(rng.uniform(0.9, 1.0) * found.level[k]) / np.linalg.norm(way)
        e = vector @ (way / np.sqrt(np.maximum(value, 1e-12 * value.max())))
        if not found.inside(t[k], found.x[k] + e):
            continue
        state, said = found.x[k] + e, "funnel"
        for j in range(k, T + 30):
            if not found.use(j * dt, state) <= 1 + 1e-6:
                raise Wrong(f"a state inside at step {k} of {T} is outside at {j}")
            at = min(j, T)
            wanted = law.u[at] - law.K[at] @ (state - law.x[at])
            if np.abs(wanted).max() > 1 + LEAST:
                raise Wrong(f"a state inside at step {k} of {T} reaches a limit at {j}: {np.abs(wanted).max():.8g}")
            acted = law.act(j * dt, state)
            near(acted, np.clip(wanted, -1, 1), "act", 1.0)
            e, du = state - ltv.x[at], acted - ((u[at] + u[at + 1]) / 2 if j < T else u[-1])
            state = ltv.x[min(j + 1, T)] + (step.A[j] @ e + step.B[j] @ du + step.c[j] if j < T else E @ e + G @ du)
    return said


def run(seed: int) -> dict[str, Any]:
    """One plant, one kind of claim."""
    kind = KINDS[seed % len(KINDS)]
    row: dict[str, Any] = {"seed": seed, "kind": kind, "said": "", "wrong": ""}
    try:
        row["said"] = globals()[kind](np.random.default_rng([seed, 6]))
    except Wrong as error:
        row["wrong"] = str(error)
    except PliantError as error:
        row["said"] = f"{kind}, refused: {type(error).__name__}"
    return row


def summary(rows: list[dict[str, Any]]) -> str:
    found, wrong = Counter(r["said"] for r in rows if not r["wrong"]), [r for r in rows if r["wrong"]]
    text = f"{len(rows)} plants: {len(wrong)} wrong claims"
    text += "".join(f"\n  {said:36} {count:6}" for said, count in sorted(found.items()))
    return text + "".join(f"\n  seed {r['seed']} ({r['kind']}): {r['wrong']}" for r in wrong[:20])


if __name__ == "__main__":
    by_seed.main(__doc__ or "", 2000, run, summary, lambda row: bool(row["wrong"]))
