"""Bodies handed over as boundary and modal freedoms: a superelement of NASTRAN, as pyYeti checks it."""

import json
from pathlib import Path

import numpy as np
import pytest
from evidence import agrees

from pliant.plants import FlexibleTree, Joint, ModalData, TreeBody
from pliant.plants.core.imports import linalg
from pliant.plants.modal_data.integrals import axial
from pliant.plants.modal_data.modal_fields import ModalNode

OUTBOARD = Path(__file__).resolve().parents[2] / "reference" / "outboard_superelement.json"
OTHERS = OUTBOARD.with_name("nastran_superelements.json")
CORNERS = np.array([[600.0, 0, 300], [600, 300, 300], [600, 300, 0], [600, 0, 0]])  # outboard.asm [in]
TURNED = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # its coordinate system 10: z along x, x along y


@pytest.fixture(scope="module", name="outboard")
def outboard_fixture():
    """(M, K) (46, 46) and the axes of the boundary's four nodes."""
    told = json.loads(OUTBOARD.read_text())
    found = []
    for kind, modal in (("mass", np.eye(22)), ("stiffness", np.diag(told["stiffness"]["modal"]))):
        lower = np.zeros((24, 24))
        for i, row in enumerate(told[kind]["boundary"]):
            lower[i, : i + 1] = row
        between = np.array(told[kind]["modal"]) if kind == "mass" else np.zeros((22, 24))
        found.append(np.block([[lower + np.tril(lower, -1).T, between.T], [between, modal]]))
    axes = np.tile(np.eye(3), (4, 1, 1))
    axes[1] = TURNED
    return *found, axes


def test_a_superelement_of_nastran(outboard):
    """Mass properties and effective masses about the boundary's middle, as pyYeti's cb.cbcheck prints them
    (outboard_cbcheck.out).
    """
    M, K, axes = outboard
    data = ModalData.from_craig_bampton(M, K, CORNERS, axes=axes, damping=0.01)
    told = {"of": "ModalData.from_craig_bampton", "source": "pyYeti, outboard_cbcheck.out", "kind": "other program"}
    agrees(data.mass, 1.5904, within=5e-5, absolute=True, what="mass of an outboard superelement of NASTRAN", **told)
    agrees(data.centre, [-415.360203, 0, 0], within=1e-4, absolute=True, what="its mass centre [in]", **told)
    about = data.inertia - data.mass * (data.centre @ data.centre * np.eye(3) - np.outer(data.centre, data.centre))
    radii = np.sqrt(np.diag(about) / data.mass)
    agrees(radii, [473.742359, 168.508196, 486.443472], within=1e-7, what="its radii of gyration [in]", **told)
    wanted = [1.650, 1.650, 1.674, 1.675, 7.025, 7.025]
    found = data.frequencies[:6] / (2 * np.pi)
    agrees(found, wanted, within=6e-4, absolute=True, what="its first six frequencies [Hz]", **told)
    driven = np.hstack([data.R, axial(data.moments)])
    part = 100 * driven**2 / np.r_[[data.mass] * 3, np.diag(data.inertia)]
    sums = [21.54, 87.57, 87.41, 95.81, 95.98, 97.85]
    agrees(part.sum(axis=0), sums, within=6e-3, absolute=True, what="sums of its effective masses [%]", **told)
    np.testing.assert_allclose(part[2], [0, 0, 0, 83.95, 0, 0], atol=6e-3)
    np.testing.assert_allclose(part[3], [0, 0, 12.24, 0, 12.34, 0], atol=6e-3)
    few = ModalData.from_craig_bampton(M, K, CORNERS, axes=axes, modes=4)
    np.testing.assert_allclose(few.R, data.R[:4], atol=1e-12)
    np.testing.assert_array_equal(np.diag(few.damping), 0.0)


def symmetric(rows):
    """A matrix by the rows of its lower triangle."""
    lower = np.zeros((len(rows), len(rows)))
    for i, row in enumerate(rows):
        lower[i, : i + 1] = row
    return lower + np.tril(lower, -1).T


@pytest.mark.parametrize("name", ["2020", "csuper", "extseout", "notall6"])
def test_other_superelements_of_nastran(name):
    """Mass properties, frequencies and effective masses as pyYeti gives them. The boundary of the last, maa and kaa,
    keeps one freedom of its fourth node."""
    own = json.loads(OTHERS.read_text())["sets"][name]
    Mb, Kb = (symmetric(own[kind]["boundary"]) for kind in ("mass", "stiffness"))
    driven, modal = np.array(own["mass"]["modal"]), np.array(own["stiffness"]["modal"])
    M = np.block([[Mb, driven.T], [driven, np.eye(len(modal))]])
    K = np.block([[Kb, np.zeros_like(driven.T)], [np.zeros_like(driven), np.diag(modal)]])
    axes = np.tile(np.eye(3), (4, 1, 1))
    axes[1] = np.eye(3) if name == "notall6" else TURNED
    freedoms = (*[(1, 2, 3, 4, 5, 6)] * 3, (2,)) if name == "notall6" else None
    data = ModalData.from_craig_bampton(M, K, own["boundary"], axes=axes, freedoms=freedoms)
    told, c = own["told"], data.centre
    of = {"of": "ModalData.from_craig_bampton", "source": "pyYeti, its test sets", "kind": "other program"}
    agrees(data.mass, told["mass"], within=1e-8, what=f"mass of NASTRAN's superelement {name}", **of)
    np.testing.assert_allclose(c, told["centre"], atol=1e-5)
    about = data.inertia - data.mass * (c @ c * np.eye(3) - np.outer(c, c))
    np.testing.assert_allclose(about, told["inertia"], rtol=0, atol=1e-7 * np.abs(about).max())
    agrees(
        data.frequencies / (2 * np.pi),
        told["frequencies"],
        within=1e-8,
        what=f"frequencies of superelement {name}",
        **of,
    )
    factors = np.hstack([data.R, axial(data.moments)])
    part = 100 * factors**2 / np.r_[[data.mass] * 3, np.diag(data.inertia)]
    what = f"effective masses of superelement {name} [%]"
    agrees(part, told["effective"], within=1e-5, absolute=True, what=what, **of)


@pytest.mark.parametrize(
    ("freedoms", "message"),
    [
        (((1, 2, 3, 4, 5, 6),) * 3, "names 3 nodes, must be 4"),
        ((*[(1, 2, 3, 4, 5, 6)] * 3, (7,)), r"freedoms\[3\] = 7 must be an integer from 1 to 6"),
        ((*[(1, 2, 3, 4, 5, 6)] * 3, (2, 1)), "ascending, each once"),
        ((*[(1, 2, 3, 4, 5, 6)] * 3, (2,)), "must be square with at least 19 rows|a rigid motion meets"),
        (((1,), (1,), (1,), (1,)), "must tell each rigid motion"),
    ],
)
def test_bad_freedoms(outboard, freedoms, message):
    M, K, axes = outboard
    with pytest.raises(ValueError, match=message):
        ModalData.from_craig_bampton(M, K, CORNERS, axes=axes, freedoms=freedoms)


def test_it_swings_on_a_joint(outboard):
    """Its modes on a hinge: those of M and K themselves, but for the hinge's turn held."""
    M, K, axes = outboard
    body = TreeBody(name="a", joint=Joint(name="j"), modal=ModalData.from_craig_bampton(M, K, CORNERS, axes=axes))
    tree = FlexibleTree.serial([body], gravity=(0, 0, 0))
    T = np.zeros((46, 23))
    for k, (at, C) in enumerate(zip(CORNERS - CORNERS.mean(axis=0), axes, strict=True)):
        T[6 * k : 6 * k + 3, 0], T[6 * k + 3 : 6 * k + 6, 0] = C.T @ np.cross([0, 0, 1.0], at), C.T @ [0, 0, 1.0]
    T[24:, 1:] = np.eye(22)
    wanted = np.sqrt(np.abs(linalg.eigh(T.T @ K @ T, T.T @ M @ T, eigvals_only=True)))
    np.testing.assert_allclose(tree.natural_frequencies()[-22:], wanted[1:], rtol=1e-6)


def test_a_node_is_mixed_as_the_modes_are(outboard):
    """Modal freedoms in another order and size give the same modes, and the same node."""
    M, K, axes = outboard
    rng = np.random.default_rng(0)
    shapes, turns = rng.normal(size=(2, 22, 3))
    mix = np.diag(rng.uniform(0.5, 2, 22))[rng.permutation(22)]
    S = np.eye(46)
    S[24:, 24:] = mix
    at = CORNERS.mean(axis=0) + np.array([-100.0, 0, 0])
    first, other = (
        ModalData.from_craig_bampton(A, B, CORNERS, axes=axes, nodes=[ModalNode("n", at, by @ shapes, by @ turns)])
        for A, B, by in ((M, K, np.eye(22)), (S.T @ M @ S, S.T @ K @ S, mix.T))
    )
    sign = np.sign((first.node("n").shapes * other.node("n").shapes).sum(axis=1))[:, None]
    np.testing.assert_allclose(other.frequencies, first.frequencies, rtol=1e-9)
    np.testing.assert_allclose(sign * other.node("n").shapes, first.node("n").shapes, atol=1e-8)
    np.testing.assert_allclose(sign * other.node("n").turns, first.node("n").turns, atol=1e-8)
    np.testing.assert_allclose(first.node("n").position, [-100.0, 0, 0])


def test_refused(outboard):
    M, K, axes = outboard
    make = ModalData.from_craig_bampton
    with pytest.raises(ValueError, match=r"from_craig_bampton\.boundary: a rigid motion meets"):
        make(M, K, CORNERS)  # all in the body's axes
    with pytest.raises(ValueError, match="must be square with at least 48 rows"):
        make(M, K, np.tile(CORNERS, (2, 1)))
    coupled = K.copy()
    coupled[0, 30] = coupled[30, 0] = 1e3
    with pytest.raises(ValueError, match="couples boundary and modes"):
        make(M, coupled, CORNERS, axes=axes)
    with pytest.raises(ValueError, match=r"from_craig_bampton\.modes = 23"):
        make(M, K, CORNERS, axes=axes, modes=23)
    with pytest.raises(ValueError, match=r"from_craig_bampton\.mass: the modes take .* times what mass"):
        heavy = M.copy()
        heavy[24:, :24], heavy[:24, 24:] = 2 * M[24:, :24], 2 * M[:24, 24:]
        make(heavy, K, CORNERS, axes=axes)
    with pytest.raises(ValueError, match="'n' has 1 shapes"):
        make(M, K, CORNERS, axes=axes, nodes=[ModalNode("n", (0, 0, 0), [[0, 0, 1.0]])])
    soft = K.copy()
    soft[24, 24] = -1.0
    with pytest.raises(ValueError, match="mode 1 has omega"):
        make(M, soft, CORNERS, axes=axes)
