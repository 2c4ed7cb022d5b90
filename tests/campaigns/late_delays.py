"""Loops with a delay, by ways of their own: imaginary eigenvalues of a Hamiltonian matrix (Bruinsma, Steinbuch 1990),
the line of delay as Chebyshev points of a transport equation (Breda, Maset and Vermiglio 2005), and the exact map from
sample to sample of a sampled loop, put together from event to event."""

from __future__ import annotations

import numpy as np
from random_loops import Array, Wrong, alone, expect, growth, held, parts_of, plant

from pliant.controllers.analysis.late_loops import MOST_PERIODS

INSIDE, OUTSIDE = 1 - 1e-4, 1 + 1e-4  # of a claim
STATES, TURNS = 400, 250.0  # of what a line of delay is followed with: Chebyshev points, radians


def lag_by_hamiltonian(A, B, C, D) -> float:
    """The shortest delay [s] at which L = C (s - A)^-1 B + D has a pole of the loop on the axis."""
    if abs(D) >= 1:
        return 0.0
    r = D * D - 1
    M = np.block(
        [[A - np.outer(B, C) * D / r, -np.outer(B, B) / r], [np.outer(C, C) / r, -A.T + np.outer(C, B) * D / r]]
    )
    values = np.linalg.eigvals(M)
    L = lambda w: C @ np.linalg.solve(1j * w * np.eye(len(A)) - A, B) + D  # noqa: E731
    lags = [np.inf]
    for w in values[(np.abs(values.real) < 1e-4 * np.abs(values)) & (values.imag > 0)].imag:
        for _ in range(20):
            step = 1e-6 * w
            slope = np.log(np.abs(L(w + step) / L(w - step))) / (2 * step)
            w -= np.clip(np.log(np.abs(L(w))) / slope, -1e-2 * w, 1e-2 * w) if slope else 0.0
        if abs(np.log(np.abs(L(w)))) < 1e-9:
            lags.append((np.angle(-L(w)) % (2 * np.pi)) / w)
    return min(lags)


def late_poles(A, B, C, delay: float, points: int) -> Array:
    """dx/dt = A x + B e(t - delay), e = -C x, the line of delay as values at Chebyshev points: its matrix."""
    k = np.arange(points + 1)
    x = np.cos(np.pi * k / points)  # 1 where e enters
    c = np.where((k == 0) | (k == points), 2.0, 1.0) * (-1.0) ** k
    apart = x[:, None] - x + np.eye(points + 1)
    D = np.outer(c, 1 / c) / apart
    D -= np.diag(D.sum(axis=1))
    flow, n = 2 / delay * D[1:], len(A)
    M = np.zeros((n + points, n + points))
    M[:n, :n], M[:n, -1] = A, B
    M[n:, :n], M[n:, n:] = np.outer(flow[:, 0], -C), flow[:, 1:]
    return M


def continuous_delay(rng, L, i: int, claim: float) -> str:
    A, B, C, D = alone(L, i)
    true = lag_by_hamiltonian(A, B, C, D)
    if not (claim == true or abs(claim - true) <= 1e-6 * true):
        raise Wrong(f"delay {claim:.8g} claimed, {true:.8g} by the Hamiltonian matrix")
    if D or not claim:
        return "delay, feedthrough"
    fastest = np.abs(np.linalg.eigvals(A - np.outer(B, C))).max()
    longest = claim if np.isfinite(claim) else 10 ** rng.uniform(-1, 1) / fastest
    points = int(longest * fastest / 2 + 30)
    if longest * fastest > TURNS or points > STATES:
        return "delay, by frequency only"
    for share in [*rng.uniform(0, INSIDE, 5), INSIDE]:
        expect(True, growth(late_poles(A, B, C, share * longest, points), None), f"delay {share:.6g} of the claim")
    if np.isfinite(claim):
        expect(False, growth(late_poles(A, B, C, 1.001 * claim, points), None), "delay past the claim")
    return "delay"


def late_map(model, law, dt: float, at: str, i: int, delay: float) -> Array:
    """The map of one period, on [x; s; inputs of the last m + 1 periods; readings under way], column by column."""
    A, B, C, D = plant(model, law)
    As, Bs, Cs, Ds = parts_of(law)
    (n, nu), ns = B.shape, len(As)
    m = int(np.floor(delay / dt * (1 + 1e-12)))
    rest = min(max(delay - m * dt, 0.0), dt)
    first, second = held(A, B, rest), held(A, B, dt - rest)
    size = n + ns + (m + 1) * nu + (m + 1)
    z = np.eye(size)
    x, s = z[:n], z[n : n + ns]
    past = z[n + ns : n + ns + (m + 1) * nu].reshape(m + 1, nu, size).copy()  # the last input first
    seen = z[n + ns + (m + 1) * nu :]  # readings at t - rest of this period's start, and of those before
    acts = past[0].copy()
    if at == "input":
        acts[i] = past[m][i]
    y = C @ x + D @ acts
    if at == "output":
        y[i] = seen[m]
    u = -(Cs @ s + Ds @ y)
    early, late = u.copy(), u.copy()
    if at == "input":
        early[i] = past[m][i]
        late[i] = u[i] if m == 0 else past[m - 1][i]
        parts = (first, early), (second, late)
    else:
        parts = (second, early), (first, late)
    (E, G), v = parts[0]
    middle = E @ x + G @ v
    (E, G), v2 = parts[1]
    after = E @ middle + G @ v2
    new = (C @ middle + D @ v)[i] if at == "output" else np.zeros(size)
    return np.vstack([after, As @ s + Bs @ y, u, past[:-1].reshape(-1, size), new, seen[:-1]])


def sampled_delay(rng, model, law, dt: float, at: str, i: int, claim: float, known: bool) -> str:
    """known: whether the model is continuous."""
    last = min(claim if np.isfinite(claim) else dt * 10 ** rng.uniform(-1, 1), MOST_PERIODS * dt)
    if known:
        for share in [*np.linspace(0, INSIDE, 24), *rng.uniform(0, INSIDE, 6)]:
            expect(True, growth(late_map(model, law, dt, at, i, share * last), dt), f"late by {share:.6g} of the claim")
        if np.isinf(claim) or claim > (MOST_PERIODS - 1) * dt:
            return "sampled delay, no end told"
        expect(False, growth(late_map(model, law, dt, at, i, claim * OUTSIDE + 1e-9 * dt), dt), "late past the claim")
        return "sampled delay"
    periods = round(last / dt)
    if np.isfinite(claim) and abs(round(claim / dt) * dt - claim) > 1e-9 * claim:
        raise Wrong("a delay that is no whole number of periods")
    for m in range(min(periods, 30) + 1):
        expect(True, growth(late_map(model, law, dt, at, i, m * dt), dt), f"late by {m} of {periods} periods")
    return "whole periods"
