"""The closed loop of a plant at rest and a linear law, as a function of the plant's parameters.

Sampled law    x[k+1] = e^(A dt) x[k] + Gamma(dt) u[k], Gamma(t) = int_0^t e^(A s) ds B: what the plant does between
               samples; the input held before joins the states where it is read or acts late. Inputs late by tau of less
               than a period: x[k+1] = e^(A dt) x[k] + Gamma(dt - tau) u[k] + (Gamma(dt) - Gamma(dt - tau)) u[k-1]

Continuous     dx/dt = A x + B u. Inputs late by tau pass a Pade approximation of third order, an all-pass that is off
               by 1e-5 of the signal at omega tau = 1 and by 1.3e-3 at 2

Source   Astrom and Wittenmark 1997, "Computer-Controlled Systems", 3.2; Golub and Van Loan 2013, 9.3.1, for the
         approximation of e^z by N(z)/N(-z)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from pliant.controllers.analysis.linear_laws import LinearLaw, closed_matrix, law_of, readings_under_way
from pliant.controllers.analysis.loops import plant_of
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import rows_by_name
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.even_units import even_units

Array = np.ndarray
DELAY = "delay"  # [s] of all inputs: of a box, and no parameter of the plant
PADE = np.array([1 / 120, 1 / 10, 1 / 2, 1.0])  # N(z), the highest power first


class LoopOverBox(NamedTuple):
    """state_matrix(delta (k,)) (n, n); mass(delta), by which it is a polynomial; dt [s]; boxes that it is known for."""

    state_matrix: Callable[[Array], Array]
    mass: Callable[[Array], Array] | None
    dt: float | None
    most: float


def loop_over_box(
    plant: Plant, controller: object, names: tuple[str, ...], middle: Array, half: Array, at: Mapping[str, float]
) -> LoopOverBox:
    """Linearised where the plant rests with the parameters in the middle."""
    law = law_of(controller)
    own = np.array([name != DELAY for name in names])
    varied = require_instance("robust_stability.plant", plant, Plant)
    varied = varied.vary(*(n for n, mine in zip(names, own) if mine)) if own.any() else varied
    late = None if own.all() else int(np.flatnonzero(~own)[0])
    most = np.inf if late is None else _most(law, middle[late], half[late])

    def values(delta: Array) -> tuple[Array | None, float]:
        v = middle + half * delta
        return (v[own] if own.any() else None), 0.0 if late is None else float(v[late])

    centre = values(np.zeros(len(names)))[0]
    x0, u0 = varied.equilibrium(at) if centre is None else varied.equilibrium(at, p=centre)
    model = varied.linearize(x0, u0) if centre is None else varied.linearize(x0, u0, p=centre)
    n, nu, rows = len(x0), len(u0), rows_by_name(model, law.reads).at
    felt = len(plant_of(model, LinearLaw(law.A, law.B, law.C, law.D, law.reads, None))[0])
    whole = (
        felt == n == len(model.A)
    )  # nothing conserved leaves the loop, and no quaternion is told by three of its four
    if late is not None and not whole:
        raise PliantError("robust_stability: a loop that leaves something conserved, and a delay, are not done at once")

    none = np.zeros(len(model.A) + nu)
    unit = even_units(_with_inputs(model.A, model.B), none, none)  # of all: each alone would take the time of the rest

    def state_matrix(delta: Array) -> Array:
        p, tau = values(delta)
        if not whole:
            return closed_matrix(plant_of(varied.linearize(x0, u0, p=p), law), law)
        A, B, _, C, D, _ = varied.jacobians(x0, u0) if p is None else varied.jacobians(x0, u0, p=p)
        seen, direct = np.vstack([np.eye(n), C])[rows], np.vstack([np.zeros_like(B), D])[rows]
        if law.dt is not None:
            return closed_matrix(_sampled(A, B, seen, direct, law, unit, late is not None, tau), law)
        return closed_matrix((A, B, seen, direct) if late is None else _late(A, B, seen, direct, tau), law)

    def mass(delta: Array) -> Array:
        p, tau = values(delta)
        M = np.asarray(varied.mass_matrix(x0) if p is None else varied.mass_matrix(x0, p=p))  # type: ignore[attr-defined]
        wide = np.eye(n + (0 if late is None else (len(PADE) - 1) * nu) + len(law.A))
        wide[n - len(M) : n, n - len(M) : n] = M
        if late is not None:
            z = np.arange(n, n + (len(PADE) - 1) * nu)
            wide[z, z] = tau / middle[late]
        return wide

    known = whole and law.dt is None and hasattr(varied, "mass_matrix") and 2 * len(varied.mass_matrix(x0)) == n
    return LoopOverBox(state_matrix, mass if known else None, law.dt, most)


def _most(law: LinearLaw, middle: float, half: float) -> float:
    """Boxes within which a delay has one model; ValueError where the box itself leaves it."""
    low, high = middle - half, middle + half
    if law.dt is None:
        if not low > 0:
            raise ValueError(f"robust_stability.box['delay'] = ({low:g}, {high:g}) s must be positive")
        return np.inf
    if not (low >= 0 and high <= law.dt):
        raise ValueError(
            f"robust_stability.box['delay'] = ({low:g}, {high:g}) s must be within one period, 0 to {law.dt:g} s"
        )
    return min(middle, law.dt - middle) / half


def _with_inputs(A: Array, B: Array) -> Array:
    n, nu = B.shape
    return np.block([[A, B], [np.zeros((nu, n + nu))]])


def _sampled(
    A: Array, B: Array, C: Array, D: Array, law: LinearLaw, unit: Array, late: bool, tau: float
) -> tuple[Array, Array, Array, Array]:
    """From sample to sample."""
    assert law.dt is not None
    n, nu = B.shape
    ratio = unit / unit[:, None]
    M = _with_inputs(A, B) * ratio
    whole = linalg.expm(M * law.dt) / ratio
    Ad, new = whole[:n, :n], whole[:n, n:]
    none: Array = np.zeros((len(C), nu))
    if late or D.any():
        old = np.zeros_like(new)
        if late:
            rest = linalg.expm(M * (law.dt - tau)) / ratio
            old, new = new - rest[:n, n:], rest[:n, n:]
        Ad = np.block([[Ad, old], [np.zeros((nu, n + nu))]])
        new, C = np.vstack([new, np.eye(nu)]), np.hstack([C, D])
    Ad, new, C = readings_under_way(Ad, new, C, law.delay)
    return Ad, new, C, none


def _late(A: Array, B: Array, C: Array, D: Array, tau: float) -> tuple[Array, Array, Array, Array]:
    """With N(-s tau)/N(s tau) before each input: tau dz/dt = F z + g u, given = h z - u."""
    order, nu = len(PADE) - 1, B.shape[1]
    signs = (-1.0) ** np.arange(order, -1, -1)
    F, g = np.diag(np.ones(order - 1), 1), np.zeros((order, 1))
    F[-1], g[-1] = -PADE[:0:-1] / PADE[0], 1.0
    h = ((signs * PADE - signs[0] * PADE) / PADE[0])[:0:-1]
    F, g, h = (np.kron(np.eye(nu), m) for m in (F, g, h[None]))
    wide = np.block([[A, B @ h], [np.zeros((order * nu, len(A))), F / tau]])
    return wide, np.vstack([signs[0] * B, g / tau]), np.hstack([C, D @ h]), signs[0] * D
