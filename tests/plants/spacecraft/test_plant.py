"""The spacecraft as a whole: parameters that vary."""

import dataclasses

import numpy as np

from pliant.plants.spacecraft_parts.appendage import Hinge


def test_varied_parameters(hinged, anywhere):
    craft = hinged().vary("hub.mass", "appendages.0.hinge.stiffness.0", "appendages.1.stiffness_factor")
    p = [400.0, 150.0, 2.0]
    made = hinged()
    parts = (
        dataclasses.replace(made.appendages[0], hinge=Hinge(axes=((0.0, 1.0, 0.0),), stiffness=150.0)),
        dataclasses.replace(made.appendages[1], stiffness_factor=2.0),
    )
    made = dataclasses.replace(made, hub=dataclasses.replace(made.hub, mass=400.0), appendages=parts)
    x = anywhere(made)
    np.testing.assert_allclose(craft.dynamics(x, p=p), made.dynamics(x), atol=1e-12)
    np.testing.assert_allclose(craft.natural_frequencies(p=p), made.natural_frequencies(), rtol=1e-10)
