"""What MPC claims of its target and its bounds, on random plants, against programs by HiGHS and SciPy: no DAQP.

target   least tracking error within the limits (`lsq_linear`), exactly met where the limits allow it, with every signal
         in units of its own between 1e-6 and 1e6
bounds   exceeded only where no plan over the horizon keeps them all (a linear program of the least excess), in closed
         loop, with one or two inputs and moves that are blocked

A seed that finds a wrong claim is printed; the script then exits with status 1.
"""

from collections import Counter

import by_seed
import numpy as np
from scipy.optimize import linprog, lsq_linear

from pliant.controllers import MPC
from pliant.controllers.mpc.steady_target import Target
from pliant.plants import UncontrollableError
from pliant.plants.linear.lti import LinearModel

EDGE = 1e-5  # least excess, in units of the bounds, that counts as none or as some
KEPT = 1e-6  # excess of a plan that keeps its bounds: rows hold to 1e-9 of their own unit, the state to SLACK


def run(seed: int) -> dict:
    """One claim tried: what was found, and what is wrong with it ('' for nothing)."""
    kind = ("target", "bounds")[seed % 2]
    found, wrong = (target if kind == "target" else bounds)(np.random.default_rng(seed))
    return {"seed": seed, "kind": kind, "found": found, "wrong": wrong}


def stable(rng, nx: int, low: float, high: float) -> np.ndarray:
    """A random A (nx, nx) with its spectral radius drawn from [low, high]."""
    A = rng.standard_normal((nx, nx))
    return A * rng.uniform(low, high) / np.abs(np.linalg.eigvals(A)).max()


def target(rng) -> tuple[str, str]:
    nx, nu = int(rng.integers(1, 7)), int(rng.integers(1, 5))
    nt = int(rng.integers(1, nu + 1))
    A, B, Bd = stable(rng, nx, 0.3, 0.95), rng.standard_normal((nx, nu)), rng.standard_normal((nx, 1))
    H, D, Hd = (
        rng.standard_normal((nt, nx)),
        rng.standard_normal((nt, nu)) * rng.integers(2),
        rng.standard_normal((nt, 1)),
    )
    low, high = -rng.uniform(0.1, 2, nu), rng.uniform(0.1, 2, nu)
    if rng.random() < 0.3:
        high[rng.integers(nu)] = np.inf
    weight = np.diag(np.concatenate([rng.uniform(0, 1, nx) * rng.integers(2, size=nx), rng.uniform(0.1, 1, nu)]))
    ux, uu, uy = (10.0 ** rng.uniform(-6, 6, n) for n in (nx, nu, nt))
    rest = np.linalg.solve(np.eye(nx) - A, np.hstack([B, Bd]))
    gain, drift = H @ rest[:, :nu] + D, (H @ rest[:, nu:] + Hd)[:, 0]
    if np.linalg.cond(gain) > 1e3:
        return "ill-conditioned", ""
    units = np.concatenate([ux, uu])
    made = Target(
        ux[:, None] * A / ux,
        ux[:, None] * B / uu,
        ux[:, None] * Bd,
        (uy[:, None] * H / ux, uy[:, None] * D / uu, uy[:, None] * Hd),
        weight / units[:, None] / units,
        low * uu,
        high * uu,
    )
    d, r = (
        0.2 * rng.standard_normal(1),
        10 ** rng.uniform(-0.6, 0.6) * rng.standard_normal(nt) * np.abs(gain).sum(axis=1),
    )
    s = made(d, r * uy) / units
    x, u = s[:nx], s[nx:]
    if np.abs(A @ x + B @ u + Bd @ d - x).max() > 1e-7 * (1 + np.abs(x).max()):
        return "", "not at rest"
    if (u < low - 1e-7).any() or (u > high + 1e-7).any():
        return "", f"past a limit: {u}"
    off = drift * d[0] - r
    error, ends = gain @ u + off, np.isfinite(high - low).all()
    least = lsq_linear(gain, -off, (low, high), tol=1e-15, max_iter=2000)
    if np.sqrt(2 * least.cost) < 1e-8:
        return "met", "" if np.abs(error).max() < 1e-6 else f"missed by {error} though it can be met"
    if not made.missed:
        return "", "missed, and not said"
    if nt > 1 and not ends:
        return "no range to compare by", ""
    half = np.abs(gain) @ (high - low) / 2 if ends else np.ones(nt)
    least = lsq_linear(gain / half[:, None], -off / half, (low, high), tol=1e-15, max_iter=2000)
    size = np.square(error / half).sum() / 2
    return "missed", "" if size <= least.cost * (1 + 1e-5) + 1e-12 else f"error {size:.6g}, least {least.cost:.6g}"


def bounds(rng) -> tuple[str, str]:
    nx, nu, N = int(rng.integers(2, 5)), int(rng.integers(1, 3)), int(rng.integers(3, 9))
    A, B = stable(rng, nx, 0.7, 1.3), rng.standard_normal((nx, nu))
    names = [f"x{i}" for i in range(nx)]
    model = LinearModel.from_matrices(A, B, states=names, inputs=[f"u{i}" for i in range(nu)], dt=0.1)
    ends = {n: (-rng.uniform(0.5, 2), rng.uniform(0.5, 2)) for n in names}
    blocks = None if rng.random() < 0.5 else [1] * (N - 2) + [2]
    weights = np.eye(nx), 10 ** rng.uniform(-3, 1) * np.eye(nu)
    try:
        law = MPC.design(model, *weights, horizon=N, limits=(-1, 1), bounds=ends, blocks=blocks)
    except UncontrollableError:
        return "no regulator", ""
    x, said = np.array([rng.uniform(*ends[n]) for n in names]), set()
    for _ in range(4):
        before = law.record.violations
        u = law.act(0.0, x)
        exceeded = law.record.violations > before
        least, G, g = least_excess(A, B, x, ends, N, blocks)
        if abs(least) > EDGE:
            if exceeded != (least > 0):
                return "", f"exceeded: {exceeded}, where the least excess is {least:.3g}"
            said.add("none keeps" if least > 0 else "kept")
            inputs = law.plan.inputs()
            worst = float((G @ np.ravel(inputs) - g).max())
            if least < 0 and worst > KEPT:
                return "", f"a plan that keeps its bounds passes them by {worst:.3g}"
        x = A @ x + B @ u
    return " and ".join(sorted(said)) or "on the edge", ""


def least_excess(A, B, x, ends, N: int, blocks) -> tuple[float, np.ndarray, np.ndarray]:
    """The least t with G U <= g + t over inputs within -1 .. 1, blocked, and G, g of U (N nu,)."""
    nx, nu = B.shape
    G, g, left, right = np.zeros((nx, N * nu)), x, [], []
    for j in range(N):
        G, g = A @ G, A @ g
        G[:, nu * j : nu * (j + 1)] += B
        for i, (low, high) in enumerate(ends.values()):
            left += [G[i].copy(), -G[i]]
            right += [high - g[i], g[i] - low]
    left, right = np.array(left), np.array(right)
    held = np.kron(np.repeat(np.eye(len(blocks)), blocks, axis=0), np.eye(nu)) if blocks else np.eye(N * nu)
    widened = np.hstack([left @ held, -np.ones((len(left), 1))])
    cost = np.append(np.zeros(held.shape[1]), 1.0)
    found = linprog(cost, A_ub=widened, b_ub=right, bounds=[(-1, 1)] * held.shape[1] + [(-10, None)])
    return float(found.fun), left, right


def summary(rows: list) -> str:
    kinds = Counter((r["kind"], r["found"] or "wrong") for r in rows)
    table = "\n".join(f"{kind:8} {found:28} {n:6}" for (kind, found), n in sorted(kinds.items()))
    wrong = [r for r in rows if r["wrong"]]
    return "\n".join(
        [table, *(f"seed {r['seed']}: {r['wrong']}" for r in wrong), f"{len(rows)} tried, {len(wrong)} wrong"]
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 2000, run, summary, lambda row: bool(row["wrong"]))
