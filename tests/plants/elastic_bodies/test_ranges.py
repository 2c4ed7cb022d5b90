"""Where bodies of a tree that bend say that they hold no more."""

import dataclasses

import numpy as np

from pliant.plants import Beam, FlexibleTree, Joint, ModalData, TreeBody, beams

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)


def told(tree):
    return {r.quantity: r for r in tree.validity}


def test_of_beams_and_of_modal_data():
    beam = FlexibleTree.serial([TreeBody(name="b", joint=Joint(name="j"), beam=STRIP, modes=(1, 1, 0, 0))])
    assert set(told(beam)) == {f"{what} of b in x-{axis}" for axis in "yz" for what in ("slope", "axial strain")}
    assert told(beam)["slope of b in x-y"].holds == 'kinematics="strain"'
    exact = told(dataclasses.replace(beam, kinematics="strain"))
    assert "turn of b in x-z" in exact
    assert exact["turn of b in x-z"].limit == np.deg2rad(80.0)
    assert any("fibres" in name for name in exact)
    data = TreeBody(name="m", joint=Joint(name="j"), modal=ModalData.boom(STRIP))
    modal = told(FlexibleTree.serial([data], kinematics="linear"))
    assert "slope of m" in modal
    assert any("spin" in name for name in modal)
