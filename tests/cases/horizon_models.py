"""LTV models for numbers of finite horizons: constant ones, and random ones with smooth matrices, by seed."""

import numpy as np

from pliant.plants.core.signals import Signal
from pliant.plants.linear.ltv import LTVModel


def _signals(letter, n):
    return tuple(Signal(f"{letter}{k + 1}", "") for k in range(n))


def made(t, A, E, C, F):
    """From matrices at the nodes; one input without effect."""
    n, nw, nz = A.shape[1], E.shape[2], C.shape[1]
    zero = {"c": np.zeros((len(t), n)), "x": np.zeros((len(t), n)), "u": np.zeros((len(t), 1))}
    signals = {"states": _signals("x", n), "inputs": _signals("u", 1)}
    signals |= {"disturbances": _signals("w", nw), "outputs": _signals("z", nz)}
    B, D = np.zeros((len(t), n, 1)), np.zeros((len(t), nz, 1))
    return LTVModel(t, A=A, B=B, E=E, C=C, D=D, F=F, y=np.zeros((len(t), nz)), **zero, **signals)


def constant(A, E, C, span, F=None, nodes=201):
    A, E, C = (np.asarray(M, dtype=float) for M in (A, E, C))
    F = np.zeros((len(C), E.shape[1])) if F is None else np.asarray(F, dtype=float)
    t = np.linspace(0.0, span, nodes)
    return made(t, *(np.broadcast_to(M, (nodes, *M.shape)).copy() for M in (A, E, C, F)))


def random_ltv(seed, nodes=481):
    """Some decay, some grow; matrices that vary by half of themselves over the motion."""
    rng = np.random.default_rng(seed)
    n, nw, nz = int(rng.integers(2, 7)), int(rng.integers(1, 3)), int(rng.integers(1, 4))
    span = float(rng.uniform(1.0, 4.0))
    t = np.linspace(0.0, span, nodes)

    def along(rows, columns, size):
        mean, change = (size * rng.normal(size=(rows, columns)) for _ in range(2))
        wave = np.sin(2 * np.pi * rng.uniform(0.2, 1.5) * t / span + rng.uniform(0, 6))
        return mean + 0.5 * wave[:, None, None] * change

    A = along(n, n, 1.0) - rng.uniform(0.0, 2.0) * np.eye(n)
    direct = along(nz, nw, 0.3) if rng.integers(2) else np.zeros((nodes, nz, nw))
    return made(t, A, along(n, nw, 1.0), along(nz, n, 1.0), direct)
