"""How far the nodes of a model leave the cost to go unknown: what is told against eight times as many nodes.

    python tests/campaigns/nodes.py --count 400

Models of oscillators from 0.3 to 60 rad/s whose A and B swing, pulse or switch over, between one and seventy intervals
of the nodes long, of 9 to 120 intervals, even or not. `riccati.tvlqr` tells an error of P, or is silent where it is to
be below KNOWN; both are compared with its own P by nodes eight times as close, at which its error is some 4,000 times
smaller. What lies unseen between two nodes no estimate knows: pulses are no narrower than the nodes are apart.
"""

from __future__ import annotations

import warnings
from itertools import pairwise
from typing import Any

import by_seed
import numpy as np

from pliant.controllers import riccati
from pliant.controllers.riccati.node_distance import KNOWN
from pliant.plants import PliantError
from pliant.plants.linear.ltv import LTVModel

FINER, LEAST = 8, 1e-6  # intervals in one; an error below which rounding decides


def drawn(rng: np.random.Generator) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray]:
    """(A and B by time, times, Q, R)."""
    n, span, intervals = 2 * int(rng.integers(1, 4)), rng.uniform(0.5, 4.0), int(rng.integers(9, 120))
    speeds = 10 ** rng.uniform(-0.5, 1.8, n // 2)
    A, moved = np.zeros((n, n)), rng.standard_normal((n, n)) * speeds.mean() * rng.uniform(0, 0.5)
    for i, w in enumerate(speeds):
        A[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[0, w], [-w, -0.02 * w]]
    B, turned = rng.standard_normal((n, 1)), rng.standard_normal((n, 1)) * rng.uniform(0, 0.5)
    steps = rng.uniform(0.4, 1.6, intervals) if rng.integers(2) else np.ones(intervals)
    t = span * np.append(0.0, np.cumsum(steps)) / steps.sum()
    swing, middle = 10 ** rng.uniform(-0.5, 1.5), rng.uniform(0.2, 0.8) * span
    width = max(span * 10 ** rng.uniform(-1.5, -0.5), np.diff(t).max())
    shapes = (
        lambda s: np.sin(swing * s),
        lambda s: np.exp(-(((s - middle) / width) ** 2)),
        lambda s: np.tanh((s - middle) / width),
    )
    shape = shapes[rng.integers(3)]
    at = lambda s: (A + moved * shape(s), B + turned * shape(s + 0.1))  # noqa: E731
    return at, t, np.diag(10 ** rng.uniform(-1, 2, n)), np.eye(1) * 10 ** rng.uniform(-3, 1)


def model(at: Any, t: np.ndarray) -> LTVModel:
    """Without disturbance or output, about rest."""
    A, B = (np.array([at(s)[i] for s in t]) for i in (0, 1))
    nt, n = len(t), A.shape[1]
    empty = np.zeros((nt, n, 0)), np.zeros((nt, 0, n)), np.zeros((nt, 0, 1)), np.zeros((nt, 0, 0))
    rows = {"c": np.zeros((nt, n)), "x": np.zeros((nt, n)), "u": np.zeros((nt, 1)), "y": np.zeros((nt, 0))}
    states = tuple(f"x{i}" for i in range(n))
    return LTVModel(t, A, B, *empty, **rows, states=states, inputs=("u",), disturbances=(), outputs=())


def run(seed: int) -> dict[str, Any]:
    """What is told of one model, and what is true."""
    at, t, Q, R = drawn(np.random.default_rng(seed))
    close = np.append(np.concatenate([np.linspace(a, b, FINER, endpoint=False) for a, b in pairwise(t)]), t[-1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            made, finer = (riccati.tvlqr(model(at, times), Q, R) for times in (t, close))
        except PliantError:
            return {"seed": seed, "told": "refused", "true": 0.0, "wrong": False}
    P, exact = ((S @ S.transpose(0, 2, 1))[:, :-1, :-1] for S in (made.root, finer.root[::FINER]))
    size = np.sqrt(np.diagonal(exact, axis1=1, axis2=2).max(axis=0))
    true = float((np.abs(P - exact) / np.outer(size, size)).max())
    most = KNOWN if made.error is None else made.error
    said = "silent" if made.error is None else "not known" if most == np.inf else f"{most:.3g}"
    return {"seed": seed, "told": said, "true": true, "wrong": true > max(most, LEAST)}


def summary(rows: list[dict[str, Any]]) -> str:
    """How many were told what, and which were wrong."""
    words = ("silent", "not known", "refused")
    count = {word: sum(r["told"] == word for r in rows) for word in words}
    numbers, wrong = len(rows) - sum(count.values()), [r for r in rows if r["wrong"]]
    said = ", ".join(f"{v} {k}" for k, v in count.items())
    lines = [f"{r['seed']}: told {r['told']}, true {r['true']:.3g}" for r in wrong]
    return "\n  ".join([f"{len(rows)} models: {numbers} told in numbers, {said}; {len(wrong)} wrong", *lines])


if __name__ == "__main__":
    by_seed.main(__doc__, 400, run, summary, lambda row: row["wrong"])
