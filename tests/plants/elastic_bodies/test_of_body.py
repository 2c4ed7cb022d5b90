"""Which kind of body that bends a body of a tree is, and what is measured of it."""

import pytest

from pliant.plants import Beam, Frame, Joint, ModalData, TreeBody, beams
from pliant.plants.elastic_bodies.bent_beam import BentBeam
from pliant.plants.elastic_bodies.modal_body import ModalBody
from pliant.plants.elastic_bodies.of_body import check_nodes, coordinates_of, elastic_body, readings_of
from pliant.plants.elastic_bodies.strain_beam import StrainBeam

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
BEAM = TreeBody(name="b", joint=Joint(name="j"), beam=STRIP)
MODAL = TreeBody(name="m", joint=Joint(name="k"), modal=ModalData.boom(STRIP, (2, 1)))


def test_kinds():
    counts = (2, 2, 1, 0)
    kinds = {k: type(elastic_body(BEAM, counts, "polynomial", k)) for k in ("linear", "stiffened", "strain")}
    assert kinds == {"linear": BentBeam, "stiffened": BentBeam, "strain": StrainBeam}
    assert isinstance(elastic_body(BEAM, (0, 0, 0, 0), "polynomial", "strain"), BentBeam)
    rigid = TreeBody(name="r", joint=Joint(name="i"), mass=1.0)
    assert elastic_body(rigid, (0, 0, 0, 0), "polynomial", "rigid") is None
    modal = elastic_body(MODAL, (2,), "polynomial", "strain")
    assert isinstance(modal, ModalBody)
    assert modal.n == 2
    assert modal.stiffened
    assert not elastic_body(MODAL, (2,), "polynomial", "linear").stiffened


def test_names():
    assert [s.name for s in coordinates_of(BEAM, (1, 2, 1, 1))] == ["y1", "z1", "z2", "twist1", "stretch1"]
    assert [s.unit for s in coordinates_of(BEAM, (1, 0, 1, 1))] == ["m", "rad", "m"]
    assert [s.name for s in coordinates_of(MODAL, (2,))] == ["eta1", "eta2"]
    assert [s.name for s in readings_of(BEAM)][::2] == ["b_deflection_y", "b_deflection_y_rate", "b_curvature_y"]
    assert [s.name for s in readings_of(MODAL)][2:4] == ["m_deflection_z", "m_deflection_x_rate"]


def test_nodes_are_checked():
    check_nodes((MODAL,), (Frame(name="f", body="m", node="tip"), Frame(name="g", body="m")))
    with pytest.raises(ValueError, match="Frame 'f' on body 'm'"):
        check_nodes((MODAL,), (Frame(name="f", body="m", node="nose"),))
