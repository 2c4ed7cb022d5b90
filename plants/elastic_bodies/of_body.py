"""A body of a tree as one that bends, in a kinematics; its coordinates, what is measured of it."""

from __future__ import annotations

from pliant.plants.core.signals import Signal
from pliant.plants.multibody_parts.joint import Frame, Joint
from pliant.plants.multibody_parts.tree_beam import TreeBeam
from pliant.plants.multibody_parts.tree_body import TreeBody

from .beam_body import family_signals
from .bent_beam import BentBeam
from .elastic_body import ElasticBody
from .modal_body import ModalBody, modal_signals, place_on
from .strain_beam import StrainBeam

EXACT = "strain"


def elastic_body(body: TreeBody, counts: tuple[int, ...], basis: str, kinematics: str) -> ElasticBody | None:
    """With these shapes by family of a beam, or that many modes; None of a rigid body.

    What modal data hold of shortening is all that is known of their large deflections: "strain" is "stiffened" there.
    """
    stiffened = kinematics in ("stiffened", EXACT)
    if body.modal is not None:
        data = body.modal.slowest(counts[0])
        return ModalBody(data, stiffened, body.stiffness_factor, body.damping_ratio)
    if body.beam is None:
        return None
    straight = TreeBeam(body.beam, counts, basis, stiffened)
    return StrainBeam(straight) if kinematics == EXACT and any(counts) else BentBeam(straight)


def coordinates_of(body: TreeBody, counts: tuple[int, ...]) -> list[Signal]:
    """Names after the body's, and units."""
    return modal_signals(counts[0]) if body.modal is not None else family_signals(counts)


def readings_of(body: TreeBody) -> list[Signal]:
    """What is measured of it, whether it bends in this fidelity or not: `ElasticBody.readings`."""
    axes = "xyz" if body.modal is not None else "yz"
    found = [Signal(f"{body.name}_deflection_{axis}", "m") for axis in axes]
    found += [Signal(f"{body.name}_deflection_{axis}_rate", "m/s") for axis in axes]
    return found + [Signal(f"{body.name}_curvature_{axis}", "1/m") for axis in axes if body.beam is not None]


def check_nodes(bodies: tuple[TreeBody, ...], frames: tuple[Frame, ...]) -> None:
    """ValueError where something hangs on a node that its body's modal data do not have, or of a body without any."""
    modal = {body.name: body.modal for body in bodies if body.modal is not None}
    hung: list[tuple[str, Joint | Frame]] = [(body.parent, body.joint) for body in bodies]
    hung += [(frame.body, frame) for frame in frames]
    for name, part in hung:
        if name in modal:
            place_on(modal[name], name, part)
        elif part.node:
            kind = type(part).__name__
            raise ValueError(
                f"{kind}.node = {part.node!r} of {kind.lower()} {part.name!r} must be '' where body {name!r} has no "
                "modal data: sections of a beam are named by `station`"
            )
