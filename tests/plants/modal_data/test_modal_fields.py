"""Named nodes of modal data: kept with the modes, compared, refused."""

import dataclasses
import pickle

import numpy as np
import pytest
from evidence import agrees

from pliant.plants import Beam, ModalData, beams
from pliant.plants.modal_data.modal_fields import ModalNode

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)


def test_a_boom_names_its_tip():
    """Shape 2, slope 2.7530 of the first mode of a cantilever of length 1 with int phi^2 = 1 (Blevins, Table 8-1)."""
    data = ModalData.boom(STRIP, (1, 1))
    tip = data.node("tip")
    np.testing.assert_allclose(np.abs(tip.shapes), [[0, 0, 2], [0, 2, 0]], atol=1e-12)
    wanted = [[0, -2.7530, 0], [0, 0, 2.7530]] * np.sign(tip.shapes.sum(axis=1))[:, None]
    agrees(
        tip.turns,
        wanted,
        within=1e-4,
        absolute=True,
        of="ModalData.boom",
        what="slope of the first mode at the tip",
        source="Blevins (1979), table 8-1",
        kind="table",
    )
    fewer = data.keep([1])
    np.testing.assert_array_equal(fewer.node("tip").shapes, tip.shapes[1:])
    np.testing.assert_array_equal(fewer.node("tip").shortening, tip.shortening[1:, 1:])
    watched = data.node("")
    assert watched.turns is None
    np.testing.assert_array_equal(watched.position, data.tip)


def test_a_panel_twists_its_tip():
    """The corners move by +-2 in the twisting mode: a turn of 4 over the width about x."""
    tip = ModalData.panel(STRIP, width=0.4, modes=(0, 1)).node("tip")
    np.testing.assert_allclose(abs(tip.turns[0, 0]), 4 / 0.4, rtol=1e-9)


def test_nodes_are_compared_and_travel():
    node = ModalNode("n", (1.0, 0, 0), [[0, 1.0, 0]])
    assert node == ModalNode("n", (1.0, 0, 0), [[0, 1.0, 0]])
    assert node != ModalNode("n", (1.0, 0, 0), [[0, 1.0, 0]], [[0, 0, 1.0]])
    assert hash(node) == hash(pickle.loads(pickle.dumps(node)))
    data = ModalData.boom(STRIP, (1, 0))
    assert data != dataclasses.replace(data, nodes=())


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"nodes": (ModalNode("n", (1.0, 0, 0), [[0, 1.0, 0]] * 2),)}, r"ModalData\.nodes\[0\] = 'n' has 2 shapes"),
        ({"nodes": (1,)}, r"ModalData\.nodes\[0\]"),
    ],
)
def test_refused(change, says):
    with pytest.raises(ValueError, match=says):
        dataclasses.replace(ModalData.boom(STRIP, (1, 0)), **change)
    with pytest.raises(ValueError, match=r"ModalNode\.name"):
        ModalNode("", (0, 0, 0), [[0, 0, 1.0]])
    with pytest.raises(ValueError, match=r"ModalNode\.turns"):
        ModalNode("a", (0, 0, 0), [[0, 0, 1.0]], [[0, 0]])
