"""Bodies as data sheets give them: rigid, or with the participation factors of modes normalised to unit mass.

A data sheet has mass, mass centre, inertia, and for each mode its frequency, damping ratio and factors

    L_translation = int phi dm,  L_rotation = int r x phi dm   about the attachment point

which are all that a craft at rest feels of it to first order:

    M_rr [dv; d(omega)] + L' eta'' = loads,  eta'' + 2 zeta omega eta' + omega^2 eta = -L [dv; d(omega)]

The integrals that a data sheet has not are those of the motion with these factors that moves least mass, the rigid
field phi = a + b x r, M_rr [a; b] = L, and of a rest that is alike in all directions and moves nothing on the whole.
It is there where I - L M_rr^-1 L' >= 0, which is that the modes take no more of the mass than there is. A craft that
spins feels these integrals; they are then a guess, as the shortening is, which is left at zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.beams.payload import check_inertia
from pliant.plants.core.argument_gates import real_array, require_finite, require_number
from pliant.plants.core.quaternions import skew
from pliant.plants.core.signals import read_only

Array = np.ndarray
ROUNDED = 1e-9  # of factors, and of mass: arithmetic's rounding; modes that take more of it no `ModalFields` passes
GIVE_MORE = "; give more of the craft's inertia to the body, less to the hub"


def rigid(mass: float, first: Any, inertia: Any) -> dict[str, Any]:
    """Fields of ModalData of a rigid body: first moment (3,) and inertia (3, 3) about the attachment point."""
    I = read_only("ModalData.inertia", inertia, (3, 3))
    first = read_only("ModalData.first", first, (3,))
    mass = require_number("ModalData.mass", mass, "positive", "kg")
    none = np.zeros((0, 6))
    return fields_of_factors("ModalData.rigid", mass, first, I, none, none, np.zeros(0), np.zeros(0))


def from_participation(
    mass: float,
    centre: Any,
    inertia: Any,
    frequencies: Any,
    damping: Any,
    L_translation: Any,
    L_rotation: Any,
) -> dict[str, Any]:
    """Fields of ModalData; the arguments are those of `ModalData.from_participation`, checked here."""
    owner = "ModalData.from_participation"
    mass = require_number(f"{owner}.mass", mass, "positive", "kg")
    d = require_finite(f"{owner}.centre", centre, (3,))
    I = require_finite(f"{owner}.inertia", inertia, (3, 3))
    omega = require_finite(f"{owner}.frequencies", frequencies, (-1,))
    n = len(omega)
    if not (omega > 0).all():
        raise ValueError(f"{owner}.frequencies = {omega.tolist()} must be > 0 [rad/s]")
    zeta = real_array(f"{owner}.damping", damping)
    zeta = require_finite(f"{owner}.damping", np.broadcast_to(zeta, (n,)) if zeta.ndim == 0 else zeta, (n,))
    if not (zeta >= 0).all():
        raise ValueError(f"{owner}.damping = {zeta.tolist()} must be >= 0")
    L_t = np.zeros((n, 3)) if L_translation is None else L_translation
    L_t = require_finite(f"{owner}.L_translation", L_t, (n, 3))
    L_r = require_finite(f"{owner}.L_rotation", L_rotation, (n, 3))
    check_inertia(f"{owner}.inertia", tuple(map(tuple, I.tolist())), GIVE_MORE)
    X = skew(mass * d)
    M = np.block([[mass * np.eye(3), -X], [X, I]])
    L = np.hstack([L_t, L_r])
    field = np.linalg.lstsq(M, L.T, rcond=None)[0].T
    size = np.abs(L).max(initial=0.0)
    if n and np.abs(field @ M - L).max() > ROUNDED * size:
        raise ValueError(f"{owner}.L_rotation asks a turn about an axis about which the body has no inertia")
    return fields_of_factors(owner, mass, mass * d, I, L, field, omega, zeta)


def fields_of_factors(
    owner: str, mass: float, first: Array, I: Array, L: Array, field: Array, omega: Array, zeta: Any
) -> dict[str, Any]:
    """Fields of ModalData of modes of unit mass with factors L (n, 6), from their rigid fields (n, 6), M_rr field = L,
    and the rest of their mass; `owner` is named where they have more of it than there is.
    """
    n = len(L)
    second = np.trace(I) / 2 * np.eye(3) - I
    least = float(np.linalg.eigvalsh(second - np.outer(first, first) / mass)[0])
    if least < -ROUNDED * np.abs(second).max():
        raise ValueError(
            f"{owner}.inertia = {I.tolist()} about the attachment point is too small for {mass:g} kg whose centre is "
            f"at {(first / mass).tolist()} m: int z^2 dm about that centre would be {least:.3g} kg m^2 along some axis"
        )
    a, b = field[:, :3], skew(field[:, 3:])  # b w = turn x w
    rest = np.eye(n) - field @ L.T
    if n and (least := np.linalg.eigvalsh((rest + rest.T) / 2)[0]) < -ROUNDED:
        alone = np.diag(field @ L.T)
        raise ValueError(
            f"{owner}: the modes take {1 - least:.8g} times what mass or inertia the body has, must be at most 1; "
            f"most takes mode {alone.argmax() + 1}, {alone.max():.3g} times by itself"
        )
    turned = b @ first
    overlaps = mass * np.einsum("ki,lj->klij", a, a) + np.einsum("ki,lj->klij", a, turned)
    overlaps = overlaps + np.einsum("ki,lj->klij", turned, a) + np.einsum("kia,ab,ljb->klij", b, second, b)
    centre, moving = first / mass, L[:, :3] / mass
    return {
        "mass": mass,
        "first": first,
        "second": second,
        "R": L[:, :3],
        "moments": np.einsum("i,kj->kij", first, a) + np.einsum("ia,kja->kij", second, b),
        "overlaps": overlaps + np.einsum("kl,ij->klij", (rest + rest.T) / 2, np.eye(3) / 3),
        "stiffness": np.diag(omega**2),
        "damping": np.diag(2 * zeta * omega),
        "shortening": np.zeros((n, n, 3)),
        "shortening_moments": np.zeros((n, n, 3, 3)),
        "shortening_overlaps": np.zeros((n, n, n, 3, 3)),
        "shortening_squares": np.zeros((n, n, n, n, 3, 3)),
        "tip": centre,
        "tip_shapes": moving,
        "outline": np.array([np.zeros(3), centre]),
        "outline_shapes": np.stack([np.zeros((n, 3)), moving], axis=1),  # clamped at the root
    }
