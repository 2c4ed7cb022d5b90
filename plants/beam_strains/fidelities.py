"""The fidelities of a beam of strains, how one is embedded in another, and the range in which each holds."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.exact_rotations.planar_chain import PlanarChain
from pliant.plants.exact_rotations.projection import nearest
from pliant.plants.exact_rotations.quadrature import Array
from pliant.plants.validity.ranges import Range, largest
from pliant.plants.validity.rotating_sections import FIBRE, fibres
from pliant.plants.validity.slender import STATIONS

from .declaration import MOST_STRAINS
from .rest_shape import is_curved
from .section_frames import TIP

BeamT = TypeVar("BeamT")
Shapes = Callable[[Array], Array]  # xi (k,) -> (k, n)
EXTENSIBLE = "LargeDeflectionBeam with extensible=True"
SHEARABLE = 'LargeDeflectionBeam with theory="timoshenko"'


def ladder(beam: BeamT) -> tuple[BeamT, ...]:
    """One to four shapes without extension and shear, where the beam has them; one to eight with what it has."""
    own: Any = beam
    found = []
    if own.extensible or own.theory != "euler-bernoulli":
        bare = {"extensible": False, "theory": "euler-bernoulli", "points": None}
        found += [dataclasses.replace(own, modes=modes, **bare) for modes in (1, 2, 3, 4)]
    found += [dataclasses.replace(own, modes=modes, points=None) for modes in (1, 2, 3, 4, 6, 8)]
    return tuple(found)


def richest(beam: Any, more: int) -> dict[str, Any]:
    """What the physics of a beam has beside bending and torsion: with any `more`, one more stretch and shear than the
    beam's, which are small and smooth, so that one tells what those left out do.
    """
    found: dict[str, Any] = {"kinematics": "strain", "points": None, "extensible": True, "theory": "timoshenko"}
    found |= {name: min(getattr(beam, name) + min(more, 1), MOST_STRAINS) for name in ("stretches", "shears")}
    return found if beam.strained and beam.segments > 1 else found | {"segments": 1}


def effects(beam: Any) -> dict[str, bool]:
    """What the physics has beside exact rotations, and whether this beam has it."""
    return {"extension": beam.extensible, "shear": beam.theory == "timoshenko"}


def lacking(effect: str) -> dict[str, Any]:
    """The fields of a beam without an effect."""
    fields: dict[str, dict[str, Any]] = {"extension": {"extensible": False}, "shear": {"theory": "euler-bernoulli"}}
    return fields[effect]


def planar_chain(beam: Any) -> PlanarChain | str:
    """The beam as a link in the plane; in words why it is none."""
    if not beam.planar or beam.root not in ("clamped", "driven") or beam.tip_loads != ("force",):
        return f"a beam in the plane, clamped or driven, is known; this one is {beam.root}, planar = {beam.planar}"
    if is_curved(beam.rest_curvature):
        return "a straight beam is known; this one is curved at rest"
    clamped = beam.root == "clamped"
    return PlanarChain(
        links=(beam.beam,),
        root="clamped" if clamped else "motion",
        turning=() if clamped else ("hub_angle",),
        hub_inertia=(0.0,),
        friction=(0.0,),
        payload=beam.payload,
        gravity=beam.gravity[:2],
        sheared=beam.theory == "timoshenko",
    )


def unmodelled(beam: Any) -> tuple[str, ...]:
    """What even the physics leaves out."""
    return (*(("bending out of the plane", "torsion") if beam.planar else ()), "plasticity")


def embedding(fine: Any, simpler: Any) -> Array:
    """Coordinates (n, n of simpler) of the same strains; what the simpler one lacks is zero."""
    own, other = (beam.strained_beam.frames.strains for beam in (fine, simpler))
    blocks = [np.eye(own.travels), fine._rotations[0].embedding(simpler._rotations[0])]
    if not fine.planar:
        blocks.append(fine._rotations[1].embedding(simpler._rotations[1]))
        blocks.append(_projected(_twist_slopes(simpler), _twist_slopes(fine)))
    for kind in ("stretch", "shear_y", "shear_z"):
        blocks.append(_projected(*[partial(strains.rows, kind) for strains in (other, own)]))
    return np.asarray(linalg.block_diag(*blocks))


def _projected(simpler: Shapes, finer: Shapes) -> Array:
    """`nearest`, of any shapes where there are none."""
    m, n = (shapes(TIP).shape[1] for shapes in (simpler, finer))
    return nearest(simpler, finer) if m and n else np.zeros((n, m))


def _twist_slopes(beam: Any) -> Shapes:
    strains = beam.strained_beam.frames.strains
    return (lambda xi: strains.rows("twist", xi)) if beam.strained else (lambda xi: beam._torsion(xi, 1))


def ranges(beam: Any, q: ca.SX, v: ca.SX, accelerations: ca.SX, loads: ca.SX) -> tuple[Range, ...]:
    """Small strains of the fibres; of axis and section where the beam does not have them as coordinates.

    accelerations (k,): those of a root that is driven.
    """
    own, strains = beam.beam, beam.nominal.strained_beam.frames.strains
    curved = []
    for kind, shapes, moment in (("bend", strains.bend, "I_z"), ("flap", strains.flap, "I_y")):
        if shapes is not None:
            curved.append((largest(shapes.curvature(STATIONS), q[strains.slices[kind]]) / own.length, moment))
    pull = beam.loads.pull(loads) + _inertial(beam, v, accelerations)
    found: Sequence[Range] = fibres(own, curved, pull, holds=EXTENSIBLE)
    if beam.extensible:
        size = strains.rows("stretch", STATIONS)
        stretched = largest(size, q[strains.slices["stretch"]])
        found = [dataclasses.replace(found[0], value=found[0].value + stretched)]
    if beam.theory == "euler-bernoulli":
        keeps = "a beam without shear misplaces its points by less than 1 % of the length"
        sheared = pull / own.shear_stiffness
        found = [*found, Range("shear strain of the beam", "1", FIBRE, keeps, SHEARABLE, sheared)]
    return tuple(found)


def _inertial(beam: Any, v: ca.SX, accelerations: ca.SX) -> ca.SX:
    """A bound on the force [N] at the root by weight, spin and acceleration of the root."""
    strains, L, load = beam.nominal.strained_beam.frames.strains, beam.beam.length, beam.payload.mass
    carried, swung = beam.beam.mass + load, beam.beam.mass * L / 2 + load * L
    force = carried * ca.norm_2(ca.vertcat(*beam.gravity))
    if strains.turns >= 0:
        force += swung * v[strains.turns] ** 2
    k = accelerations.shape[0]
    if k:
        force += swung * ca.fabs(accelerations[k - 1])
    return force + carried * ca.norm_2(accelerations[: k - 1]) if k > 1 else force
