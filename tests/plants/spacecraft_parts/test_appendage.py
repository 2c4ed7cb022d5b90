"""Hinges, mounting and modes of an appendage."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def test_hinge_turns_follow_the_right_hand():
    """A three-axis hinge: the tip of a rigid bar after quarter turns, by hand."""
    hinge = Hinge(axes=((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)))
    craft = FlexibleSpacecraft(
        hub=CRAFT.hub, appendages=(Appendage(position=(1.0, 0, 0), body=ModalData.boom(BOOM, (0, 0)), hinge=hinge),)
    )
    line = craft.outline(craft.state(hinge1_1=np.pi / 2))[0]
    np.testing.assert_allclose(line[-1], [1.0, 5.0, 0.0], atol=1e-12)
    line = craft.outline(craft.state(hinge1_1=np.pi / 2, hinge1_2=np.pi / 2))[0]
    np.testing.assert_allclose(line[-1], [1.0, 0.0, -5.0], atol=1e-12)


def boom(**changes):
    return Appendage(**{"position": (1.0, 0.0, 0.0), "body": BOOM, **changes})


def test_a_count_of_modes_is_of_the_slowest():
    """Modal data in any order: here two modes out of plane, then the one in plane that lies between them."""
    data = ModalData.boom(BOOM, (1, 2))
    assert data.slowest(2).frequencies == pytest.approx([0.994479295645, 1.98895859129], rel=1e-9)
    part = boom(body=data, modes=2)
    np.testing.assert_array_equal(part.data.stiffness, data.slowest(2).stiffness)
    np.testing.assert_allclose(boom(modes=2).data.frequencies, part.data.frequencies, rtol=1e-12)


def test_lists_and_arrays_become_tuples():
    part = boom(position=np.array([1.0, 0.0, 0.0]), hinge=Hinge(axes=[[0.0, 1.0, 0.0]], stiffness=[3.0]))
    assert part.position == (1.0, 0.0, 0.0) and part.hinge.stiffness == (3.0,)
    same = boom(position=(1.0, 0.0, 0.0), hinge=Hinge(axes=((0.0, 1.0, 0.0),), stiffness=(3.0,)))
    crafts = [FlexibleSpacecraft(hub=CRAFT.hub, appendages=given) for given in ([part], (same,))]
    assert crafts[0] == crafts[1] and hash(crafts[0]) == hash(crafts[1])


BAD_APPENDAGE = {
    "hinge": (lambda: boom(hinge="free"), r"Appendage\.hinge = 'free' must be a Hinge"),
    "flat axes": (lambda: Hinge(axes=(0.0, 1.0, 0.0)), r"Hinge\.axes\[0\] has shape \(\), must be \(3,\)"),
    "negative modes": (lambda: boom(modes=-1), r"Appendage\.modes = -1 must be an integer from 0 to 100"),
    "too many modes": (
        lambda: boom(body=ModalData.boom(BOOM), modes=3),
        r"Appendage\.modes = 3 must be an integer from 0 to 2",
    ),
    "no turn": (lambda: boom(orientation=(0.0, 0.0, 0.0, 0.0)), r"Appendage\.orientation = .* rotation matrix or a q"),
    "hinge axes": (lambda: Hinge(axes=((1.0, 0.0, 0.0),) * 4), r"number of axes = 4 must be an integer from 0 to 3"),
    "hinge axis": (lambda: Hinge(axes=((1.0, 1.0, 0.0),)), r"Hinge\.axes\[0\] = .* must be a unit vector"),
    "hinge stiffness": (
        lambda: Hinge(axes=((1.0, 0, 0),), stiffness=-1.0),
        r"Hinge\.stiffness\[0\] = -1\.0 must be >= 0",
    ),
    "hinge count": (
        lambda: Hinge(axes=((1.0, 0, 0),), stiffness=(1.0, 2.0)),
        r"Hinge\.stiffness .* one value for each of 1",
    ),
    "drive": (lambda: Hinge(drive="belt"), r"Hinge\.drive = 'belt' must be one of 'free'"),
    "orientation": (
        lambda: boom(orientation=((1, 0, 0), (0, 1, 0), (0, 0, -1))),
        r"Appendage\.orientation .* rotation matrix",
    ),
    "body": (lambda: boom(body="boom"), r"Appendage\.body = 'boom' must be a Beam or ModalData"),
    "pair of modes": (
        lambda: boom(body=ModalData.boom(BOOM), modes=(1, 1)),
        r"Appendage\.modes = \(1, 1\) must be a count",
    ),
    "varied body": (
        lambda: CRAFT.vary("appendages.0.body.E").dynamics(CRAFT.state()),
        r"vary its stiffness_factor instead",
    ),
}


@pytest.mark.parametrize("name", BAD_APPENDAGE)
def test_bad_input(name):
    make, words = BAD_APPENDAGE[name]
    with pytest.raises(ValueError, match=words):
        make()
