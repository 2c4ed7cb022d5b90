"""M = L diag(d) L^T of a symmetric matrix of expressions, and the solution of M a = r."""

from __future__ import annotations

import casadi as ca


def ldl(M: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
    """M = L diag(d) L^T without pivoting, which a positive definite M does not need; returns (L, d)."""
    n = M.shape[0]
    L, d = ca.SX.eye(n), [ca.SX(0)] * n
    for j in range(n):
        scaled = [L[j, k] * d[k] for k in range(j)]
        d[j] = M[j, j] - sum((L[j, k] * scaled[k] for k in range(j)), ca.SX(0))
        for i in range(j + 1, n):
            L[i, j] = (M[i, j] - sum((L[i, k] * scaled[k] for k in range(j)), ca.SX(0))) / d[j]
    return L, d


def ldl_solve(L: ca.SX, d: list[ca.SX], r: ca.SX) -> ca.SX:
    """Solve L diag(d) L^T a = r for every column of r (n, m)."""
    n = len(d)
    a = [r[i, :] for i in range(n)]
    for i in range(n):
        for k in range(i):
            a[i] = a[i] - L[i, k] * a[k]
    for i in reversed(range(n)):
        a[i] = a[i] / d[i]
        for k in range(i + 1, n):
            a[i] = a[i] - L[k, i] * a[k]
    return ca.vertcat(*a)
