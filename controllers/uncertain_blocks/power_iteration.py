"""The lower bound of the structured singular value: a perturbation of the structure that makes I - M Delta singular.

Power iteration towards  M b = beta a, M* z = beta w  with b = Q a, z = Q* w (Packard, Fan and Doyle 1988; Young and
Doyle 1990 for real blocks), from a few starts. What it ends at is a Delta of norm one; the bound is the largest
eigenvalue of M Delta that is real and positive, to rounding: Delta over it makes I - M Delta singular. Where all blocks
are complex any eigenvalue serves, by its modulus, for its phase can go into Delta.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .blocks import Block, places

Array = np.ndarray
ROUNDS, STARTS = 150, 6
REAL = 1e-7  # |imaginary part| over the modulus, of an eigenvalue that counts as real
TINY = 1e-300


def lower(M: Array, blocks: Sequence[Block], seed: int = 0) -> tuple[float, Array]:
    """(bound, Delta (n, n) of norm 1/bound); (0, zeros) where none was found."""
    n, rng = len(M), np.random.default_rng(seed)
    best, worst = 0.0, np.zeros((n, n), dtype=complex)
    if not np.abs(M).max(initial=0.0) > 0:
        return best, worst
    _, _, right = np.linalg.svd(M)
    for start in range(STARTS):
        if start < min(2, n):
            b = right[start].conj()
        else:
            b = rng.normal(size=n) + 1j * rng.normal(size=n)
        w = b.copy()
        for _ in range(ROUNDS):
            before = b
            a = _unit(M @ b)
            w = _unit(M.conj().T @ _left(a, w, blocks))
            b = _unit(_right(a, w, blocks))
            if np.linalg.norm(b - before) < 1e-12:
                break
        Delta = perturbation(a, w, blocks)
        found, turned = singular(M, Delta, all(b.kind != "real" for b in blocks))
        if found > best:
            best, worst = found, turned
    return best, worst


def singular(M: Array, Delta: Array, turns: bool) -> tuple[float, Array]:
    """(beta, Delta e^(i phase) / beta) with I - M Delta / beta singular, beta the largest there is; `turns`: whether
    the phase may be chosen."""
    values = np.linalg.eigvals(M @ Delta)
    size = np.abs(values)
    if not turns:
        size = np.where(np.abs(values.imag) <= REAL * size, np.abs(values.real), 0.0)
    k = int(size.argmax())
    if not size[k] > 0:
        return 0.0, np.zeros_like(Delta)
    phase = np.conj(values[k]) / size[k] if turns else np.sign(values[k].real)
    norm = np.linalg.norm(Delta, 2)
    return float(size[k] / norm), Delta * phase / size[k]


def perturbation(a: Array, w: Array, blocks: Sequence[Block]) -> Array:
    """Delta of norm one that takes a to b = Q a and, adjoint, w to z."""
    Delta = np.zeros((len(a), len(a)), dtype=complex)
    for block, at in zip(blocks, places(blocks)):
        if block.kind == "full":
            Delta[at, at] = np.outer(_unit(w[at]), _unit(a[at]).conj())
        else:
            Delta[at, at] = _scalar(a[at], w[at], block.kind) * np.eye(block.size)
    return Delta


def _scalar(a: Array, w: Array, kind: str) -> complex:
    product = np.vdot(a, w)
    if kind == "complex":
        return complex(product / max(abs(product), TINY))
    # inside (-1, 1) only where Re(a* w) = 0: the sign moves there by the product over the sizes
    share = product.real / max(float(np.linalg.norm(a) * np.linalg.norm(w)), TINY)
    return float(np.clip(np.sign(share) * min(1.0, 1e3 * abs(share)), -1, 1))


def _left(a: Array, w: Array, blocks: Sequence[Block]) -> Array:
    z = np.empty_like(a)
    for block, at in zip(blocks, places(blocks)):
        if block.kind == "full":
            z[at] = a[at] * np.linalg.norm(w[at]) / max(float(np.linalg.norm(a[at])), TINY)
        else:
            z[at] = np.conj(_scalar(a[at], w[at], block.kind)) * w[at]
    return z if np.linalg.norm(z) > 0 else w


def _right(a: Array, w: Array, blocks: Sequence[Block]) -> Array:
    b = np.empty_like(a)
    for block, at in zip(blocks, places(blocks)):
        if block.kind == "full":
            b[at] = w[at] * np.linalg.norm(a[at]) / max(float(np.linalg.norm(w[at])), TINY)
        else:
            b[at] = _scalar(a[at], w[at], block.kind) * a[at]
    return b if np.linalg.norm(b) > 0 else a


def _unit(v: Array) -> Array:
    return np.asarray(v / max(float(np.linalg.norm(v)), TINY))
