"""Valid calls of closed forms of beams and of modal data."""

from __future__ import annotations

from typing import Any

import numpy as np
from argument_kinds import Call, Choice, Flag, Object
from calls_of_declarations import BEAM
from further_kinds import Text
from kinds_of_numbers import POSITIVE, Array, Count, Counts, Number

from pliant.plants import ModalData, ModalNode, Payload, beams
from pliant.plants.beams import OffsetPayload


def beam_calls() -> list[Call]:
    """Roots, shapes and frequencies."""
    ratio: dict[str, Any] = {"low": 0.0}
    n, half = Count(3, low=0), Number(0.5, **ratio)
    loaded = {"tip_mass_ratio": half, "tip_inertia_ratio": half, "tip_coupling_ratio": Number(0.125)}
    system = OffsetPayload(mass=1.0, offset=(0.125, 0.0, 0.0), inertia=0.5, chi=0.5, mu=0.01)
    offset = {
        "mass": half,
        "offset": Array((0.125, 0.0, 0.0)),
        "inertia": Number(0.5, array=True, **ratio),
        "chi": Number(0.5, **POSITIVE),
        "mu": half,
    }
    turning = {"gamma": Number(2.0, **ratio), "n": n, "plane": Choice("flap"), "stiffened": Flag(True)}
    more = {"theory": Choice("euler-bernoulli"), "tip_mass": half, "tip_inertia": half, "hub_radius": half}
    lam = Array((1.0, 2.0), wrong=False)
    return [
        Call("beams.basis", beams.basis, {"kind": Choice("payload"), "n": n} | loaded, compare=False),
        Call("beams.roots", beams.roots, {"boundary": Choice("clamped-free"), "n": n}),
        Call("beams.loaded_roots", beams.loaded_roots, {"n": n, "mass": half, "inertia": half}),
        Call("beams.count_loaded", beams.count_loaded, {"beta": lam, "mass": half, "inertia": half}),
        Call("beams.shapes", beams.shapes, {"boundary": Choice("clamped-free"), "n": n}, compare=False),
        Call(
            "beams.frequencies",
            beams.frequencies,
            {
                "beam": Object(BEAM),
                "n": n,
                "boundary": Choice("clamped-free"),
                "payload": Object(Payload(mass=1.0), none=True),
            },
        ),
        Call(
            "beams.coupled_frequencies",
            beams.coupled_frequencies,
            {"beam": Object(BEAM), "n": n, "payload": Object(Payload(mass=1.0))},
        ),
        Call("beams.rotating_frequencies", beams.rotating_frequencies, turning | more),
        Call("beams.clamped_payload_roots", beams.clamped_payload_roots, {"n": n} | offset),
        Call("OffsetPayload", OffsetPayload, offset, compare=False),
        Call("OffsetPayload.of", OffsetPayload.of, {"beam": Object(BEAM), "payload": Object(Payload(mass=1.0))}),
        Call("OffsetPayload.count", system.count, {"lam": lam}),
        Call("OffsetPayload.equation", system.equation, {"lam": lam}),
        Call("OffsetPayload.roots", system.roots, {"n": n}),
        Call("OffsetPayload.roots_between", system.roots_between, {"low": half, "high": Number(9.0, **ratio)}),
        Call("OffsetPayload.shapes", system.shapes, {"n": n}, compare=False),
        Call(
            "PayloadModes.bending",
            system.shapes(2).bending,
            {"xi": Array((0.5, 1.0), wrong=False), "derivative": Count(1, low=0)},
        ),
        Call(
            "PayloadModes.torsion",
            system.shapes(2).torsion,
            {"xi": Array((0.5, 1.0), wrong=False), "derivative": Count(1, low=0)},
        ),
    ]


def modal_calls() -> list[Call]:
    """Modal integrals."""
    positions = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    shapes = np.array([[[0.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 2.0, 0.0]]])
    nodes = {
        "positions": Array(positions),
        "masses": Array((1.0, 1.0, 2.0)),
        "shapes": Array(shapes),
        "frequencies": Array((3.0,), none=False),
        "damping": Number(0.125, low=0.0, array=True),
        "tip": Count(2, low=None),
    }
    springs = np.diag([4.0, 5.0, 6.0, 4.0, 5.0, 6.0, 4.0, 5.0, 6.0])
    built = {
        "mass": Array(np.diag([1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0])),
        "stiffness": Array(springs),
        "positions": Array(positions),
        "root": Counts((0,), wrong=False),
        "modes": Count(1, low=0),
        "damping": Number(0.125, low=0.0),
    }
    data = ModalData.boom(BEAM, (1, 1))
    body, swung = np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]), np.array([[0.5, 0.0, 0.0, 0.0, 0.25, 0.0]])
    handed = {
        "mass": Array(np.block([[body, swung.T], [swung, np.eye(1)]])),
        "stiffness": Array(np.diag([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0])),
        "boundary": Array(np.zeros((1, 3))),
        "origin": Array((0.0, 0.0, 0.0), none=True),
        "modes": Count(1, low=0, none=True),
        "damping": Number(0.125, low=0.0),
    }
    node = {"name": Text("n"), "position": Array((0.5, 0.0, 0.0)), "shapes": Array(np.ones((1, 3)), wrong=False)}
    return [
        Call("ModalData.from_nodes", ModalData.from_nodes, nodes, compare=False),
        Call("ModalData.from_matrices", ModalData.from_matrices, built, compare=False),
        Call("ModalData.from_craig_bampton", ModalData.from_craig_bampton, handed, compare=False),
        Call("ModalNode", ModalNode, node, compare=False),
        Call("ModalData.boom", ModalData.boom, {"beam": Object(BEAM), "modes": Counts((1, 1))}, compare=False),
        Call(
            "ModalData.panel",
            ModalData.panel,
            {"beam": Object(BEAM), "width": Number(0.5, **POSITIVE), "modes": Counts((1, 1))},
            compare=False,
        ),
        Call(
            "ModalData.rigid",
            ModalData.rigid,
            {"mass": Number(2.0, **POSITIVE), "first": Array((0.5, 0.0, 0.0)), "inertia": Array(np.eye(3))},
            compare=False,
        ),
        Call(
            "ModalData.from_participation",
            ModalData.from_participation,
            {
                "mass": Number(2.0, **POSITIVE),
                "centre": Array((0.5, 0.0, 0.0)),
                "inertia": Array(np.eye(3), wrong=False),
                "frequencies": Array(np.array([1.0, 2.0]), leads=True),
                "damping": Number(0.125, low=0.0, array=True),
                "L_translation": Array(np.zeros((2, 3)), none=True),
                "L_rotation": Array(np.array([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0]])),
            },
            compare=False,
        ),
        Call("ModalData.slowest", data.slowest, {"count": Count(1, low=0)}, compare=False),
        Call("ModalData.keep", data.keep, {"modes": Counts((0,), wrong=False)}, compare=False),
    ]
