"""The ranges in which bodies of a tree that bend hold; their derivations are those of `validity`."""

from __future__ import annotations

import casadi as ca
import numpy as np

from pliant.plants.exact_rotations.strain_link import StrainLink
from pliant.plants.validity.appendages import of_appendage
from pliant.plants.validity.ranges import Range
from pliant.plants.validity.rotating_sections import strains_of
from pliant.plants.validity.slender import NONE_HOLDS, Pull, pulled, slopes, small_slopes

from .bent_beam import BentBeam
from .elastic_body import ElasticBody
from .modal_body import ModalBody
from .strain_beam import StrainBeam

STRAIN = 'kinematics="strain"'
SINGULAR = np.deg2rad(80.0)  # of the turn in x-z; at 90 degrees the angles are singular


def ranges_of(name: str, body: ElasticBody, numbers: ElasticBody, eta: ca.SX, pull: Pull, omega: ca.SX) -> list[Range]:
    """At coordinates eta (n,) of a body whose root turns at omega, under an axial force; `numbers`: the body with
    numbers for its parameters.
    """
    if isinstance(body, ModalBody):
        return of_appendage(name, body.data, eta, omega, ca.SX.zeros(3), body.factor, body.stiffened)
    assert isinstance(body, (BentBeam, StrainBeam))
    assert isinstance(numbers, (BentBeam, StrainBeam))
    found = list[Range]()
    planes = zip("yz", body.straight.planes, numbers.straight.planes, body.straight.parted(eta)[:2], strict=True)
    for axis, link, number, q in planes:
        plane = f"{name} in x-{axis}"
        if isinstance(body, BentBeam):
            found += [*small_slopes(plane, link, q, STRAIN), *pulled(plane, link, number, pull)]
            continue
        found += strains_of(plane, StrainLink(link.beam, link.basis, True), q, pull.at_root(link))
        if axis == "z" and link.basis.n:
            keeps = "the angles of the sections are not singular"
            found.append(Range(f"turn of {plane}", "rad", SINGULAR, keeps, NONE_HOLDS, slopes(link, q)))
    return found
