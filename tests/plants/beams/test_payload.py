"""A payload by its numbers."""

import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.core import parameters


def test_payload_inertia_about_z_and_dotted_names():
    tensor = ((2.0, 0.1, 0.0), (0.1, 2.0, 0.0), (0.0, 0.0, 3.0))
    assert Payload(inertia=tensor).inertia_z == 3.0 and Payload(inertia=0.4).inertia_z == 0.4
    assert Payload(inertia=np.array(tensor)) == Payload(inertia=tensor)
    assert parameters.put(Payload(), "offset.0", 0.2).offset == (0.2, 0.0, 0.0)
    assert parameters.unit_of(Payload(inertia=tensor), "inertia.2.2") == "kg m^2"
    Payload(inertia=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0)))  # a thin plate is on the limit
