"""Linear-quadratic problems from node to node of an LTVModel, of fourth order in the distance of the nodes.

sampled_along     the discrete problem with the input held, the cost integrated in between
noise_along       the covariance that white disturbances leave in between
hamiltonian_flow  x+ = F x - G m+,  m = H x + F'm+,   G, H >= 0: state and half the costate m under the best input

Both are exponentials of a fourth-order Magnus exponent (Iserles and Norsett 1999), taken of a small part of an interval
and doubled (the second as in Anderson 1978), so that no growing exponential appears however stiff A is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import require_finite, require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.linear.even_units import even_units
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.magnus import costed, exponent, halvings, reached

from .checks import weight_matrix

Array = np.ndarray
LARGEST_DEFECT = 1e-6  # negative part of what must be >= 0, against its size: above, the nodes are too far apart


class SampledLTV(NamedTuple):
    """x+ = A x + B u + c and the cost x'Qx + u'Ru + 2 x'Nu + 2 q'x + 2 s'u + r of every step.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> arm = SingleLinkArm.textbook()
    >>> along = arm.linearize_along(arm.simulate(np.zeros(arm.nx), [1.0], np.linspace(0.0, 0.1, 11)))
    >>> sampled_along(along, np.eye(arm.nx), np.eye(1)).A.shape
    (10, 6, 6)
    """

    A: Array  # (T, nx, nx)
    B: Array  # (T, nx, nu)
    c: Array  # (T, nx)
    Q: Array  # (T, nx, nx)
    R: Array  # (T, nu, nu)
    N: Array  # (T, nx, nu)
    q: Array  # (T, nx)
    s: Array  # (T, nu)
    r: Array  # (T,)


def sampled_along(model: LTVModel, Q: Any, R: Any, N: Any = None) -> SampledLTV:
    """The discrete problem from node to node of an LTVModel with the input held, the cost integrated in between.

    Q (nx, nx), R (nu, nu), N (nx, nu) as in `tvlqr`. Of fourth order in the distance of the nodes; exact where the
    model does not vary.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> arm = SingleLinkArm.textbook()
    >>> along = arm.linearize_along(arm.simulate(np.zeros(arm.nx), [1.0], np.linspace(0.0, 0.1, 11)))
    >>> sampled_along(along, np.eye(arm.nx), np.eye(1)).B.shape
    (10, 6, 1)
    """
    require_instance("model", model, LTVModel)
    nx, nu = len(model.states), len(model.inputs)
    Q, R = weight_matrix("Q", Q, nx, definite=False), weight_matrix("R", R, nu, definite=False)
    N = np.zeros((nx, nu)) if N is None else require_finite("N", N, (nx, nu))
    A, B, _, c = model._gauss
    n = nx + nu + 1
    F = np.zeros((*A.shape[:2], n, n))  # of [x; u; 1]
    F[:, :, :nx, :nx], F[:, :, :nx, nx:-1], F[:, :, :nx, -1] = A, B, c
    M = np.zeros((n, n))
    M[:nx, :nx], M[:nx, nx:-1], M[nx:-1, :nx], M[nx:-1, nx:-1] = Q, N, N.T, R
    step, cost, unit = costed(F, M, np.diff(model.t))
    weight = unit[:, None] * unit
    cost = _semidefinite(cost * weight, model.t) / weight
    x, u = slice(0, nx), slice(nx, nx + nu)
    dynamics = step[:, x, x], step[:, x, u], step[:, x, -1]
    return SampledLTV(
        *dynamics, cost[:, x, x], cost[:, u, u], cost[:, x, u], cost[:, x, -1], cost[:, u, -1], cost[:, -1, -1]
    )


def noise_along(model: LTVModel, W: Any) -> Array:
    """Covariance (nt-1, nx, nx) of what white disturbances of density W (nw, nw) [unit^2 s] do to the state from node
    to node: the integral of Phi(end, s) E W E' Phi(end, s)' (Van Loan 1978), of fourth order in their distance.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> arm = SingleLinkArm.textbook()
    >>> along = arm.linearize_along(arm.simulate(np.zeros(arm.nx), [1.0], np.linspace(0.0, 0.1, 11)))
    >>> noise_along(along, np.eye(along.E.shape[2])).shape
    (10, 6, 6)
    """
    require_instance("model", model, LTVModel)
    A, _, E, _ = model._gauss
    W = weight_matrix("W", W, E.shape[-1], definite=False)
    return reached(A, E @ W @ E.transpose(0, 1, 3, 2), np.diff(model.t))


def hamiltonian_flow(model: LTVModel, Q: Array, R: Array, lean: Array) -> tuple[Array, Array, Array, Array]:
    """F, G, H (nt-1, nx+1, nx+1) of every interval, and the even units (nx+1,) of [x; 1] that they are in."""
    A, B, _, c = model._gauss
    n = A.shape[-1] + 1
    big = np.zeros((*A.shape[:2], 2 * n, 2 * n))
    own = big[:, :, :n, :n]
    own[:, :, :-1, :-1], own[:, :, :-1, -1] = A - B @ lean, c
    drive, sight = np.zeros((*A.shape[:2], n, n)), np.zeros((n, n))
    drive[:, :, :-1, :-1], sight[:-1, :-1] = B @ np.linalg.solve(R, B.transpose(0, 1, 3, 2)), Q
    reach = np.abs(np.diagonal(drive, axis1=2, axis2=3)).max(axis=(0, 1), initial=0.0)
    unit = even_units(own, reach, np.diagonal(sight))  # with them G and H are alike
    weight = unit[:, None] * unit
    own *= unit[None, :] / unit[:, None]
    big[:, :, n:, n:] = -own.transpose(0, 1, 3, 2)
    big[:, :, :n, n:], big[:, :, n:, :n] = -drive / weight, -sight * weight
    Omega = exponent(big, np.diff(model.t))
    j = halvings(Omega)
    flow = sla.expm(Omega / 2**j)
    back = np.linalg.inv(flow[:, n:, n:])
    F, G, H = back.transpose(0, 2, 1), -flow[:, :n, n:] @ back, -back @ flow[:, n:, :n]
    for _ in range(j):
        middle = np.linalg.inv(np.eye(n) + G @ H)
        turned = F.transpose(0, 2, 1)
        F, G, H = F @ middle @ F, G + F @ middle @ G @ turned, H + turned @ H @ middle @ F
        G, H = ((V + V.transpose(0, 2, 1)) / 2 for V in (G, H))
    return F, G, H, unit


def _semidefinite(cost: Array, t: Array) -> Array:
    """cost (nt-1, n, n) less the negative part that the order of the method leaves; PliantError where it is large."""
    value, vector = np.linalg.eigh((cost + cost.transpose(0, 2, 1)) / 2)
    lost = -value.min(axis=1) / np.maximum(np.abs(value).max(axis=1), 1e-300)
    i = int(np.argmax(lost))
    if lost[i] > LARGEST_DEFECT:
        raise PliantError(
            f"sampled_along: between the nodes at {t[i]:.4g} and {t[i + 1]:.4g} s the cost loses its sign by "
            f"{lost[i]:.2g} of its size, at most {LARGEST_DEFECT:g}: put the nodes of the nominal closer there"
        )
    return (vector * np.maximum(value, 0.0)[:, None, :]) @ vector.transpose(0, 2, 1)
